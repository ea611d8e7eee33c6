"""The data that flows through cutcell: a mesh, a skeleton, and both together as a rig.

All are frozen and checked when they are made, so that no later stage meets a bad array.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import MeshError, SkeletonError, WeightsError
from ..runtime.memory import check_matrix
from .arrays import as_array
from .checks import shown
from .clip import Clip

LONG_CYCLE = 10
"""Joints of a cycle that are named; of a longer one only the first and the last."""
FAR_OUTSIDE = 10.0
"""A joint this many bounding-box diagonals away from the mesh is in another unit."""


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """Triangles in space; closed or open, clean or a soup.

    Parameters
    ----------
    vertices : array_like, shape (n, 3), float64
        Rest positions in the file's units.
    faces : array_like, shape (m, 3), int32
        Vertex indices, counter-clockwise seen from outside.

    Raises
    ------
    MeshError
        No vertices or faces, a coordinate that is not finite, an index out of range, or
        a mesh without extent.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]

    if TYPE_CHECKING:  # what is given may be of other types than what is kept

        def __init__(self, vertices: ArrayLike, faces: ArrayLike) -> None: ...

    def __post_init__(self) -> None:
        vertices = as_array(self.vertices, np.float64, (None, 3), "vertices", MeshError)
        faces = as_array(self.faces, np.int64, (None, 3), "faces", MeshError)
        if len(faces) == 0:
            raise MeshError("the mesh has no faces; it needs at least one triangle")
        _check_finite(vertices, "vertex", MeshError)
        bad = np.flatnonzero(((faces < 0) | (faces >= len(vertices))).any(axis=1))
        if len(bad):
            raise MeshError(
                f"face {bad[0]} uses the vertices {faces[bad[0]].tolist()}, but the mesh has "
                f"only {len(vertices)} (numbered from 0); faces out of range: {len(bad)}"
            )
        used = vertices[np.unique(faces)]
        if (used == used[0]).all():
            raise MeshError("all faces of the mesh lie in one point; it has no extent")
        object.__setattr__(self, "vertices", _frozen(vertices))
        object.__setattr__(self, "faces", _frozen(faces.astype(np.int32)))

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """Lowest and highest corner of the faces' bounding box, shape (2, 3)."""
        used = self.vertices[np.unique(self.faces)]
        return np.stack([used.min(axis=0), used.max(axis=0)])


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Joints and their parents, in the space and units of the mesh.

    A mesh without a skeleton has one of no joints, `Skeleton([], [])`.

    Parameters
    ----------
    joints : array_like, shape (j, 3), float64
        Rest positions.
    parents : array_like, shape (j,), int32
        Index of each joint's parent, -1 for a root; several roots are allowed.
    names : sequence of str, optional
        One name a joint; "joint 0", "joint 1", ... when left out.
    deform : array_like, shape (j,), bool, optional
        Which joints may carry weight; all when left out.
    orientations : array_like, shape (j, 3, 3), float64, optional
        Rest orientations: column k is the joint's k-th local axis, a unit vector in the mesh's
        space. None where the file does not tell.

    Raises
    ------
    SkeletonError
        A position or an orientation that is not finite, a parent out of range, a cycle, a wrong
        number of names, or joints of which none may carry weight.
    """

    joints: NDArray[np.float64]
    parents: NDArray[np.int32]
    names: tuple[str, ...] = ()
    deform: NDArray[np.bool_] = None  # type: ignore[assignment]
    orientations: NDArray[np.float64] | None = None

    if TYPE_CHECKING:

        def __init__(
            self,
            joints: ArrayLike,
            parents: ArrayLike,
            names: Sequence[str] = (),
            deform: ArrayLike | None = None,
            orientations: ArrayLike | None = None,
        ) -> None: ...

    def __post_init__(self) -> None:
        joints = as_array(self.joints, np.float64, (None, 3), "joints", SkeletonError)
        count = len(joints)
        parents = as_array(self.parents, np.int64, (count,), "parents", SkeletonError)
        names = _joint_names(self.names, count)
        _check_finite(joints, "joint", SkeletonError, names)
        bad = np.flatnonzero((parents < -1) | (parents >= count))
        if len(bad):
            raise SkeletonError(
                f'joint "{names[bad[0]]}" has the parent {parents[bad[0]]}, but parents are '
                f"-1 (a root) to {count - 1}"
            )
        deform = np.ones(count, bool) if self.deform is None else self.deform
        deform = as_array(deform, np.bool_, (count,), "deform", SkeletonError)
        if count and not deform.any():
            raise SkeletonError("no joint of the skeleton may carry weight (deform is all False)")
        if count:
            _check_acyclic(parents, names)
        if self.orientations is not None:
            shape = (count, 3, 3)
            axes = as_array(self.orientations, np.float64, shape, "orientations", SkeletonError)
            if not np.isfinite(axes).all():
                raise SkeletonError("an orientation holds a number that is not finite")
            object.__setattr__(self, "orientations", _frozen(axes))
        object.__setattr__(self, "joints", _frozen(joints))
        object.__setattr__(self, "parents", _frozen(parents.astype(np.int32)))
        object.__setattr__(self, "names", names)
        object.__setattr__(self, "deform", _frozen(deform))

    def require_joints(self) -> None:
        """Refuse the skeleton of a mesh that came without one, and say how to give it one.

        Raises
        ------
        SkeletonError
            It has no joints.
        """
        if len(self.joints) == 0:
            raise SkeletonError(
                "the rig has no skeleton; export the mesh together with its armature, or save it "
                "as OBJ or PLY and put a skeleton beside it in a JSON file of the same name, for "
                'example {"joints": [{"name": "root", "position": [0, 0, 0], "parent": null}, '
                '{"name": "tip", "position": [0, 1, 0], "parent": "root"}]}'
            )

    @cached_property
    def children(self) -> tuple[NDArray[np.intp], ...]:
        """The child joints of each joint, ascending."""
        ordered = np.argsort(self.parents, kind="stable")
        starts = np.searchsorted(self.parents[ordered], np.arange(len(self.joints) + 1))
        return tuple(ordered[a:b] for a, b in pairwise(starts))

    @cached_property
    def depth(self) -> NDArray[np.int64]:
        """How many joints are above each joint, shape (j,)."""
        above = self.parents.copy()
        depth = (above >= 0).astype(np.int64)
        while (climbing := above >= 0).any():  # each time twice as far
            further = above[climbing]
            depth[climbing] += depth[further]
            above[climbing] = above[further]
        return _frozen(depth)

    @cached_property
    def subtree(self) -> NDArray[np.bool_]:
        """Whether joint k moves along when joint j turns: shape (j, k); true for k = j."""
        inside = np.eye(len(self.parents), dtype=bool)
        above = self.parents.copy()
        while (above >= 0).any():
            k = np.flatnonzero(above >= 0)
            inside[above[k], k] = True
            above[k] = self.parents[above[k]]
        return _frozen(inside)


@dataclass(frozen=True, eq=False)
class Attachment:
    """An unskinned mesh that hangs rigidly on one joint, such as a sword in a hand.

    Its vertices are in the rig's space at rest. It is shown and moved, never bound; `hidden`
    is whether the file says not to show it.
    """

    name: str
    mesh: TriangleMesh
    joint: int
    hidden: bool = False


@dataclass(frozen=True)
class Part:
    """One of the meshes that a file holds under names of their own: some vertices of the rig.

    Parameters
    ----------
    name : str
    vertices : slice
        Its vertices in the rig's mesh.
    hidden : bool
        Whether the file says not to show it. It is bound all the same.
    """

    name: str
    vertices: slice
    hidden: bool = False


@dataclass(frozen=True)
class LeftOut:
    """A mesh of the file that the rig does not hold, and why in a few words."""

    name: str
    why: str


@dataclass(frozen=True, eq=False)
class Rig:
    """A character: mesh, skeleton, and what its file says about weights and motion.

    Parameters
    ----------
    mesh : TriangleMesh
        All skinned meshes of the file, one after the other, vertices in the file's order.
    skeleton : Skeleton
    weights : array_like, shape (n, j), float64, optional
        Not negative; rows sum to one, or to zero where a vertex has no weight.
    clips : tuple of Clip
    attachments : tuple of Attachment
    name : str
    world : array_like, shape (4, 4)
        From the rig's space to the scene's, where y is up. For looking, not for computing.
    allowed : array_like, shape (n, j), bool, optional
        Which joints the file can store for which vertex; None when all. A glTF primitive
        can only name the joints of its own skin.
    parts : tuple of Part
        The meshes that `mesh` is made of, by name; the whole as one part when left out.
    left_out : tuple of LeftOut
        Meshes of the file that are not here.
    warnings : tuple of str
        What a person should know of how the file was read, in sentences.
    weight_sums : array, shape (n,), float64, optional
        What the weights of each vertex summed to in the file, before they were scaled to one;
        NaN where some were negative or no numbers. None where `weights` are not the file's.
    origin : array_like, shape (j,), int32, optional
        Which joint of the file each one is, -1 where joints were added; None where the skeleton
        is the file's. See `corrected_rig`.
    source
        What `cutcell.save` needs to write the same document again; opaque.

    Raises
    ------
    SkeletonError
        A joint that may carry weight lies more than ten bounding-box diagonals away from
        the mesh: skeleton and mesh are in different units.
    WeightsError
        Weights of the wrong shape, negative, or not finite.
    """

    mesh: TriangleMesh
    skeleton: Skeleton
    weights: NDArray[np.float64] | None = None
    clips: tuple[Clip, ...] = ()
    attachments: tuple[Attachment, ...] = ()
    name: str = "rig"
    world: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    allowed: NDArray[np.bool_] | None = None
    parts: tuple[Part, ...] = ()
    left_out: tuple[LeftOut, ...] = ()
    warnings: tuple[str, ...] = ()
    weight_sums: NDArray[np.float64] | None = None
    origin: NDArray[np.int32] | None = None
    source: Any = field(default=None, repr=False)

    if TYPE_CHECKING:

        def __init__(
            self,
            mesh: TriangleMesh,
            skeleton: Skeleton,
            weights: ArrayLike | None = None,
            clips: tuple[Clip, ...] = (),
            attachments: tuple[Attachment, ...] = (),
            name: str = "rig",
            world: ArrayLike = ...,
            allowed: ArrayLike | None = None,
            parts: tuple[Part, ...] = (),
            left_out: tuple[LeftOut, ...] = (),
            warnings: tuple[str, ...] = (),
            weight_sums: NDArray[np.float64] | None = None,
            origin: ArrayLike | None = None,
            source: Any = None,
        ) -> None: ...

    def __post_init__(self) -> None:
        shape = (len(self.mesh.vertices), len(self.skeleton.joints))
        if self.weights is not None:
            check_matrix(*shape)
            weights = as_array(self.weights, np.float64, shape, "weights", WeightsError)
            bad = np.flatnonzero(~(np.isfinite(weights) & (weights >= 0)).all(axis=1))
            if len(bad):
                raise WeightsError(
                    f"vertex {bad[0]} has a weight that is negative or not a number; "
                    f"{len(bad)} of {len(weights)} vertices are so"
                )
            object.__setattr__(self, "weights", _frozen(weights))
        if self.allowed is not None:
            allowed = as_array(self.allowed, np.bool_, shape, "allowed", WeightsError)
            object.__setattr__(self, "allowed", _frozen(allowed))
        if self.origin is not None:
            origin = as_array(self.origin, np.int64, shape[1:], "origin", SkeletonError)
            object.__setattr__(self, "origin", _frozen(origin.astype(np.int32)))
        if not self.parts or self.parts[-1].vertices.stop != shape[0]:  # of another mesh
            object.__setattr__(self, "parts", (Part(self.name, slice(0, shape[0])),))
        self._check_units()

    def with_weights(self, weights: NDArray[np.float64] | None) -> Rig:
        """Return the same rig with other weights, shape (n, j), or with none."""
        return replace(self, weights=weights, weight_sums=None)

    def with_joints(self, joints: ArrayLike) -> Rig:
        """Return the same rig with joints that stand elsewhere at rest, shape (j, 3).

        What hangs on a joint, other joints and attachments, stays where it is. Clips turn each
        joint as before, about its new place. `cutcell.save` writes it all.

        Raises
        ------
        SkeletonError
            A position that is not finite, or too far from the mesh.
        """
        before = self.skeleton
        skeleton = replace(before, joints=joints)  # type: ignore[arg-type]
        by = skeleton.joints - before.joints
        if not by.any():
            return self
        clips = tuple(clip.moved(before.joints, before.parents, by) for clip in self.clips)
        return replace(self, skeleton=skeleton, clips=clips)

    def _check_units(self) -> None:
        joints = self.skeleton.joints
        unit = np.abs(self.mesh.bounds).max()  # squares of what is measured must not overflow
        with np.errstate(over="ignore"):
            low, high = self.mesh.bounds / unit
            outside = np.maximum(np.maximum(low - joints / unit, joints / unit - high), 0)
            distance = np.linalg.norm(outside, axis=1)
        diagonal = np.linalg.norm(high - low)
        far = np.flatnonzero((distance > FAR_OUTSIDE * diagonal) & self.skeleton.deform)
        if len(far):
            worst = far[np.argmax(distance[far])]
            position = ", ".join(f"{x:.4g}" for x in joints[worst])
            raise SkeletonError(
                f'joint "{self.skeleton.names[worst]}" at ({position}) lies '
                f"{distance[worst] / diagonal:.0f} times the mesh's size away from it "
                f"(joints too far: {len(far)}); are skeleton and mesh in the same units?"
            )


def with_origin(skeleton: Skeleton, origin: NDArray[np.integer]) -> NDArray[np.int_]:
    """Return for each joint the nearest one, it or above it, that the file has; else the first.

    Shapes: origin (j,).
    """
    found = np.arange(len(origin))
    while len(open_ := np.flatnonzero((origin[found] < 0) & (skeleton.parents[found] >= 0))):
        found[open_] = skeleton.parents[found[open_]]
    return found


def _frozen(array: NDArray) -> NDArray:
    array.flags.writeable = False
    return array


def _joint_names(names: Any, count: int) -> tuple[str, ...]:
    if isinstance(names, str) or not isinstance(names, Sequence | np.ndarray):
        raise SkeletonError(f"the names of joints must be a list of them, not {shown(names)}")
    if len(names) == 0:
        return tuple(f"joint {i}" for i in range(count))
    if len(names) != count:
        raise SkeletonError(f"the skeleton has {count} joints but {len(names)} names")
    for joint, name in enumerate(names):
        if not isinstance(name, str):
            raise SkeletonError(f"the name of joint {joint} must be a text, not {shown(name)}")
    return tuple(names)


def _check_finite(points: NDArray, what: str, error: type, names: Any = None) -> None:
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        which = f'"{names[bad[0]]}"' if names else str(bad[0])
        raise error(
            f"{what} {which} has a coordinate that is not a finite number "
            f"({points[bad[0]].tolist()}); {len(bad)} of {len(points)} are so"
        )


def _check_acyclic(parents: NDArray, names: tuple[str, ...]) -> None:
    above = parents.copy()
    for _ in range(len(parents).bit_length() + 1):  # each time twice as far
        climbing = above >= 0
        if not climbing.any():
            return
        above[climbing] = above[above[climbing]]
    joint = int(np.flatnonzero(above >= 0)[0])
    for _ in range(len(parents)):
        joint = int(parents[joint])  # walk until surely on the cycle itself
    cycle = [joint]
    while parents[cycle[-1]] != joint:
        cycle.append(int(parents[cycle[-1]]))
    shown = [f'"{names[j]}"' for j in [*cycle, joint]]
    if len(shown) > LONG_CYCLE:
        shown[LONG_CYCLE // 2 : -LONG_CYCLE // 2] = ["..."]
    chain = " -> ".join(shown)
    raise SkeletonError(f"the skeleton has a cycle: {chain}; every joint needs a root above it")
