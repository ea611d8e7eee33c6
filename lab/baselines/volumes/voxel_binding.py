"""Geodesic voxel binding: distances along solid voxels (Dionne & de Lasa 2013)."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from cutcell.method import PAPER, Leaf
from cutcell.rig import Rig
from cutcell.weights.paper_kernel import paper_kernel

from ..body import NEAREST, Body, follow_nearest, unreached
from ..frame import BaselineBinding, Run, bind_by
from .voxels import Voxels, voxelize

NO_PATH = "no path along solid voxels leads from a bone to them"

UNIRIG_VOXEL_COST = 3.0
"""UniRig counts a step between voxels three times, and so prefers paths on the surface."""

UNIRIG_REACH = 1.001
"""Voxels: UniRig links a vertex with a voxel that is this near, and no farther one."""

UNIRIG_SIDE = 2.0
"""UniRig scales the longest side of a mesh to 2, and its falloff takes these lengths as is."""


def voxel(
    rig: Rig,
    resolution: int = 64,
    *,
    alpha: float = 0.5,
    leaf: Leaf = "point",
    max_influences: int | None = None,
    threshold: float = 0.0,
) -> BaselineBinding:
    """Bind by distances along solid voxels.

    Voxels that a bone runs through are at distance 0; from there paths lead through the
    26 neighbours of each voxel. A vertex adds the distance to the centre of its voxel.

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
    method = PAPER.with_options(
        resolution=resolution,
        alpha=alpha,
        leaf=leaf,
        max_influences=max_influences,
        threshold=threshold,
    )

    def solve(body: Body, run: Run) -> NDArray[np.float64]:
        distance = voxel_distances(body, run)
        run.warnings += follow_nearest(body, distance, NO_PATH)
        run.end("distances")
        return paper_kernel(body.joint_minimum(distance), body.lattice.diagonal, alpha)

    return bind_by(solve, rig, method)


def voxel_distances(body: Body, run: Run | None = None) -> NDArray[np.float64]:
    """Measure how far every welded vertex is from every bone along solid voxels.

    Returns shapes (b, k).
    """
    voxels = voxelize(body)
    links, lengths = voxels.links()
    if run is not None:
        run.end("graph")
    sources = [
        voxels_of_bone(voxels, start, end)
        for start, end in zip(body.bones.start, body.bones.end, strict=True)
    ]
    by_voxel = path_lengths(len(voxels.centres), links, lengths, sources)
    voxel_of = voxels.at(body.points)
    inside = np.linalg.norm(body.points - voxels.centres[voxel_of], axis=1)
    return by_voxel[:, voxel_of] + inside


def voxel_unirig(
    rig: Rig,
    resolution: int = 196,
    *,
    alpha: float = 0.5,
    max_influences: int | None = None,
    threshold: float = 0.0,
) -> BaselineBinding:
    """Bind as UniRig prepares its prior: joints as points, voxels and surface as one graph.

    Solid are the voxels of the surface, and those between its first and last voxel along at least
    two axes. Each is linked to its six neighbours at three times the distance; a vertex to the
    nearest voxel, if it is within the size of one, and along the mesh's edges. Each joint starts
    at the nearest node. Where no path leads from a joint, its distance is the largest
    finite one.

    Parameters
    ----------
    rig : Rig
    resolution : int
        R, voxels along the longest side, 2 to 1024; UniRig takes 196.
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
    Zhang et al. 2025 (UniRig); its published settings: grid 196, alpha 0.5, grid query 7 (a voxel
    and its six neighbours), vertex query 1, grid weight 3.
    """
    method = PAPER.with_options(
        resolution=resolution, alpha=alpha, max_influences=max_influences, threshold=threshold
    )

    def solve(body: Body, run: Run) -> NDArray[np.float64]:
        voxels = voxelize(body, fill="spans")
        links, lengths = _unirig_links(body, voxels)
        run.end("graph")
        nodes = np.concatenate([body.points, voxels.centres])
        deform = np.flatnonzero(rig.skeleton.deform)
        at = body.lattice.to_unit(rig.skeleton.joints[deform])
        nearest = cKDTree(nodes).query(at)[1]
        by_node = path_lengths(len(nodes), links, lengths, nearest[:, None])
        distance = by_node[:, : len(body.points)]
        run.warnings += _follow_nearest_joints(body, at, distance)
        distance[~np.isfinite(distance)] = distance[np.isfinite(distance)].max()
        run.end("distances")
        full = np.full((body.joints, len(body.points)), np.inf)
        full[deform] = np.maximum(UNIRIG_SIDE * distance, 1e-6)
        return paper_kernel(full, 1.0, alpha)

    return bind_by(solve, rig, method)


def path_lengths(
    count: int,
    links: NDArray[np.int32],
    lengths: NDArray[np.float64],
    sources: Iterable[NDArray[np.intp]],
) -> NDArray[np.float64]:
    """Return how far all nodes are from each set of sources: links (e, 2); (sets, count)."""
    matrix = csr_array((lengths, links.T), shape=(count, count))
    search = partial(dijkstra, matrix, directed=False, min_only=True)
    return np.array([search(indices=nodes) for nodes in sources])


def voxels_of_bone(voxels: Voxels, start: NDArray, end: NDArray) -> NDArray[np.intp]:
    """Return the solid voxels along a bone, or the nearest one where it runs outside."""
    steps = int(np.ceil(4 * voxels.resolution * np.linalg.norm(end - start))) + 1
    points = start + np.linspace(0, 1, steps)[:, None] * (end - start)
    hit = voxels.at(points)
    hit = np.unique(hit[hit >= 0])
    if len(hit):
        return hit.astype(np.intp)
    distance, nearest = cKDTree(voxels.centres).query(points)
    return nearest[[distance.argmin()]]


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
    return (unreached(lost, body, NO_PATH),)


def _unirig_links(body: Body, voxels: Voxels) -> tuple[NDArray, NDArray]:
    """Link voxels, vertices with the nearest voxel, and vertices along edges."""
    between, lengths = voxels.links(connectivity=6)
    count = len(body.points)
    edges, along = body.mesh.edges.edges, body.mesh.edge_lengths
    away, nearest = cKDTree(voxels.centres).query(body.points)
    near = np.flatnonzero(away < UNIRIG_REACH / voxels.resolution)
    return (
        np.concatenate([between + count, edges, np.stack([near, nearest[near] + count], axis=1)]),
        np.concatenate([UNIRIG_VOXEL_COST * lengths, along, np.maximum(away[near], 1e-12)]),
    )
