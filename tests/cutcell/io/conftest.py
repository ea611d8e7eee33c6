"""Loading what a builder made."""

import subprocess
import sys

import pytest

import cutcell
from cutcell.isolated import run

READER = """
import sys
from cutcell.isolated.__main__ import main
for line in sys.stdin:
    main(*line.split())
    print(flush=True)
"""


@pytest.fixture
def loaded(tmp_path):
    """Return a function that writes a builder's document and loads it."""

    def load(builder, name="rig.glb"):
        return cutcell.load(builder.save(tmp_path / name))

    return load


@pytest.fixture(scope="session")
def reader():
    """Start a process that reads FBX, USD and Draco until all tests are done."""
    command = [sys.executable, "-c", READER]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        yield process
        process.kill()


@pytest.fixture(autouse=True)
def read_by_one(request, monkeypatch):
    """Let one process do all reading, but of tests marked `isolated`.

    A process takes a third of a second to start.
    """

    def read(command, *_):
        process = request.getfixturevalue("reader")
        task, job, result, _ = command[len(run.COMMAND) :]
        process.stdin.write(f"{task} {job} {result}\n")
        process.stdin.flush()
        assert process.stdout.readline(), "the reader ended"
        return subprocess.CompletedProcess(command, 0)

    if not request.node.get_closest_marker("isolated"):
        monkeypatch.setattr(run, "_done", read)
