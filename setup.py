"""Which packages are installed, and under which names; all else is in pyproject.toml.

What is installed at top level begins with `cutcell`, so that it meets no other package of that name
on the path. In the checkout the page's folder is `app`, and so on.
"""

from setuptools import find_packages, setup

FOLDERS = {"cutcell_app": "app", "cutcell_assets": "assets", "cutcell_viewers": "viewers"}

packages = find_packages(include=["cutcell", "cutcell.*"])
for name, folder in FOLDERS.items():
    packages += [name, *(f"{name}.{below}" for below in find_packages(folder))]

setup(packages=packages, package_dir=FOLDERS)
