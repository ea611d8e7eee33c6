"""Transfer of weights to meshes that lie on a character."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypedDict, Unpack, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from ...checks import check_flag, check_integer, check_number
from ...errors import ParameterError, WeightsError
from ...rig import Rig, Skeleton, TriangleMesh
from ...rig.checks import as_array
from ...rig.inputs import MeshLike, as_mesh
from ...runtime.progress import Progress, silent
from ...runtime.repr import Summarized
from ...weights.prune import prune
from ..locks import joint_index, lock_joints
from .attachment import attach
from .inpainting import inpaint
from .matching import match
from .names import joint_matrix, storable
from .spaces import between, moved_mesh, with_skeleton

MATCHED, INPAINTED, REFUSED, UNCHANGED = range(4)
STATES = "matched", "in-painted", "refused", "unchanged"
"""Names of the states of vertices."""


@dataclass(frozen=True, eq=False, repr=False)
class Transfer(Summarized):
    """Weights that were transferred to a mesh.

    Parameters
    ----------
    weights : array, shape (n, j), float64
        Rows sum to one. Joints are those of the target if it has any, else those of the source.
    state : array, shape (n,), uint8
        Where the weights of each vertex come from, an index into `cutcell.editing.transfer.STATES`:
        0, matched: the closest point of the source. 1, in-painted: the vertices around it. 2,
        refused: the closest point although it is too far away or its normal does not fit, since
        no vertex of the connected component has a match. 3, unchanged: the target's own weights,
        outside of the mask.
    distance : array, shape (n,), float64
        Distance from each vertex to its match, in the source's units; infinite without one.
    resolved : array, shape (n,), bool
        Whether a match that is farther away, but nearer through the body to those of the vertices
        around it, replaced the closest one.
    rig : Rig
        The target with the weights, and the source's skeleton if it had none.
    """

    weights: NDArray[np.float64]
    state: NDArray[np.uint8]
    distance: NDArray[np.float64]
    resolved: NDArray[np.bool_]
    rig: Rig

    @property
    def report(self) -> dict[str, int]:
        """Number of vertices by state, and of those whose ambiguous match was resolved."""
        counts = np.bincount(self.state, minlength=len(STATES)).tolist()
        return {**dict(zip(STATES, counts, strict=True)), "resolved": int(self.resolved.sum())}

    @property
    def _summary(self) -> dict[str, Any]:
        return {"vertices": len(self.state), **self.report}


class TransferOptions(TypedDict, total=False):
    """Options of `transfer`."""

    distance: float
    angle: float
    flipped: bool
    joints: Sequence[int | str] | None
    mix: float
    locked: Sequence[int | str]
    mask: ArrayLike | None
    max_influences: int | None
    names: Mapping[str, str] | None
    progress: Progress


@overload
def transfer(
    source: Rig, target: Rig | MeshLike, **options: Unpack[TransferOptions]
) -> Transfer: ...
@overload
def transfer(
    source: Rig, target: list[Any], **options: Unpack[TransferOptions]
) -> list[Transfer]: ...
def transfer(
    source: Rig,
    target: Rig | MeshLike | list[Any],
    *,
    distance: float = 0.05,
    angle: float = 30.0,
    flipped: bool = False,
    joints: Sequence[int | str] | None = None,
    mix: float = 1.0,
    locked: Sequence[int | str] = (),
    mask: ArrayLike | None = None,
    max_influences: int | None = 4,
    names: Mapping[str, str] | None = None,
    progress: Progress = silent,
) -> Transfer | list[Transfer]:
    """Transfer the weights of a character to a mesh that lies on it.

    A vertex is matched with the closest point of the source within a distance whose normal fits.
    Where several parts of the body are near, as between two fingers, the point wins that is nearest
    through the body to the matches of the vertices around. Vertices without a match are in-painted:
    their weights minimise the bi-Laplacian energy with the others fixed. A connected component that
    lies on the surface and mostly follows one joint, such as a wig, becomes rigid. Vertices at one
    place get the same weights, also those of several targets.

    Parameters
    ----------
    source : Rig
        Has weights. Vertices whose weights are all zero are no matches.
    target : Rig, mesh as `build_graph` takes, or list of them
        A mesh is in the source's space. A rig lies where it is in the scene (`Rig.world`), and
        keeps its joints, if it has any; see `names`. Several, such as levels of detail, are
        transferred to at once.
    distance : float
        Greatest distance of a match, as part of the diagonal of the source's bounding box.
    angle : float
        Greatest angle between the normals of a match, in degrees, 0 to 180. Normals do not count
        within three tenths of the distance, or a twentieth on components that mostly do not fit.
    flipped : bool
        Match opposite normals, too, such as those of the inside of layered cloth.
    joints : sequence of int or str, optional
        Transfer the weights of these joints of the target only; the target's own weights of the
        others share the rest. All when left out.
    mix : float
        Part of the new weights, 0 to 1; the rest are the target's own.
    locked : sequence of int or str
        Joints of the target that keep its own weights; the others share the rest.
    mask : array_like, shape (n,), optional
        Part of the new weights by vertex, 0 to 1, or whether it changes. Only for one target.
    max_influences : int or None
        Largest number of weights of a vertex; None for all.
    names : mapping of str to str, optional
        The target's joint by the source's, where the names differ; "" for none. Others are matched
        by equal names, then by names without name spaces and case. The weight of a joint without a
        partner, or one that the vertex may not follow (`Rig.allowed`), goes to the nearest joint
        above it that can take it; of the latter, to the nearest joint if none above can.
    progress : callable
        See `cutcell.runtime.progress`; stages are "graph" and "weights".

    Returns
    -------
    Transfer, or a list of one for each target

    Raises
    ------
    ParameterError
        A parameter is out of its range, or the mask does not fit.
    WeightsError
        The source has no weights, or the target none where its own are needed.
    SkeletonError
        A joint with weight has no partner, nor has any joint above it.
    MeshError
        The target is no mesh.

    Examples
    --------
    >>> body, coat = cutcell.load("body.glb"), cutcell.load("coat.obj")  # doctest: +SKIP
    >>> dressed = cutcell.transfer(body, coat)  # doctest: +SKIP
    >>> dressed.report  # doctest: +SKIP
    {'matched': 5210, 'in-painted': 640, 'refused': 0, 'unchanged': 0, 'resolved': 31}
    >>> cutcell.save("coat.glb", dressed.rig)  # doctest: +SKIP
    """
    if source.weights is None or not source.weights.any():
        raise WeightsError(f"{source.name} has no weights to transfer; bind it first")
    radius = check_number("distance", distance, 0, 10)
    degrees = check_number("angle", angle, 0, 180)
    flipped = check_flag("flipped", flipped)
    mix = check_number("mix", mix, 0, 1)
    if max_influences is not None:
        max_influences = check_integer("max_influences", max_influences, 1, 1_000_000)
    several = isinstance(target, list)
    targets = target if isinstance(target, list) else [target]
    if not targets:
        raise ParameterError("there is no target; give a mesh or a rig, or several in a list")
    if mask is not None and several:
        raise ParameterError("a mask is for one target; transfer to each of them by itself")
    rigs = [_with_skeleton(one, source) for one in targets]
    joined, bounds = _joined([moved_mesh(rig.mesh, between(rig, source)) for rig in rigs])
    matches = match(source, joined, radius, degrees, flipped, progress)
    progress("weights", 0.0)
    rows = inpaint(joined.welded, matches.state == MATCHED, matches.weights)
    diagonal = float(np.linalg.norm(np.ptp(source.mesh.bounds, axis=0)))
    rows = attach(joined.welded, rows, matches.distance / diagonal)
    index = joined.welded.index
    results = []
    for rig, begin, end in zip(rigs, bounds[:-1], bounds[1:], strict=True):
        welded = index[begin:end]
        weights = rows[welded] @ joint_matrix(source.skeleton, source.weights, rig.skeleton, names)
        weights = _few(storable(weights, rig), rig, max_influences)
        state = matches.state[welded]
        weights, is_unchanged = _merged(rig, weights, joints, mix, locked, mask, max_influences)
        results.append(
            Transfer(
                weights,
                np.where(is_unchanged, UNCHANGED, state).astype(np.uint8),
                matches.distance[welded],
                matches.resolved[welded],
                rig.with_weights(weights),
            )
        )
    progress("weights", 1.0)
    return results if several else results[0]


def _with_skeleton(target: Any, source: Rig) -> Rig:
    """Return a target as a rig, with the source's skeleton if it has none."""
    if not isinstance(target, Rig):
        target = Rig(as_mesh(target), Skeleton([], []), world=source.world)
    return target if len(target.skeleton.joints) else with_skeleton(target, source)


