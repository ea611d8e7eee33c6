"""The course kit: stubs fail their tests, solutions pass them, pictures are those shown."""

import ast
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path
from urllib.parse import parse_qsl

import numpy as np
import pytest
from PIL import Image

from cutcell import load
from cutcell_app.headless.address import read_address
from cutcell_assets import demo_path
from cutcell_lab.baselines.methods import METHODS

TEACHING = Path(__file__).resolve().parents[1] / "docs" / "teaching"
EXERCISES = TEACHING / "exercises"
FOLDERS = sorted(EXERCISES.glob("[1-9]_*"))
NUMBERS = [folder.name[0] for folder in FOLDERS]
ALLOWED = {"matplotlib", "numpy", "pytest", "stub"} | sys.stdlib_module_names
"""Modules that a student has installed."""
MAX_DIFFERENCE = 3
"""Mean difference of two pictures, of 255: versions of matplotlib place text differently."""

exercises = pytest.mark.parametrize("folder", FOLDERS, ids=NUMBERS)


def solution_of(folder):
    """Return the solution of an exercise."""
    return TEACHING / "solutions" / f"{folder.name}.py"


def outcomes(folder, functions, tmp_path):
    """Run an exercise's tests on a file as a student does; return how many passed and did not."""
    shutil.copy(functions, tmp_path / "stub.py")
    shutil.copy(folder / "test_stub.py", tmp_path)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:dash"]
    subprocess.run(
        [*command, "--junitxml", "results.xml"], cwd=tmp_path, capture_output=True, timeout=120
    )
    (suite,) = ET.parse(tmp_path / "results.xml").getroot()
    total, bad = (int(suite.get(name)) for name in ("tests", "failures"))
    assert suite.get("errors") == suite.get("skipped") == "0"
    return total - bad, bad


def test_there_are_five_exercises():
    assert "".join(NUMBERS) == "12345"


@exercises
@pytest.mark.slow
def test_no_test_passes_with_the_stub(folder, tmp_path):
    passed, failed = outcomes(folder, folder / "stub.py", tmp_path)
    assert passed == 0
    assert failed >= 9


@exercises
@pytest.mark.slow
def test_the_solution_passes_every_test(folder, tmp_path):
    passed, failed = outcomes(folder, solution_of(folder), tmp_path)
    assert failed == 0
    assert passed >= 9


@exercises
def test_stub_and_solution_have_the_same_functions(folder):
    def signatures(path):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
        return {one.name: ast.unparse(one.args) for one in functions}

    assert signatures(folder / "stub.py") == signatures(solution_of(folder))


@pytest.mark.parametrize(
    "path", [*EXERCISES.rglob("*.py"), *map(solution_of, FOLDERS)], ids=lambda path: path.stem
)
def test_students_need_three_packages_only(path):
    imported = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            imported |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            imported.add(node.module.partition(".")[0])
    assert imported <= ALLOWED


def drawn(tmp_path, *arguments):
    """Run draw.py as a student does, in a copy of the exercises."""
    copy = tmp_path / "exercises"
    shutil.copytree(EXERCISES, copy)
    return copy, subprocess.run(
        [sys.executable, "draw.py", *arguments],
        cwd=copy, capture_output=True, text=True, timeout=120,
    )  # fmt: skip


@exercises
@pytest.mark.slow
def test_the_solution_draws_the_reference_picture(folder, tmp_path):
    script = tmp_path / "mine.py"
    shutil.copy(solution_of(folder), script)
    _, done = drawn(tmp_path, folder.name[0], str(script))
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) >= 2, "it prints numbers"
    pictures = []
    for path in (tmp_path / "picture.png", folder / "reference.png"):
        with Image.open(path) as image:
            pictures.append(np.asarray(image.convert("RGB").resize((450, 250))).astype(float))
    assert np.abs(pictures[0] - pictures[1]).mean() < MAX_DIFFERENCE


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [((), "Name an exercise"), (("6",), "Name an exercise"), (("1",), "still empty")],
)
def test_a_picture_that_cannot_be_drawn_is_explained(arguments, sentence, tmp_path):
    _, done = drawn(tmp_path, *arguments)
    assert done.returncode == 1
    assert sentence in done.stderr
    assert "Traceback" not in done.stderr


ADDRESSES = re.findall(r"`(\?[^`]+)`", (TEACHING / "index.md").read_text(encoding="utf-8"))


@pytest.mark.parametrize("address", ADDRESSES)
def test_addresses_of_demos_can_be_opened(address):
    choices, _ = read_address(address)
    query = dict(parse_qsl(address))
    rig = load(demo_path(query["?rig"]))
    assert choices["panel"] == query["panel"]
    assert choices.get("bone", "hips") in rig.skeleton.names
    assert set(choices.get("methods", [])) <= set(METHODS)
    assert all(joint < len(rig.skeleton.names) for joint in choices.get("turns", {}))
