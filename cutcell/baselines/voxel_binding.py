"""Geodesic voxel binding: distances along solid voxels (Dionne & de Lasa 2013)."""

from __future__ import annotations

from time import perf_counter

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..checks import check_number
from ..geodesics.fallback import straight_to_nearest
from ..rig import Rig
from ..skinning.kernel import paper_kernel
from .body import Body
from .paths import path_lengths
from .result import BaselineBinding, finish
from .voxels import Voxels, voxelize

NEAREST = 3
"""Bones that a vertex follows which no path reaches, as in the paper."""

UNIRIG_VOXEL_COST = 3.0
"""UniRig counts a step between voxels three times, and so prefers paths on the surface."""

UNIRIG_SIDE = 2.0
"""UniRig scales the longest side of a mesh to 2, and its falloff takes these lengths as is."""


def voxel(
    rig: Rig,
    resolution: int = 64,
    *,
    alpha: float = 0.5,
    leaf: str = "point",
    max_influences: int | None = None,
    threshold: float = 0.0,
) -> BaselineBinding:
    """Bind by distances along solid voxels.

    Voxels that a bone runs through are at distance 0; from there paths lead through the
    26 neighbours of each voxel. A vertex adds the way from the centre of its own voxel.

    Parameters
    ----------
    rig : Rig
    resolution : int
        R, voxels along the longest side, 2 to 1024.
    alpha : float
        Smoothness of the falloff, 0 to 1.
    leaf
        See `bone_segments`.
    max_influences, threshold
        See `skinning_weights`.

    Returns
    -------
    BaselineBinding
        Stages "graph", "distances", "weights".

    Raises
    ------
    ParameterError
        A parameter is out of its range.

    References
    ----------
    Dionne & de Lasa 2013, "Geodesic voxel binding for production character meshes".
    """
    alpha = check_number("alpha", alpha, 0, 1)
    begin = perf_counter()
    body = Body.of(rig, leaf, resolution)
    distance, built = voxel_distances(body)
    warnings = _follow_nearest(body, distance)
    found = perf_counter()
    weights = paper_kernel(body.joint_minimum(distance), body.lattice.diagonal, alpha)
    weights, more = finish(rig, body, weights, max_influences=max_influences, threshold=threshold)
    ticks = np.diff([begin, built, found, perf_counter()]).tolist()
    seconds = dict(zip(("graph", "distances", "weights"), ticks, strict=True))
    return BaselineBinding(weights, seconds, warnings + more)


def voxel_distances(body: Body) -> tuple[NDArray[np.float64], float]:
    """Measure how far every place is from every bone along solid voxels.

    Parameters
    ----------
    body : Body
        Its lattice says how many voxels.

    Returns
    -------
    distance : array, shape (b, k)
        In the unit cube; infinite where no path leads.
    built : float
        The time, by `perf_counter`, when the voxels and their links were there.
    """
    voxels = voxelize(body)
    links, lengths = voxels.links()
    built = perf_counter()
    sources = [
        _voxels_of_bone(voxels, start, end)
        for start, end in zip(body.bones.start, body.bones.end, strict=True)
    ]
    starts = [np.zeros(len(nodes)) for nodes in sources]
    by_voxel = path_lengths(len(voxels.centres), links, lengths, sources, starts)
    home = voxels.at(body.points)
    inside = np.linalg.norm(body.points - voxels.centres[home], axis=1)
    return by_voxel[:, home] + inside, built


