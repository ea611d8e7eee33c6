"""A second measure of pairs, which sees topology, clothes and pose where Chamfer does not."""

from __future__ import annotations

import hashlib
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...rig.rig import Rig

SAME_BONES = 0.02
"""Bone lengths that differ by less than this share of their sum are those of one skeleton."""
REACH = 0.04
"""In longest sides: a surface that reaches this far beyond the other has something more on."""
TURNED = 5.0
"""Degrees that bones differ by on average, for another pose."""
FACES = 0.9
"""Two meshes are the same triangles if the smaller has this share of the larger's faces."""
TWIN, VARIANT = 5e-4, 2e-3
FEW_BONES = 3
"""With fewer, equal lengths say nothing."""


@dataclass(frozen=True, eq=False)
class Traits:
    """What the second measure looks at.

    Parameters
    ----------
    vertices, faces : int
    tree : str
        A hash of the joints' parents.
    bones : array, shape (j, 3), float32
        From each joint's parent, over the sum of all lengths; zero for roots.
    """

    vertices: int
    faces: int
    tree: str
    bones: NDArray[np.float32]


def traits_of(rig: Rig) -> Traits:
    """Return the traits of a rig."""
    skeleton = rig.skeleton
    above = np.where(skeleton.parents < 0, np.arange(len(skeleton.parents)), skeleton.parents)
    bones = skeleton.joints - skeleton.joints[above]
    total = max(float(np.linalg.norm(bones, axis=1).sum()), 1e-30)
    tree = hashlib.blake2b(skeleton.parents.tobytes(), digest_size=8).hexdigest()
    counts = len(rig.mesh.vertices), len(rig.mesh.faces)
    return Traits(*counts, tree, (bones / total).astype(np.float32))


@dataclass(frozen=True)
class Likeness:
    """How two characters are alike, beyond their Chamfer distance.

    Parameters
    ----------
    kind : {"copy", "remeshed", "mirrored", "clothes", "pose", "similar"}
        What the figures come to.
    same_tree : bool
        Whether their joints hang together alike.
    bones : float or None
        By how much bone lengths differ, as a share of their sum; None for different trees.
    degrees : float or None
        By how much bones point elsewhere, on average by length.
    mirrored : float or None
        The same, after one of them is mirrored along the axis that suits best.
    faces : float
        Faces of the smaller mesh over those of the larger.
    reach : float
        How far one surface goes beyond the other, but for the farthest hundredth and the spacing
        of the points; in longest sides. NaN where surfaces were not compared.
    """

    kind: str
    same_tree: bool
    bones: float | None
    degrees: float | None
    mirrored: float | None
    faces: float
    reach: float


def likeness(a: Traits, b: Traits, surface: float, reach: float) -> Likeness:
    """Measure a pair."""
    faces = min(a.faces, b.faces) / max(a.faces, b.faces)
    same = a.tree == b.tree
    bones = degrees = mirrored = None
    if same:
        bones, degrees = _of_bones(a.bones, b.bones)
        mirrored = min(_of_bones(a.bones * mirror, b.bones)[1] for mirror in MIRRORS)
    found = (same, bones, degrees, mirrored, faces, reach)
    return Likeness(_kind(surface, *found), *found)


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


def same_skeletons(traits: Sequence[Traits], other: Sequence[Traits] | None) -> NDArray[np.int64]:
    """Find the pairs of equal trees whose bone lengths agree, whatever their pose; shape (c, 2)."""
    from sklearn.neighbors import NearestNeighbors

    groups = _by_tree(traits)
    others = groups if other is None else _by_tree(other)
    found = []
    for tree, rows in groups.items():
        columns = others.get(tree)
        if columns is None or len(traits[rows[0]].bones) <= FEW_BONES:
            continue
        lengths = np.stack([np.linalg.norm(traits[k].bones, axis=1) for k in rows])
        source = traits if other is None else other
        theirs = np.stack([np.linalg.norm(source[k].bones, axis=1) for k in columns])
        search = NearestNeighbors(radius=SAME_BONES, metric="manhattan").fit(theirs)
        near = search.radius_neighbors(lengths, return_distance=False)
        for row, hits in zip(rows, near, strict=True):
            found += [(row, columns[k]) for k in hits if other is not None or columns[k] > row]
    return np.array(sorted(found), np.int64).reshape(-1, 2)


def _by_tree(traits: Sequence[Traits]) -> dict[str, list[int]]:
    groups: dict[str, list[int]] = defaultdict(list)
    for index, one in enumerate(traits):
        groups[one.tree].append(index)
    return groups
