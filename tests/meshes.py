"""Meshes for tests: clean, open, degenerate and random ones, all in the unit cube."""

import numpy as np
import trimesh

from cutcell.geometry.welded import WeldedMesh


def boundary(faces):
    vertices = np.zeros((int(faces.max()) + 1, 3))
    return WeldedMesh.of(vertices, np.asarray(faces, np.int32)).boundary


def box(low=0.25, high=0.75):
    mesh = trimesh.creation.box(extents=(1, 1, 1))
    return (np.array(mesh.vertices) + 0.5) * (high - low) + low, np.array(mesh.faces, np.int32)


def ball(subdivisions=2, radius=0.45):
    mesh = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)
    return np.array(mesh.vertices) + 0.5, np.array(mesh.faces, np.int32)


def torus():
    mesh = trimesh.creation.torus(0.33, 0.13, major_sections=12, minor_sections=6)
    return np.array(mesh.vertices) + 0.5, np.array(mesh.faces, np.int32)


def two_boxes_that_touch():
    (v, f), (w, g) = box(), box()
    v[:, 0] = v[:, 0] / 2 + 0.125
    w[:, 0] = w[:, 0] / 2 + 0.375
    return np.concatenate([v, w]), np.concatenate([f, g + len(v)])


def ball_with_holes(seed=0):
    v, f = ball(2)
    rng = np.random.default_rng(seed)
    return v, f[rng.random(len(f)) < 0.85]


def tube():
    """Open at both ends, along x: some rays run through without any crossing."""
    mesh = trimesh.creation.cylinder(radius=0.3, height=0.9, sections=16)
    v, f = np.array(mesh.vertices)[:, [2, 0, 1]] + 0.5, np.array(mesh.faces, np.int32)
    lids = np.ptp(v[f][:, :, 0], axis=1) < 1e-9
    return v, f[~lids]


def flipped_ball():
    v, f = ball(1)
    return v, np.concatenate([f[:40], f[40:, ::-1]])


def open_box():
    v, f = box()
    return v, f[2:]


def non_manifold():
    """Three fins on one edge, and a box that shares a vertex with them."""
    v, f = box()
    more = [[0.25, 0.25, 0.0], [0.0, 0.25, 0.25], [0.25, 0.0, 0.25]]
    fins = [[0, 1, len(v)], [0, 1, len(v) + 1], [1, 0, len(v) + 2]]
    return np.concatenate([v, more]), np.concatenate([f, np.array(fins, np.int32)])


def degenerate():
    """Spoil a box with needles, points and doubled faces among its triangles."""
    v, f = box()
    bad = [[0, 0, 1], [2, 2, 2], [0, 1, 0], [0, 7, 7], list(f[0]), list(f[0][::-1])]
    return v, np.concatenate([f, np.array(bad, np.int32)])


def grid_soup(seed=0, resolution=8):
    """Random triangles whose corners lie on the lattice: rays meet edges and vertices."""
    rng = np.random.default_rng(seed)
    v = (rng.integers(0, resolution, (14, 3)) + 0.5) / resolution
    return v, rng.integers(0, len(v), (20, 3)).astype(np.int32)


def random_soup(seed=0):
    rng = np.random.default_rng(seed)
    return rng.uniform(0.05, 0.95, (20, 3)), rng.integers(0, 20, (24, 3)).astype(np.int32)


CLOSED = {"box": box, "ball": ball, "torus": torus, "touching": two_boxes_that_touch}
OPEN = {
    "holes": ball_with_holes,
    "tube": tube,
    "flipped": flipped_ball,
    "open box": open_box,
    "non-manifold": non_manifold,
    "degenerate": degenerate,
    "grid soup": grid_soup,
    "random soup": random_soup,
}
ALL = CLOSED | OPEN
