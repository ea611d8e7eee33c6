"""Two vertices are one everywhere or nowhere, and what a welded mesh knows of itself is true."""

import numpy as np
import pytest
import trimesh

from cutcell import Rig, Skeleton, TriangleMesh, build_graph
from cutcell.diagnosis.subject import Subject
from cutcell.editing.selections import Neighbours
from cutcell.editing.symmetry import find_mirror
from cutcell.geometry.weld import WELD_TOLERANCE
from cutcell.rig.mesh import vertex_shares
from cutcell_lab.baselines.body import Body
from cutcell_lab.networks.samples import sample_rig
from tests import meshes
from tests.bars import grid_box


def figure(gap):
    """Return a mirrored cube of two halves, which lie a gap apart, in parts of its side.

    The diagonal of a cube is 1.73 times as long as its side.
    """
    vertices, faces = grid_box(4, 4, 4, (1, 1, 1))
    upper = vertices[faces].mean(axis=1)[:, 2] > 0.5
    apart = vertices + np.array([0, 0, gap])
    both = np.concatenate([vertices, apart]) - np.array([0.5, 0, 0])
    faces = np.where(upper[:, None], faces + len(vertices), faces)
    used, faces = np.unique(faces, return_inverse=True)
    joints = [[0, 0.5, 0.5], [-0.3, 0.5, 0.5], [0.3, 0.5, 0.5]]
    skeleton = Skeleton(joints, [-1, 0, 0], ["hips", "arm.L", "arm.R"])
    return Rig(TriangleMesh(both[used], faces.reshape(-1, 3)), skeleton)


@pytest.mark.parametrize("gap", [0.0, 0.5, 0.99, 1.01, 1.3, 1.7, 3.0])
@pytest.mark.parametrize("size", [0.01, 1.0, 170.0])
def test_two_vertices_are_one_everywhere_or_nowhere(gap, size):
    rig = figure(gap * WELD_TOLERANCE)
    mesh = TriangleMesh(rig.mesh.vertices * size, rig.mesh.faces)
    rig = Rig(mesh, Skeleton(rig.skeleton.joints * size, [-1, 0, 0], rig.skeleton.names))
    is_one = gap < 1
    x, _, z = mesh.vertices.T / size
    beside = np.flatnonzero(np.isclose(z, 0.5, atol=1e-4) & (abs(x) > 0.1))
    assert len(beside) == 28

    graph = build_graph(mesh, 8)
    places = {
        "mesh": len(mesh.welded.points),
        "graph": graph.first_point,
        "diagnosis": int(Subject(rig, 8).welded.max()) + 1,
        "selections": int(Neighbours.of(mesh).welded.max()) + 1,
        "baselines": len(Body.of(rig).points),
        "networks": len(sample_rig(rig).vertices),
    }
    assert set(places.values()) == {98 if is_one else 114}
    # Copies have one mirror image, and share what counts for their place.
    assert len(np.unique(find_mirror(rig).vertex[beside])) == (14 if is_one else 28)
    shares = vertex_shares(mesh)
    assert shares[beside] == pytest.approx(shares.max() / 2 if is_one else shares.max())
    # What is one place is one component.
    components = 1 if is_one else 2
    assert mesh.welded.component.max() + 1 == components
    assert graph.mesh.component.max() + 1 == components


def test_graphs_of_a_sound_mesh_share_its_welded_mesh():
    mesh = TriangleMesh(*meshes.ball(2))
    assert build_graph(mesh, 8).mesh is build_graph(mesh, 12).mesh is mesh.welded


@pytest.mark.parametrize("name", meshes.ALL)
def test_properties_are_those_of_trimesh(name):
    vertices, faces = meshes.ALL[name]()
    mesh = TriangleMesh(vertices, faces).welded
    whole = trimesh.Trimesh(mesh.points, mesh.faces[mesh.is_whole], process=False)
    np.testing.assert_allclose(mesh.face_areas[mesh.is_whole], whole.area_faces, atol=1e-12)
    assert mesh.areas.sum() == pytest.approx(whole.area)
    edges, uses = np.unique(whole.edges_sorted, axis=0, return_counts=True)
    is_used = mesh.edges.uses > 0
    np.testing.assert_array_equal(mesh.edges.edges[is_used], edges)
    np.testing.assert_array_equal(mesh.edges.uses[is_used], uses)
    np.testing.assert_allclose(
        mesh.edge_lengths[is_used], np.linalg.norm(np.subtract(*mesh.points[edges.T]), axis=1)
    )
    length = np.linalg.norm(mesh.normals, axis=1)
    assert (np.isclose(length, 1) | (length == 0)).all()
    np.testing.assert_allclose(
        mesh.points[mesh.index],
        TriangleMesh(vertices, faces).cube.to_unit(vertices),
        atol=2 * WELD_TOLERANCE,
    )
    np.testing.assert_array_equal(mesh.index[mesh.first], np.arange(len(mesh.points)))


@pytest.mark.parametrize("name", meshes.ALL)
def test_components_are_numbered_by_their_vertices_from_the_largest(name):
    mesh = TriangleMesh(*meshes.ALL[name]()).welded
    sizes = np.bincount(mesh.component[mesh.index])
    assert (np.diff(sizes) <= 0).all()
    assert (mesh.component[mesh.edges.edges[:, 0]] == mesh.component[mesh.edges.edges[:, 1]]).all()
    assert (sizes > 0).all()
    boxes = [mesh.points[mesh.component == c] for c in range(len(sizes))]
    sides = [np.ptp(points, axis=0).max() for points in boxes]
    np.testing.assert_allclose(mesh.longest_sides, sides)
