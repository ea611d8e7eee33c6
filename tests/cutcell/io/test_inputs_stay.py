"""What was read is never replaced, unless it is named as what to write."""

import json
import os
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.io.gltf.container import read_document
from tests.cutcell.io.gltf.gltf_builder import column
from tests.cutcell.io.gltf.test_gltf_fresh import small_rig
from tests.cutcell.io.gltf.test_gltf_save import random_weights

TEXTURED = "# with UVs\nmtllib body.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\n"
TEXTURED += "f 1/1 3/1 2/2\nf 1/1 2/2 4/1\nf 1/1 4/1 3/2\nf 2/2 3/1 4/1\n"
JOINTS = [
    {"name": "base", "position": [0.1, 0.1, 0.1]},
    {"name": "tip", "position": [0.1, 0.5, 0.1], "parent": "base"},
]


def with_buffer_file(folder, name, buffer):
    """Write the column as a .gltf with its buffer in a file of a given name."""
    builder = column()
    document = builder.finished()
    document["buffers"][0]["uri"] = buffer
    (folder / buffer).write_bytes(builder.data)
    (folder / name).write_text(json.dumps(document))
    return folder / name


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def changed(folder, before):
    """Return the names of files whose content is another, or is new; none may be gone."""
    after = contents(folder)
    assert before.keys() <= after.keys()
    return {name for name in after if after[name] != before.get(name)}


@pytest.fixture
def body(tmp_path):
    """Give a mesh with texture coordinates and, beside it, a skeleton."""
    (tmp_path / "body.obj").write_text(TEXTURED)
    (tmp_path / "body.json").write_text(json.dumps({"joints": JOINTS}))
    return tmp_path / "body.obj"


def test_the_mesh_that_a_rignet_rig_came_from_stays_as_it_is(tmp_path, body):
    before = contents(tmp_path)
    rig = cutcell.load(body)
    weights = random_weights(rig, 2)
    written = cutcell.save(tmp_path / "body.txt", rig.with_weights(weights))
    assert written == (tmp_path / "body.txt",)
    assert changed(tmp_path, before) == {"body.txt"}
    again = cutcell.load(body)
    assert_allclose(again.weights, weights)
    assert_array_equal(again.mesh.vertices, rig.mesh.vertices)
    before = contents(tmp_path)
    cutcell.save(tmp_path / "body.txt", again.with_weights(random_weights(rig, 1)))
    assert changed(tmp_path, before) == {"body.txt"}


@pytest.mark.parametrize("there", [TEXTURED, "no mesh at all\n", "\0\xff"])
def test_a_mesh_that_is_another_is_never_replaced(tmp_path, there):
    (tmp_path / "body.obj").write_text(there)
    before = contents(tmp_path)
    with pytest.raises(
        cutcell.FileError,
        match=r"^body\.txt: its mesh belongs in body\.obj, but a file of that name is there and "
        "holds another mesh; choose another name, or remove that file",
    ):
        cutcell.save(tmp_path / "body.txt", small_rig())
    assert changed(tmp_path, before) == set()


def test_a_mesh_that_was_changed_does_not_replace_its_file(tmp_path, body):
    rig = cutcell.load(body)
    moved = cutcell.TriangleMesh(rig.mesh.vertices + 1e-9, rig.mesh.faces)
    rig = replace(rig, mesh=moved, weights=random_weights(rig, 2))
    with pytest.raises(cutcell.FileError, match="holds another mesh"):
        cutcell.save(tmp_path / "body.txt", rig)
    cutcell.save(tmp_path / "moved.txt", rig)
    assert_array_equal(cutcell.load(tmp_path / "moved.txt").mesh.vertices, moved.vertices)
    assert body.read_text() == TEXTURED


def test_the_buffer_of_the_file_that_was_read_stays(tmp_path):
    path = with_buffer_file(tmp_path, "in.gltf", "model.bin")
    before = contents(tmp_path)
    rig = cutcell.load(path)
    for turn in range(3):  # again and again: nothing piles up
        weights = random_weights(rig, 2, seed=turn)
        written = cutcell.save(tmp_path / "model.gltf", rig.with_weights(weights))
        assert written == (tmp_path / "model-2.bin", tmp_path / "model.gltf")
        assert changed(tmp_path, before) == {"model.gltf", "model-2.bin"}
        assert_allclose(cutcell.load(tmp_path / "model.gltf").weights, weights, atol=1e-7)
    assert_array_equal(cutcell.load(path).weights, rig.weights)


def test_a_buffer_that_two_documents_share_stays_when_one_of_them_is_read(tmp_path):
    path = with_buffer_file(tmp_path, "in.gltf", "model.bin")
    with_buffer_file(tmp_path, "model.gltf", "model.bin")
    before = contents(tmp_path)
    cutcell.save(tmp_path / "model.gltf", cutcell.load(path))
    assert changed(tmp_path, before) == {"model.gltf", "model-2.bin"}


