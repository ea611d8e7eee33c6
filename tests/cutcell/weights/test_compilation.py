"""After `warm_up` no binding has to compile anything; what is stale is announced."""

import subprocess
import sys
import textwrap
from itertools import pairwise

import pytest

import cutcell
from cutcell.runtime import compile_cache
from cutcell.weights import warm_up as compilation
from cutcell.weights.warm_up import is_compiled, warm_up
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


@pytest.mark.slow
def test_another_process_compiles():
    with compilation.start_process() as process:
        assert process.wait() == 0
    assert compile_cache.is_complete()


def test_another_process_ends_with_this_one(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))  # all is to be compiled
    process = compilation.start_process()
    process.stdin.close()  # as if this process had been killed
    assert process.wait(60) == 0
    assert not list(tmp_path.rglob("complete"))


def test_no_other_process_is_started_where_it_could_hand_nothing_over(monkeypatch):
    monkeypatch.setattr(compile_cache, "folders", tuple)
    monkeypatch.setattr(compile_cache, "refusals", [])
    monkeypatch.delattr(subprocess, "Popen")
    assert compilation.start_process() is None


@pytest.mark.parametrize("executable", ["", None, "/nowhere/python3", "/opt/maya/bin/maya.bin"])
def test_without_another_process_this_one_goes_on(executable, monkeypatch):
    monkeypatch.setattr(sys, "executable", executable)
    assert compilation.start_process() is None
