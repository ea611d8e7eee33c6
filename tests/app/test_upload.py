"""Files from the browser."""

import pytest

from app.opening import main_file
from app.state import MAX_UPLOAD
from app.upload import Receiver, safe_name
from cutcell.errors import FileError


@pytest.fixture
def receiver(tmp_path):
    received, refused = [], []
    receiver = Receiver(tmp_path, received.append, refused.append)
    receiver.received, receiver.refused = received, refused
    return receiver


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
    assert not [p for p in tmp_path.rglob("*") if p.is_file()]


def test_less_than_announced_is_refused(receiver):
    receiver.answer({"type": "upload-begin", "files": [{"name": "a.glb", "size": 2}]})
    answer = receiver.answer({"type": "upload-end"})
    assert not answer["ok"]
    assert "a.glb" in answer["message"]


def test_a_cancelled_upload_leaves_nothing(receiver, tmp_path):
    receiver.answer({"type": "upload-begin", "files": [{"name": "a.glb", "size": 4}]})
    receiver.answer({"type": "upload-piece", "index": 0, "data": b"12"})
    assert receiver.answer({"type": "upload-cancel"}) == {"ok": True}
    assert not [p for p in tmp_path.rglob("*") if p.is_file()]
    assert not receiver.received
    assert not receiver.refused


def test_pieces_of_nothing_are_refused(receiver):
    assert not receiver.answer({"type": "upload-piece", "index": 0, "data": b"1"})["ok"]
    assert not receiver.answer({"type": "upload-end"})["ok"]


def test_other_messages_are_no_concern(receiver):
    assert receiver.answer({"type": "ready"}) is None


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
