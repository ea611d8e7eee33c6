"""The document of the page's speed takes what its two scripts print."""

import shutil

from benchmarks.document import PAGE_SPEED, fill


def test_both_tables_have_their_place(tmp_path):
    copy = tmp_path / "copy.md"
    shutil.copy(PAGE_SPEED, copy)
    fill(copy, {"page": "| one |", "sessions": "| two |"})
    text = copy.read_text()
    assert text.index("<!-- page -->\n| one |") < text.index("<!-- sessions -->\n| two |")
    assert text.startswith("# How soon")
