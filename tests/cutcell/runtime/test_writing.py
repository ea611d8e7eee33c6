"""Files are written whole or not at all, and what a killed process leaves is swept."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from cutcell import FileError
from cutcell.runtime.writing import TEMPORARY, check_place, replacing, sweep, write_all
from tests.signals import reset_signals

ROOT = Path(__file__).resolve().parents[3]

WRITES = """
import os, sys, time
from pathlib import Path
from cutcell.runtime.writing import replacing

with replacing(Path(sys.argv[1])) as (unready,):
    unready.write_text("half")
    print(unready.name, flush=True)
    time.sleep(60)
"""
"""A process that is in the middle of writing, once it has said so."""


@pytest.fixture
def writer(tmp_path):
    """Start a process that is writing to a file; return it and the name of its temporary file."""
    started = []

    def start(path):
        process = subprocess.Popen(
            [sys.executable, "-c", WRITES, str(path)],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            preexec_fn=reset_signals,
        )
        started.append(process)
        return process, process.stdout.readline().strip()

    yield start
    for process in started:
        process.kill()
        process.communicate()


def let_age(folder):
    """Let the files of a folder be a day old."""
    for path in folder.glob(".cutcell-*"):
        if path.is_file() and not path.is_symlink():
            os.utime(path, (time.time() - 86400,) * 2)


def names(folder):
    return sorted(os.listdir(folder))


def test_files_are_put_in_place_together(tmp_path):
    paths = [tmp_path / "new" / "a.bin", tmp_path / "b.gltf"]
    paths[1].write_text("old")
    paths[1].chmod(0o640)
    write_all({paths[0]: b"one", paths[1]: b"two"})
    assert [path.read_bytes() for path in paths] == [b"one", b"two"]
    assert names(tmp_path) == ["b.gltf", "new"]
    assert paths[1].stat().st_mode & 0o777 == 0o640


def test_a_temporary_file_has_the_ending_and_the_folder_of_its_own(tmp_path):
    with replacing(tmp_path / "a.b.png") as (unready,):
        assert unready.parent == tmp_path
        assert unready.suffix == ".png"
        assert TEMPORARY.fullmatch(unready.name)
        assert not (tmp_path / "a.b.png").exists()
        unready.write_text("drawn")
    assert (tmp_path / "a.b.png").read_text() == "drawn"


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt, OSError(28, "No space left")])
def test_a_block_that_fails_leaves_the_old_file(tmp_path, error):
    path = tmp_path / "a.txt"
    path.write_text("old")

    def fail():
        with replacing(path) as (unready,):
            unready.write_text("half")
            raise error

    with pytest.raises(FileError if isinstance(error, OSError) else error) as failure:
        fail()
    assert path.read_text() == "old"
    assert names(tmp_path) == ["a.txt"]
    if isinstance(error, OSError):
        assert str(failure.value) == "a.txt: cannot be written (No space left)"


def test_nothing_is_replaced_where_one_of_two_cannot_be_written(tmp_path):
    for name in ("a.bin", "b.gltf"):
        (tmp_path / name).write_text("old")

    def fail():
        with replacing(tmp_path / "a.bin", tmp_path / "b.gltf") as unready:
            unready[0].write_text("new")
            unready[1].unlink()

    with pytest.raises(FileError, match=r"b\.gltf: cannot be written"):
        fail()
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {
        "a.bin": "old", "b.gltf": "old",
    }  # fmt: skip


def test_links_stay_links(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "real.txt").write_text("old")
    (tmp_path / "link.txt").symlink_to(tmp_path / "there" / "real.txt")
    (tmp_path / "loop.txt").symlink_to(tmp_path / "loop.txt")
    for name in ("link.txt", "loop.txt"):
        write_all({tmp_path / name: b"new"})
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "there" / "real.txt").read_text() == "new"
    assert (tmp_path / "loop.txt").read_text() == "new"


def test_a_killed_writer_leaves_the_old_file_and_the_next_one_sweeps(tmp_path, writer):
    path = tmp_path / "a.txt"
    path.write_text("old")
    process, left = writer(path)
    process.kill()
    process.wait()
    assert names(tmp_path) == sorted(["a.txt", left])
    assert path.read_text() == "old"
    let_age(tmp_path)
    write_all({tmp_path / "b.txt": b"another"})
    assert names(tmp_path) == ["a.txt", "b.txt"]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_writer_that_is_stopped_leaves_nothing_that_stays(tmp_path, writer, number):
    path = tmp_path / "a.txt"
    path.write_text("old")
    process, _ = writer(path)
    process.send_signal(number)
    process.wait()
    if number == signal.SIGINT:
        assert names(tmp_path) == ["a.txt"]
    let_age(tmp_path)
    sweep(tmp_path)
    assert names(tmp_path) == ["a.txt"]
    assert path.read_text() == "old"


def test_what_is_being_written_is_not_swept(tmp_path, writer):
    _, unready = writer(tmp_path / "a.txt")
    write_all({tmp_path / "b.txt": b"another"})
    assert names(tmp_path) == sorted(["b.txt", unready])


def test_only_our_own_leftovers_are_swept(tmp_path):
    others = [".cutcell-notes", ".cutcell-0123456789abcdeg.txt", "x.cutcell-0123456789abcdef.txt"]
    for name in others:
        (tmp_path / name).touch()
    (tmp_path / ".cutcell-0123456789abcdef").mkdir()
    (tmp_path / ".cutcell-fedcba9876543210").symlink_to(tmp_path / others[0])
    os.mkfifo(tmp_path / ".cutcell-00000000000000ff")
    (tmp_path / ".cutcell-0000000000000000.png").touch()
    before = names(tmp_path)
    let_age(tmp_path)
    sweep(tmp_path)
    assert set(before) - set(names(tmp_path)) == {".cutcell-0000000000000000.png"}
    sweep(tmp_path / "nowhere")


def test_many_writers_of_one_file_do_not_meet(tmp_path):
    code = (
        "import sys; from pathlib import Path; from cutcell.runtime.writing import write_all\n"
        "for k in range(40): write_all({Path(sys.argv[1]): sys.argv[2].encode() * 50_000})"
    )
    path = tmp_path / "a.txt"
    running = [
        subprocess.Popen([sys.executable, "-c", code, str(path), letter], cwd=ROOT)
        for letter in "xyz"
    ]
    deadline = time.monotonic() + 300
    while any(process.poll() is None for process in running):
        assert time.monotonic() < deadline
        content = path.read_text() if path.exists() else ""
        assert content in ("", *(letter * 50_000 for letter in "xyz"))
    assert [process.returncode for process in running] == [0, 0, 0]
    assert names(tmp_path) == ["a.txt"]


LONG = "骨" * 85
"""255 bytes in UTF-8: as long as a name can be, and longer with an ending."""


def test_names_may_be_as_long_as_the_system_takes(tmp_path):
    path = tmp_path / ("骨" * 83 + ".glb")
    write_all({path: b"new"})
    assert names(tmp_path) == [path.name]


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("no/where.glb", "where.glb: there is no folder .*no to save it in"),
        (f"{LONG}.glb", "cannot be written .File name too long"),
        ("a\0b.glb", "cannot be written .*embedded null"),
        ("folder.glb", "folder.glb: is a folder; name a file"),
    ],
)
def test_a_place_that_cannot_be_written_to_is_told_before_the_work(tmp_path, name, sentence):
    (tmp_path / "folder.glb").mkdir()
    with pytest.raises(FileError, match=sentence):
        check_place(tmp_path / name)


def test_a_folder_without_the_right_to_write_is_told_before_the_work(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "access", lambda *_: False)  # the tests may run as root, who may all
    with pytest.raises(FileError, match=r"a\.glb: the folder .* cannot be written to"):
        check_place(tmp_path / "a.glb")
