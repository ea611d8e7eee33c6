"""Layers of the page: imports run one way and in no cycle, not even for types."""

import ast
import subprocess
import sys
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import param
import pytest

from cutcell_app.features.state import PageState
from tests.test_layers import ROOT, imports_of, modules_of, package_of

APP = ROOT / "app"

LAYERS = (
    {"derive", "server"},
    {"files"},
    {"document"},
    {"widgets"},
    {"looks"},
    {"editing"},
    {"features"},
    {"headless", "shell"},
    {"serve"},
    {"command_line"},
)
"""Each may use itself, those beside it and those before it; the last are the commands."""
RANK = {name: rank for rank, names in enumerate(LAYERS) for name in names}
MAX_ENTRIES = 15


def graph_of(names: list[str]) -> dict[str, set[str]]:
    """Return which modules of `app` each one imports, under TYPE_CHECKING and in functions, too."""
    known = set(names)
    graph: dict[str, set[str]] = {}
    for name in names:
        path = APP / Path(*name.split(".")[1:])
        path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
        graph[name] = {result for result in used_by(path) if result in known}
    return graph


@cache
def page_graph() -> dict[str, set[str]]:
    """Return the imports between all modules of the page."""
    return graph_of(modules_of("cutcell_app"))


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
    graph = page_graph()
    assert sum(map(len, graph.values())) > 100, "the imports were not found"
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(" -> ".join(error.args[1]))


def test_layers_use_only_those_before_them():
    names = {path.stem for path in APP.glob("*.py")} - {"__init__"}
    names |= {path.parent.name for path in APP.glob("*/__init__.py")}
    assert names == set(RANK)
    wrong = [
        f"{name} imports {used}"
        for name, all_used in page_graph().items()
        for used in all_used
        if name.count(".") and used.count(".")
        if (a := name.split(".")[1]) != (b := used.split(".")[1]) and RANK[b] > RANK[a]
    ]
    assert wrong == []


def test_folders_import_each_other_in_no_cycle():
    folders: dict[str, set[str]] = {}
    for name, used in page_graph().items():
        folders.setdefault(folder_of(name), set()).update(map(folder_of, used))
    graph = {name: used - {name} for name, used in folders.items()}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(" -> ".join(error.args[1]))


def folder_of(module: str) -> str:
    """Return the folder of a module, which a package is itself."""
    path = APP / Path(*module.split(".")[1:])
    return module if path.is_dir() else module.rpartition(".")[0]


def features() -> list[str]:
    return sorted(path.parent.name for path in (APP / "features").glob("*/__init__.py"))


@pytest.mark.parametrize("feature", features())
def test_features_import_no_other_feature(feature):
    package = f"cutcell_app.features.{feature}."
    others = {
        f"{name} imports {used}"
        for name, all_used in page_graph().items()
        for used in all_used
        if f"{name}.".startswith(package)
        if used.startswith("cutcell_app.features") and not f"{used}.".startswith(package)
    }
    assert others == set()


def test_folders_can_be_taken_in_at_a_glance():
    folders = [path for path in APP.rglob("*") if path.is_dir()]
    folders = [path for path in (APP, *folders) if path.name != "__pycache__"]
    count = {path: len({*path.iterdir()} - {path / "__pycache__"}) for path in folders}
    large = {str(path): n for path, n in count.items() if n > MAX_ENTRIES}
    assert large == {}


def test_commands_know_no_widget_and_no_server_and_these_no_plotting_library():
    # matplotlib takes 60 MB of memory, VTK 75, and both time until the page is there.
    code = (
        "import sys, cutcell_app.headless, cutcell_app.shell.session.watchers\n"
        "import cutcell_app.document.loading\n"
        "print({'panel', 'bokeh', 'tornado'} & set(sys.modules))\n"
        "import cutcell_app.serve\n"
        "print({'matplotlib', 'pyvista', 'vtk', 'vtkmodules'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.stdout.split() == ["set()", "set()"], done.stdout + done.stderr


def test_each_choice_of_the_state_is_declared_once():
    # One of two with the same name would silently stand for both.
    classes = [one for one in PageState.__mro__ if one.__module__.startswith("cutcell_app.")]
    names = [
        name for one in classes for name, value in vars(one).items()
        if isinstance(value, param.Parameter) and name != "name"
    ]  # fmt: skip
    assert len(names) > 100
    assert sorted(names) == sorted(set(names))
