"""Broken twins of the walker: what people's files are like."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .body import Body
from .character import Bones, Character, Material, Surface
from .make_biped import shape_around
from .meshing import normals_of
from .weights import quantised

HOLES = (
    # centre and radius of what is torn out
    ([0.06, 1.02, -0.1], 0.035),
    ([-0.05, 0.93, 0.1], 0.028),
    ([0.14, 0.62, 0.0], 0.03),
    ([-0.1, 0.3, -0.06], 0.026),
    ([0.1, 1.49, -0.06], 0.034),
    ([-0.2, 0.87, 0.02], 0.02),
)
COARSE = 1.5
"""The torn twin's triangles are larger by this: it has three vertices for each."""

LOST = 0.02
"""Share of the other triangles that are missing, here and there."""


def torn(walker: Character) -> Character:
    """Return it with a vertex of its own for every corner, and holes."""
    rng = np.random.default_rng(7)
    surfaces = []
    for surface in walker.surfaces:
        middle = surface.vertices[surface.faces].mean(axis=1)
        is_left = rng.random(len(middle)) >= LOST
        for centre, radius in HOLES:
            is_left &= ((middle - centre) ** 2).sum(axis=1) > radius**2
        corners = surface.faces[is_left].ravel()
        surfaces.append(
            replace(
                surface,
                vertices=surface.vertices[corners],
                faces=np.arange(len(corners)).reshape(-1, 3),
                normals=None,
                weights=surface.weights[corners],
            )
        )
    return replace(walker, name="Walker, torn", surfaces=surfaces)


def flipped_arm(walker: Character) -> Character:
    """Return it with the triangles of the right arm, from the upper arm on, inside out."""
    arm = np.array(sorted(walker.bones.below("upper_arm.R")))
    surfaces = []
    for surface in walker.surfaces:
        share = surface.weights[:, arm].sum(axis=1)[surface.faces].mean(axis=1)
        faces = np.where((share > 0.5)[:, None], surface.faces[:, ::-1], surface.faces)
        surfaces.append(replace(surface, faces=faces))
    return replace(walker, name="Walker, arm inside out", surfaces=surfaces)


def caped(walker: Character) -> Character:
    """Return it with a cape: one sheet of triangles, open on all sides."""
    return replace(
        walker, name="Walker in a cape", surfaces=[*walker.surfaces, _cape(walker.bones)]
    )


def _cape(bones: Bones, across: int = 26, down: int = 34) -> Surface:
    """Return a sheet around the shoulders that falls, in folds, to the knees."""
    u, v = np.meshgrid(np.linspace(-1, 1, across + 1), np.linspace(0, 1, down + 1), indexing="ij")
    angle = u * np.radians(78 - 22 * v)  # from straight behind
    fold = np.cos(u * 4.5 * np.pi) * 0.028 * np.clip(v * 1.3 - 0.12, 0, 1)
    wide = 0.095 + 0.115 * _ease(v / 0.2) + 0.05 * v
    deep = 0.088 + 0.042 * _ease(v / 0.25) + 0.12 * v * v
    x = (wide + fold) * np.sin(angle)
    z = -(deep + fold) * np.cos(angle) - 0.01
    y = 1.172 - 0.70 * v - 0.035 * _ease(v / 0.2) * np.abs(np.sin(angle)) ** 2
    vertices = _clear_of(shape_around(bones), np.stack([x, y, z], axis=-1).reshape(-1, 3))
    row = np.arange(len(vertices)).reshape(across + 1, down + 1)
    a, b = row[:-1, :-1].ravel(), row[1:, :-1].ravel()
    c, d = row[1:, 1:].ravel(), row[:-1, 1:].ravel()
    faces = np.concatenate([np.column_stack([a, c, b]), np.column_stack([a, d, c])])
    material = Material("cape", "#c8434f", roughness=0.85, both_sides=True)
    weights = _cape_weights(bones, u.ravel(), v.ravel())
    return Surface(vertices, faces, _normals(vertices, faces), weights, material)


def _clear_of(body: Body, points: NDArray, air: float = 0.016) -> NDArray:
    """Return the points pushed out of the body, and a bit further."""
    for _ in range(6):
        points = (
            points + normals_of(body, points) * np.maximum(air - body.distance(points), 0)[:, None]
        )
    return np.round(points, 6)


def _cape_weights(bones: Bones, u: NDArray, v: NDArray) -> NDArray:
    """Hang it on the chest, and less stiffly on spine and hips; its corners on the shoulders."""
    weights = np.zeros((len(u), len(bones.names)))
    stops = {"chest": 0.0, "spine2": 0.3, "spine1": 0.55, "hips": 0.85}
    reach = 0.3
    for name, stop in stops.items():
        share = np.clip(1 - np.abs(v - stop) / reach, 0, 1)
        if name == "hips":
            share = np.where(v > stop, 1, share)
        weights[:, bones.names.index(name)] = share
    corner = 0.7 * np.clip((np.abs(u) - 0.35) / 0.65, 0, 1) * np.clip(1 - v / 0.3, 0, 1)
    weights *= ((1 - corner) / weights.sum(axis=1))[:, None]
    for side, here in (("L", u > 0), ("R", u < 0)):
        weights[:, bones.names.index(f"clavicle.{side}")] = corner * here
    return quantised(weights)


def _normals(vertices: NDArray, faces: NDArray) -> NDArray:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    vectors = np.repeat(np.cross(b - a, c - a), 3, axis=0)
    total = [np.bincount(faces.ravel(), column, len(vertices)) for column in vectors.T]
    normals = np.stack(total, axis=1)
    return np.round(normals / np.sqrt((normals**2).sum(axis=1, keepdims=True)), 6)


def _ease(t: NDArray) -> NDArray:
    t = np.clip(t, 0, 1)
    return t * t * (3 - 2 * t)
