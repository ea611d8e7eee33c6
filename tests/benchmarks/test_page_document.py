"""The document of the page's speed takes what its scripts print."""

import shutil

from cutcell_lab.benchmarks.document import PAGE_SPEED, fill


def test_all_tables_have_their_place(tmp_path):
    copy = tmp_path / "copy.md"
    shutil.copy(PAGE_SPEED, copy)
    fill(copy, {"page": "| one |", "joints": "| three |", "sessions": "| two |"})
    text = copy.read_text()
    assert text.index("<!-- page -->\n| one |") < text.index("<!-- sessions -->\n| two |")
    assert text.startswith("# Page latency")
