"""Vertices that are split at seams when a mesh with materials is saved."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import cutcell
from cutcell.io.gltf.buffer import BufferWriter
from cutcell.io.gltf.container import json_bytes, pack_glb
from cutcell.io.gltf.write.faces import with_faces
from cutcell.io.materials.gltf_colored import split_at_seams
from cutcell.io.materials.transfer import read_materials
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES
from tests.cutcell.io.materials.test_gltf_colored import SKIN_PNG, check_same, load_again, load_obj
from tests.cutcell.io.materials.test_obj_materials import RED, SKIN, lines


def naive_split(faces, count, values):
    """Return corners' numbers, made one by one: where values are new to a vertex it is a copy."""
    known, origin, result = {}, list(range(count)), []
    for vertex, value in zip(
        faces.ravel().tolist(), values.reshape(-1, values.shape[2]), strict=True
    ):
        mine = known.setdefault(vertex, {})
        key = tuple(value.tolist())
        if key not in mine and mine:
            origin.append(vertex)
        result.append(mine.setdefault(key, vertex if not mine else len(origin) - 1))
    return np.reshape(result, faces.shape), np.array(origin)


@pytest.mark.parametrize("different", [1, 2, 50])
@pytest.mark.parametrize("seed", range(5))
def test_it_is_what_a_slow_one_makes(seed, different):
    rng = np.random.default_rng(seed)
    faces = rng.integers(0, 9, (20, 3))
    values = rng.integers(0, different, (20, 3, 2)).astype(np.float32)
    split, origin = split_at_seams(faces, 10, values)
    expected, expected_origin = naive_split(faces, 10, values)
    assert_array_equal(origin[split], faces)
    assert_array_equal(origin[:10], np.arange(10))
    assert len(origin) == len(expected_origin)
    pairs = {*zip(split.ravel().tolist(), expected.ravel().tolist(), strict=True)}
    assert len(pairs) == len({a for a, _ in pairs}) == len({b for _, b in pairs})
    kept = split < 10
    assert_array_equal(kept, expected < 10)


def test_without_seams_nothing_is_split():
    faces = np.array([[0, 1, 2], [2, 1, 3]])
    values = np.arange(4)[faces][..., None].astype(np.float32)
    split, origin = split_at_seams(faces, 5, values)
    assert_array_equal(split, faces)
    assert_array_equal(origin, np.arange(5))


class TestSavedAgain:
    """A file with split vertices is a glTF document like others."""

    @pytest.fixture
    def first(self, tmp_path):
        rig = load_obj(tmp_path, lines("red", "skin"), RED + SKIN, skin=SKIN_PNG)
        result = load_again(tmp_path, rig)
        assert len(result.mesh.vertices) > len(rig.mesh.vertices)
        return result

    def test_other_weights(self, first, tmp_path):
        other = first.with_weights(np.eye(2)[np.arange(len(first.mesh.vertices)) % 2])
        check_same(other, load_again(tmp_path, other))

    def test_the_same_weights_give_the_same_bytes(self, first, tmp_path):
        cutcell.save(tmp_path / "a.glb", first)
        cutcell.save(tmp_path / "b.glb", cutcell.load(tmp_path / "a.glb"))
        assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()

    def test_repaired_faces_keep_their_colours(self, first, tmp_path):
        kept, turned = np.ones(len(FACES), bool), np.zeros(len(FACES), bool)
        kept[[2, 15]], turned[[4, 16]] = False, True
        mended = with_faces(first, kept, turned)
        check_same(mended, load_again(tmp_path, mended))

    def test_faces_that_are_not_the_files_have_no_colours(self, first):
        faces = first.mesh.faces[1:]
        mesh = cutcell.TriangleMesh(first.mesh.vertices, faces)
        assert read_materials(replace(first, mesh=mesh)) is None

    def test_copies_have_the_position_of_their_vertex(self, first):
        assert len(np.unique(first.mesh.vertices, axis=0)) == len(COLUMN)

    def test_files_of_older_builds_load_with_all_stored_vertices(self, first, tmp_path):
        """They had one more attribute, the vertex that each was split from."""
        document = first.source.document
        numbers = np.arange(len(first.mesh.vertices), dtype="<f4")[:, None]
        writer = BufferWriter(document.json, document.buffers)
        split_from = writer.store(numbers)
        for primitive in document.json["meshes"][0]["primitives"]:
            primitive["attributes"]["_SPLIT_FROM"] = split_from
        data = writer.finish()
        (tmp_path / "older.glb").write_bytes(pack_glb(json_bytes(document.json), data, []))
        older = cutcell.load(tmp_path / "older.glb")
        assert_array_equal(older.mesh.vertices, first.mesh.vertices)
        assert_array_equal(older.mesh.faces, first.mesh.faces)
        assert_array_equal(older.weights, first.weights)
