"""Meshes without a skeleton: they load, their graph can be built, and nothing binds them."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.geodesics import bone_distances, bone_segments
from cutcell_lab.baselines.compare import compare
from cutcell_lab.metrics import clip_error, deformation_error
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES, Builder, column
from tests.gltf_validator.validator import errors, reports

TURN = [0, 0, np.sqrt(0.5), np.sqrt(0.5)]
"""A quarter turn about z: x becomes y."""


def bare(**node):
    builder = Builder()
    mesh = builder.mesh({"POSITION": builder.positions(COLUMN)}, name="column")
    builder.node(mesh=mesh, **node)
    return builder


@pytest.fixture
def alone(loaded):
    return loaded(bare())


@pytest.mark.parametrize("end", [".obj", ".ply", ".stl", ".off"])
def test_a_mesh_of_its_own(tmp_path, end):
    trimesh.Trimesh(COLUMN, FACES, process=False).export(tmp_path / f"column{end}")
    rig = cutcell.load(tmp_path / f"column{end}")
    assert_allclose(rig.mesh.vertices[rig.mesh.faces], COLUMN[FACES])
    assert rig.skeleton.joints.shape == (0, 3)
    assert rig.weights is None
    assert [(part.name, part.vertices) for part in rig.parts] == [
        ("column", slice(0, len(rig.mesh.vertices)))
    ]


def test_gltf_meshes_stand_where_the_scene_has_them(loaded):
    builder = bare(name="left", rotation=TURN, translation=[5, 0, 0])
    builder.node(mesh=0, name="right", scale=[-2, 2, 2])
    rig = loaded(builder)
    x, y, z = COLUMN.T
    assert_allclose(rig.mesh.vertices[:12], np.stack([5 - y, x, z], axis=1), atol=1e-6)
    assert_allclose(rig.mesh.vertices[12:], 2 * np.stack([-x, y, z], axis=1), atol=1e-6)
    assert_array_equal(rig.mesh.faces[: len(FACES)], FACES)
    assert_array_equal(rig.mesh.faces[len(FACES) :], FACES[:, ::-1] + 12)
    assert [part.name for part in rig.parts] == ["left", "right"]
    assert rig.skeleton.names == ()


def test_its_graph_can_be_built(alone):
    graph = cutcell.build_graph(alone.mesh, 8)
    assert graph.is_closed


@pytest.mark.parametrize(
    "use",
    [
        cutcell.bind,
        lambda rig: bone_segments(rig.skeleton),
        lambda rig: bone_distances(cutcell.build_graph(rig.mesh, 4), rig.skeleton),
        lambda rig: bone_distances(cutcell.build_graph(rig.mesh, 4), rig.skeleton, leaf="fit"),
        lambda rig: compare([rig], ["euclidean"]),
        lambda rig: deformation_error(rig, np.zeros((12, 0)), np.zeros((12, 0))),
        lambda rig: clip_error(rig, np.zeros((12, 0)), np.zeros((12, 0))),
    ],
    ids=["bind", "segments", "distances", "fit", "compare", "deformation", "clips"],
)
def test_what_needs_joints_says_how_to_get_some(alone, use):
    with pytest.raises(cutcell.SkeletonError, match="no skeleton; export the mesh together"):
        use(alone)


@pytest.mark.parametrize("end", [".glb", ".npz", ".txt"])
def test_there_is_nothing_to_save(alone, tmp_path, end):
    with pytest.raises(cutcell.SkeletonError, match=rf"^out\{end}: the rig has no skeleton; exp"):
        cutcell.save(tmp_path / f"out{end}", alone)
    assert not (tmp_path / f"out{end}").exists()


def test_lines_alone_are_no_mesh(loaded):
    builder = bare()
    builder.json["meshes"][0]["primitives"][0]["mode"] = 1
    with pytest.raises(cutcell.MeshError, match=r"^rig\.glb: its meshes have no triangles"):
        loaded(builder)


def column_ends(rig):
    return rig.mesh.bounds * [0, 1, 0]


class TestASkeletonForIt:
    """A mesh that is given a skeleton goes back into its document, with all else that is there."""

    def dressed(self, loaded, builder, tmp_path, end=".glb"):
        rig = loaded(builder)
        bottom, top = (rig.mesh.bounds.mean(axis=0) * [1, 0, 1] + y for y in column_ends(rig))
        joints = [bottom, (bottom + top) / 2, top]
        rig = replace(rig, skeleton=cutcell.Skeleton(joints, [-1, 0, 1], ["a", "b", "c"]))
        rig = rig.with_weights(cutcell.bind(rig, 8).weights)
        path = tmp_path / f"out{end}"
        cutcell.save(path, rig)
        again = cutcell.load(path)
        assert errors(reports(path)[0]) == {}
        for computed, its in (
            (again.mesh.vertices, rig.mesh.vertices),
            (again.skeleton.joints, rig.skeleton.joints),
        ):
            assert_allclose(computed @ again.world[:3, :3].T + again.world[:3, 3], its, atol=1e-5)
        assert_array_equal(again.mesh.faces, rig.mesh.faces)
        assert again.skeleton.names == ("a", "b", "c")
        assert_allclose(again.weights, rig.weights, atol=1e-6)
        return rig, again

    @pytest.mark.parametrize("end", [".glb", ".gltf"])
    def test_its_materials_and_nodes_stay(self, loaded, tmp_path, end):
        builder = bare(name="body", rotation=TURN, translation=[5, 0, 0], scale=[2, 2, 2])
        material = builder.add("materials", {"name": "red"})
        builder.json["meshes"][0]["primitives"][0]["material"] = material
        builder.node(name="lamp")
        _, again = self.dressed(loaded, builder, tmp_path, end)
        document = again.source.document.json
        assert document["materials"] == [{"name": "red"}]
        assert document["meshes"][0]["primitives"][0]["material"] == material
        assert "lamp" in {node.get("name") for node in document["nodes"]}

    def test_a_mesh_in_two_places_has_weights_for_each(self, loaded, tmp_path):
        builder = bare(name="left", translation=[0, 5, 0])
        builder.node(mesh=0, name="right")
        _, again = self.dressed(loaded, builder, tmp_path)
        assert [part.name for part in again.parts] == ["left", "right"]
        assert len(again.source.document.json["skins"]) == 2
        assert not np.allclose(again.weights[:12], again.weights[12:])

    def test_hidden_meshes_stay_hidden(self, loaded, tmp_path):
        builder = bare()
        off = {"KHR_node_visibility": {"visible": False}}
        builder.json["extensionsUsed"] = ["KHR_node_visibility"]
        group = builder.node(name="group", extensions=off)
        builder.node(
            group, name="spare", mesh=builder.mesh({"POSITION": builder.positions(COLUMN + 3)})
        )
        _, again = self.dressed(loaded, builder, tmp_path)
        assert [part.hidden for part in again.parts] == [False, True]

    def test_what_a_skin_cannot_take_becomes_a_new_file(self, loaded, tmp_path):
        builder = bare(scale=[-1, 1, 1])
        builder.add("materials", {"name": "red"})
        _, again = self.dressed(loaded, builder, tmp_path)
        assert [one["name"] for one in again.source.document.json["materials"]] == ["plain"]


class TestParts:
    def test_every_mesh_has_a_name_and_its_vertices(self, loaded):
        builder = column()
        hat = builder.mesh(name="hat")
        builder.node(mesh=hat, skin=0)
        builder.node(mesh=builder.mesh(), skin=0)
        assert [(p.name, p.vertices, p.hidden) for p in loaded(builder).parts] == [
            ("body", slice(0, 12), False),
            ("hat", slice(12, 24), False),
            ("mesh 2", slice(24, 36), False),
        ]

    def test_hidden_meshes_are_bound_and_told(self, loaded):
        builder = column()
        off = {"KHR_node_visibility": {"visible": False}}
        group = builder.node(name="group", extensions=off)
        builder.node(group, name="spare", mesh=builder.mesh(), skin=0)
        builder.node(1, name="sword", mesh=builder.mesh(), extensions=off)
        builder.node(1, name="bow", mesh=builder.mesh(), scale=[1, 0, 0])
        rig = loaded(builder)
        assert [(p.name, p.hidden) for p in rig.parts] == [("body", False), ("spare", True)]
        assert [(a.name, a.hidden) for a in rig.attachments] == [("sword", True), ("bow", True)]

    def test_meshes_left_out_are_told(self, loaded):
        builder = column()
        builder.node(name="floor", mesh=0)
        builder.add("nodes", {"name": "old", "mesh": builder.mesh(), "skin": 0})
        builder.node(1, name="gone", mesh=builder.mesh(), scale=[0, 0, 0])
        wire = builder.mesh()
        builder.json["meshes"][wire]["primitives"][0]["mode"] = 1
        builder.node(name="wire", mesh=wire)
        rig = loaded(builder)
        assert {(out.name, out.why) for out in rig.left_out} == {
            ("floor", "has no skin and hangs on no joint"),
            ("old", "is outside of the scene"),
            ("gone", "is scaled to nothing"),
            ("wire", "is points or lines"),
        }
        assert [p.name for p in rig.parts] == ["body"]
