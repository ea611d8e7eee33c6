"""Regions where two sets of weights move the surface differently, ranked by what they change."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from cutcell.checks import check_number
from cutcell.geodesics import BoneDistances
from cutcell.geometry.triangles import face_edges
from cutcell.graph import CutCellGraph
from cutcell.graph.fingerprint import data_fingerprint, require_same
from cutcell.rig import Rig
from cutcell.rig.mesh import vertex_shares
from cutcell.runtime.progress import Progress, silent

from ..metrics import DeformationError, Turn, deformation_error
from ..metrics.deformation import AXES, ROUNDING, squared_chord, turn_error
from ..metrics.weight_error import checked_pair
from .reasons import Reasons

DEGREES = 30.0
"""Each joint turns by this, as in the deformation error of the paper."""
NOTICED = 5.0
"""Millimetres at a longest side of 1 m: vertices that differ less agree."""
ALIKE = 0.5
"""Cosine of the differences of two neighbours' weights: with less they are of two regions."""
SMALL = 0.005
"""Part of the whole error: patches of less join another patch of the same two joints."""
MAX_REGIONS = 40
"""Regions that are explained, those that change most."""
BLOCK = 1 << 16
"""Edges whose ends are compared at a time."""


@dataclass(frozen=True, eq=False)
class Region:
    """A part of the surface that two sets of weights move differently.

    Parameters
    ----------
    vertices : array of int
        Ascending.
    first, second : int
        The joint of which the first weights give it more, and that of the second.
    error : float
        The region's part of `DeformationError.mean`, cm²: the sum over its vertices.
    rms, largest : float
        Root mean square and maximum of the distance in motion, mm, the longest side being 1 m.
    turn : Turn
        The turn of a joint that moves the region most differently: mean over the region and
        greatest, cm².
    degrees : float
        How far the joint turns.
    reason : str
        A key of `REASONS`.
    text : str
        The reason with numbers.
    """

    vertices: NDArray[np.intp]
    first: int
    second: int
    error: float
    rms: float
    largest: float
    turn: Turn
    degrees: float
    reason: str
    text: str

    @property
    def key(self) -> str:
        """A name of the region that no other one has."""
        return f"{self.reason}/{self.first}/{self.second}"


@dataclass(frozen=True, eq=False)
class Disagreement:
    """All regions where two sets of weights differ, those that change most first.

    Parameters
    ----------
    regions : tuple of Region
    errors : DeformationError
        The errors of all vertices.
    rest : float
        The part of `errors.mean` outside the regions, cm².
    """

    regions: tuple[Region, ...]
    errors: DeformationError
    rest: float


def disagreement(
    rig: Rig,
    first: ArrayLike,
    second: ArrayLike,
    distances: BoneDistances,
    *,
    degrees: float = DEGREES,
    noticed: float = NOTICED,
    names: tuple[str, str] = ("the first", "the second"),
    progress: Progress = silent,
) -> Disagreement:
    """Find the regions where two sets of weights differ in motion, and the reason of each.

    The measure is `deformation_error`. If a region of the first weights got the rows of the second,
    the mean error would fall by the region's `error`.

    Parameters
    ----------
    rig : Rig
    first, second : array_like, shape (n, j)
        Rows sum to one, or to zero.
    distances : BoneDistances
        Of this rig, such as those of a `Binding`.
    degrees : float
        How far each joint turns.
    noticed : float
        Vertices that differ less agree; mm, the longest side of the mesh being 1 m.
    names : pair of str
        What the texts call the two sets of weights.
    progress : callable
        See `cutcell.runtime.progress`; stages are "deformation" and "reasons".

    Returns
    -------
    Disagreement

    Raises
    ------
    SkeletonError
        No joints.
    WeightsError
        Weights that do not fit the rig or each other.
    ParameterError
        A parameter is out of its range, or the distances are of another rig.
    """
    noticed = check_number("noticed", noticed, 0, 1e6)
    expected = data_fingerprint(rig.mesh, rig.skeleton)
    require_same("distances", distances.fingerprint, expected)
    pair = checked_pair(first, second)
    errors = deformation_error(rig, *pair, degrees, progress=progress)
    share = vertex_shares(rig.mesh)
    lengths = millimetres(errors.vertex)
    vertices = np.flatnonzero((lengths > noticed) & (share > 0))
    difference = pair[0][vertices] - pair[1][vertices]
    label = _patches(distances.graph, vertices, difference)
    more, less = difference.argmax(axis=1), difference.argmin(axis=1)
    error = share[vertices] * errors.vertex[vertices]
    patches = _joined(label, error, more, less, SMALL * errors.mean)
    patches.sort(key=lambda members: -error[members].sum())
    reasons = Reasons(rig, distances, *pair, names)
    regions: dict[tuple[str, int, int], list[NDArray[np.intp]]] = {}
    texts: dict[tuple[str, int, int], str] = {}  # of the largest patch
    for done, members in enumerate(patches[:MAX_REGIONS]):
        progress("reasons", done / min(len(patches), MAX_REGIONS))
        joints = _leading(more[members], error[members]), _leading(less[members], error[members])
        reason, text = reasons.of(vertices[members], joints)
        regions.setdefault((reason, *joints), []).append(members)
        texts.setdefault((reason, *joints), text)
    chord = squared_chord(rig.mesh, degrees)
    result = []
    for (reason, one, other), parts in regions.items():
        members = np.sort(np.concatenate(parts))
        at = vertices[members]
        weight = share[at] / share[at].sum()
        result.append(
            Region(
                vertices=at,
                first=one,
                second=other,
                error=float(error[members].sum()),
                rms=float(millimetres(weight @ errors.vertex[at])),
                largest=float(lengths[at].max()),
                turn=_worst_turn(rig, at, difference[members], weight, chord),
                degrees=degrees,
                reason=reason,
                text=texts[reason, one, other],
            )
        )
    result.sort(key=lambda region: -region.error)
    rest = errors.mean - sum(region.error for region in result)
    return Disagreement(tuple(result), errors, rest)


