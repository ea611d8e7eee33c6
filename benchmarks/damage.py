"""Known damage to the weights of real characters: what `benchmarks.mending` mends on the page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

import cutcell
from cutcell import Rig
from cutcell.editing.symmetry import find_mirror
from cutcell.io.gltf.read.primitives import primitives
from cutcell.io.gltf.read.read import GltfSource
from cutcell_lab.benchmarks.rigs import SHARED
from tests.bars import legs

LEAK = 0.3
"""Part of a joint's weight that leaks to another one."""
NOISE = 1.0
"""Standard deviation of the logarithm of factors that make weights noisy."""
SEED = 49

Weights = NDArray[np.float64]


@dataclass(frozen=True)
class Damage:
    """One kind of damage, on a character that has what it needs.

    Parameters
    ----------
    path : str
        Of the character, below the folder of shared data.
    make : callable
        Takes the rig, and returns damaged weights (n, j).
    accessories : bool
        Whether meshes on a joint become part of the skin first.
    build : callable, optional
        Makes the character, where there is no file of it.
    """

    path: str
    make: Callable[[Rig], Weights]
    accessories: bool = False
    build: Callable[[], Rig] | None = None

    @property
    def file(self) -> Path:
        """The character."""
        return SHARED / self.path

    def load(self) -> Rig:
        """Load the character, undamaged."""
        if self.build is not None:
            return saved_and_loaded(self.build())
        if self.file.suffix == ".npz":
            return saved_and_loaded(cutcell.load(self.file))
        return cutcell.load(self.file, accessories=self.accessories)


def saved_and_loaded(rig: Rig) -> Rig:
    """Return a rig as its GLB has it."""
    with TemporaryDirectory() as folder:
        path = Path(folder, "built.glb")
        cutcell.save(path, rig)
        return cutcell.load(path)


def damaged_vertices(before: Weights, after: Weights) -> NDArray[np.intp]:
    """Return the vertices whose weights differ; shapes (n, j) and (k,)."""
    return np.flatnonzero((before != after).any(axis=1))


def write_damaged(damage: Damage, rig: Rig, path: Path) -> NDArray[np.intp]:
    """Write a GLB with damaged weights, and return the damaged vertices; others are the same."""
    assert rig.weights is not None
    weights = damage.make(rig)
    cutcell.save(path, rig.with_weights(weights))
    return damaged_vertices(rig.weights, weights)


def leaked(rig: Rig, of: str, to: str, part: float = LEAK) -> Weights:
    """Give a part of one joint's weight to another joint, wherever it has any."""
    weights, (source, target) = _copy(rig), _joints(rig, of, to)
    leak = part * weights[:, source]
    weights[:, source] -= leak
    weights[:, target] += leak
    return weights


def rigid(rig: Rig, vertices: NDArray[np.intp], to: str) -> Weights:
    """Let some vertices follow one joint alone."""
    weights, (joint,) = _copy(rig), _joints(rig, to)
    weights[vertices] = 0
    weights[vertices, joint] = 1
    return weights


def noisy(rig: Rig, joint: str, deviation: float = NOISE, seed: int = SEED) -> Weights:
    """Multiply the weights of all vertices that a joint moves by random factors, log-normal."""
    weights, (index,) = _copy(rig), _joints(rig, joint)
    moved = np.flatnonzero((weights[:, index] > 0) & ((weights > 0).sum(axis=1) > 1))
    factors = np.random.default_rng(seed).normal(0, deviation, [len(moved), weights.shape[1]])
    rows = weights[moved] * np.exp(factors)
    weights[moved] = rows / rows.sum(axis=1, keepdims=True)
    return weights


def mirrored_names(rig: Rig) -> Weights:
    """Exchange the weights of left and right joints, as names of mirrored sides do."""
    return _copy(rig)[:, find_mirror(rig).swap]


def shifted(rig: Rig, of: Sequence[str], to: Sequence[str]) -> Weights:
    """Give the weights of a chain of joints to another chain, joint by joint."""
    weights = _copy(rig)
    for source, target in zip(_joints(rig, *of), _joints(rig, *to), strict=True):
        weights[:, target] += weights[:, source]
        weights[:, source] = 0
    return weights


def exchanged(rig: Rig, of: Sequence[str], to: Sequence[str]) -> Weights:
    """Exchange the weights of two chains of joints, joint by joint."""
    weights, (one, other) = _copy(rig), (_joints(rig, *names) for names in (of, to))
    weights[:, [*one, *other]] = weights[:, [*other, *one]]
    return weights


def onto_the_other_side(rig: Rig, side: str, other: str) -> Weights:
    """Give the weights of all joints of a side, by the end of their names, to their partners."""
    of = [name for name in rig.skeleton.names if name.endswith(side) and name.startswith("DEF")]
    return shifted(rig, of, [name.removesuffix(side) + other for name in of])


