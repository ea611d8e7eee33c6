"""Files from the browser."""

import errno
import os
from pathlib import Path

import pytest

from cutcell.errors import FileError
from cutcell_app.files.reading import main_file
from cutcell_app.files.receive import MAX_UPLOAD, NAME_BYTES, Receiver, safe_name
from cutcell_app.files.storage import Storage
from cutcell_app.files.upload_cache import SPARE_BYTES, UploadCache


@pytest.fixture
def receiver(keep):
    received, refused = [], []
    receiver = Receiver(keep, "a page", lambda group: received.append(group.paths), refused.append)
    receiver.received, receiver.refused = received, refused
    return receiver


def files_in(folder):
    """Return all files but the lock of the storage."""
    return [p for p in folder.rglob("*") if p.is_file() and p.name != "lock"]


def send(receiver, *files, piece=3):
    """Send files as the page does; return the last answer."""
    announced = [{"name": name, "size": len(data)} for name, data in files]
    answer = receiver.answer({"type": "upload-begin", "files": announced})
    for index, (_, data) in enumerate(files):
        for at in range(0, len(data), piece):
            if answer["ok"]:
                message = {"type": "upload-piece", "index": index, "data": data[at : at + piece]}
                answer = receiver.answer(message)
    return receiver.answer({"type": "upload-end"}) if answer["ok"] else answer


def test_files_arrive_as_they_were_together(receiver):
    assert send(receiver, ("a.obj", b"0123456789"), ("a.txt", b"")) == {"ok": True}
    ((first, second),) = receiver.received
    assert first.read_bytes() == b"0123456789"
    assert second.read_bytes() == b""
    assert first.parent == second.parent


def test_two_uploads_of_one_name_stay_apart(receiver):
    send(receiver, ("a.glb", b"one"))
    send(receiver, ("a.glb", b"two"))
    assert [paths[0].read_bytes() for paths in receiver.received] == [b"one", b"two"]


def test_too_large_a_file_is_refused_before_it_is_sent(receiver):
    announced = [{"name": "huge.glb", "size": MAX_UPLOAD + 1}]
    answer = receiver.answer({"type": "upload-begin", "files": announced})
    assert not answer["ok"]
    assert "huge.glb" in str(receiver.refused[0])
    assert "200 MB" in str(receiver.refused[0])


@pytest.mark.parametrize("count", [0, 65])
def test_no_files_and_too_many_are_refused(receiver, count):
    files = [{"name": str(i), "size": 1} for i in range(count)]
    assert not receiver.answer({"type": "upload-begin", "files": files})["ok"]


def test_more_than_announced_is_refused(receiver, tmp_path):
    receiver.answer({"type": "upload-begin", "files": [{"name": "a.glb", "size": 2}]})
    answer = receiver.answer({"type": "upload-piece", "index": 0, "data": b"123"})
    assert not answer["ok"]
    assert not files_in(tmp_path)


def test_less_than_announced_is_refused(receiver):
    receiver.answer({"type": "upload-begin", "files": [{"name": "a.glb", "size": 2}]})
    answer = receiver.answer({"type": "upload-end"})
    assert not answer["ok"]
    assert "a.glb" in answer["message"]


def test_a_cancelled_upload_leaves_nothing(receiver, tmp_path):
    receiver.answer({"type": "upload-begin", "files": [{"name": "a.glb", "size": 4}]})
    receiver.answer({"type": "upload-piece", "index": 0, "data": b"12"})
    assert receiver.answer({"type": "upload-cancel"}) == {"ok": True}
    assert not files_in(tmp_path)
    assert not receiver.received
    assert not receiver.refused


def test_pieces_of_nothing_are_refused(receiver):
    assert not receiver.answer({"type": "upload-piece", "index": 0, "data": b"1"})["ok"]
    assert not receiver.answer({"type": "upload-end"})["ok"]


def test_other_messages_are_no_concern(receiver):
    assert receiver.answer({"type": "ready"}) is None


@pytest.mark.parametrize(
    "message",
    [
        {"type": "upload-begin"},
        {"type": "upload-begin", "files": 3},
        {"type": "upload-begin", "files": [{"name": "a.glb"}]},
        {"type": "upload-begin", "files": [{"name": "a.glb", "size": "large"}]},
        {"type": "upload-begin", "files": [{"name": "a.glb", "size": float("nan")}]},
        {"type": "upload-piece", "index": 0, "data": 10**12},  # bytes(10**12) would be all memory
        {"type": "upload-piece", "index": "x", "data": b"1"},
    ],
)
def test_a_message_that_is_none_is_answered_in_a_sentence(receiver, message):
    receiver.answer({"type": "upload-begin", "files": [{"name": "a.glb", "size": 4}]})
    answer = receiver.answer(message)
    assert not answer["ok"]
    assert "reload" in answer["message"]
    assert send(receiver, ("b.glb", b"1234")) == {"ok": True}


def test_two_files_of_one_name_are_refused_before_they_are_sent(receiver, tmp_path):
    announced = [{"name": name, "size": 3} for name in ("x/a.bin", "y/a.bin", "b.gltf")]
    answer = receiver.answer({"type": "upload-begin", "files": announced})
    assert 'two of the files are called "a.bin"' in answer["message"]
    assert not files_in(tmp_path)


