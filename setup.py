"""Which packages are installed, and under which names; all else is in pyproject.toml.

What is installed at top level begins with `cutcell`, so that it meets no other package of that name
on the path. In the checkout the page's folder is `app`, and so on.
"""

import re
from pathlib import Path

from setuptools import find_packages, setup

FOLDERS = {
    "cutcell_app": "app",
    "cutcell_assets": "assets",
    "cutcell_lab": "lab",
    "cutcell_viewers": "viewers",
}
FILES = "https://raw.githubusercontent.com/cutcell/cutcell/main/"
PAGES = "https://github.com/cutcell/cutcell/blob/main/"


def readme():
    """Return README.md with absolute links: on PyPI there is no folder around it."""
    text = (Path(__file__).parent / "README.md").read_text(encoding="utf-8")
    text = re.sub(r'((?:src|srcset)="|!\[[^]]*\]\()(?!http)', rf"\1{FILES}", text)
    return re.sub(r"\]\((?!http|#)", f"]({PAGES}", text)


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
)
