"""Tables in documents that people write: between marks that name them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from cutcell.runtime.writing import write_all

from .rigs import ROOT

PAGE_SPEED = ROOT / "docs" / "page-speed.md"


def fill(path: Path, blocks: Mapping[str, str]) -> None:
    """Replace what stands between `<!-- NAME -->` and `<!-- /NAME -->` of a document.

    Parameters
    ----------
    path : Path
        A Markdown file.
    blocks : mapping of names to Markdown

    Raises
    ------
    ValueError
        The document lacks a mark.
    """
    text = path.read_text(encoding="utf-8")
    for name, block in blocks.items():
        begin, end = f"<!-- {name} -->", f"<!-- /{name} -->"
        head, marks, rest = text.partition(begin)
        _, closed, tail = rest.partition(end)
        if not marks or not closed:
            raise ValueError(f"{path.name} lacks the marks {begin} and {end}")
        text = f"{head}{begin}\n{block.strip()}\n{end}{tail}"
    write_all({path: text.encode()})
