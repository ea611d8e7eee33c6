"""Meshes for fuzzing: a few parts, and random faults."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.random import Generator

from tests import meshes

Mesh = tuple[np.ndarray, np.ndarray]


def sheet(rng: Generator) -> Mesh:
    """Give a grid of squares in a plane, some rows of it perhaps without width."""
    rows, columns = rng.integers(1, 9, 2)
    x = np.cumsum(rng.random(columns + 1) * rng.integers(0, 2, columns + 1)) + 0.1
    points = [(a, b, 0.0) for b in range(rows + 1) for a in x]
    here = [r * (columns + 1) + c for r in range(rows) for c in range(columns)]
    faces = [
        f
        for k in here
        for f in ((k, k + 1, k + columns + 1), (k + 1, k + columns + 2, k + columns + 1))
    ]
    return np.array(points), np.array(faces)


def loose(rng: Generator) -> Mesh:
    """Give triangles that have nothing in common."""
    count = int(rng.integers(1, 150))
    middles = rng.random((count, 1, 3))
    points = middles + rng.normal(0, 10.0 ** rng.uniform(-3, 0), (count, 3, 3))
    return points.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def tangled(rng: Generator) -> Mesh:
    """Give triangles between points by chance."""
    points = rng.random((int(rng.integers(3, 30)), 3))
    return points, rng.integers(0, len(points), (int(rng.integers(1, 80)), 3))


def coarse(rng: Generator) -> Mesh:
    """Give points of a coarse lattice, so that rays meet edges and corners."""
    side = int(rng.integers(1, 5))
    points = rng.integers(0, side + 1, (int(rng.integers(4, 20)), 3)) / side
    return points, rng.integers(0, len(points), (int(rng.integers(1, 40)), 3))


def needle(rng: Generator) -> Mesh:
    """Give triangles on a line, or nearly."""
    t = rng.random((int(rng.integers(3, 12)), 1))
    points = t * rng.normal(size=3) + rng.choice([0, 1e-12, 1e-7]) * rng.normal(size=(len(t), 3))
    return points, np.stack([np.arange(len(t) - 2) + k for k in range(3)], axis=1)


PARTS: tuple[Callable[[Generator], Mesh], ...] = (
    lambda rng: meshes.box(),
    lambda rng: meshes.ball(int(rng.integers(0, 3))),
    lambda rng: meshes.torus(),
    lambda rng: meshes.tube(),
    lambda rng: meshes.ball_with_holes(int(rng.integers(100))),
    lambda rng: meshes.non_manifold(),
    lambda rng: meshes.degenerate(),
    sheet,
    loose,
    tangled,
    coarse,
    needle,
)


def put_somewhere(rng: Generator, mesh: Mesh) -> Mesh:
    """Turn, stretch, mirror and move a part."""
    points, faces = mesh
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    size = 10.0 ** rng.choice([0, 0, 0, -1, -3, 1, 2])
    stretch = size * rng.choice([1, 1, 1, 1, 0.01, 0], 3) if rng.random() < 0.3 else size
    move = rng.normal(size=3) * rng.choice([0, 0.3, 1, 3])
    return (points * stretch) @ turn.T + move, faces


def drop_faces(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    kept = faces[rng.random(len(faces)) < rng.uniform(0.3, 1)]
    return points, kept if len(kept) else faces[:1]


def turn_faces(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    turned = rng.random(len(faces)) < rng.random()
    return points, np.where(turned[:, None], faces[:, ::-1], faces)


def split_vertices(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    return points[faces.ravel()], np.arange(faces.size).reshape(-1, 3)


def jitter(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    size = np.ptp(points, axis=0).max()
    return points + rng.normal(0, size * 10.0 ** rng.uniform(-9, -1), points.shape), faces


def repeat_faces(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    some = faces[rng.integers(0, len(faces), int(rng.integers(1, 4)))]
    if rng.random() < 0.3:
        some = some[:, ::-1]
    return points, np.concatenate([faces, np.tile(some, (int(rng.integers(1, 2000)), 1))])


def add_degenerate(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    a, b = rng.integers(0, len(points), (2, int(rng.integers(1, 20))))
    return points, np.concatenate([faces, np.stack([a, b, rng.choice([a, b])], axis=1)])


def only_degenerate(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    return points, np.stack([faces[:, 0], faces[:, 1], faces[:, 1]], axis=1)


def stray(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    """Add a triangle with a corner far away."""
    size = min(np.ptp(points, axis=0).max(), 1e200) or 1.0
    far = points[0] + rng.normal(size=3) * size * 10.0 ** rng.integers(1, 12)
    others = rng.integers(0, len(points), 2)
    return np.concatenate([points, [far]]), np.concatenate([faces, [[*others, len(points)]]])


def far_and_flat(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    """Add two triangles on a line, far away."""
    far = points[0] + 10.0 ** rng.integers(0, 7) * np.outer([1, 2, 3, 4], rng.normal(size=3))
    new = np.array([[0, 1, 2], [1, 2, 3]]) + len(points)
    return np.concatenate([points, far]), np.concatenate([faces, new])


def unused_vertex(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    far = rng.normal(size=3) * rng.choice([1, 1e5, 1e20, 1e200, 1e308])
    return np.concatenate([points, [far]]), faces


def flatten(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    return points * rng.permutation([[1, 1, 0], [1, 0, 0], [1, 1, 1e-9]])[0], faces


def rescale(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    powers = [-323, -310, -300, -160, -100, -30, -5, 5, 30, 100, 153, 160, 300, 307]
    with np.errstate(all="ignore"):
        return points * 10.0 ** float(rng.choice(powers)), faces


def far_from_origin(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    return points + rng.normal(size=3) * 10.0 ** rng.integers(2, 17), faces


def few_values(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    return np.round(points, int(rng.integers(0, 4))), faces


def wrong_number(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    points = points.astype(float)
    points[rng.integers(len(points)), rng.integers(3)] = rng.choice([np.nan, np.inf, -np.inf])
    return points, faces


def wrong_index(rng: Generator, points: np.ndarray, faces: np.ndarray) -> Mesh:
    faces = faces.astype(np.int64)
    wrong = [-1, len(points), 2**31, 2**40, -(2**63)]
    faces[rng.integers(len(faces)), rng.integers(3)] = rng.choice(wrong)
    return points, faces


COMMON = (
    drop_faces,
    turn_faces,
    split_vertices,
    jitter,
    repeat_faces,
    add_degenerate,
    stray,
    far_and_flat,
    unused_vertex,
    flatten,
    far_from_origin,
    few_values,
)
RARE = (only_degenerate, rescale, wrong_number, wrong_index)

KINDS: tuple[Callable[[np.ndarray, np.ndarray], Any], ...] = (
    lambda points, faces: (points.astype(np.float32), faces),
    lambda points, faces: (np.asfortranarray(points), faces.astype(np.uint32)),
    lambda points, faces: (points[::-1][::-1], faces.astype(float)),
    lambda points, faces: (points.tolist(), faces.tolist()),
    lambda points, faces: (points.astype(object), faces),
    lambda points, faces: (points.astype(complex), faces),
    lambda points, faces: (points + 1j, faces),
    lambda points, faces: (points, faces + 0.5),
    lambda points, faces: (points.astype(str), faces),
    lambda points, faces: (points.ravel(), faces),
    lambda points, faces: (points[:, :2], faces),
    lambda points, faces: (points, faces[:, :2]),
    lambda points, faces: (points, faces[:0]),
    lambda points, faces: (points[:0], faces),
    lambda points, faces: (None, faces),
    lambda points, faces: (points, "faces"),
)
"""In which other ways the same may be given, most of them wrong."""


def mesh_of(rng: Generator) -> Mesh:
    """Make a mesh of one to four parts, with faults."""
    parts = [
        put_somewhere(rng, PARTS[k](rng)) for k in rng.integers(0, len(PARTS), rng.integers(1, 5))
    ]
    points = np.concatenate([part[0] for part in parts])
    starts = np.cumsum([0, *(len(part[0]) for part in parts)])
    faces = np.concatenate(
        [part[1] + start for part, start in zip(parts, starts[:-1], strict=True)]
    )
    for fault in rng.choice(np.array(COMMON, object), rng.integers(0, 4), replace=False):
        points, faces = fault(rng, points, faces)
    if rng.random() < 0.15:
        points, faces = rng.choice(np.array(RARE, object))(rng, points, faces)
    return points, faces
