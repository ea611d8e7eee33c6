"""The page's rooms: arrows run one way, and nothing imports in a circle, not even for types."""

import ast
import subprocess
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import param
import pytest

from cutcell_app.document.state import State
from tests.test_layers import ROOT, imports_of, modules_of, package_of

APP = ROOT / "app"

ROOMS = (
    {"editing", "messages"},
    {"derive", "server"},
    {"document", "features", "files", "widgets"},
    {"headless", "shell"},
    {"serve"},
    {"command_line"},
)
"""Each may use itself, those beside it and those before it; the last are the commands."""
RANK = {room: rank for rank, rooms in enumerate(ROOMS) for room in rooms}


def graph_of(names: list[str]) -> dict[str, set[str]]:
    """Return which modules of `app` each one imports, under TYPE_CHECKING and in functions, too."""
    known = set(names)
    graph: dict[str, set[str]] = {}
    for name in names:
        path = APP / Path(*name.split(".")[1:])
        path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
        graph[name] = {result for result in used_by(path) if result in known}
    return graph


def used_by(path: Path) -> set[str]:
    """Return all that a file imports: `from ..commands import pose` is of both."""
    package = package_of(path)
    result = {name for name, _ in imports_of(path)}
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level and node.module:
            base = (*package[: len(package) - node.level + 1], node.module)
            result |= {".".join((*base, alias.name)) for alias in node.names}
    return result


def test_nothing_imports_in_a_circle():
    graph = graph_of(modules_of("cutcell_app"))
    assert sum(map(len, graph.values())) > 100, "the imports were not found"
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(" -> ".join(error.args[1]))


def test_rooms_use_only_those_before_them():
    rooms = {path.stem for path in APP.glob("*.py")} - {"__init__"}
    rooms |= {path.parent.name for path in APP.glob("*/__init__.py")}
    assert rooms == set(RANK)
    wrong = [
        f"{name} imports {used}"
        for name, all_used in graph_of(modules_of("cutcell_app")).items()
        for used in all_used
        if name.count(".") and used.count(".")
        if (a := name.split(".")[1]) != (b := used.split(".")[1]) and RANK[b] > RANK[a]
    ]
    assert wrong == []


def test_commands_know_no_widget_and_no_server_and_these_no_plotting_library():
    # matplotlib takes 60 MB of memory, VTK 75, and both time until the page is there.
    code = (
        "import sys, cutcell_app.headless, cutcell_app.shell.watchers\n"
        "import cutcell_app.document.arrival\n"
        "print({'panel', 'bokeh', 'tornado'} & set(sys.modules))\n"
        "import cutcell_app.serve\n"
        "print({'matplotlib', 'pyvista', 'vtk', 'vtkmodules'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.stdout.split() == ["set()", "set()"], done.stdout + done.stderr


def test_each_choice_of_the_state_is_declared_once():
    # One of two with the same name would silently stand for both.
    classes = [one for one in State.__mro__ if one.__module__.startswith("cutcell_app.")]
    names = [
        name for one in classes for name, value in vars(one).items()
        if isinstance(value, param.Parameter) and name != "name"
    ]  # fmt: skip
    assert len(names) > 100
    assert sorted(names) == sorted(set(names))
