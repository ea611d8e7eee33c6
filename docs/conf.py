"""Settings of the documentation site: `make docs`. Nothing is fetched from elsewhere."""

import re
import sys
import tomllib
from pathlib import Path
from zipfile import ZipFile

DOCS = Path(__file__).resolve().parent
sys.path[:0] = [str(DOCS), str(DOCS.parent)]

import one_file_pages  # noqa: E402

import cutcell  # noqa: E402

project = "cutcell"
author = "The cutcell authors"
copyright = "2026, the cutcell authors"
version = release = cutcell.__version__

extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = ["README.md"]  # the list of documents in the checkout
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 4

autosummary_generate = True
autosummary_context = {"with_a_page": ", ".join(cutcell.__all__)}
autodoc_typehints = "none"  # the docstrings name the types
autodoc_preserve_defaults = True
default_role = "py:obj"
templates_path = ["_templates"]
numpydoc_show_class_members = False

sphinx_gallery_conf = {
    "examples_dirs": ["gallery", "tutorials"],
    "gallery_dirs": ["auto_gallery", "auto_tutorials"],
    "filename_pattern": "",
    "image_scrapers": ("gallery_pictures", "matplotlib"),
    "download_all_examples": False,
    "show_signature": False,
    "capture_repr": ("_repr_html_",),  # interactive pages, and tables of counts
    "min_reported_time": 1e9,
    "within_subsection_order": "FileNameSortKey",
}

html_theme = "pydata_sphinx_theme"
html_title = "cutcell"
html_theme_options = {
    "navigation_with_keys": False,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
}
html_show_sphinx = False
html_copy_source = False
html_extra_path = [one_file_pages.PAGES.name]
copybutton_prompt_text = r">>> |\$ "
copybutton_prompt_is_regexp = True

REPOSITORY = tomllib.loads((DOCS.parent / "pyproject.toml").read_text())["tool"]["cutcell"][
    "repository"
]

TEACHING = DOCS / "teaching"
with ZipFile(TEACHING / "exercises.zip", "w") as archive:
    for part in ("*.py", "*.npz", "*_*/*stub.py", "*_*/reference.png"):
        for path in sorted((TEACHING / "exercises").glob(part)):
            archive.write(path, path.relative_to(TEACHING))


def setup(app):
    """Let links to files outside this folder lead into the repository, or leave them out."""

    def outside(app, name, source):
        if "/" not in name:  # in a folder below, `..` is this one
            link = rf"[\1]({REPOSITORY}/blob/main/\2)" if REPOSITORY else r"\1"
            source[0] = re.sub(r"\[([^]]*)\]\(\.\./([^)]*)\)", link, source[0])

    app.connect("source-read", outside)
    app.connect("config-inited", lambda *_: one_file_pages.main(), 100)  # before paths are checked