def component_vertices(rig: Rig, number: int) -> NDArray[np.intp]:
    """Return the vertices of a connected component, numbered from 1, the largest; shape (k,)."""
    welded = rig.mesh.welded
    return np.flatnonzero(welded.component[welded.index] == number - 1)


def part_vertices(rig: Rig, part: str, side: int = 0) -> NDArray[np.intp]:
    """Return the vertices of a mesh of the file, of all or with x of one sign; shape (k,)."""
    rows = next(one.vertices for one in rig.parts if one.name == part)
    vertices = np.arange(rows.start, rows.stop)
    return vertices[rig.mesh.vertices[vertices, 0] * side >= 0]


def stored_rows(rig: Rig, sets: int = 2) -> list[NDArray[np.void]]:
    """Return the bytes of joints and weights of each vertex, as a GLB stores them, by part."""
    source = rig.source
    assert isinstance(source, GltfSource)
    document = source.document
    rows = []
    for part in source.parts:
        mesh, k = part.primitives[0]
        primitive = primitives(document, mesh)[k]
        both = []
        for name in ("JOINTS", "WEIGHTS"):
            values = [
                primitive.accessor(f"{name}_{n}", "VEC4").stored for n in primitive.influence_sets
            ]
            empty = np.zeros_like(values[0])  # a set that another file has more
            both.append(np.hstack([*values, *[empty] * (sets - len(values))]))
        packed = np.hstack([np.ascontiguousarray(one).view(np.uint8) for one in both])
        rows.append(np.ascontiguousarray(packed).view(f"V{packed.shape[1]}").ravel())
    return rows


def changed_bytes(before: Rig, after: Rig) -> NDArray[np.bool_]:
    """Return the vertices whose joints or weights are stored in other bytes, shape (n,)."""
    changed = [
        one != other if one.dtype == other.dtype else np.ones(len(one), np.bool_)
        for one, other in zip(stored_rows(before), stored_rows(after), strict=True)
    ]
    return np.concatenate(changed)


def _copy(rig: Rig) -> Weights:
    if rig.weights is None:
        raise ValueError(f"{rig.name} has no weights")
    return rig.weights.copy()


def _joints(rig: Rig, *names: str) -> list[int]:
    return [rig.skeleton.names.index(name) for name in names]


def finger(name: str) -> list[str]:
    """Return the joints of a finger of the hand."""
    ends = ("metacarpal", "phalanx-proximal", "phalanx-intermediate", "phalanx-distal", "tip")
    return [f"{name}-finger-{end}" for end in ends]


FINGER = tuple(f"index_0{k}.l" for k in (1, 2, 3))
DAMAGES = {
    "leak": Damage("rigs/quaternius_man_king.glb", lambda rig: leaked(rig, "UpperLeg.L", "Hand.L")),
    "lost island": Damage(
        "wild/babylon_rigged25skins.glb",
        lambda rig: rigid(rig, part_vertices(rig, "free3dmodelFBXASC046011", 1), "hips"),
    ),
    "noise": Damage("rigs/quaternius_wolf.glb", lambda rig: noisy(rig, "FrontLowerLeg.L")),
    "wrong eye": Damage(
        "rigs/makehuman_clothed_mixamo.glb",
        lambda rig: rigid(rig, part_vertices(rig, "eyes", 1), "mixamorig:LeftArm"),
    ),
    "cape": Damage(
        "rigs/kaykit_knight.glb",
        lambda rig: rigid(rig, part_vertices(rig, "Knight_Cape"), "upperleg.l"),
        accessories=True,
    ),
    "blade": Damage(
        "wild/kaykit_rogue.glb",
        lambda rig: rigid(rig, part_vertices(rig, "Knife"), "upperleg.r"),
        accessories=True,
    ),
    "mirrored names": Damage("wild/m2m_eagle.glb", mirrored_names),
    "finger": Damage(
        "wild/godot_mannequiny.glb",
        lambda rig: shifted(rig, FINGER, [name.replace("index", "middle") for name in FINGER]),
    ),
    "coat": Damage(
        "more/sumerian_maya.npz",
        lambda rig: rigid(rig, component_vertices(rig, 1), "char:def_l_thigh"),
    ),
    "trident": Damage(
        "more/pumpkin_knight.npz",
        lambda rig: rigid(rig, component_vertices(rig, 5), "Bip001 R Thigh_050"),
    ),
    "fingers": Damage(
        "rigs/webxr_hand_right.glb", lambda rig: exchanged(rig, *map(finger, ("index", "middle")))
    ),
    "other side": Damage("more/dcl_elf.npz", lambda rig: onto_the_other_side(rig, "_R", "_L")),
    "twist": Damage(
        "made-up legs of Auto-Rig Pro", lambda rig: noisy(rig, "thigh_twist.l"), build=legs
    ),
}
"""Damage by its name."""
