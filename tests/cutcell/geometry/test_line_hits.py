"""Lines through edges and vertices hit the same faces in all code that casts rays."""

import numpy as np
import pytest

from cutcell.animation.falloff.components import POINTS, bone_containment
from cutcell.bones.bones import Bones
from cutcell.geometry.line_hits import line_hits
from cutcell.geometry.welded import WeldedMesh
from cutcell.graph.rays import cast_rays, points_on_rays
from cutcell_lab.baselines.visibility import Blockers
from tests import meshes
from tests.bars import grid_box

R = 8
OUT = 0.4
"""Part of a cell that ends of segments lie outside of the cube."""


def on_lattice_lines():
    """Return a box all of whose vertices lie on lattice lines: they meet its edges and vertices."""
    vertices, faces = grid_box(4, 4, 4, (4, 4, 4))
    return (vertices + 1.5) / R, faces.astype(np.int32)


def cast(vertices, faces, axis):
    """Return pairs of ray and face."""
    hits = cast_rays(vertices, faces, R, axis)
    ray = np.repeat(np.arange(R * R), np.diff(hits.start))
    return set(zip(ray.tolist(), hits.triangle.tolist(), hits.sign.tolist(), strict=True))


@pytest.mark.parametrize("axis", range(3))
def test_lines_and_rays_of_the_graph_hit_the_same(axis):
    vertices, faces = on_lattice_lines()
    points = points_on_rays(np.arange(R * R), np.float64(0.5), R, axis)
    blocks = list(line_hits(vertices, faces, points, axis))
    assert len(blocks) >= 1
    line, face, sign = (
        np.concatenate([getattr(block, name) for block in blocks]).tolist()
        for name in ("line", "face", "sign")
    )
    result = set(zip(line, face, sign, strict=True))
    assert len(result) == len(line) > R
    assert result == cast(vertices, faces, axis)


@pytest.mark.parametrize("axis", range(3))
def test_segments_of_visibility_hit_the_same(axis):
    vertices, faces = on_lattice_lines()
    rays = np.arange(R * R)
    start, end = (points_on_rays(rays, np.float64(x), R, axis) for x in (-OUT / R, 1 + OUT / R))
    points, result = np.concatenate([start, vertices]), set()
    for f, face in enumerate(faces):
        blockers = Blockers(points, face[None] + len(start))
        result |= {(int(ray), f) for ray in np.flatnonzero(blockers.blocked(rays, end))}
    assert result == {(ray, face) for ray, face, _ in cast(vertices, faces, axis)}


@pytest.mark.parametrize("axis", range(3))
def test_containment_counts_lines_through_edges_as_the_graph_does(axis):
    vertices, faces = on_lattice_lines()
    start, end = (points_on_rays(np.arange(R * R), np.float64(x), R, axis) for x in (-0.5, 1.5))
    bones = Bones(start, end, np.arange(R * R, dtype=np.int32))
    contained = bone_containment(WeldedMesh.of(vertices, faces), bones)[0]
    inside = {ray for ray, _, _ in cast(vertices, faces, axis)}
    assert {int(bone) for bone in np.flatnonzero(contained)} == inside
    along = -0.5 + 2 * (np.arange(POINTS) + 0.5) / POINTS
    low, high = vertices[:, axis].min(), vertices[:, axis].max()
    part = ((low < along) & (along < high)).mean()
    np.testing.assert_allclose(contained[sorted(inside)], part)


@pytest.mark.parametrize("name", meshes.ALL)
@pytest.mark.parametrize("axis", range(3))
def test_hits_in_blocks_are_those_of_rays(name, axis):
    vertices, faces = meshes.ALL[name]()
    points = points_on_rays(np.arange(R * R), np.float64(0.5), R, axis)
    hits = list(line_hits(vertices, faces, np.tile(points, (3, 1)), axis))
    result = {
        (int(line), int(face), int(sign), round(float(ahead) + 0.5, 12))
        for block in hits
        for face, line, ahead, sign in zip(*block, strict=True)
    }
    rays = cast_rays(vertices, faces, R, axis)
    ray = np.repeat(np.arange(R * R), np.diff(rays.start))
    expected = {
        (int(line) + shift, int(face), int(sign), round(float(at), 12))
        for line, face, sign, at in zip(ray, rays.triangle, rays.sign, rays.position, strict=True)
        for shift in (0, R * R, 2 * R * R)
    }
    assert result == expected


def test_a_block_ends_where_the_next_face_might_not_fit():
    wall = np.array([[0, 0, 0.5], [3, 0, 0.5], [0, 3, 0.5]]) / 3
    faces = np.tile(np.array([[0, 1, 2]], np.int32), (100, 1))
    points = np.full((5, 3), 0.2)
    blocks = list(line_hits(wall, faces, points, 2))
    assert len(blocks) > 5
    face = np.concatenate([block.face for block in blocks])
    np.testing.assert_array_equal(face, np.repeat(np.arange(100), 5))
    assert all((block.sign == 1).all() for block in blocks)
