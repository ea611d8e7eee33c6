"""Second measure of pairs, sensitive to topology, clothes and pose, unlike Chamfer distance."""

from __future__ import annotations

import hashlib
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cutcell.rig import Rig

SAME_BONES = 0.02
"""Bone lengths that differ by less than this share of their sum are those of one skeleton."""
REACH = 0.04
"""In longest sides: a surface with this overhang has additional clothes."""
TURNED = 5.0
"""Degrees that bones differ by on average, for another pose."""
FACES = 0.9
"""Two meshes are the same triangles if the smaller has this share of the larger's faces."""
TWIN, VARIANT = 5e-4, 2e-3
FEW_BONES = 3
"""With fewer bones, equal lengths are no evidence."""


@dataclass(frozen=True, eq=False)
class Features:
    """Features of a character for the second measure."""

    vertices: int
    faces: int
    tree: str
    """Hash of the parent of each joint."""
    bones: NDArray[np.float32]
    """Vectors from each joint's parent, over the sum of all lengths; zero for roots; (j, 3)."""


def features_of(rig: Rig) -> Features:
    """Return the traits of a rig."""
    skeleton = rig.skeleton
    above = np.where(skeleton.parents < 0, np.arange(len(skeleton.parents)), skeleton.parents)
    bones = skeleton.joints - skeleton.joints[above]
    total = max(float(np.linalg.norm(bones, axis=1).sum()), 1e-30)
    tree = hashlib.blake2b(skeleton.parents.tobytes(), digest_size=8).hexdigest()
    counts = len(rig.mesh.vertices), len(rig.mesh.faces)
    return Features(*counts, tree, (bones / total).astype(np.float32))


@dataclass(frozen=True)
class Similarity:
    """Similarity of two characters beyond their Chamfer distance; its fields are columns."""

    kind: str
    """"copy", "remeshed", "mirrored", "clothes", "pose" or "similar"; follows from the rest."""
    same_tree: bool
    bones: float | None
    """Difference of bone lengths as a share of their sum; None for different trees."""
    degrees: float | None
    """Mean angle between bones, weighted by length."""
    mirrored: float | None
    """The same after one character is mirrored along the best axis."""
    faces: float
    """Faces of the smaller mesh over those of the larger."""
    reach: float
    """Overhang of one surface beyond the other; see `chamfer.reach_of`; NaN if not compared."""


def likeness(a: Features, b: Features, surface: float, reach: float) -> Similarity:
    """Measure a pair."""
    faces = min(a.faces, b.faces) / max(a.faces, b.faces)
    same = a.tree == b.tree
    bones = degrees = mirrored = None
    if same:
        bones, degrees = _of_bones(a.bones, b.bones)
        mirrored = min(_of_bones(a.bones * mirror, b.bones)[1] for mirror in MIRRORS)
    figures = (same, bones, degrees, mirrored, faces, reach)
    return Similarity(_kind(surface, *figures), *figures)


MIRRORS = (1 - 2 * np.eye(3)).astype(np.float32)


def _of_bones(a: NDArray, b: NDArray) -> tuple[float, float]:
    """Return by how much bones differ in length, as a share of all, and in direction, degrees."""
    long_a, long_b = np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1)
    weight = np.minimum(long_a, long_b)
    cosine = (a * b).sum(axis=1) / np.maximum(long_a * long_b, 1e-30)
    angle = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    total = max(float(weight.sum()), 1e-30)
    return float(np.abs(long_a - long_b).sum()), float((angle * weight).sum() / total)


def _kind(
    surface: float,
    same: bool,
    bones: float | None,
    degrees: float | None,
    mirrored: float | None,
    faces: float,
    reach: float,
) -> str:
    one_skeleton = same and bones is not None and bones < SAME_BONES
    if one_skeleton and degrees is not None and degrees > TURNED:
        return "mirrored" if mirrored is not None and mirrored < TURNED else "pose"
    if surface <= TWIN and reach < REACH:
        return "copy" if faces >= FACES else "remeshed"
    if one_skeleton and reach >= REACH:
        return "clothes"
    return "similar"


def same_skeletons(
    features: Sequence[Features], other: Sequence[Features] | None
) -> NDArray[np.int64]:
    """Find the pairs of equal trees and bone lengths in any pose; shape (c, 2)."""
    from sklearn.neighbors import NearestNeighbors

    groups = _by_tree(features)
    others = groups if other is None else _by_tree(other)
    pairs = []
    for tree, rows in groups.items():
        columns = others.get(tree)
        if columns is None or len(features[rows[0]].bones) <= FEW_BONES:
            continue
        lengths = np.stack([np.linalg.norm(features[k].bones, axis=1) for k in rows])
        source = features if other is None else other
        other_lengths = np.stack([np.linalg.norm(source[k].bones, axis=1) for k in columns])
        search = NearestNeighbors(radius=SAME_BONES, metric="manhattan").fit(other_lengths)
        near = search.radius_neighbors(lengths, return_distance=False)
        for row, hits in zip(rows, near, strict=True):
            pairs += [(row, columns[k]) for k in hits if other is not None or columns[k] > row]
    return np.array(sorted(pairs), np.int64).reshape(-1, 2)


def _by_tree(features: Sequence[Features]) -> dict[str, list[int]]:
    groups: dict[str, list[int]] = defaultdict(list)
    for index, one in enumerate(features):
        groups[one.tree].append(index)
    return groups