def millimetres(squared: NDArray[np.float64] | float) -> NDArray[np.float64]:
    """Return squared distances in cm² as lengths in mm."""
    return np.asarray(10 * np.sqrt(squared))


def _patches(
    graph: CutCellGraph, vertices: NDArray[np.intp], difference: NDArray[np.float64]
) -> NDArray[np.int32]:
    """Return the number (v,) of the connected patch of vertices whose weights differ alike.

    Shapes: vertices (v,), difference (v, j).
    """
    count = len(graph.vertex_node)
    number = np.full(count, -1, np.intp)
    number[vertices] = np.arange(len(vertices))
    first = np.unique(graph.vertex_node, return_index=True)[1]
    corners = first[graph.faces]
    copies = np.stack([np.arange(count), first[graph.vertex_node]], axis=1)
    ends = number[np.concatenate([face_edges(corners), copies])]
    low, high = np.sort(ends[(ends >= 0).all(axis=1) & (ends[:, 0] != ends[:, 1])], axis=1).T
    ends = np.stack(np.divmod(np.unique(low * count + high), count), axis=1)
    length = np.linalg.norm(difference, axis=1)
    alike = [
        np.einsum("ij,ij->i", difference[a], difference[b]) > ALIKE * length[a] * length[b]
        for a, b in (ends[k : k + BLOCK].T for k in range(0, len(ends), BLOCK))
    ]
    a, b = ends[np.concatenate([np.zeros(0, bool), *alike])].T
    matrix = coo_array((np.ones(len(a), bool), (a, b)), shape=(len(vertices),) * 2)
    label: NDArray[np.int32] = connected_components(matrix, directed=False)[1]
    return label


def _joined(
    label: NDArray[np.int32],
    error: NDArray[np.float64],
    more: NDArray[np.intp],
    less: NDArray[np.intp],
    small: float,
) -> list[NDArray[np.intp]]:
    """Return the members of each patch; small ones join the largest of the same two joints."""
    order = np.argsort(label, kind="stable")
    patches = np.split(order, np.flatnonzero(np.diff(label[order])) + 1) if len(order) else []
    patches.sort(key=lambda members: -error[members].sum())
    of_pair: dict[tuple[int, int], list[NDArray[np.intp]]] = {}
    result: list[list[NDArray[np.intp]]] = []
    for members in patches:
        pair = _leading(more[members], error[members]), _leading(less[members], error[members])
        if pair in of_pair and error[members].sum() < small:
            of_pair[pair].append(members)
        else:
            result.append([members])
            of_pair.setdefault(pair, result[-1])
    return [np.concatenate(parts) for parts in result]


def _leading(joints: NDArray[np.intp], error: NDArray[np.float64]) -> int:
    """Return the joint that most of the error is about."""
    return int(np.bincount(joints, error).argmax())


def _worst_turn(
    rig: Rig,
    vertices: NDArray[np.intp],
    difference: NDArray[np.float64],
    weight: NDArray[np.float64],
    chord: float,
) -> Turn:
    """Return the turn with the greatest mean error over some vertices."""
    skeleton, points = rig.skeleton, rig.mesh.vertices[vertices]
    turned: Iterable[int] = np.flatnonzero(skeleton.deform).tolist()
    best = Turn(0, skeleton.names[0], AXES[0], -1.0, 0.0)
    for joint in turned:
        moved = difference @ skeleton.subtree[joint].astype(np.float64)
        rows = np.flatnonzero(np.abs(moved) > ROUNDING)
        error = turn_error(points[rows], skeleton.joints[joint], moved[rows], chord)
        mean = weight[rows] @ error
        axis = int(mean.argmax())
        if mean[axis] > best.mean:
            name, largest = skeleton.names[joint], float(error[:, axis].max(initial=0))
            best = Turn(joint, name, AXES[axis], float(mean[axis]), largest)
    return best