def voxel_unirig(
    rig: Rig,
    resolution: int = 64,
    *,
    alpha: float = 0.5,
    max_influences: int | None = None,
    threshold: float = 0.0,
) -> BaselineBinding:
    """Bind as UniRig prepares its prior: joints as points, voxels and surface as one graph.

    Solid voxels are linked to their 26 neighbours at three times the distance, vertices to
    the voxels around them and along the mesh's edges; each joint starts at the nearest node.
    Where no path leads from a joint, it counts as far as the farthest that one leads from.

    Parameters
    ----------
    rig : Rig
    resolution : int
        R, voxels along the longest side, 2 to 1024.
    alpha : float
        Smoothness of the falloff, 0 to 1, of distances in half longest sides.
    max_influences, threshold
        See `skinning_weights`.

    Returns
    -------
    BaselineBinding
        Stages "graph", "distances", "weights".

    Raises
    ------
    ParameterError
        A parameter is out of its range.

    References
    ----------
    Zhang et al. 2025 (UniRig).
    """
    alpha = check_number("alpha", alpha, 0, 1)
    begin = perf_counter()
    body = Body.of(rig, "point", resolution)
    voxels = voxelize(body)
    links, lengths = _unirig_links(body, voxels)
    built = perf_counter()
    nodes = np.concatenate([body.points, voxels.centres])
    deform = np.flatnonzero(rig.skeleton.deform)
    at = body.lattice.to_unit(rig.skeleton.joints[deform])
    nearest = cKDTree(nodes).query(at)[1]
    sources, starts = [np.array([n]) for n in nearest], [np.zeros(1)] * len(nearest)
    distance = path_lengths(len(nodes), links, lengths, sources, starts)[:, : len(body.points)]
    warnings = _follow_nearest_joints(body, at, distance)
    distance[~np.isfinite(distance)] = distance[np.isfinite(distance)].max()
    found = perf_counter()
    full = np.full((body.joints, len(body.points)), np.inf)
    full[deform] = np.maximum(UNIRIG_SIDE * distance, 1e-6)
    weights, more = finish(
        rig,
        body,
        paper_kernel(full, 1.0, alpha),
        max_influences=max_influences,
        threshold=threshold,
    )
    ticks = np.diff([begin, built, found, perf_counter()]).tolist()
    seconds = dict(zip(("graph", "distances", "weights"), ticks, strict=True))
    return BaselineBinding(weights, seconds, warnings + more)


def _voxels_of_bone(voxels: Voxels, start: NDArray, end: NDArray) -> NDArray[np.intp]:
    """Return the solid voxels along a bone, or the nearest one where it runs outside."""
    steps = int(np.ceil(4 * voxels.resolution * np.linalg.norm(end - start))) + 1
    points = start + np.linspace(0, 1, steps)[:, None] * (end - start)
    hit = voxels.at(points)
    hit = np.unique(hit[hit >= 0])
    if len(hit):
        return hit.astype(np.intp)
    distance, nearest = cKDTree(voxels.centres).query(points)
    return nearest[[distance.argmin()]]


def _follow_nearest(body: Body, distance: NDArray[np.float64]) -> tuple[str, ...]:
    """Give places that no path reaches straight distances to their nearest bones."""
    lost = np.flatnonzero(~np.isfinite(distance).any(axis=0))
    if len(lost) == 0:
        return ()
    distance[:, lost] = straight_to_nearest(body.points[lost], body.bones, NEAREST)
    return (_unreached(lost, body),)


def _follow_nearest_joints(
    body: Body, joints: NDArray[np.float64], distance: NDArray[np.float64]
) -> tuple[str, ...]:
    lost = np.flatnonzero(~np.isfinite(distance).any(axis=0))
    if len(lost) == 0:
        return ()
    near, which = cKDTree(joints).query(
        body.points[lost], k=range(1, min(NEAREST, len(joints)) + 1)
    )
    distance[which, lost[:, None]] = near
    return (_unreached(lost, body),)


def _unreached(lost: NDArray[np.intp], body: Body) -> str:
    return (
        f"{len(lost)} of {len(body.points)} places follow their nearest bones in a straight "
        "line: no path along solid voxels leads from a bone to them"
    )


def _unirig_links(body: Body, voxels: Voxels) -> tuple[NDArray, NDArray]:
    """Link voxels, vertices with the voxels around them, and vertices along edges."""
    between, lengths = voxels.links()
    count = len(body.points)
    ends = np.concatenate([body.faces[:, [0, 1]], body.faces[:, [1, 2]], body.faces[:, [2, 0]]])
    edges = np.unique(np.sort(ends, axis=1), axis=0)
    reach = np.sqrt(3) / voxels.resolution * (1 + 1e-9)
    near = cKDTree(body.points).sparse_distance_matrix(
        cKDTree(voxels.centres), reach, output_type="coo_matrix"
    )
    along = np.linalg.norm(body.points[edges[:, 0]] - body.points[edges[:, 1]], axis=1)
    links = [between + count, edges, np.stack([near.row, near.col + count], axis=1)]
    return (
        np.concatenate(links),
        np.concatenate([UNIRIG_VOXEL_COST * lengths, along, np.maximum(near.data, 1e-12)]),
    )
