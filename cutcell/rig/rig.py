"""Rigs: a mesh and a skeleton, with the weights, clips and parts of their file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import assign
from ..errors import SkeletonError, WeightsError
from ..runtime.memory import check_matrix
from ..runtime.repr import Summarized
from .checks import as_array, frozen
from .clip import Clip
from .mesh import TriangleMesh
from .skeleton import Skeleton

FAR_OUTSIDE = 10.0
"""A joint this many bounding-box diagonals away from the mesh is in another unit."""
EXACT_SUM_TOLERANCE = 1e-12
"""Rows of weights whose sums differ less from one are taken as they are."""
LARGE = 1e300
"""The sum of larger weights may overflow."""


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
    """One of the named meshes of a file: some vertices of the rig.

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


@dataclass(frozen=True, eq=False, repr=False)
class Rig(Summarized):
    """A character: mesh, skeleton, and what its file says about weights and motion.

    Parameters
    ----------
    mesh : TriangleMesh
        All skinned meshes of the file, one after the other, vertices in the file's order.
    skeleton : Skeleton
    weights : array_like, shape (n, j), float64, optional
        Not negative. Rows are scaled to sum to one; a row of zeros is a vertex without weight.
    clips : tuple of Clip
    attachments : tuple of Attachment
    name : str
    world : array_like, shape (4, 4)
        From the rig's space to the scene's, where y is up. For looking, not for computing.
    allowed : array_like, shape (n, j), bool, optional
        Which joints the file can store for which vertex; None when all. A glTF primitive
        can only name the joints of that skin.
    parts : tuple of Part
        The meshes that `mesh` is made of, by name; the whole as one part when left out.
    left_out : tuple of LeftOut
        Meshes of the file that are not here.
    warnings : tuple of str
        What a person should know of how the file was read, in sentences.
    weight_sums : array, shape (n,), float64, optional
        What the weights of each vertex summed to before they were scaled to one; NaN where some
        were negative or no numbers in the file. None where they summed to one.
    origin : array_like, shape (j,), int32, optional
        Which joint of the file each one is, -1 where joints were added; None where the skeleton
        is the file's. See `edited_rig`.
    original : Skeleton, optional
        The skeleton before edits added, removed, renamed or reparented joints.
    partners : mapping of str to str
        Joints on the other side that a person set, by joint, "" for none; see `JointEdit`.
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
    original: Skeleton | None = None
    partners: Mapping[str, str] = field(default_factory=dict)
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
            original: Skeleton | None = None,
            partners: Mapping[str, str] = ...,
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
            with np.errstate(over="ignore"):
                sums = weights.sum(axis=1)
            is_off = (np.abs(sums - 1) > EXACT_SUM_TOLERANCE) & (sums > 0)
            if is_off.any():
                weights = weights.copy()
                weights[is_off] = normalised(weights[is_off])
                if self.weight_sums is None:
                    assign(self, weight_sums=frozen(sums))
            assign(self, weights=frozen(weights))
        if self.allowed is not None:
            allowed = as_array(self.allowed, np.bool_, shape, "allowed", WeightsError)
            assign(self, allowed=frozen(allowed))
        if self.origin is not None:
            origin = as_array(self.origin, np.int64, shape[1:], "origin", SkeletonError)
            assign(self, origin=frozen(origin.astype(np.int32)))
        if not self.parts or self.parts[-1].vertices.stop != shape[0]:  # of another mesh
            assign(self, parts=(Part(self.name, slice(0, shape[0])),))
        check_units(self.skeleton, self.mesh.bounds)

    @property
    def _summary(self) -> dict[str, Any]:
        return {
            "name": self.name,
            "vertices": len(self.mesh.vertices),
            "triangles": len(self.mesh.faces),
            "joints": len(self.skeleton.joints),
            "clips": len(self.clips),
            "parts": len(self.parts),
            "attachments": len(self.attachments),
            "weights": self.weights is not None,
            "warnings": len(self.warnings),
        }

    def require_joints(self) -> None:
        """Refuse a rig without joints, and say why its file has none, as far as the reader says.

        Raises
        ------
        SkeletonError
            It has no joints.
        """
        try:
            self.skeleton.require_joints()
        except SkeletonError as e:
            why = getattr(self.source, "why_bare", "")
            raise SkeletonError(why or str(e)) from None

    def with_weights(self, weights: NDArray[np.float64] | None) -> Rig:
        """Return the same rig with other weights, shape (n, j), or with none."""
        return replace(self, weights=weights, weight_sums=None)

    def with_joints(self, joints: ArrayLike) -> Rig:
        """Return the same rig with joints that stand elsewhere at rest, shape (j, 3).

        The children of a joint, other joints and attachments, stay in place. Clips turn each
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
        clips = tuple(clip.moved(before.parents, by) for clip in self.clips)
        return replace(self, skeleton=skeleton, clips=clips)


def check_units(skeleton: Skeleton, bounds: NDArray[np.float64]) -> None:
    """Raise an error if a joint that may carry weight is far from a mesh with bounds (2, 3)."""
    distance = times_outside(skeleton, bounds)
    far = np.flatnonzero((distance > FAR_OUTSIDE) & skeleton.deform)
    if len(far):
        worst = far[np.argmax(distance[far])]
        position = ", ".join(f"{x:.4g}" for x in skeleton.joints[worst])
        raise SkeletonError(
            f'joint "{skeleton.names[worst]}" at ({position}) lies '
            f"{distance[worst]:.0f} times the mesh's size away from it "
            f"(joints too far: {len(far)}); are skeleton and mesh in the same units?"
        )


def times_outside(skeleton: Skeleton, bounds: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how far each joint is from a mesh with bounds (2, 3), in diagonals of these, (j,)."""
    joints = skeleton.joints
    unit = np.abs(bounds).max()  # squares of what is measured must not overflow
    with np.errstate(over="ignore"):
        low, high = bounds / unit
        outside = np.maximum(np.maximum(low - joints / unit, joints / unit - high), 0)
        distance = np.linalg.norm(outside, axis=1)
    return np.asarray(distance / np.linalg.norm(high - low))


def normalised(weights: NDArray) -> NDArray[np.float64]:
    """Scale each row to sum to one; rows of zero stay zero."""
    if weights.max(initial=0) > LARGE:
        top = weights.max(axis=1, keepdims=True)
        weights = weights / np.where(top > 0, top, 1)
    sums = weights.sum(axis=1, keepdims=True)
    return np.divide(weights, sums, out=np.zeros(weights.shape), where=sums > 0)
