"""Files that once ended in something else than a sentence: huge numbers, false headers, loops."""

import io
import json
import struct
import time
import tracemalloc
import zipfile

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cutcell
from tests.cutcell.io.gltf.gltf_builder import column
from tests.cutcell.io.test_articulation import arrays, write

CUBE = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1))
SIDES = "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"
MANY = "9" * 5000
"""More digits than Python makes a whole number of."""
SHORT = 400


def refused(path, message):
    """See that loading ends in one sentence, which is short and names the file."""
    with pytest.raises(cutcell.CutcellError, match=message) as caught:
        cutcell.load(path)
    sentence = str(caught.value)
    assert path.name in sentence
    assert len(sentence) < SHORT
    assert "\n" not in sentence


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("f 1 2 99999999999999999999", "line 15: vertex 99999999999999999999 is out of range"),
        (f"f 1 2 {MANY}", 'line 15: "9{40}" is not a corner'),
        (f"v 1 2 {MANY}", "line 15: 1 2 9+ is not finite"),
        ("v 1 2 nothing" + "x" * 5000, 'line 15: "nothingx{33}" is not a number'),
    ],
)
def test_an_obj_with_huge_numbers(tmp_path, line, message):
    path = tmp_path / "cube.obj"
    path.write_text(f"{CUBE}{SIDES}{line}\n")
    refused(path, message)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (f"skin {MANY} a 1", "line 4: there is no vertex 9{40};"),
        (f"skin 1 {'b' * 5000} 1", 'line 4: there is no joint "b{40}"'),
        (f"hier a {'b' * 5000}", 'the joint "b{40}" has no line'),
    ],
)
def test_a_rignet_with_huge_words(tmp_path, line, message):
    (tmp_path / "rig.obj").write_text(CUBE + SIDES)
    path = tmp_path / "rig.txt"
    path.write_text(f"joints a .5 .5 .5\nroot a\nskin 0 a 1\n{line}\n")
    refused(path, message)


def test_weights_whose_sum_is_more_than_any_number(tmp_path):
    (tmp_path / "rig.obj").write_text(CUBE + SIDES)
    path = tmp_path / "rig.txt"
    joints = "joints a .5 .5 .5\njoints b .5 .6 .5\nroot a\nhier a b\n"
    path.write_text(joints + "".join(f"skin {k} a 1e308 b 1e308 b 1e308\n" for k in range(8)))
    assert_allclose(cutcell.load(path).weights, np.tile([1 / 3, 2 / 3], (8, 1)))


def test_a_skeleton_with_huge_numbers(tmp_path):
    (tmp_path / "cube.obj").write_text(CUBE + SIDES)
    path = tmp_path / "cube.skeleton.json"
    joint = {"name": "a", "position": [0, 0, "many"]}
    path.write_text(json.dumps({"joints": [joint]}).replace('"many"', MANY))
    with pytest.raises(cutcell.FileError, match=r"^cube\.skeleton\.json: its JSON cannot be read"):
        cutcell.load(tmp_path / "cube.obj")


@pytest.mark.slow
def test_a_skeleton_of_thousands_of_joints_takes_seconds(tmp_path):
    (tmp_path / "cube.obj").write_text(CUBE + SIDES)
    names = [f"joint {k}" for k in range(8000)]
    joints = [{"name": names[0], "position": [0.5, 0, 0.5]}]
    for k in range(1, len(names)):
        joints.append({"name": names[k], "position": [0.5, k / 1e4, 0.5], "parent": names[k - 1]})
    (tmp_path / "cube.skeleton.json").write_text(json.dumps({"joints": joints}))
    begin = time.process_time()
    rig = cutcell.load(tmp_path / "cube.obj")
    assert time.process_time() - begin < 6
    assert len(rig.skeleton.joints) == rig.skeleton.deform.sum() == 8000


def test_a_message_is_one_line_and_short(tmp_path):
    builder = column()
    builder.json["meshes"][0]["name"] = "a\nb" + "x" * 5000
    del builder.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]
    path = builder.save(tmp_path / "rig.glb")
    with pytest.raises(
        cutcell.MeshError, match=r"^rig\.glb: mesh \"a bx+ \.\.\. x+\".*POSITION$"
    ) as e:
        cutcell.load(path)
    assert len(str(e.value)) < 1100


def test_a_gltf_with_huge_numbers(tmp_path):
    document = json.dumps(column().finished()).replace('"scene": 0', f'"scene": {MANY}')
    path = tmp_path / "rig.gltf"
    path.write_text(document)
    refused(path, "its JSON cannot be read: Exceeds the limit")


