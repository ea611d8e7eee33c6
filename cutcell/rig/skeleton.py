"""Skeletons: joints and their parents, checked and frozen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import assign, shown
from ..errors import SkeletonError
from ..runtime.display import listed
from ..runtime.repr import Summarized
from .checks import as_array, check_finite, frozen
from .names import is_neutral

LONG_CYCLE = 10
"""Joints of a cycle that are named; of a longer one only the first and the last."""


@dataclass(frozen=True, eq=False, repr=False)
class Skeleton(Summarized):
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
        Which joints may carry weight; when left out, all but Blender's stand-in for vertices
        without weights, ``neutral_bone``.
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
        check_finite(joints, "joint", SkeletonError, names)
        bad = np.flatnonzero((parents < -1) | (parents >= count))
        if len(bad):
            raise SkeletonError(
                f'joint "{names[bad[0]]}" has the parent {parents[bad[0]]}, but parents are '
                f"-1 (a root) to {count - 1}"
            )
        deform = self.deform
        if deform is None:
            neutral = np.array([is_neutral(name) for name in names], bool)
            deform = ~neutral | neutral.all()
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
            assign(self, orientations=frozen(axes))
        assign(self, joints=frozen(joints), parents=frozen(parents.astype(np.int32)))
        assign(self, names=names, deform=frozen(deform))

    @property
    def _summary(self) -> dict[str, Any]:
        roots, deforming = int((self.parents < 0).sum()), int(self.deform.sum())
        return {"joints": len(self.joints), "roots": roots, "deforming": deforming}

    def require_joints(self) -> None:
        """Refuse the skeleton of a mesh that came without one, and say how to give it one.

        Raises
        ------
        SkeletonError
            It has no joints.
        """
        if len(self.joints) == 0:
            raise SkeletonError(
                "the rig has no skeleton; export the mesh together with its armature, fit a "
                "skeleton (`--template`), give the file of one (`--skeleton`), or put a skeleton "
                "beside it in a JSON file of the same name, for example "
                '{"joints": [{"name": "root", "position": [0, 0, 0], "parent": null}, '
                '{"name": "tip", "position": [0, 1, 0], "parent": "root"}]}'
            )

    def listed(self, which: NDArray[np.bool_]) -> str:
        """Return the names of some joints (j,), the first ones of many."""
        return listed([self.names[j] for j in np.flatnonzero(which)])

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
        return frozen(depth)

    @cached_property
    def subtree(self) -> NDArray[np.bool_]:
        """True where joint k moves along when joint j turns, shape (j, k); true for k = j."""
        inside = np.eye(len(self.parents), dtype=bool)
        above = self.parents.copy()
        while (above >= 0).any():
            k = np.flatnonzero(above >= 0)
            inside[above[k], k] = True
            above[k] = self.parents[above[k]]
        return frozen(inside)


def with_origin(skeleton: Skeleton, origin: NDArray[np.integer]) -> NDArray[np.int_]:
    """Return for each joint (j,) the nearest one, it or above it, of the file; else the first."""
    nearest = np.arange(len(origin))
    while len(missing := np.flatnonzero((origin[nearest] < 0) & (skeleton.parents[nearest] >= 0))):
        nearest[missing] = skeleton.parents[nearest[missing]]
    return nearest


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


def _check_acyclic(parents: NDArray, names: tuple[str, ...]) -> None:
    parent_of = {j: [parent] if parent >= 0 else [] for j, parent in enumerate(parents.tolist())}
    try:
        TopologicalSorter(parent_of).prepare()
    except CycleError as error:
        cycle = error.args[1][::-1]  # from each joint to its parent
    else:
        return
    labels = [f'"{names[j]}"' for j in cycle]
    if len(labels) > LONG_CYCLE:
        labels[LONG_CYCLE // 2 : -LONG_CYCLE // 2] = ["..."]
    chain = " -> ".join(labels)
    raise SkeletonError(f"the skeleton has a cycle: {chain}; every joint needs a root above it")
