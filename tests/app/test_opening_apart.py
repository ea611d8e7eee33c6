"""A file that is read by a process of its own can be cancelled while it is."""

import sys

import psutil

from tests.cutcell.io.fbx_builder import column_scene, text


def readers():
    return [p for p in psutil.Process().children() if "time.sleep(62)" in " ".join(p.cmdline())]


def test_cancelling_ends_the_reader(session, loop, tmp_path, monkeypatch):
    monkeypatch.setattr(
        "cutcell.apart.COMMAND", (sys.executable, "-c", "import time; time.sleep(62)")
    )
    path = tmp_path / "column.fbx"
    path.write_bytes(text(column_scene()))
    session.opening.files([path])
    loop.run_until(lambda: len(readers()) == 1)
    session.cancel()
    loop.run_until(lambda: not readers())
    assert session.state.rig is None
    assert not session.state.busy