def _joined(meshes: list[TriangleMesh]) -> tuple[TriangleMesh, NDArray[np.intp]]:
    """Return several meshes as one, and where the vertices of each begin and end."""
    bounds = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    if len(meshes) == 1:
        return meshes[0], bounds
    faces = [mesh.faces + begin for mesh, begin in zip(meshes, bounds[:-1], strict=True)]
    return TriangleMesh(np.concatenate([m.vertices for m in meshes]), np.concatenate(faces)), bounds


def _few(weights: NDArray[np.float64], rig: Rig, max_influences: int | None) -> NDArray[np.float64]:
    """Keep the largest weights of each row; ties go to the joint that is first by name."""
    names = rig.skeleton.names
    priority = np.array(sorted(range(len(names)), key=lambda joint: (names[joint], joint)))
    return prune(csr_array(weights), max_influences, 0.0, priority).toarray()


def _merged(
    rig: Rig,
    weights: NDArray[np.float64],
    joints: Sequence[int | str] | None,
    mix: float,
    locked: Sequence[int | str],
    mask: ArrayLike | None,
    max_influences: int | None,
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return new weights (n, j) mixed with a target's own, and which vertices keep theirs."""
    part = np.full(len(weights), mix)
    if mask is not None:
        strength = as_array(mask, np.float64, (len(weights),), "mask", ParameterError)
        if not np.all((strength >= 0) & (strength <= 1)):
            raise ParameterError("mask must hold numbers from 0 to 1")
        part = mix * strength
    if joints is None and not len(locked) and (part == 1).all():
        return weights, np.zeros(len(weights), np.bool_)
    stored = rig.weights
    if stored is None:
        raise WeightsError(
            f"{rig.name} has no weights of its own to keep; leave out joints, mix, locked and mask"
        )
    has_stored = np.asarray(stored.any(axis=1))
    if joints is not None:
        chosen = [joint_index(rig.skeleton, joint) for joint in joints]
        new = lock_joints(rig.with_weights(weights), stored, chosen, max_influences)
        weights = np.where(has_stored[:, None], new, weights)
    part = np.where(has_stored, part, 1.0)  # no row of zeros
    weights = (1 - part[:, None]) * stored + part[:, None] * weights
    is_unchanged = np.asarray(part == 0)
    if ((part > 0) & (part < 1)).any():
        few = _few(weights, rig, max_influences)
        weights = np.where(is_unchanged[:, None], stored, few)
    return lock_joints(rig, weights, list(locked), max_influences), is_unchanged
