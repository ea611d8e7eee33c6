"""Work in processes of its own: results, errors, crashes, and its end when it is not wanted."""

import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import psutil
import pytest

import cutcell
from cutcell.errors import Cancelled, CutcellError, FileError, MeshError
from cutcell_app.derive.processes import in_process
from cutcell_app.files import reading
from cutcell_app.files.reading import read
from cutcell_app.files.storage import NEW_SECONDS, Storage
from cutcell_assets import demo_path
from tests.app.loop import wait_until
from tests.conftest import ROOT

pytestmark = pytest.mark.slow


class OddError(Exception):
    """Cannot be copied: it is made of two things, and tells one."""

    def __init__(self, one, other):
        super().__init__(one)


SERVER = """
import subprocess, sys
from cutcell_app.files.storage import NEW_SECONDS, Storage
from cutcell_app.derive.processes import in_process
in_process(subprocess.call, ["sh", "-c", 'echo $PPID $$ > "$0"; sleep 600', sys.argv[1]])
"""


KILLED_SERVER = """
import os, signal
from cutcell_app.files.storage import Storage
from cutcell_app.files.storage import NEW_SECONDS, Storage
from cutcell_app.derive.processes import get_ready, in_process
get_ready(Storage().make)
in_process(divmod, 7, 2)
os.kill(os.getpid(), signal.SIGKILL)
"""


def fails(error):
    raise error


def fails_oddly():
    raise OddError("no", "luck")


def needs_too_much():
    return np.ones(2**62, np.uint8)


def killed():
    os.kill(os.getpid(), signal.SIGKILL)


def starts_another(path):
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    path.write_text(f"{os.getpid()} {child.pid}")
    time.sleep(600)


def gone(pid):
    return not psutil.pid_exists(pid) or psutil.Process(pid).status() == psutil.STATUS_ZOMBIE


def test_a_result_comes_back():
    assert in_process(divmod, 7, 2) == (3, 1)
    assert in_process(os.getpid) != os.getpid()


@pytest.mark.parametrize("kind", [FileError, MeshError, MemoryError, ValueError])
def test_errors_come_back_as_they_are(kind):
    with pytest.raises(kind, match="no luck"):
        in_process(fails, kind("no luck"))


def test_an_error_that_cannot_be_copied_is_told_all_the_same():
    with pytest.raises(RuntimeError, match="OddError: no"):
        in_process(fails_oddly)


def test_what_never_ends_is_ended():
    with pytest.raises(FileError):
        in_process(time.sleep, 3600, limit=0.1)


def test_running_out_of_memory_is_told():
    with pytest.raises(MemoryError):
        in_process(needs_too_much)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux chooses whom to end so")
def test_where_memory_runs_out_it_is_ended_before_the_server():
    computed = int(Path("/proc/self/oom_score_adj").read_text())
    assert int(in_process(Path.read_text, Path("/proc/self/oom_score_adj"))) == 1000 > computed


def test_a_crash_is_told_and_harms_nobody():
    with pytest.raises(CutcellError, match=r"came to a sudden end \(signal 9\)"):
        in_process(killed)
    assert in_process(divmod, 7, 2) == (3, 1)


def test_where_no_process_can_begin_it_is_told(monkeypatch):
    def gone(self):
        raise BrokenPipeError

    monkeypatch.setattr("multiprocessing.process.BaseProcess.start", gone)
    with pytest.raises(FileError, match=r"came to a sudden end \(no process could begin\)"):
        in_process(divmod, 7, 2)


def test_what_is_not_wanted_ends_with_all_that_it_started(tmp_path):
    path = tmp_path / "pids"

    def wanted():
        if path.exists() and len(path.read_text().split()) == 2:
            raise Cancelled

    with pytest.raises(Cancelled):
        in_process(starts_another, path, check=wanted)
    for pid in map(int, path.read_text().split()):
        wait_until(lambda pid=pid: gone(pid))


def test_it_ends_with_a_server_that_is_killed(tmp_path):
    path = tmp_path / "pids"
    server = subprocess.Popen([sys.executable, "-c", SERVER, str(path)], cwd=ROOT)
    wait_until(lambda: path.exists() and len(path.read_text().split()) == 2)
    server.kill()
    server.wait()
    for pid in map(int, path.read_text().split()):
        wait_until(lambda pid=pid: gone(pid))


def test_a_character_comes_back_as_it_is():
    here, there = cutcell.load(demo_path("robot")), read(demo_path("robot"))
    np.testing.assert_array_equal(here.mesh.vertices, there.mesh.vertices)
    np.testing.assert_array_equal(here.weights, there.weights)
    assert here.skeleton.names == there.skeleton.names
    assert not there.weights.flags.writeable
    assert not there.mesh.faces.flags.writeable


def test_a_bad_file_is_named(tmp_path):
    path = tmp_path / "bad.glb"
    path.write_bytes(b"glTF nonsense")
    with pytest.raises(FileError, match=r"bad\.glb: "):
        read(path)


def test_a_reader_that_ends_its_process_is_named(monkeypatch, tmp_path):
    monkeypatch.setattr(reading, "load_with_materials", killed_by)
    with pytest.raises(
        FileError, match=r"bad\.glb: reading it came to a sudden end; .* \(signal 9\)"
    ):
        read(tmp_path / "bad.glb")


def killed_by(path):
    killed()


def test_a_killed_server_leaves_no_folder_that_is_not_swept():
    with tempfile.TemporaryDirectory() as folder:  # of a short name: it holds a socket
        environment = {**os.environ, "TMPDIR": folder}
        command = [sys.executable, "-c", KILLED_SERVER]
        done = subprocess.run(command, cwd=ROOT, env=environment)
        assert done.returncode == -signal.SIGKILL
        long_ago = time.time() - 2 * NEW_SECONDS
        for left in Path(folder).iterdir():
            os.utime(left, (long_ago, long_ago))
        Storage(Path(folder)).sweep()
        assert os.listdir(folder) == []
