"""The extension for Blender, as far as it needs no Blender: its manifest and its worker process."""

import ast
import importlib.util
import os
import signal
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

import cutcell

from .bars import bar

ROOT = Path(__file__).resolve().parent.parent
BLENDER = ROOT / "blender"
LIBRARIES = {"cutcell", "numpy", "scipy"}
"""What the worker may import, beside Python's own."""


def module(name):
    spec = importlib.util.spec_from_file_location(f"blender_{name}", BLENDER / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


job, process = module("job"), module("worker")


@pytest.fixture
def worker():
    """Return a worker with the packages of the tests."""
    worker = job.Worker([str(ROOT)])
    yield worker
    worker.stop()


def arrays_of(rig):
    skeleton = rig.skeleton
    return {
        "vertices": rig.mesh.vertices,
        "faces": rig.mesh.faces,
        "joints": skeleton.joints,
        "parents": skeleton.parents,
        "names": np.array(skeleton.names),
        "deform": skeleton.deform,
    }


def result_of(steps):
    """Run a job to its end; return its stages, arrays and result."""
    stages = []
    while True:
        try:
            stages.append(next(steps)[0])
        except StopIteration as end:
            return stages, *end.value


def test_the_manifest_is_of_the_package_and_names_both_licences():
    manifest = tomllib.loads((BLENDER / "blender_manifest.toml").read_text(encoding="utf-8"))
    assert manifest["version"] == cutcell.__version__
    assert manifest["license"] == ["SPDX:GPL-3.0-or-later", "SPDX:MIT"]
    assert len(manifest["permissions"]["files"]) <= 64  # what Blender's validator allows
    for file in BLENDER.rglob("*.py"):
        assert file.read_text(encoding="utf-8").startswith("# SPDX-License-Identifier: GPL-3.0-or")


@pytest.mark.parametrize("name", ["job", "worker"])
def test_the_worker_needs_no_blender(name):
    imported = set()
    for node in ast.walk(ast.parse((BLENDER / f"{name}.py").read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            imported |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            imported.add((node.module or "").partition(".")[0])
    assert imported - sys.stdlib_module_names <= LIBRARIES


@pytest.mark.slow
def test_binding_loads_no_reader_of_files():
    code = """
import sys
for name in ("trimesh", "typer", "rich", "ufbx", "DracoPy", "meshopt"):
    sys.modules[name] = None
import cutcell
from tests.bars import bar
rig = bar()
bound = rig.with_weights(cutcell.bind(rig, 16).weights)
cutcell.clean(bound, 16), cutcell.diagnose(bound, 16), cutcell.explain(bound, 0, 16)
cutcell.transfer(bound, rig.mesh)
"""
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True)


@pytest.mark.slow
def test_jobs_share_a_process_and_report_stages_results_and_errors(worker):
    rig = bar()
    options = {"method": "animation", "options": {"resolution": 16, "max_influences": 4}}
    stages, arrays, _ = result_of(worker.run("bind", arrays_of(rig), options, 1.0))
    assert "Computing weights" in stages
    expected = cutcell.bind(rig, 16).weights
    weights = np.zeros_like(expected)
    for j in range(weights.shape[1]):
        entries = slice(*arrays["indptr"][j : j + 2])
        weights[arrays["indices"][entries], j] = arrays["data"][entries]
    assert np.array_equal(weights, expected)
    first = worker.process
    with pytest.raises(job.Problem, match=r"^Faces|^Every|^The mesh|^Face"):
        result_of(worker.run("bind", arrays_of(rig) | {"faces": rig.mesh.faces + 99}, options, 1.0))
    with pytest.raises(job.Problem, match="KeyError"):
        result_of(worker.run("bind", {}, options, 1.0))
    assert worker.process is first


@pytest.mark.skipif(sys.platform == "win32", reason="processes are stopped by signals")
def test_an_ended_process_is_reported_and_the_next_job_starts_another(worker):
    steps = worker.run("save", {}, {"path": ""}, 0.1)
    next(steps)
    os.kill(worker.process.pid, signal.SIGKILL)
    with pytest.raises(job.Problem, match=r"process ended \(code -9\)"):
        result_of(steps)
    steps = worker.run("save", {}, {"path": ""}, 0.1)
    next(steps)
    assert worker.process.poll() is None
    steps.close()


def test_the_first_job_says_that_it_compiles(tmp_path, monkeypatch):
    from cutcell.weights import warm_up

    monkeypatch.setattr(warm_up, "is_compiled", lambda: False)
    monkeypatch.setattr(warm_up, "warm_up", lambda: None)
    np.savez(tmp_path / "input.npz")
    paths = {name: str(tmp_path / f"{name}.npz") for name in ("input", "output")}
    messages: list[dict] = []
    process.run({"task": "bind", "options": {}, **paths}, messages.append)
    assert "Compiling, once" in job.STAGES[messages[0]["stage"]]


def test_locked_groups_leave_the_rest_to_the_others():
    weights = np.array([[0.5, 0.3, 0.2], [0.0, 0.6, 0.4], [0.2, 0.2, 0.6]])
    locked = np.zeros((3, 3), bool)
    locked[:, 0] = True
    arrays = {"locked": locked, "stored": np.array([[0.25, 9, 9], [0, 9, 9], [1.0, 9, 9]])}
    result = process.beside_locked(weights, arrays, 2)
    assert np.allclose(result, [[0, 0.75, 0], [0, 0.6, 0.4], [0, 0, 0]])
    assert process.beside_locked(weights, {}) is weights
