"""Whether a surface has an inside that is not seen."""

import time

import numpy as np
import trimesh

from cutcell import TriangleMesh
from cutcell_viewers.character import is_closed, smooth_normals


def box(**how):
    mesh = trimesh.creation.box(**how)
    return np.array(mesh.vertices), np.array(mesh.faces)


def closed(points, faces):
    return is_closed(TriangleMesh(points, faces).welded)


def test_a_box_is_closed_seams_or_not():
    points, faces = box()
    assert closed(points, faces)
    assert closed(points[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3))


def test_a_box_with_a_hole_is_not():
    points, faces = box()
    assert not closed(points, faces[1:])


def test_a_box_inside_out_is_not_even_beside_a_larger_one():
    points, faces = box()
    large, other = box(extents=[5, 5, 5])
    assert not closed(points, faces[:, ::-1])
    both = np.concatenate([points, large + 9])
    assert closed(both, np.concatenate([faces, other + len(points)]))
    assert not closed(both, np.concatenate([faces[:, ::-1], other + len(points)]))


def test_nothing_is_not():
    assert not closed(np.eye(3), np.array([[0, 1, 1]]))


def test_a_heap_of_vertices_at_one_place_is_soon_done():
    heap = np.zeros((40_000, 3))
    points = np.concatenate([heap, np.eye(3)])
    faces = np.arange(len(points) // 3 * 3).reshape(-1, 3)
    began = time.process_time()
    normals = smooth_normals(points, faces, TriangleMesh(points, faces).welded.index)
    assert time.process_time() - began < 20, "it was quadratic, and took a minute"
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1)


def test_vertices_of_a_seam_share_their_normals():
    points, faces = box()
    split = points[faces].reshape(-1, 3)
    mesh = TriangleMesh(split, np.arange(len(split)).reshape(-1, 3))
    normals = smooth_normals(split, mesh.faces, mesh.welded.index)
    for point in points:
        here = np.flatnonzero((split == point).all(axis=1))
        assert len(np.unique(normals[here].round(6), axis=0)) == 3, "one for each side of the box"
