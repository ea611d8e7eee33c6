"""After `warm_up` no binding has to compile anything; what is stale is announced."""

import subprocess
import sys
import textwrap
from dataclasses import fields
from itertools import pairwise

import numpy as np
import pytest

import cutcell
from cutcell.graph import build_graph
from cutcell.runtime import compile_cache
from cutcell.weights import warm_up as compilation
from cutcell.weights.warm_up import is_compiled, warm_up
from cutcell.weights.warm_up_inputs import block_graph, chain, tube
from tests.bars import bar
from tests.conftest import ROOT

SCRIPT = textwrap.dedent(
    """
    import sys
    from numba.core.dispatcher import Dispatcher
    import cutcell
    from cutcell_assets import demo_path
    from cutcell.weights.warm_up import is_compiled, warm_up

    def versions():
        return {
            f"{module.__name__}.{name}": len(kernel.signatures)
            for module in list(sys.modules.values())
            if module and module.__name__.startswith("cutcell")
            for name, kernel in vars(module).items()
            if isinstance(kernel, Dispatcher)
        }

    OPTIONS = (
        {},
        {"falloff": "paper"},
        {"max_influences": 8},
        {"connectivity": 6, "falloff": "paper"},
        {"connectivity": 26},
    )
    warm_up()
    assert is_compiled()
    loaded = versions()
    assert loaded
    for demo in ("robot", "biped_cape", "biped_soup", "biped_flipped_arm"):
        rig = cutcell.load(demo_path(demo))
        for options in OPTIONS:
            cutcell.bind(rig, 24, **options)
    mesh = cutcell.load(demo_path("robot")).mesh
    cutcell.build_graph(cutcell.TriangleMesh(mesh.vertices, mesh.faces[:, ::-1]), 24)
    now = versions()
    print({name for name in now if now[name] != loaded.get(name, 0)})
    """
)


@pytest.mark.slow
def test_nothing_is_compiled_after_the_first_time():
    command = [sys.executable, "-c", SCRIPT]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=1200)
    assert done.stdout.strip() == "set()", done.stdout + done.stderr


@pytest.fixture
def another_machine(tmp_path, monkeypatch):
    """Begin with nothing compiled on disk, and as if nothing were compiled in this process.

    It has all functions in memory, whichever tests it ran before: to compile them takes minutes.
    """
    warm_up()
    monkeypatch.setattr(compile_cache, "folders", lambda: (tmp_path / "kernels-new",))
    monkeypatch.setattr(compilation, "start_process", lambda function: None)
    warm_up.cache_clear()
    return tmp_path


@pytest.mark.slow
def test_all_is_compiled_once_it_was_warmed_up(another_machine, monkeypatch):
    assert not is_compiled()
    warm_up()
    assert is_compiled()
    warm_up.cache_clear()  # as a process started later
    assert is_compiled()


@pytest.mark.slow
def test_a_compile_is_announced_once(another_machine):
    reports = []
    for _ in range(2):
        cutcell.bind(bar(4), 8, progress=lambda stage, done: reports.append(stage))
        reports.append("|")
    stages = "".join(f"{a} " for a, b in pairwise([*reports, ""]) if a != b)
    assert stages == "compile graph distances weights | graph distances weights | "


@pytest.mark.slow
def test_where_nothing_can_be_kept_one_sentence_says_so(another_machine, monkeypatch, caplog):
    (another_machine / "kernels-new").write_text("not a folder")
    monkeypatch.setattr(compile_cache, "refusals", [])
    warm_up()
    assert [record.name for record in caplog.records] == ["cutcell"]
    assert "cannot be kept" in caplog.text
    assert "NUMBA_CACHE_DIR" in caplog.text
    assert is_compiled()  # in this process
    assert not compile_cache.is_complete()


def kinds(thing):
    """List the types of an object's arrays, for which functions are compiled."""
    arrays = {field.name: getattr(thing, field.name) for field in fields(thing)}
    result = {k: (v.dtype, v.ndim) for k, v in arrays.items() if isinstance(v, np.ndarray)}
    assert all(arrays[name].flags.c_contiguous for name in result)
    return result


def test_the_graph_made_by_hand_is_of_the_types_that_are_built():
    built, by_hand = build_graph(tube(), 8, connectivity="any"), block_graph()
    assert kinds(by_hand) == kinds(built)
    assert kinds(by_hand.interior) == kinds(built.interior)
    assert by_hand.connectivity == built.connectivity
    weights = cutcell.skinning_weights(cutcell.bone_distances(by_hand, chain()))
    np.testing.assert_allclose(weights.sum(axis=1), 1)


def test_another_process_compiles_what_this_one_then_loads(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    with compilation.start_process("compile_cache.mark_complete") as process:
        assert not list(tmp_path.rglob("complete"))  # it takes a second to start
        assert process.wait() == 0
    assert len(list(tmp_path.rglob("complete"))) == 1


def test_another_process_ends_with_this_one(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))  # all is to be compiled
    process = compilation.start_process("compile_from_other_end")
    process.stdin.close()  # as if this process had been killed
    assert process.wait(60) == 0
    assert not list(tmp_path.rglob("complete"))


def test_it_is_stopped_when_this_one_is_interrupted(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    started, popen = [], subprocess.Popen

    def interrupt(*arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(compile_cache, "is_complete", lambda: False)
    monkeypatch.setattr(compilation, "build_graph", interrupt)
    monkeypatch.setattr(
        subprocess, "Popen", lambda *a, **k: started.append(popen(*a, **k)) or started[0]
    )
    with pytest.raises(KeyboardInterrupt):
        warm_up.__wrapped__()
    assert started[0].returncode not in (0, None)


def test_no_other_process_is_started_where_it_could_hand_nothing_over(monkeypatch):
    monkeypatch.setattr(compile_cache, "folders", tuple)
    monkeypatch.setattr(compile_cache, "refusals", [])
    monkeypatch.delattr(subprocess, "Popen")
    assert compilation.start_process("warm_up") is None


@pytest.mark.parametrize("executable", ["", None, "/nowhere/python3", "/opt/maya/bin/maya.bin"])
def test_without_another_process_this_one_goes_on(executable, monkeypatch):
    monkeypatch.setattr(sys, "executable", executable)
    assert compilation.start_process("warm_up") is None
