"""The command as a whole: help, bars, JSON, exit codes, real processes, real files."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

import cutcell
from cutcell.cli.app import main
from cutcell.cli.console import print_json, progress_bars
from cutcell.method import FALLOFFS
from cutcell.runtime import compile_cache
from cutcell.runtime.compiled import compiled
from tests.conftest import ROOT
from tests.signals import reset_signals


class TestHelp:
    def test_no_arguments_show_help(self, run):
        shown = run()
        assert "Usage" in shown.stdout + shown.stderr

    def test_version(self, run):
        assert run("--version").stdout == f"cutcell {cutcell.__version__}\n"

    @pytest.mark.parametrize("command", ["app", "bind", "graph", "diagnose", "render"])
    def test_each_command_shows_examples(self, run, command):
        shown = run(command, "--help")
        assert shown.exit_code == 0
        assert f"cutcell {command} " in shown.stdout.partition("Example")[2]

    def test_every_falloff_is_explained(self, run):
        shown = run("bind", "--help").stdout
        assert all(f"{name}:" in shown for name in FALLOFFS)


@pytest.mark.parametrize(("given", "threads"), [(None, "1"), ("3", "3")])
def test_numpys_threads_do_not_wait_for_more(given, threads, monkeypatch, capsys):
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", given or "")
    if given is None:
        monkeypatch.delenv("OPENBLAS_NUM_THREADS")
    monkeypatch.setattr(sys, "argv", ["cutcell", "--version"])
    with pytest.raises(SystemExit):
        main()
    assert os.environ["OPENBLAS_NUM_THREADS"] == threads


@pytest.mark.parametrize("in_dispatcher", [False, True])
def test_ctrl_c_stops_with_130(run, bar, monkeypatch, tmp_path, in_dispatcher):
    def interrupted(*_, **__):
        if in_dispatcher:  # as numba's raises it
            raise SystemError("returned a result with an exception set") from KeyboardInterrupt()
        raise KeyboardInterrupt

    monkeypatch.setattr("cutcell.binding.bind", interrupted)
    result = run("bind", bar, tmp_path / "out.glb")
    assert result.exit_code == 130
    assert "Traceback" not in result.stderr
    assert not (tmp_path / "out.glb").exists()


def test_other_errors_of_the_interpreter_go_through(run, bar, monkeypatch, tmp_path):
    def fails(*_, **__):
        raise SystemError

    monkeypatch.setattr("cutcell.binding.bind", fails)
    with pytest.raises(SystemError):
        run("bind", bar, tmp_path / "out.glb")


def test_bars_are_drawn_on_a_terminal_only(monkeypatch, capsys):
    with progress_bars() as report:
        report("graph", 0.5)
    assert capsys.readouterr() == ("", "")
    monkeypatch.setenv("FORCE_COLOR", "1")
    with progress_bars() as report:
        report("graph", 0.5)
        report("graph", 1.0)
        report("distances", 0.1)
    drawn = capsys.readouterr()
    assert "Building the graph" in drawn.err
    assert drawn.out == ""


@pytest.mark.parametrize(
    ("options", "lines"), [((), 1), (("--json",), 1), (("--quiet",), 0), (("--json", "--quiet"), 0)]
)
def test_a_first_compile_is_one_line_where_no_bar_shows_it(
    run, bar, tmp_path, monkeypatch, options, lines
):
    def compiles(*_, **__):
        compiled(lambda number: number + 1)(1)
        raise KeyboardInterrupt

    monkeypatch.setattr(compile_cache, "folders", lambda: (tmp_path / "kernels",))
    compile_cache.announce.cache_clear()
    monkeypatch.setattr("cutcell.binding.bind", compiles)
    shown = run("bind", bar, tmp_path / "out.glb", *options)
    assert shown.stdout == ""
    assert len(shown.stderr.splitlines()) == lines + 1
    monkeypatch.setenv("FORCE_COLOR", "1")  # as on a terminal
    compile_cache.announce.cache_clear()
    assert "minute" not in run("bind", bar, tmp_path / "out.glb", *options).stderr


def test_json_never_holds_what_is_not_json():
    with pytest.raises(ValueError, match="not JSON compliant"):
        print_json({"seconds": float("nan")})


def test_python_m_cutcell_is_the_command(bar, tmp_path):
    command = [sys.executable, "-m", "cutcell", "bind", str(bar), str(tmp_path / "o.glb"), "--json"]
    command.append("--quiet")  # a first compile would be told
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["output"].endswith("o.glb")


def test_a_real_process_refuses_with_2(tmp_path):
    command = [sys.executable, "-m", "cutcell", "graph", str(tmp_path / "nope.glb")]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 2
    assert done.stderr.endswith("nope.glb: there is no such file\n")


def test_a_real_process_stops_at_ctrl_c(bar, tmp_path):
    code = f"""
import os, signal, sys, time
import cutcell.editing, cutcell.cli.app

def long_work(*_, **__):
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(600)

cutcell.binding.bind = long_work
sys.argv = ["cutcell", "bind", {str(bar)!r}, {str(tmp_path / "o.glb")!r}]
cutcell.cli.app.main()
"""
    command = [sys.executable, "-c", code]
    done = subprocess.run(
        command, capture_output=True, text=True, cwd=ROOT, timeout=300, preexec_fn=reset_signals
    )
    assert (done.returncode, done.stderr) == (130, "stopped: by Ctrl-C\n")
    assert not (tmp_path / "o.glb").exists()


def test_main_runs_the_command(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["cutcell", "--version"])
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 0
    assert capsys.readouterr().out.startswith("cutcell ")


def test_real_characters_bind_and_stay_in_order(run, rigs, tmp_path):
    for path in rigs[1:3]:
        out = tmp_path / path.name
        assert run("bind", path, out, "-r", 24, "--quiet").exit_code == 0
        before, after = cutcell.load(path), cutcell.load(out)
        np.testing.assert_array_equal(before.mesh.vertices, after.mesh.vertices)
        np.testing.assert_allclose(after.weights.sum(axis=1), 1, atol=1e-6)


def test_demo_characters_have_a_graph(run, demo_paths):
    document = json.loads(run("graph", demo_paths[0], "-r", 16, "--json").stdout)
    assert document["graph"]["nodes"]["total"] > 0
