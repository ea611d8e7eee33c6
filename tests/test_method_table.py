"""The table in docs/method.md: each function exists, at most two calls from a public name."""

import importlib
import inspect
import re
from pathlib import Path

import pytest

import cutcell

ROOT = Path(__file__).resolve().parent.parent
MAX_CALLS = 2
PUBLIC = (
    "cutcell",
    "cutcell.geodesics",
    "cutcell.metrics",
    "cutcell.pose",
    "cutcell.baselines.methods",
)
PAPER = ("algorithm 1", "algorithm 2", "equation 1", "section 4.3", "section 4.3.1")


def rows() -> list[tuple[str, str, str, list[str]]]:
    """Return what the paper has, file, function and callers of each row."""
    text = (ROOT / "docs" / "method.md").read_text(encoding="utf-8")
    table = text[: text.index("## 1. ")]
    cells = [
        re.split(r"\s*\|\s*", line.strip("| ")) for line in re.findall(r"^\|.*\|$", table, re.M)
    ]
    found = []
    for what, *code in cells[2:]:  # after the heading and the line below it
        file, function, *callers = (re.findall(r"`([^`]+)`", cell) for cell in code)
        found.append((what, file[0], function[0], callers[0] if callers else []))
    return found


def imported(file: str, function: str):
    module = file.removesuffix(".py").replace("/", ".")
    return getattr(importlib.import_module(module), function)


def public(name: str):
    for module in PUBLIC:
        found = getattr(importlib.import_module(module), name, None)
        if found is not None:
            return found
    pytest.fail(f"{name} is not public")


@pytest.mark.parametrize("row", rows(), ids=lambda row: f"{row[0]} {row[2]}")
def test_each_function_is_found_and_near_a_public_name(row):
    _, file, function, callers = row
    found = imported(file, function)
    assert found.__doc__
    assert len(callers) <= MAX_CALLS
    path = [*callers, function]
    here = public(path[0])
    for name in path[1:]:
        assert re.search(rf"\b{name}\b", inspect.getsource(here)), f"{here} does not call {name}"
        here = vars(inspect.getmodule(here))[name]
    assert here is found


def test_the_table_names_what_the_paper_has():
    text = " ".join(what for what, *_ in rows())
    assert all(part in text for part in PAPER)
    assert len(rows()) > len(PAPER)
    assert cutcell.build_graph is imported("cutcell/graph/build.py", "build_graph")
