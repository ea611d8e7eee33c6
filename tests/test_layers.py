"""Imports follow the layers app -> viewers -> cutcell, and those inside the core."""

import ast
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
HEAVY = {
    "matplotlib",
    "numba",
    "numpy",
    "pandas",
    "panel",
    "pyvista",
    "scipy",
    "torch",
    "trimesh",
    "vtk",
}
FOLDERS = {"cutcell": "cutcell", "cutcell_viewers": "viewers", "cutcell_app": "app"}
"""Where the packages lie."""
PAGE = {"bokeh", "cutcell_app", "panel", "panel_material_ui"}
PICTURES = {"cutcell_viewers", "pyvista", "vtk", "vtkmodules"}
IMPORT_SECONDS = 0.3
TORCH = [
    path.relative_to(ROOT).as_posix()
    for path in sorted((ROOT / "cutcell").rglob("*.py"))
    if re.search(r"^(import|from) torch\b", path.read_text(encoding="utf-8"), re.MULTILINE)
]
"""Files that import torch at once."""
SHORT_CHAINS = ("surface", "winding", "graph", "geodesics")
LONGEST_CHAIN = 6

# Each part of the core may use itself and those on lines above it.
ORDER = [
    {
        "apart",
        "arrays",
        "checks",
        "colors",
        "compiled",
        "display",
        "errors",
        "hierarchy",
        "inputs",
        "compile_cache",
        "corrections",
        "memory",
        "method",
        "motion",
        "progress",
        "rig",
        "sorting",
        "standard_output",
        "subprocesses",
        "threads",
        "triangles",
        "unions",
        "writing",
    },
    {"deform"},
    {"io"},
    {"surface"},
    {"winding"},
    {"graph"},
    {"geodesics"},
    {"skinning", "templates"},
    {"pose"},
    {"metrics"},
    {"workers"},
    {"baselines", "diagnosis", "dataset"},
    {"networks"},
    {"summary", "compare"},
    {
        "options",
        "console",
        "report",
        "bind_command",
        "clean_command",
        "diagnose_command",
        "explain_command",
        "dataset_audit_command",
        "dataset_command",
        "networks_command",
        "graph_command",
        "render_command",
        "joints_command",
        "cli",
        "__main__",
    },
]
RANK = {part: rank for rank, parts in enumerate(ORDER) for part in parts}


def modules_of(package: str) -> list[str]:
    """Names of all modules of a package here, found by their files, but those that import torch.

    These are the networks' own; tests_networks imports them.
    """
    names = []
    folder = ROOT / FOLDERS[package]
    for path in sorted(folder.rglob("*.py")):
        if path.relative_to(ROOT).as_posix() in TORCH:
            continue
        parts = (package, *path.relative_to(folder).with_suffix("").parts)
        if parts[-1] != "__main__":  # importing it runs the command
            names.append(".".join(parts[:-1] if parts[-1] == "__init__" else parts))
    return names


def loaded_by(modules: list[str]) -> set[str]:
    """Top-level packages in memory once a fresh Python has imported these modules."""
    code = (
        f"import importlib, json, sys\n"
        f"for name in {modules!r}: importlib.import_module(name)\n"
        f"print(json.dumps(sorted({{name.partition('.')[0] for name in sys.modules}})))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=False
    )
    assert done.returncode == 0, done.stderr
    return set(json.loads(done.stdout.splitlines()[-1]))


@pytest.mark.parametrize("module", ["cutcell", "cutcell.cli"])
def test_importing_the_core_or_its_command_brings_nothing_heavy(module):
    assert not loaded_by([module]) & HEAVY


def test_torch_is_imported_by_what_needs_it_alone():
    assert "torch" not in loaded_by(modules_of("cutcell"))
    wrong = [name for name in TORCH if not name.startswith("cutcell/networks/")]
    assert wrong == []


def test_importing_the_core_is_quick():
    code = "import time; t = time.process_time(); import cutcell; print(time.process_time() - t)"
    seconds = [
        float(subprocess.run([sys.executable, "-c", code], capture_output=True, cwd=ROOT).stdout)
        for _ in range(3)
    ]
    assert min(seconds) < IMPORT_SECONDS


def test_the_core_knows_no_screen_and_no_server():
    above = loaded_by(modules_of("cutcell")) & (PAGE | PICTURES)
    assert above == {"cutcell_app"}, "its commands alone, which add themselves to the command line"


def test_the_viewers_know_no_server():
    assert not loaded_by(modules_of("cutcell_viewers")) & PAGE


@pytest.mark.parametrize(
    ("package", "forbidden"),
    [
        ("cutcell", {"cutcell_viewers", "cutcell_app", "cutcell_assets"}),
        ("cutcell_viewers", {"cutcell_app"}),
    ],
)
def test_no_import_anywhere_points_upwards(package, forbidden):
    """Imports inside functions count as well."""
    wrong = [
        f"{path.relative_to(ROOT)}:{line} imports {name}"
        for path in sorted((ROOT / FOLDERS[package]).rglob("*.py"))
        for name, line in imports_of(path)
        if name.partition(".")[0] in forbidden
    ]
    assert wrong == []


def test_every_part_of_the_core_has_its_place_in_the_order():
    parts = {path.stem for path in (ROOT / "cutcell").glob("*.py")} - {"__init__"}
    parts |= {path.parent.name for path in (ROOT / "cutcell").glob("*/__init__.py")}
    assert parts <= set(RANK), f"add to ORDER in this file: {sorted(parts - set(RANK))}"


def test_parts_of_the_core_use_only_those_before_them():
    wrong = []
    for path in sorted((ROOT / "cutcell").rglob("*.py")):
        part = path.relative_to(ROOT / "cutcell").parts[0].removesuffix(".py")
        if part == "__init__":
            continue
        for name, line in imports_of(path):
            used = name.split(".")[1] if name.startswith("cutcell.") else part
            if RANK.get(used, -1) > RANK[part]:
                wrong.append(f"{path.relative_to(ROOT)}:{line} imports {name}")
    assert wrong == []


@pytest.mark.parametrize("package", SHORT_CHAINS)
def test_chains_of_imports_inside_a_package_are_short(package):
    files = {path.stem: path for path in (ROOT / "cutcell" / package).glob("*.py")}
    del files["__init__"]
    used = {}
    for module, path in files.items():
        names = (name.removeprefix(f"cutcell.{package}.") for name, _ in imports_of(path))
        used[module] = {name for name in names if name in files}

    def longest(module: str, above: tuple[str, ...] = ()) -> tuple[str, ...]:
        assert module not in above, f"a circle: {' -> '.join([*above, module])}"
        chains = [longest(name, (*above, module)) for name in used[module]]
        return (module, *max(chains, key=len, default=()))

    chain = max((longest(module) for module in files), key=len)
    assert len(chain) <= LONGEST_CHAIN, " -> ".join(chain)


def package_of(path: Path) -> tuple[str, ...]:
    """Return the package that a file is in: its folders, by the names that they are imported by."""
    names = {folder: name for name, folder in FOLDERS.items()}
    folder, *below = path.relative_to(ROOT).parent.parts
    return (names.get(folder, folder), *below)


def imports_of(path: Path) -> list[tuple[str, int]]:
    """Absolute names of all that a file imports, with the lines."""
    package = package_of(path)
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [(alias.name, node.lineno) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else ()
            base = ".".join([*above, *([node.module] if node.module else [])])
            # `from . import summary` names a module, `from .errors import X` does not.
            if node.module:
                found.append((base, node.lineno))
            else:
                found += [(f"{base}.{alias.name}", node.lineno) for alias in node.names]
    return found
