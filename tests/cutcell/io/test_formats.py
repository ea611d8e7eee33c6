"""The registry of file formats, and the document that lists them."""

import re
from pathlib import Path

from cutcell.io.formats import BY_SUFFIX, FORMATS, described, suffixes
from tests.conftest import ROOT

FUNCTIONS = ("read", "write", "read_skeleton")


def listed(path: Path) -> dict[frozenset[str], list[bool]]:
    """Return what a document says of formats, by their suffixes, in order of `FUNCTIONS`."""
    rows = re.findall(r"^\|[^|]+\|((?: `\.\w+`,?)+) \| (.+) \|$", path.read_text("utf-8"), re.M)
    return {
        frozenset(re.findall(r"`(\.\w+)`", files)): [cell == "yes" for cell in cells.split(" | ")]
        for files, cells in rows
    }


def test_the_document_lists_each_format():
    expected = {
        frozenset(one.suffixes): [name in one.functions for name in FUNCTIONS] for one in FORMATS
    }
    assert listed(ROOT / "docs" / "formats.md") == expected


def test_each_suffix_is_of_one_format():
    assert len(BY_SUFFIX) == sum(len(one.suffixes) for one in FORMATS)
    assert all(suffix == suffix.lower() and suffix.startswith(".") for suffix in BY_SUFFIX)


def test_lists_hold_what_has_a_function():
    assert {".glb", ".npz", ".txt"} <= set(suffixes("write")) <= set(suffixes("read"))
    assert ".json" in described("read_skeleton")
    assert ".json;" not in described("read")
