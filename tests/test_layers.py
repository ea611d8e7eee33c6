"""Imports follow the layers app -> lab, viewers -> cutcell, and those inside the core."""

import ast
import json
import re
import subprocess
import sys
from collections import Counter
from graphlib import CycleError, TopologicalSorter
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
FOLDERS = {
    "cutcell": "cutcell",
    "cutcell_lab": "lab",
    "cutcell_viewers": "viewers",
    "cutcell_app": "app",
}
"""Where the packages lie."""
PAGE = {"bokeh", "cutcell_app", "panel", "panel_material_ui"}
PICTURES = {"cutcell_viewers", "pyvista", "vtk", "vtkmodules"}
IMPORT_SECONDS = 0.3
TORCH = [
    path.relative_to(ROOT).as_posix()
    for path in sorted((ROOT / "lab").rglob("*.py"))
    if re.search(r"^(import|from) torch\b", path.read_text(encoding="utf-8"), re.MULTILINE)
]
"""Files that import torch at once."""
# Each package of the core uses only those before it. The method for animation is one folder, and
# each stage of a binding uses one part of it.
ORDER = (
    "errors", "checks", "options", "animation.declaration", "method", "runtime", "geometry", "rig",
    "isolated", "io", "graph", "bones", "animation.any_angle", "animation.bone_extents",
    "geodesics", "pose", "animation.falloff", "weights", "priors", "editing", "binding",
    "templates", "diagnosis", "cli", "__main__",
)  # fmt: skip
MAX_ROOT_ENTRIES = 25
MAX_FILES = 15
"""In one folder of the core."""


def modules_of(package: str) -> list[str]:
    """Names of all modules of a package, found by their files.

    Left out are those that import torch, which tests_networks imports, and benchmarks.
    """
    names = []
    folder = ROOT / FOLDERS[package]
    for path in sorted(folder.rglob("*.py")):
        if path.relative_to(ROOT).as_posix() in TORCH or folder / "benchmarks" in path.parents:
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


@pytest.mark.parametrize("module", ["cutcell", "cutcell.cli.app"])
def test_importing_the_core_or_its_command_brings_nothing_heavy(module):
    assert not loaded_by([module]) & HEAVY


@pytest.mark.slow
def test_torch_is_imported_by_what_needs_it_alone():
    assert "torch" not in loaded_by([*modules_of("cutcell"), *modules_of("cutcell_lab")])
    allowed = ("lab/networks/", "lab/benchmarks/")
    wrong = [name for name in TORCH if not name.startswith(allowed)]
    assert wrong == []


def test_importing_the_core_is_quick():
    code = "import time; t = time.process_time(); import cutcell; print(time.process_time() - t)"
    seconds = (
        float(subprocess.run([sys.executable, "-c", code], capture_output=True, cwd=ROOT).stdout)
        for _ in range(3)
    )
    assert any(taken < IMPORT_SECONDS for taken in seconds)


@pytest.mark.slow
def test_the_core_knows_no_screen_and_no_server():
    above = loaded_by(modules_of("cutcell")) & (PAGE | PICTURES | {"cutcell_lab"})
    assert above == {"cutcell_app", "cutcell_lab"}, "their commands add themselves"


@pytest.mark.slow
def test_the_laboratory_knows_no_screen_and_no_server():
    assert loaded_by(modules_of("cutcell_lab")) & (PAGE | PICTURES) <= {"cutcell_app"}


@pytest.mark.slow
def test_the_viewers_know_no_server():
    assert not loaded_by(modules_of("cutcell_viewers")) & PAGE


@pytest.mark.parametrize(
    ("package", "forbidden"),
    [
        ("cutcell", {"cutcell_lab", "cutcell_viewers", "cutcell_app", "cutcell_assets"}),
        ("cutcell_lab", {"cutcell_viewers", "cutcell_app"}),
        ("cutcell_viewers", {"cutcell_lab", "cutcell_app"}),
    ],
)
def test_no_import_anywhere_points_upwards(package, forbidden):
    """Imports inside functions count as well, and names of modules in strings."""
    wrong = [
        f"{path.relative_to(ROOT)}:{line} imports {name}"
        for path in sorted((ROOT / FOLDERS[package]).rglob("*.py"))
        for name, line in [*imports_of(path), *modules_in_strings(path)]
        if name.partition(".")[0] in forbidden
    ]
    assert wrong == []


def part_of(module: str) -> str:
    """Return the part of the core, one of `ORDER`, that a module belongs to."""
    below = module.removeprefix("cutcell.")
    return next((part for part in ORDER if f"{below}.".startswith(f"{part}.")), below)


def test_packages_of_the_core_use_only_those_before_them():
    roots = {ROOT / "cutcell/__init__.py", ROOT / "cutcell/animation/__init__.py"}
    modules = {path: ".".join((*package_of(path), path.stem)) for path in core_files()}
    parts = {path: part_of(name) for path, name in modules.items() if path not in roots}
    assert set(parts.values()) == set(ORDER)
    rank = {part: number for number, part in enumerate(ORDER)}
    wrong = [
        f"{path.relative_to(ROOT)}:{line} imports {name}"
        for path, part in parts.items()
        for name, line in imports_of(path)
        if name.startswith("cutcell.") and rank[part_of(name)] > rank[part]
    ]
    assert wrong == []


