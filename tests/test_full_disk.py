"""Every kind of output on a full disk: a sentence, the old file as it was, no leftovers."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.nightly

ROOT = Path(__file__).resolve().parents[1]
OUTPUTS = [
    "rig.glb", "rig.gltf", "rig.txt", "rig.npz", "numbers.csv", "numbers.npz",
    "plot.svg", "scene.png", "turn.mp4", "turn.gif",
]  # fmt: skip
"""One of each writer."""

WRITES = """
import json, resource, sys
from dataclasses import replace
from pathlib import Path

import cutcell
from cutcell_lab.baselines.compare import compare
from cutcell_lab.baselines.compare.plot import plot_comparison
from cutcell_app.files.table_export import save_numbers
from tests.lab.baselines.test_compare import character
from tests.viewers.arm import arm_rig
from cutcell_viewers import film
from cutcell_viewers.order import Order
from cutcell_viewers.weights_scene import weights_scene

folder, names = Path(sys.argv[1]), sys.argv[2:]
rig = arm_rig()
cutcell.save(folder / "source.glb", rig)
stored = cutcell.load(folder / "source.glb")
(folder / "source.glb").unlink()
compared = compare([character()], ["artist", "euclidean"])
order = Order(weights_scene(rig, rig.weights, 1), size=(320, 240))
film.TURN_SECONDS = 0.5

def write(path):
    kind = path.stem
    if kind == "rig":
        cutcell.save(path, stored)
    elif kind == "numbers":
        save_numbers(path, rig, weights=rig.weights)
    elif kind == "plot":
        plot_comparison(compared, path)
    else:
        film.draw(replace(order, turntable=kind == "turn"), path)

told = {}
for full in (False, True):
    if full:  # of each file no more than this many bytes can be written
        resource.setrlimit(resource.RLIMIT_FSIZE, (700, 700))
    for name in names:
        try:
            write(folder / name)
        except cutcell.FileError as error:
            told[name] = str(error)
        if not full:
            (folder / name).rename(folder / ("good-" + name))
            (folder / name).write_text("old")
print(json.dumps(told))
"""


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Write everything with room for it, then once more without; return what was told."""
    folder = tmp_path_factory.mktemp("disk")
    done = subprocess.run(
        [sys.executable, "-c", WRITES, str(folder), *OUTPUTS],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return folder, json.loads(done.stdout.splitlines()[-1])


@pytest.mark.parametrize("name", OUTPUTS)
def test_an_output_is_written_whole_or_not_at_all(written, name):
    folder, reports = written
    assert (folder / f"good-{name}").stat().st_size > 700
    assert reports[name].startswith(f"{name}: cannot be written (")
    assert reports[name].endswith("File too large)")
    assert (folder / name).read_text() == "old"


def test_nothing_else_is_left(written):
    folder, _ = written
    beside = {"rig.bin", "rig.obj"}  # of the first run, when there was room
    expected = {*OUTPUTS, *(f"good-{name}" for name in OUTPUTS), *beside}
    assert set(os.listdir(folder)) == expected
