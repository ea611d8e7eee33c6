"""Plain arrays and meshes of other libraries are taken as they are, or a sentence says why not."""

import numpy as np
import pytest
import pyvista
import trimesh

from cutcell import (
    CutcellError,
    MeshError,
    Rig,
    Skeleton,
    SkeletonError,
    TriangleMesh,
    bone_distances,
    build_graph,
    diagnose,
    save,
)
from cutcell.rig.inputs import as_mesh, as_rig
from tests import meshes

VERTICES, FACES = meshes.ball(1)


@pytest.mark.parametrize(
    "given",
    [
        (VERTICES, FACES),
        [VERTICES.tolist(), FACES.tolist()],
        trimesh.Trimesh(VERTICES, FACES, process=False),
        pyvista.PolyData.from_regular_faces(VERTICES, FACES),
    ],
)
def test_meshes_of_all_kinds_are_the_same_mesh(given):
    mesh = as_mesh(given)
    np.testing.assert_array_equal(mesh.vertices, VERTICES)
    np.testing.assert_array_equal(mesh.faces, FACES)
    assert len(build_graph(given, 8).nodes) == len(build_graph(mesh, 8).nodes)


def test_positions_are_not_copied_and_stay_the_givers():
    vertices = VERTICES.copy()
    mesh = as_mesh((vertices, FACES))
    assert np.shares_memory(mesh.vertices, vertices)
    assert not mesh.vertices.flags.writeable
    assert vertices.flags.writeable
    other = trimesh.Trimesh(vertices, FACES, process=False)
    assert np.shares_memory(as_mesh(other).vertices, other.vertices)
    assert as_mesh(mesh) is mesh
    halves = as_mesh((vertices.astype(np.float32), FACES))
    assert halves.vertices.dtype == np.float64


def test_rigs_are_made_of_parts():
    joints, parents = [[0.5, 0.5, 0.5], [0.5, 0.5, 0.7]], [-1, 0]
    for given in (
        (VERTICES, FACES, joints, parents),
        ((VERTICES, FACES), (joints, parents)),
        (TriangleMesh(VERTICES, FACES), Skeleton(joints, parents)),
    ):
        rig = as_rig(given)
        assert isinstance(rig, Rig)
        np.testing.assert_array_equal(rig.skeleton.parents, parents)
    assert as_rig(rig) is rig


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ("ball.obj", "a mesh must be a cutcell.TriangleMesh.*, not 'ball.obj'"),
        ((VERTICES,), "a mesh must be .*, not a tuple of 1"),
        (VERTICES, "a mesh must be .*, not a ndarray"),
        ((VERTICES, FACES[:, :2]), r"faces has the shape \(80, 2\), expected \(any, 3\)"),
        (([[1, 2], [3]], FACES), "vertices must be an array of numbers"),
        (pyvista.Box(), r"faces that are no triangles; call its triangulate\(\) first"),
        (pyvista.PolyData(VERTICES), "faces that are no triangles|has no faces"),
    ],
)
def test_what_is_no_mesh_is_refused_in_a_sentence(given, sentence):
    with pytest.raises(MeshError, match=sentence):
        as_mesh(given)


def test_what_is_no_rig_is_refused_in_a_sentence():
    with pytest.raises(CutcellError, match=r"a rig must be a cutcell.Rig, .*, not 'rig.glb'"):
        as_rig("rig.glb")
    with pytest.raises(SkeletonError, match=r"a skeleton must be .*, not None"):
        as_rig(((VERTICES, FACES), None))


def test_diagnose_and_distances_take_arrays_too():
    joints, parents = [[0.5, 0.5, 0.5], [0.5, 0.5, 0.7]], [-1, 0]
    rig = as_rig((VERTICES, FACES, joints, parents))
    arrays = diagnose((VERTICES, FACES, joints, parents), 8)
    assert arrays.findings == diagnose(rig, 8).findings
    graph = build_graph(rig.mesh, 8)
    expected = bone_distances(graph, rig.skeleton).joint
    np.testing.assert_array_equal(bone_distances(graph, (joints, parents)).joint, expected)


@pytest.mark.parametrize(
    ("function", "error"),
    [
        (diagnose, CutcellError),
        (lambda rig: save("rig.glb", rig), CutcellError),
        (lambda rig: bone_distances(build_graph((VERTICES, FACES), 8), rig), SkeletonError),
    ],
)
def test_no_function_takes_a_mesh_for_a_rig(function, error):
    with pytest.raises(error, match="must be"):
        function(TriangleMesh(VERTICES, FACES))