@pytest.mark.parametrize("buffer", ["in.bin", "model.bin"])
def test_a_file_that_is_named_is_replaced_with_the_buffer_of_its_name(tmp_path, buffer):
    path = with_buffer_file(tmp_path, "in.gltf", buffer)
    rig = cutcell.load(path)
    before = contents(tmp_path)
    weights = random_weights(rig, 2)
    cutcell.save(path, rig.with_weights(weights))
    assert changed(tmp_path, before) == {"in.gltf", "in.bin"}
    assert_allclose(cutcell.load(path).weights, weights, atol=1e-7)


@pytest.mark.parametrize("there", [None, b"not a document", b'{"buffers": 5}'])
def test_a_file_that_belongs_to_nothing_we_know_stays(tmp_path, there):
    (tmp_path / "in").mkdir()
    rig = cutcell.load(with_buffer_file(tmp_path / "in", "in.gltf", "in.bin"))
    for name in ("out.bin", "out-2.bin"):
        (tmp_path / name).write_bytes(b"something else")
    if there is not None:
        (tmp_path / "out.gltf").write_bytes(there)
    written = cutcell.save(tmp_path / "out.gltf", rig)
    assert [path.name for path in written] == ["out-3.bin", "out.gltf"]
    assert (tmp_path / "out.bin").read_bytes() == b"something else"
    assert_array_equal(cutcell.load(tmp_path / "out.gltf").weights, rig.weights)


def test_a_link_to_what_was_read_is_not_written_through(tmp_path):
    path = with_buffer_file(tmp_path, "in.gltf", "in.bin")
    (tmp_path / "out.bin").symlink_to("in.bin")
    before = contents(tmp_path)
    cutcell.save(tmp_path / "out.gltf", cutcell.load(path))
    assert changed(tmp_path, before) == {"out.gltf", "out-2.bin"}


def test_an_image_and_the_buffer_do_not_take_one_name(tmp_path):
    (tmp_path / "in").mkdir()
    path = with_buffer_file(tmp_path / "in", "in.gltf", "in.bin")
    document = json.loads(path.read_text())
    document["images"] = [{"uri": "out.bin"}]
    path.write_text(json.dumps(document))
    (tmp_path / "in" / "out.bin").write_bytes(b"\x89PNG in an odd name")
    cutcell.save(tmp_path / "out.gltf", cutcell.load(path))
    assert (tmp_path / "out.bin").read_bytes() == b"\x89PNG in an odd name"
    cutcell.load(tmp_path / "out.gltf")


@pytest.mark.parametrize(
    "name", ["a:b", "a b", "a\\b", "ü骨", "50%", "a#b?c", "..a", "a.b", "tab\there", "data:x"]
)
def test_odd_names_can_be_read_again(tmp_path, name):
    (tmp_path / "in").mkdir()
    rig = cutcell.load(with_buffer_file(tmp_path / "in", "in.gltf", "in.bin"))
    path = tmp_path / f"{name}.gltf"
    cutcell.save(path, rig)
    assert len(read_document(path).buffers) == 1
    assert_array_equal(cutcell.load(path).weights, rig.weights)


def test_a_name_that_is_no_unicode_can_be_read_again(tmp_path):
    rig = cutcell.load(column().save(tmp_path / "in.glb"))
    path = tmp_path / os.fsdecode(b"caf\xe9.gltf")
    cutcell.save(path, rig)
    assert_allclose(cutcell.load(path).weights, rig.weights, atol=1e-7)


def test_all_that_could_be_read_stays_whatever_is_saved_beside_it(tmp_path, body):
    """Every ending, under the name of every input."""
    with_buffer_file(tmp_path, "in.gltf", "model.bin")
    column().save(tmp_path / "hero.glb")
    inputs = {name: cutcell.load(tmp_path / name) for name in ("body.obj", "in.gltf", "hero.glb")}
    given = contents(tmp_path)
    for rig in inputs.values():
        rig = rig.with_weights(random_weights(rig, 1))
        for stem in ("body", "in", "model", "hero"):
            for end in (".glb", ".gltf", ".txt", ".npz"):
                named = tmp_path / f"{stem}{end}"
                if named.name in given:
                    continue
                try:
                    written = cutcell.save(named, rig)
                except cutcell.FileError:
                    written = ()
                assert {k: v for k, v in contents(tmp_path).items() if k in given} == given
                for path in written:
                    path.unlink()


@pytest.mark.parametrize("end", [".glb", ".gltf", ".npz", ".txt"])
def test_numbers_that_are_no_weights_are_refused(tmp_path, end):
    rig = small_rig()
    with pytest.raises(
        cutcell.WeightsError, match="weights must be an array of real numbers, not of complex"
    ):
        rig.with_weights(rig.weights * 1j)
    with pytest.raises(
        cutcell.WeightsError, match="weights must be an array of real numbers, not of <U"
    ):
        rig.with_weights(rig.weights.astype(str))
    whole = np.rint(rig.weights * 2).astype(np.uint8)
    cutcell.save(tmp_path / "in.glb", rig)
    source = cutcell.load(tmp_path / "in.glb")
    cutcell.save(tmp_path / f"out{end}", source.with_weights(whole))
    assert_allclose(cutcell.load(tmp_path / f"out{end}").weights, whole / 2, atol=1e-7)
