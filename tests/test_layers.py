"""The house has one direction: app -> viewers -> cutcell, and an order inside the core."""

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
HEAVY = {
    "app",
    "matplotlib",
    "numba",
    "numpy",
    "pandas",
    "panel",
    "pyvista",
    "scipy",
    "trimesh",
    "vtk",
}
PAGE = {"app", "bokeh", "panel", "panel_material_ui"}
PICTURES = {"pyvista", "viewers", "vtk", "vtkmodules"}
IMPORT_SECONDS = 0.3

# Each part of the core may use itself and those on lines above it.
ORDER = [
    {
        "apart",
        "arrays",
        "checks",
        "compiled",
        "display",
        "errors",
        "kernel_cache",
        "memory",
        "motion",
        "progress",
        "rig",
        "sorting",
        "threads",
        "unions",
        "writing",
    },
    {"deform"},
    {"io"},
    {"graph"},
    {"geodesics"},
    {"skinning"},
    {"pose"},
    {"metrics"},
    {"workers"},
    {"baselines", "diagnosis", "dataset"},
    {"summary", "compare"},
    {
        "options",
        "console",
        "report",
        "diagnose_command",
        "render_command",
        "joints_command",
        "cli",
        "__main__",
    },
]
RANK = {part: rank for rank, parts in enumerate(ORDER) for part in parts}


def modules_of(package: str) -> list[str]:
    """Names of all modules of a package here, found by their files."""
    names = []
    for path in sorted((ROOT / package).rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
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


def test_importing_the_core_is_quick():
    code = "import time; t = time.perf_counter(); import cutcell; print(time.perf_counter() - t)"
    seconds = [
        float(subprocess.run([sys.executable, "-c", code], capture_output=True, cwd=ROOT).stdout)
        for _ in range(3)
    ]
    assert min(seconds) < IMPORT_SECONDS


def test_the_core_knows_no_screen_and_no_server():
    assert not loaded_by(modules_of("cutcell")) & (PAGE | PICTURES)


def test_the_viewers_know_no_server():
    assert not loaded_by(modules_of("viewers")) & PAGE


@pytest.mark.parametrize(
    ("package", "forbidden"), [("cutcell", {"viewers", "app", "assets"}), ("viewers", {"app"})]
)
def test_no_import_anywhere_points_upwards(package, forbidden):
    """Imports inside functions count as well, except the command's door to the page."""
    wrong = [
        f"{path.relative_to(ROOT)}:{line} imports {name}"
        for path in sorted((ROOT / package).rglob("*.py"))
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


def imports_of(path: Path) -> list[tuple[str, int]]:
    """Absolute names of all that a file imports, with the lines."""
    package = path.relative_to(ROOT).parent.parts
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
