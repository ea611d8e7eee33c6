"""Uploaded files: their quota, how long they stay, and what dead servers left."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from cutcell.errors import FileError
from cutcell_app.files import upload_cache
from cutcell_app.files.storage import LOCK, NEW_SECONDS, UNKNOWN_SECONDS, Storage
from cutcell_app.files.upload_cache import MB, UploadCache
from tests.conftest import ROOT


def put(keep, size=1, owner="a page", name="a.glb"):
    """Let a group of one file arrive."""
    group = keep.begin(size, owner)
    group.paths = [group.folder / name]
    group.paths[0].write_bytes(b"1")
    group.written = size
    return group


def aged(path, seconds):
    """Make a path look as old as that."""
    then = time.time() - seconds
    os.utime(path, (then, then))
    return path


class TestStaying:
    def test_files_go_some_time_after_they_were_left(self, tmp_path):
        keep = UploadCache(Storage(tmp_path), seconds=0.0)
        group = put(keep)
        (path,) = group.paths
        assert keep.take(group.key) == [path]
        keep.leave(group.key)
        assert path.exists()
        keep.leave(group.key)
        assert not path.exists()
        assert keep.take(group.key) is None
        keep.close()

    def test_they_go_by_the_clock_when_nobody_comes(self, keep, monkeypatch):
        group = put(keep)
        keep.leave(group.key)
        keep.sweep()
        assert group.paths[0].exists()
        later = time.monotonic() + upload_cache.STORED_SECONDS + 1
        # Its own clock alone: event loops of other tests in this process go by the real one.
        monkeypatch.setattr(
            upload_cache, "time", SimpleNamespace(monotonic=lambda: later, sleep=time.sleep)
        )
        keep.sweep()
        assert not group.folder.exists()

    def test_what_has_not_arrived_cannot_be_taken(self, keep):
        assert keep.take(keep.begin(1, "a page").key) is None

    def test_at_the_end_nothing_is_left(self, keep, tmp_path):
        put(keep)
        keep.close()
        assert list(tmp_path.iterdir()) == []


class TestQuota:
    def test_a_page_may_hold_only_so_much(self, keep, tmp_path):
        put(keep, 300 * MB)
        before = sorted(tmp_path.rglob("*"))
        with pytest.raises(FileError, match=r"300 MB.* 500 MB"):
            keep.begin(201 * MB, "a page")
        assert sorted(tmp_path.rglob("*")) == before, "it is refused before anything is written"
        keep.begin(200 * MB, "a page")
        keep.begin(300 * MB, "another page")

    def test_a_group_may_be_only_so_large(self, keep):
        with pytest.raises(FileError, match="have 501 MB together; a page takes 500 MB"):
            keep.begin(501 * MB, "a page")

    def test_all_together_may_hold_only_so_much(self, keep):
        for owner in range(4):
            put(keep, 500 * MB, owner)
        with pytest.raises(FileError, match="2,000 MB"):
            keep.begin(100 * MB, "another page")
        keep.begin(48 * MB, "another page")

    def test_what_nobody_uses_makes_way_the_oldest_first(self, keep):
        groups = [put(keep, 500 * MB, owner) for owner in range(4)]
        for group in groups[:2]:
            keep.leave(group.key)
        keep.begin(400 * MB, "another page")
        assert [group.folder.exists() for group in groups] == [False, True, True, True]

    def test_of_one_page_too(self, keep):
        first, other = put(keep, 400 * MB), put(keep, 10 * MB, "another page")
        for group in (first, other):
            keep.leave(group.key)
        keep.begin(400 * MB, "a page")
        assert not first.folder.exists()
        assert other.folder.exists()

    def test_what_did_not_arrive_gives_its_room_back(self, keep):
        group = keep.begin(500 * MB, "a page")
        keep.drop(group)
        assert not group.folder.exists()
        keep.begin(500 * MB, "a page")

    def test_the_disk_keeps_some_room_for_others(self, keep, monkeypatch):
        left = put(keep)
        keep.leave(left.key)
        monkeypatch.setattr(Storage, "free", lambda self: 300 * MB)
        put(keep, 40 * MB)
        assert left.folder.exists()
        with pytest.raises(FileError, match="no room for 50 MB: 300 MB are free"):
            keep.begin(50 * MB, "a page")
        assert not left.folder.exists(), "what nobody uses made way first"

    def test_the_disk_has_room_for_all_that_is_announced(self, keep, monkeypatch):
        monkeypatch.setattr(Storage, "free", lambda self: 300 * MB)
        first = keep.begin(30 * MB, "a page")
        with pytest.raises(FileError, match="no room for 30 MB: 270 MB are free"):
            keep.begin(30 * MB, "another page")
        first.written = 20 * MB
        monkeypatch.setattr(Storage, "free", lambda self: 280 * MB)
        keep.begin(14 * MB, "another page")
        keep.drop(first)
        keep.begin(10 * MB, "a page")


class TestSweeping:
    def dead(self, tmp_path, name, age, lock=True):
        """Leave a folder as a server does that was killed some time ago."""
        folder = tmp_path / name
        folder.mkdir()
        (folder / "a.glb").write_bytes(b"1")
        if lock:
            (folder / LOCK).touch()
        return aged(folder, age)

    def test_folders_of_dead_servers_are_removed(self, tmp_path):
        dead = self.dead(tmp_path, "cutcell-dead", 2 * NEW_SECONDS)
        older = self.dead(tmp_path, "cutcell-kept-old", 2 * UNKNOWN_SECONDS, lock=False)
        (dead / "loop").symlink_to(dead / "loop")
        aged(dead, 2 * NEW_SECONDS)
        Storage(tmp_path).sweep()
        assert not dead.exists()
        assert not older.exists()

    def test_what_may_be_in_use_stays(self, tmp_path):
        storage = Storage(tmp_path)
        mine = aged(storage.make().parent, 9 * UNKNOWN_SECONDS)
        young = self.dead(tmp_path, "cutcell-young", NEW_SECONDS / 2)
        picture = self.dead(tmp_path, "cutcell-draw-x", UNKNOWN_SECONDS / 2, lock=False)
        other = self.dead(tmp_path, "something-else", 9 * UNKNOWN_SECONDS)
        Storage(tmp_path).sweep()
        assert all(path.exists() for path in (mine, young, picture, other))
        storage.close()
        assert not mine.exists()

    def test_links_are_not_followed(self, tmp_path):
        treasure = self.dead(tmp_path, "treasure", 9 * UNKNOWN_SECONDS)
        here = tmp_path / "here"
        here.mkdir()
        (here / "cutcell-link").symlink_to(treasure)
        (here / "cutcell-loop").symlink_to(here / "cutcell-loop")
        inner = self.dead(here, "cutcell-dead", 2 * NEW_SECONDS)
        (inner / "out").symlink_to(treasure)
        aged(inner, 2 * NEW_SECONDS)
        Storage(here).sweep()
        assert not inner.exists()
        assert (treasure / "a.glb").exists()

    def test_what_belongs_to_someone_else_stays(self, tmp_path, monkeypatch):
        folder = self.dead(tmp_path, "cutcell-dead", 2 * NEW_SECONDS)
        uid = os.getuid()
        monkeypatch.setattr(os, "getuid", lambda: uid + 1)
        Storage(tmp_path).sweep()
        assert folder.exists()

    def test_a_parent_that_is_not_there_is_no_error(self, tmp_path):
        Storage(tmp_path / "nowhere").sweep()

    def test_a_killed_server_leaves_nothing_for_long(self, tmp_path):
        code = "import sys; from app.files.storage import Storage; from pathlib import Path; "
        code += "s = Storage(Path(sys.argv[1])); print(s.make(), flush=True); sys.stdin.read()"
        process = subprocess.Popen(
            [sys.executable, "-c", code, str(tmp_path)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=ROOT,
        )
        with process:
            folder = Path(process.stdout.readline().strip()).parent
            aged(folder, 2 * NEW_SECONDS)
            Storage(tmp_path).sweep()
            assert folder.exists(), "its server lives"
            process.send_signal(signal.SIGKILL)
        Storage(tmp_path).sweep()
        assert not folder.exists()
