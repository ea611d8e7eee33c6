"""What people are told: sentences, without folders, without what a terminal or HTML obeys."""

import errno
import logging
import os
from html import unescape

import panel_material_ui as pmui
import pytest

from cutcell.errors import FileError
from cutcell.runtime.display import printable
from cutcell_app.server.log import Printable
from cutcell_app.server.messages import error_text, sentence
from cutcell_app.widgets.text import as_text, unique_names


@pytest.mark.parametrize(
    ("error", "expected"),
    [
        (FileError("/tmp/cutcell-a/b/rig.glb: the file is empty"), "rig.glb: the file is empty."),
        (FileError('joint "a\x1b[31m\nb" is bad'), 'Joint "a\\x1b[31m\\nb" is bad.'),
        (MemoryError("Unable to allocate 44.0 GiB"), "Not enough memory. "),
        (
            OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "/tmp/cutcell-x/a.csv"),
            "The server's disk is full. ",
        ),
        (PermissionError(errno.EACCES, "Permission denied", "/srv/x"), "Permission denied)"),
        (RuntimeError("cannot read /home/ann/x/y.py"), "(RuntimeError: cannot read y.py)"),
    ],
)
def test_errors_are_told_without_folders(error, expected):
    message = error_text(error)
    assert expected in message
    assert message.endswith(".")
    assert "/" not in message


def test_sentences():
    assert sentence("it failed") == "It failed."
    assert sentence("Done!") == "Done!"
    assert sentence("bad.glb: not a file") == "bad.glb: not a file."


def test_the_log_obeys_nobody():
    record = logging.makeLogRecord({"msg": "GET /\x1b[31m\x9b1m%s", "args": ("a\u202eb",)})
    try:
        raise ValueError("\x1b]0;owned\x07")
    except ValueError as error:
        record.exc_info = (type(error), error, error.__traceback__)
    text = Printable().format(record)
    assert not {"\x1b", "\x9b", "\x07", "\u202e"} & {*text}
    assert text.count("\n") >= 3, "a traceback keeps its lines"


@pytest.mark.parametrize(
    "text",
    [
        "<b>x</b>", "*x* **y** _z_ `c`", "[x](https://example.org)", "www.example.org", "1. x",
        "2) x", "- x", "# x", "> x", "&lt;b&gt;", "\\*", "a:b", "https://x", "it's, so; well. No!",
        "!", "\n", "    x",
    ],
)  # fmt: skip
def test_texts_are_neither_markdown_nor_html(text):
    sent = pmui.Typography(as_text(text))._transform_object(as_text(text))["object"]
    put_on_the_page = unescape(sent).strip()
    assert put_on_the_page.startswith("<p>")
    assert put_on_the_page.endswith("</p>")
    inner = put_on_the_page[3:-4]
    assert "<" not in inner
    assert unescape(inner).strip() == printable(text).strip()


def test_no_text_is_none():
    assert as_text("") == as_text(None) == ""


def test_names_of_a_menu_can_be_told_apart():
    names = unique_names(["a", "a", "a (1)", "x" * 90, "x" * 91, "\x1b"])
    assert len({*names}) == 6
    assert names[0] == "a"
    assert "\x1b" not in "".join(names)
    assert len(unique_names(["a"] * 20_000)) == 20_000
