"""A standard output that is full, closed, read by nobody, or that lacks letters."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from cutcell.cli.app import main
from tests.conftest import ROOT
from tests.cutcell.cli.files import write_obj

COMMANDS = [
    ["joints", "BAR"],
    ["joints", "BAR", "--json"],
    ["--version"],
    ["--help"],
]


def cutcell(words, bar, **options):
    command = [sys.executable, "-m", "cutcell", *(str(bar) if w == "BAR" else w for w in words)]
    return subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, **options)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
@pytest.mark.parametrize("words", COMMANDS[::2])
def test_a_full_output_is_one_sentence(words, bar):
    with open("/dev/full", "wb") as full, cutcell(words, bar, stdout=full) as process:
        said = process.stderr.read().decode()
    assert (process.returncode, len(said.splitlines())) == (2, 1)
    assert "No space left" in said


@pytest.mark.parametrize("words", COMMANDS[1:3])
def test_a_closed_output_is_one_sentence(words, bar):
    with cutcell(words, bar, preexec_fn=lambda: os.close(1)) as process:
        said = process.stderr.read().decode()
    assert (process.returncode, len(said.splitlines())) == (2, 1)


def test_a_closed_output_does_no_harm_where_nothing_is_printed(bar, tmp_path):
    words = ["bind", "BAR", str(tmp_path / "bound.glb"), "-r", "16", "--quiet"]
    with cutcell(words, bar, preexec_fn=lambda: os.close(1)) as process:
        assert process.stderr.read() == b""
    assert process.returncode == 0
    assert (tmp_path / "bound.glb").exists()


@pytest.mark.parametrize("words", COMMANDS[::3])
def test_a_reader_that_has_enough_needs_no_sentence(words, bar):
    reading, writing = os.pipe()
    os.close(reading)
    with open(writing, "wb") as pipe, cutcell(words, bar, stdout=pipe) as process:
        assert process.stderr.read() == b""
    assert process.returncode == 141


def test_what_an_encoding_lacks_is_escaped(tmp_path):
    names = ["h\u00fcfte", "\u9aa8\U0001f9b4"]
    joints = [
        {"name": names[0], "position": [0.5, 0.5, 0.1], "parent": None},
        {"name": names[1], "position": [0.5, 0.5, 1.9], "parent": names[0]},
    ]
    bar = write_obj(tmp_path / "bar.obj", joints=joints)
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    words = ["joints", "BAR", "--json"]
    with cutcell(words, bar, stdout=subprocess.PIPE, env=environment) as process:
        out, said = process.communicate()
    assert (process.returncode, said) == (0, b"")
    assert b"\\u9aa8" in out
    assert {joint["name"] for joint in json.loads(out)["joints"]} == set(names)


def test_standard_output_is_left_as_it_was(monkeypatch, capsys):
    before = sys.stdout
    monkeypatch.setattr(sys, "argv", ["cutcell", "--version"])
    with pytest.raises(SystemExit):
        main()
    assert sys.stdout is before
    print("and more")
    assert capsys.readouterr().out.endswith("\nand more\n")
