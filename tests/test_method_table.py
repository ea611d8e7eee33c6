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
    "cutcell_lab.metrics",
    "cutcell.pose",
    "cutcell_lab.baselines.methods",
)
PAPER = ("algorithm 1", "algorithm 2", "equation 1", "section 4.3", "section 4.3.1")


def rows() -> list[tuple[str, str, str, list[str]]]:
    """Return what the paper has, file, function and callers of each row."""
    text = (ROOT / "docs" / "method.md").read_text(encoding="utf-8")
    table = text[: text.index("## 1. ")]
    cells = [
        re.split(r"\s*\|\s*", line.strip("| ")) for line in re.findall(r"^\|.*\|$", table, re.M)
    ]
    result = []
    for what, *code in cells[2:]:  # after the heading and the line below it
        file, function, *callers = (re.findall(r"`([^`]+)`", cell) for cell in code)
        result.append((what, file[0], function[0], callers[0] if callers else []))
    return result


def imported(file: str, function: str):
    module = re.sub(r"^lab\b", "cutcell_lab", file.removesuffix(".py").replace("/", "."))
    return getattr(importlib.import_module(module), function)


def public(name: str):
    for module in PUBLIC:
        result = getattr(importlib.import_module(module), name, None)
        if result is not None:
            return result
    pytest.fail(f"{name} is not public")


def test_each_function_is_there_and_near_a_public_name():
    faults = {}
    for what, file, function, callers in rows():
        if not imported(file, function).__doc__:
            faults[what, function] = "no docstring"
        elif len(callers) > MAX_CALLS:
            faults[what, function] = callers
        elif broken := first_broken_call([*callers, function], imported(file, function)):
            faults[what, function] = broken
    assert faults == {}


def first_broken_call(path: list[str], function) -> str:
    """Return what is wrong on the way from a public name to a function, empty if nothing is."""
    caller = public(path[0])
    for name in path[1:]:
        if not re.search(rf"\b{name}\b", inspect.getsource(caller)):
            return f"{caller} does not call {name}"
        caller = vars(inspect.getmodule(caller))[name]
    return "" if caller is function else f"{caller} is another function"


def test_the_table_names_what_the_paper_has():
    text = " ".join(what for what, *_ in rows())
    assert all(part in text for part in PAPER)
    assert len(rows()) > len(PAPER)
    assert cutcell.build_graph is imported("cutcell/graph/build.py", "build_graph")