def test_the_method_of_the_paper_reads_alone():
    """Few modules choose between it and the method for animation; no other one knows the latter."""
    choosing = {
        ROOT / "cutcell" / name
        for name in (
            "geodesics/solver.py",
            "geodesics/tracing/inside.py",
            "weights/skinning_weights.py",
        )
    }
    stages = [
        path
        for part in ("graph", "bones", "geodesics", "weights")
        for path in (ROOT / "cutcell" / part).rglob("*.py")
    ]
    wrong = [
        f"{path.relative_to(ROOT)}:{line} imports {name}"
        for path in sorted(set(stages) - choosing)
        for name, line in imports_of(path)
        if name.startswith("cutcell.animation")
    ]
    assert wrong == []


INTERFACES = ("EPILOG", "NOTE", "SUFFIXES")
"""Constants by which each command and each file format describes itself."""


def test_no_name_of_a_constant_has_two_meanings():
    meanings: dict[str, dict[str, list[str]]] = {}
    for path in core_files():
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            for name, value in constants_of(node):
                where = f"{path.relative_to(ROOT)}:{node.lineno}"
                meanings.setdefault(name, {}).setdefault(value, []).append(where)
    several = {name: values for name, values in meanings.items() if len(values) > 1}
    assert {name: several[name] for name in several if name not in INTERFACES} == {}


def constants_of(node: ast.stmt) -> list[tuple[str, str]]:
    """Return the constants that a statement of a module defines, and their values as text."""
    if isinstance(node, ast.AnnAssign) and node.value is not None:
        targets, value = [node.target], node.value
    elif isinstance(node, ast.Assign):
        targets, value = node.targets, node.value
    else:
        return []
    pairs = []
    for target in targets:
        names = target.elts if isinstance(target, ast.Tuple) else [target]
        values = value.elts if isinstance(value, ast.Tuple) and len(names) > 1 else [value]
        pairs += zip(names, values * (len(names) // len(values)), strict=True)
    return [
        (name.id, ast.unparse(value))
        for name, value in pairs
        if isinstance(name, ast.Name) and re.fullmatch(r"[A-Z][A-Z0-9_]*", name.id)
    ]


def test_reading_gltf_needs_no_writing():
    wrong = [
        f"{path.relative_to(ROOT)}:{line} imports {name}"
        for path in sorted((ROOT / "cutcell/io/gltf").rglob("*.py"))
        for name, line in imports_of(path)
        if path.parent.name != "write" and name.startswith("cutcell.io.gltf.write")
    ]
    assert wrong == []


def test_no_modules_of_the_core_import_each_other():
    """Imports in functions, and those for type checkers alone, count as well."""
    names = {".".join((*package_of(path), path.stem)): path for path in core_files()}
    imports = {
        name.removesuffix(".__init__"): {
            module for module, _ in imports_of(path) if module != name.removesuffix(".__init__")
        }
        for name, path in names.items()
    }
    try:
        list(TopologicalSorter(imports).static_order())
    except CycleError as error:
        pytest.fail(" -> ".join(error.args[1]))


def core_files() -> list[Path]:
    return sorted((ROOT / "cutcell").rglob("*.py"))


def test_folders_of_the_core_can_be_taken_in_at_a_glance():
    visible = [path for path in (ROOT / "cutcell").iterdir() if path.name != "__pycache__"]
    assert len(visible) <= MAX_ROOT_ENTRIES
    files = Counter(path.parent for path in core_files())
    assert {folder: count for folder, count in files.items() if count > MAX_FILES} == {}


def package_of(path: Path) -> tuple[str, ...]:
    """Return the package that a file is in: its folders, by the names that they are imported by."""
    names = {folder: name for name, folder in FOLDERS.items()}
    folder, *below = path.relative_to(ROOT).parent.parts
    return (names.get(folder, folder), *below)


def imports_of(path: Path) -> list[tuple[str, int]]:
    """Absolute names of all modules that a file imports, with the lines."""
    package = package_of(path)
    imports = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            imports += [(alias.name, node.lineno) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else ()
            base = ".".join([*above, *([node.module] if node.module else [])])
            for alias in node.names:
                name = f"{base}.{alias.name}"
                imports.append((name if is_module(name) else base, node.lineno))
    return imports


def modules_in_strings(path: Path) -> list[tuple[str, int]]:
    """Names of modules that a file may import by `import_module`, or in a subprocess."""
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    texts = {id(node.value) for node in nodes if isinstance(node, ast.Expr)}  # docstrings
    return [
        (name, node.lineno)
        for node in nodes
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in texts
        for name in re.findall(r"\bcutcell_\w+(?:\.\w+)*", node.value)
    ]


def test_modules_in_strings_are_seen(tmp_path):
    source = (
        '"""See cutcell_app."""\nimport_module("cutcell_app.x")\nrun("from cutcell_lab import y")'
    )
    (tmp_path / "a.py").write_text(source)
    assert modules_in_strings(tmp_path / "a.py") == [("cutcell_app.x", 2), ("cutcell_lab", 3)]


def is_module(name: str) -> bool:
    package, *below = name.split(".")
    path = ROOT.joinpath(FOLDERS.get(package, package), *below)
    return path.is_dir() or path.with_suffix(".py").is_file()
