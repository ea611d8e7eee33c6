"""Which packages are installed, and under which names; all else is in pyproject.toml.

What is installed at top level begins with `cutcell`, so that it meets no other package of that name
on the path. In the checkout the page's folder is `app`, and so on.
"""

import re
import tomllib
from pathlib import Path

from setuptools import find_packages, setup

FOLDERS = {
    "cutcell_app": "app",
    "cutcell_assets": "assets",
    "cutcell_lab": "lab",
    "cutcell_viewers": "viewers",
}
ROOT = Path(__file__).parent
REPOSITORY = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"][
    "cutcell"
]["repository"]


def readme():
    """Return README.md for a package index: its links are absolute or left out."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    if not REPOSITORY:
        text = re.sub(r"!\[[^]]*\]\((?!http)[^)]*\)\n*", "", text)
        return re.sub(r"\[([^]]*)\]\((?!http|#)[^)]*\)", r"\1", text)
    text = re.sub(r"(!\[[^]]*\]\()(?!http)", rf"\1{REPOSITORY}/raw/main/", text)
    return re.sub(r"\]\((?!http|#)", f"]({REPOSITORY}/blob/main/", text)


def urls():
    """Return the links that a package index shows beside the description."""
    if not REPOSITORY:
        return {}
    changelog, issues = f"{REPOSITORY}/blob/main/CHANGELOG.md", f"{REPOSITORY}/issues"
    return {"Homepage": REPOSITORY, "Changelog": changelog, "Issues": issues}


packages = find_packages(include=["cutcell", "cutcell.*"])
for name, folder in FOLDERS.items():
    # Benchmarks need a checkout.
    below = find_packages(folder, exclude=["benchmarks"])
    packages += [name, *(f"{name}.{package}" for package in below)]

setup(
    packages=packages,
    package_dir=FOLDERS,
    long_description=readme(),
    long_description_content_type="text/markdown",
    project_urls=urls(),
)
