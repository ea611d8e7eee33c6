"""What `load_kernels` has loaded, no binding has to compile; what is stale is announced."""

import os
import subprocess
import sys
import textwrap
from ast import literal_eval
from contextlib import nullcontext
from dataclasses import fields
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import cutcell
from cutcell.graph import build_graph
from cutcell.skinning import kernels, kernels_are_compiled, load_kernels
from cutcell.skinning.specimens import block_graph, chain, tube
from tests.bars import bar
from tests.conftest import ROOT

SCRIPT = textwrap.dedent(
    """
    import sys
    from numba.core.dispatcher import Dispatcher
    import cutcell
    from assets import demo_path
    from cutcell.skinning import kernels_are_compiled, load_kernels

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
    load_kernels()
    assert kernels_are_compiled()
    loaded = versions()
    assert loaded
    for demo in ("robot", "biped_cape", "biped_soup"):
        rig = cutcell.load(demo_path(demo))
        for options in OPTIONS:
            cutcell.bind(rig, 24, **options)
    now = versions()
    print({name for name in now if now[name] != loaded.get(name, 0)})
    """
)


def test_nothing_is_compiled_after_the_first_time():
    command = [sys.executable, "-c", SCRIPT]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=240)
    assert done.stdout.strip() == "set()", done.stdout + done.stderr


HELPED = """
from numba import njit
from helper import number

@njit(cache=True)
def kernel():
    return number()
"""


def test_kernels_are_compiled_anew_where_another_file_of_theirs_has_changed(tmp_path):
    (tmp_path / "kernel.py").write_text(HELPED)
    helper = tmp_path / "helper.py"
    forgets = "from cutcell.skinning.kernels import forget; from kernel import kernel; "

    def answer(number, first=""):
        helper.write_text(f"from numba import njit\n\n@njit\ndef number(): return {number}\n")
        command = [sys.executable, "-c", f"{forgets}{first}print(kernel())"]
        environment = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{tmp_path}"}
        done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=240)
        return done.stdout.strip() or done.stderr

    assert answer(1) == "1"
    assert answer(2) == "1"  # what numba does by itself
    assert answer(2, "forget([kernel]); ") == "2"
    assert answer(3, "kernel(); forget([kernel]); ") == "2"  # in use


@pytest.fixture
def another_machine(tmp_path, monkeypatch):
    """Keep the note of what was compiled in a folder of its own, and the sources it is of."""
    for folder in ("graph", "geodesics", "skinning"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "kernel.py").write_text("one")
    monkeypatch.setattr(kernels, "PACKAGE", tmp_path)
    monkeypatch.setattr(kernels, "_known", False)
    monkeypatch.setattr(kernels, "_stamp_path", lambda: tmp_path / "kernels.stamp")
    monkeypatch.setattr(kernels, "forget", lambda kernels: None)
    monkeypatch.setattr(kernels, "_beside", lambda function: nullcontext())
    return tmp_path


def test_kernels_are_compiled_once_they_were_loaded(another_machine, monkeypatch):
    assert not kernels_are_compiled()
    load_kernels()
    assert kernels_are_compiled()
    monkeypatch.setattr(kernels, "_known", False)  # as a process started later
    assert kernels_are_compiled()
    assert [path.name for path in another_machine.glob("kernels.*")] == ["kernels.stamp"]


def test_the_files_of_all_kernels_are_watched():
    watched = {path for pattern in kernels.SOURCES for path in kernels.PACKAGE.glob(pattern)}
    command = (
        "from cutcell.skinning import kernels; print([k.__module__ for k in kernels._kernels()])"
    )
    done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, cwd=ROOT)
    modules = {"cutcell.compiled", *literal_eval(done.stdout)}
    assert len(modules) > 10
    assert {Path(find_spec(module).origin) for module in modules} <= watched


@pytest.mark.parametrize("folder", ["graph", "geodesics", "skinning"])
def test_after_a_change_of_the_code_kernels_are_not_compiled(folder, another_machine):
    load_kernels()
    (another_machine / folder / "kernel.py").write_text("another")
    assert not kernels_are_compiled()


@pytest.mark.parametrize("what", ["numba.__version__", "sys.implementation.cache_tag"])
def test_for_another_compiler_kernels_are_not_compiled(what, another_machine, monkeypatch):
    load_kernels()
    monkeypatch.setattr(f"cutcell.skinning.kernels.{what}", "another")
    assert not kernels_are_compiled()


def test_a_compile_is_announced_once(another_machine):
    told = []
    for _ in range(2):
        cutcell.bind(bar(4), 8, progress=lambda stage, done: told.append(stage))
        told.append("|")
    stages = "".join(f"{a} " for a, b in pairwise([*told, ""]) if a != b)
    assert stages == "compile graph distances weights | graph distances weights | "


def test_where_no_note_can_be_kept_binding_goes_on(another_machine, monkeypatch):
    monkeypatch.setattr(kernels, "_stamp_path", lambda: another_machine / "away" / "kernels.stamp")
    load_kernels()
    assert not kernels_are_compiled()


def kinds(thing):
    """List the types of an object's arrays, for which kernels are compiled."""
    arrays = {field.name: getattr(thing, field.name) for field in fields(thing)}
    found = {k: (v.dtype, v.ndim) for k, v in arrays.items() if isinstance(v, np.ndarray)}
    assert all(arrays[name].flags.c_contiguous for name in found)
    return found


def test_the_graph_made_by_hand_is_of_the_types_that_are_built():
    built, by_hand = build_graph(tube(), 8, connectivity="any"), block_graph()
    assert kinds(by_hand) == kinds(built)
    assert kinds(by_hand.interior) == kinds(built.interior)
    assert by_hand.connectivity == built.connectivity
    weights = cutcell.skinning_weights(cutcell.bone_distances(by_hand, chain()))
    np.testing.assert_allclose(weights.sum(axis=1), 1)


def test_another_process_compiles_meanwhile(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    with kernels._beside("_write_stamp"):
        assert not list(tmp_path.rglob("kernels.stamp"))  # it takes a second to start
    assert len(list(tmp_path.rglob("kernels.stamp"))) == 1


def test_it_ends_with_what_is_done_meanwhile(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))  # all is to be compiled
    started, popen = [], subprocess.Popen
    monkeypatch.setattr(
        subprocess, "Popen", lambda *a, **k: started.append(popen(*a, **k)) or started[0]
    )
    with pytest.raises(KeyboardInterrupt), kernels._beside("compile_after_graph"):
        raise KeyboardInterrupt
    assert started[0].returncode not in (0, None)


@pytest.mark.parametrize("executable", ["", None, "/nowhere/python3", "/usr/bin/false"])
def test_without_another_process_this_one_goes_on(executable, monkeypatch):
    monkeypatch.setattr(sys, "executable", executable)
    done = []
    with kernels._beside("compile_after_graph"):
        done.append(True)
    assert done


def test_a_program_that_python_is_built_into_is_not_started(monkeypatch):
    def refuse(*arguments, **options):
        raise AssertionError(arguments)

    monkeypatch.setattr(subprocess, "Popen", refuse)
    monkeypatch.setattr(sys, "executable", "/opt/maya/bin/maya.bin")
    with kernels._beside("compile_after_graph"):
        pass
