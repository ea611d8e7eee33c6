"""Faces of a glTF document are turned and dropped, and nothing else in it changes."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.graph import inverted_faces
from cutcell.io.gltf.container import read_document
from cutcell.io.gltf.read.accessors import read_accessor
from cutcell.io.gltf.write.faces import with_faces
from cutcell.rig import TriangleMesh
from cutcell_assets import demo_path
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES, column, two_skins
from tests.gltf_validator.validator import errors, reports

SOME = np.arange(len(FACES)) % 3 == 0


def every(rig):
    return np.ones(len(rig.mesh.faces), bool)


def loaded(path, builder):
    return cutcell.load(builder.save(path))


def saved(path, rig):
    """Save a rig and load it again; the file is valid, and holds nothing that is not used."""
    cutcell.save(path, rig)
    (report,) = reports(path)
    assert not errors(report)
    assert all(message["code"] != "UNUSED_OBJECT" for message in report["issues"]["messages"])
    return cutcell.load(path)


def test_turned_and_dropped_faces_are_stored(tmp_path):
    rig = loaded(tmp_path / "column.glb", column())
    kept = np.arange(len(FACES)) != 4
    edited = with_faces(rig, kept, SOME)
    expected = np.where(SOME[:, None], FACES[:, [0, 2, 1]], FACES)[kept]
    assert_array_equal(edited.mesh.faces, expected)
    again = saved(tmp_path / "edited.glb", edited)
    assert_array_equal(again.mesh.faces, expected)
    assert_array_equal(again.mesh.vertices, rig.mesh.vertices)
    assert_allclose(again.weights, rig.weights, atol=1e-7)


def test_faces_are_edited_more_than_once(tmp_path):
    rig = loaded(tmp_path / "column.glb", column())
    once = with_faces(rig, ~SOME, ~SOME)
    twice = with_faces(once, every(once), every(once))
    assert_array_equal(saved(tmp_path / "a.glb", twice).mesh.faces, FACES[~SOME])


def test_each_primitive_gets_its_own_faces_and_keeps_one(tmp_path):
    rig = loaded(tmp_path / "two.glb", two_skins((2, 0, 0)))
    stored = rig.source.faces
    assert len(stored) == 2
    kept = every(rig)
    kept[stored[1].rows] = False
    edited = with_faces(rig, kept, ~every(rig))
    again = saved(tmp_path / "edited.glb", edited)
    assert_array_equal(again.mesh.faces, edited.mesh.faces)
    assert len(again.mesh.faces) == stored[0].rows.stop + 1


def test_what_did_not_change_is_not_written_anew(tmp_path):
    rig = loaded(tmp_path / "two.glb", two_skins((2, 0, 0)))
    turned = np.zeros(len(rig.mesh.faces), bool)
    turned[-1] = True
    cutcell.save(tmp_path / "edited.glb", with_faces(rig, every(rig), turned))
    before, after = (read_document(tmp_path / n) for n in ("two.glb", "edited.glb"))
    first, second = (d.json["meshes"][0]["primitives"][0] for d in (before, after))
    assert first["indices"] == second["indices"]


def test_normals_that_look_inward_turn_with_the_faces(tmp_path):
    broken = replace(cutcell.load(demo_path("biped_flipped_arm")), source=None)
    cutcell.save(tmp_path / "inside_out.glb", broken)  # with normals made from its faces
    rig = cutcell.load(tmp_path / "inside_out.glb")
    turned = inverted_faces(rig.mesh)
    again = saved(tmp_path / "mended.glb", with_faces(rig, every(rig), turned))
    assert not inverted_faces(again.mesh).any()
    assert agreement(tmp_path / "inside_out.glb", again.mesh) < 0.95
    assert agreement(tmp_path / "mended.glb", again.mesh) > 0.99


def test_normals_that_look_outward_already_stay(tmp_path):
    path = demo_path("biped_flipped_arm")
    rig = cutcell.load(path)
    saved(tmp_path / "mended.glb", with_faces(rig, every(rig), inverted_faces(rig.mesh)))
    assert_array_equal(normals(tmp_path / "mended.glb"), normals(path))


def test_a_rig_without_a_document_is_edited_too():
    rig = cutcell.Rig(TriangleMesh(COLUMN, FACES), cutcell.Skeleton([[0, 0, 0]], [-1]))
    assert_array_equal(with_faces(rig, SOME, ~SOME).mesh.faces, FACES[SOME])


def test_other_faces_than_the_documents_are_refused(tmp_path):
    rig = loaded(tmp_path / "column.glb", column())
    fewer = replace(rig, mesh=TriangleMesh(rig.mesh.vertices, rig.mesh.faces[1:]))
    with pytest.raises(cutcell.MeshError, match="the rig has 19 faces, its document 20; set the"):
        cutcell.save(tmp_path / "out.glb", fewer)


def normals(path):
    document = read_document(path)
    result = [p for mesh in document.items("meshes") for p in mesh["primitives"]]
    return np.concatenate(
        [read_accessor(document, p["attributes"]["NORMAL"], "VEC3", "it") for p in result]
    )


def agreement(path, mesh):
    """Return for which share of corners the file's normals look where the faces do."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    facing = np.cross(b - a, c - a)
    return (np.einsum("mi,mki->mk", facing, normals(path)[mesh.faces]) > 0).mean()