def test_a_file_that_the_browser_cannot_read_is_told(receiver, tmp_path):
    receiver.answer({"type": "upload-begin", "files": [{"name": "a.glb", "size": 4}]})
    answer = receiver.answer({"type": "upload-cancel", "unreadable": True})
    assert "could not read" in answer["message"]
    assert not files_in(tmp_path)


def test_names_of_85_chinese_letters_arrive(receiver):
    name = "骨" * 85 + ".glb"  # 259 bytes: more than a file's name may have
    assert send(receiver, (name, b"1234")) == {"ok": True}
    (path,) = receiver.received[0]
    assert path.read_bytes() == b"1234"
    assert path.name.endswith("骨骨.glb")
    assert len(path.name.encode()) <= NAME_BYTES


def test_pieces_count_against_the_room_that_was_announced(receiver, keep, monkeypatch):
    monkeypatch.setattr(Storage, "free", lambda self: SPARE_BYTES + 10)
    receiver.answer({"type": "upload-begin", "files": [{"name": "a.glb", "size": 9}]})
    with pytest.raises(FileError, match="no room"):
        keep.begin(2, "another page")
    receiver.answer({"type": "upload-piece", "index": 0, "data": b"12345"})
    monkeypatch.setattr(Storage, "free", lambda self: SPARE_BYTES + 5)
    with pytest.raises(FileError, match="no room"):
        keep.begin(2, "another page")
    assert keep.begin(1, "another page")


def test_after_a_full_disk_uploads_work_again(receiver, tmp_path, monkeypatch):
    opened = Path.open

    def full(self, mode="r", *args, **kwargs):
        if mode == "ab":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(self))
        return opened(self, mode, *args, **kwargs)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "open", full)
        answer = send(receiver, ("a.glb", b"1234"))
    assert not answer["ok"]
    assert "disk is full" in answer["message"]
    assert str(tmp_path) not in answer["message"]
    assert not files_in(tmp_path), "what came is removed, and gives its room back"
    assert send(receiver, ("a.glb", b"1234")) == {"ok": True}


def test_after_the_folder_is_gone_uploads_work_again(receiver, keep, tmp_path):
    assert send(receiver, ("a.glb", b"1234")) == {"ok": True}
    for folder in tmp_path.iterdir():
        for path in sorted(folder.rglob("*"), reverse=True):
            path.rmdir() if path.is_dir() else path.unlink()
        folder.rmdir()
    assert send(receiver, ("b.glb", b"1234")) == {"ok": True}
    assert receiver.received[-1][0].read_bytes() == b"1234"


def test_a_folder_that_is_a_loop_of_links_is_told_in_a_sentence(tmp_path):
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    refused = []
    receiver = Receiver(UploadCache(Storage(loop)), "a page", pytest.fail, refused.append)
    answer = send(receiver, ("a.glb", b"1234"))
    assert not answer["ok"]
    assert "could not store the file" in answer["message"]
    assert str(tmp_path) not in answer["message"]


def test_two_uploads_at_once_do_not_mix(keep):
    received = []
    one, other = (
        Receiver(keep, "a page", lambda group: received.append(group.paths[0]), pytest.fail)
        for _ in range(2)
    )
    for receiver in (one, other):
        receiver.answer({"type": "upload-begin", "files": [{"name": "a.glb", "size": 4}]})
    for data in (b"12", b"34"):
        one.answer({"type": "upload-piece", "index": 0, "data": data})
        other.answer({"type": "upload-piece", "index": 0, "data": data[::-1]})
    assert one.answer({"type": "upload-end"}) == {"ok": True}
    assert other.answer({"type": "upload-end"}) == {"ok": True}
    assert [path.read_bytes() for path in received] == [b"1234", b"2143"]


def test_a_new_upload_takes_the_place_of_one_that_was_not_finished(receiver, tmp_path):
    receiver.answer({"type": "upload-begin", "files": [{"name": "a.glb", "size": 9}]})
    receiver.answer({"type": "upload-piece", "index": 0, "data": b"12"})
    assert send(receiver, ("b.glb", b"1234")) == {"ok": True}
    assert [path.name for path in files_in(tmp_path)] == ["b.glb"]


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("a.glb", "a.glb"),
        ("../../etc/passwd", "passwd"),
        ("C:\\temp\\a b.glb", "a b.glb"),
        ("", "file"),
        ("..", "file"),
        ("x\n\0.glb", "x.glb"),
        ("é.glb", "é.glb"),
        ("a\u202eblg.glb", "ablg.glb"),
        ("\ud800.glb", "glb"),
        ("." * 300, "file"),
        ("a" * 500 + ".glb", "a" * (NAME_BYTES - 4) + ".glb"),
    ],
)
def test_names_cannot_lead_elsewhere(name, expected):
    assert safe_name(name) == expected


def test_the_main_file_of_a_group(tmp_path):
    obj, txt = tmp_path / "a.obj", tmp_path / "a.txt"
    assert main_file([txt, obj]) == obj
    with pytest.raises(FileError, match="no character"):
        main_file([txt])
    with pytest.raises(FileError, match="one at a time"):
        main_file([obj, tmp_path / "b.glb"])
