"""Bytes, open files and pipes in the place of files."""

import io
import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import cutcell
from cutcell.io.formats import BY_SUFFIX
from tests.cutcell.io.fbx_builder import binary, column_scene, old_text
from tests.cutcell.io.gltf.gltf_builder import COLUMN, column
from tests.cutcell.io.test_usd import text as usd_text
from tests.fuzz.formats import OBJ, RIGNET, SKELETON, _meshes, _text, _usd


@pytest.fixture(scope="module")
def contents(tmp_path_factory):
    """Return sound files by their endings."""
    folder = tmp_path_factory.mktemp("contents")
    rig = cutcell.load(column().save(folder / "a.glb"))
    cutcell.save(folder / "a.npz", rig)
    builder = column()
    builder.json["buffers"] = [{}]
    builder.save(folder / "a.gltf")
    files = {end: (folder / f"a{end}").read_bytes() for end in (".glb", ".gltf", ".npz")}
    files |= {"fbx": binary(column_scene()), ".fbx": old_text(), ".usda": usd_text().encode()}
    files |= {"#.obj": b"# a comment\n" + OBJ.encode(), "bom.obj": b"\xef\xbb\xbf\n" + OBJ.encode()}
    files |= {
        f"{k}.{kind}": one for kind in _meshes() for k, (one, _) in enumerate(_meshes()[kind])
    }
    return files | _usd()


NAMES = [
    *(".glb", ".gltf", ".npz", "fbx", ".fbx", ".usda", ".usdc", ".usdz", "#.obj", "bom.obj"),
    *("0.ply", "1.ply", "2.ply", "0.stl", "1.stl", "0.off"),
]


@pytest.mark.parametrize("name", NAMES)
def test_bytes_are_read_as_what_they_are(contents, name):
    rig = cutcell.load(contents[name])
    assert {tuple(p) for p in rig.mesh.vertices.round(3)} >= {tuple(p) for p in COLUMN.round(3)}


@pytest.mark.parametrize("form", [bytearray, memoryview, io.BytesIO])
def test_bytes_come_in_several_forms(contents, form):
    rig = cutcell.load(form(contents[".glb"]))
    assert_array_equal(rig.weights, cutcell.load(contents[".glb"]).weights)
    assert rig.name == "bytes"


def test_an_open_file_gives_its_name(contents, tmp_path):
    (tmp_path / "rig.any").write_bytes(contents[".glb"])
    with (tmp_path / "rig.any").open("rb") as file:
        assert cutcell.load(file).name == "rig"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
@pytest.mark.parametrize("name", [".glb", ".fbx", ".usdz", "#.obj"])
def test_a_named_pipe(contents, tmp_path, name):
    os.mkfifo(tmp_path / "pipe")
    writer = threading.Thread(target=(tmp_path / "pipe").write_bytes, args=(contents[name],))
    writer.start()
    rig = cutcell.load(tmp_path / "pipe")
    writer.join()
    assert rig.name == "pipe"
    assert len(rig.mesh.vertices) >= len(COLUMN)


def test_the_skeleton_may_be_bytes_too(contents):
    for skeleton in (_text(SKELETON), RIGNET.encode(), contents[".fbx"], contents[".npz"]):
        assert cutcell.load(OBJ.encode(), skeleton).skeleton.names[:2] == ("root", "tip")


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("https://example.org/a.glb", "https://example.org/a.glb is an address, not a file"),
        (Path("s3://example/a.glb"), "s3://example/a.glb is an address, not a file"),
        ("a" * 300 + ".glb", "cannot be read"),
        ("a\0.glb", "cannot be read"),
        ("/dev/fd/987", "/dev/fd/987: "),
        (io.StringIO("v 0 0 0"), "is open as text"),
        (b"", "bytes: the file is empty"),
        (b"a letter", '"" cannot be read'),
        (b"glTF", "bytes.glb: is cut short"),
    ],
)
def test_what_is_no_input_is_told(source, message):
    with pytest.raises(cutcell.FileError) as error:
        cutcell.load(source)
    assert message in str(error.value)


def test_nothing_is_left_behind(contents, tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    rig = cutcell.load(contents[".glb"])
    cutcell.load(contents[".fbx"])
    assert list(tmp_path.iterdir()) == []
    cutcell.save(tmp_path / "out.glb", rig)  # although the file that it came from is gone


def test_beginnings_are_told_apart(contents):
    assert set(BY_SUFFIX) >= {f".{name.rpartition('.')[2]}" for name in NAMES}


@pytest.mark.slow
@pytest.mark.parametrize("command", [["clean", "-r16", "-q"], ["bind", "-r16"]])
def test_the_command_reads_and_writes_pipes(contents, tmp_path, command):
    words = [sys.executable, "-m", "cutcell", *command, "-", "-"]
    done = subprocess.run(words, input=contents[".glb"], capture_output=True, check=True)
    again = cutcell.load(done.stdout)
    assert np.allclose(again.weights.sum(axis=1), 1)
    assert len(again.mesh.vertices) == len(COLUMN)
    assert (b"stdout.glb" in done.stderr) == ("-q" not in command)


@pytest.mark.slow
def test_the_command_writes_nothing_after_an_error(contents):
    words = [sys.executable, "-m", "cutcell", "bind", "-", "-"]
    done = subprocess.run(words, input=b"a letter", capture_output=True)
    assert (done.returncode, done.stdout) == (2, b"")
    assert b"error: stdin: " in done.stderr
    for nothing in ("</dev/null", "<&-"):
        line = f"{sys.executable} -m cutcell bind - - {nothing}"
        done = subprocess.run(line, shell=True, capture_output=True)
        assert (done.returncode, done.stdout) == (2, b"")
        assert b"Traceback" not in done.stderr