@pytest.mark.parametrize("name", ["vertices", "joints", "skinning_weights_value"])
def test_complex_numbers_are_none(tmp_path, name):
    refused(write(tmp_path, **{name: arrays()[name] + 1j}), "numbers")


def with_header(tmp_path, header, content=b""):
    """Write an archive with one more array, given what stands in the file."""
    path = write(tmp_path)
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive:
        start = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header))
        archive.writestr("odd.npy", start + header + content)
    return path


def plain(shape, kind="<f8"):
    return f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n".encode()


@pytest.mark.parametrize(
    ("header", "message"),
    [
        (plain("(1000000000,)"), '"odd.npy" announces 8,000,000,000 bytes and holds 0'),
        (plain("(-1,)"), "announces -8 bytes and holds 0"),
        (plain("(2,)", "<U100000000"), "announces 800,000,000 bytes and holds 0"),
        (plain(f"({MANY},)"), "is not a readable npz archive: Cannot parse header"),
        (plain("(1,)", "|O"), "pickled Python objects"),
        (b"{'descr': '<f8', 'fortran_order': Fal", "is not a readable npz archive"),
        (b"{'shape': " + b"(" * 50, "is not a readable npz archive"),
        (b"\xff" * 20, "is not a readable npz archive"),
    ],
)
def test_an_array_that_is_not_what_its_header_says(tmp_path, header, message):
    tracemalloc.start()
    refused(with_header(tmp_path, header), message)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 20e6


def test_an_array_of_zeros_that_takes_no_room_in_the_file(tmp_path, monkeypatch):
    monkeypatch.setattr("cutcell.io.files.LEAST", 2**20)
    path = with_header(tmp_path, plain("(2000000,)"), bytes(16_000_000))
    refused(path, '"odd.npy" would take 32.0 MB of memory, and a file of')


def test_an_array_of_a_later_version(tmp_path):
    path = write(tmp_path)
    stored = io.BytesIO()
    np.lib.format.write_array(stored, np.zeros(3), version=(3, 0))
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("odd.npy", stored.getvalue())
    refused(path, '"odd.npy" is of the npy version 3.0')


@pytest.mark.parametrize("end", ["glb", "gltf", "vrm", "fbx", "usda", "npz", "txt", "obj", "ply"])
def test_links_that_lead_to_each_other(tmp_path, end):
    path, other = tmp_path / f"one.{end}", tmp_path / f"other.{end}"
    path.symlink_to(other)
    other.symlink_to(path)
    refused(path, "cannot be read")


def test_a_skeleton_and_a_buffer_that_are_such_links(tmp_path):
    loop = tmp_path / "loop.json"
    loop.symlink_to(loop)
    (tmp_path / "cube.obj").write_text(CUBE + SIDES)
    with pytest.raises(cutcell.FileError, match=r"loop\.json: cannot be read"):
        cutcell.load(tmp_path / "cube.obj", skeleton=loop)
    document = column().finished()
    document["buffers"][0]["uri"] = "loop.json"
    path = tmp_path / "rig.gltf"
    path.write_text(json.dumps(document))
    refused(path, r"loop\.json: cannot be read")


def test_many_buffers_in_one_file_are_read_once(tmp_path):
    builder = column()
    document = builder.finished()
    document["buffers"][0]["uri"] = "all.bin"
    document["buffers"] += [{"uri": "all.bin", "byteLength": 2**20}] * 100
    (tmp_path / "all.bin").write_bytes(bytes(builder.data).ljust(2**20, b"\0"))
    path = tmp_path / "rig.gltf"
    path.write_text(json.dumps(document))
    tracemalloc.start()
    cutcell.load(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 10e6


@pytest.mark.parametrize("name", ["vertices", "joints", "skinning_weights_value"])
def test_signalling_nans_are_nans(tmp_path, name):
    values = np.array(arrays()[name], "f4")
    values.view("u4").flat[0] = 0x7F800001
    path = write(tmp_path, **{name: values})
    if name == "skinning_weights_value":
        assert "not a number" in cutcell.load(path).warnings[0]
    else:
        refused(path, "not a finite number")


def test_faces_in_half_precision(tmp_path):
    faces = arrays()["faces"].astype("f2")
    assert_allclose(cutcell.load(write(tmp_path, faces=faces)).mesh.faces, faces)
    faces[0, 0] = np.inf
    refused(write(tmp_path, faces=faces), "faces must be whole numbers")
