"""RigNet's distance: straight along lines of sight from bones, over the surface elsewhere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from cutcell.checks import check_number
from cutcell.geometry.edges import find_edges
from cutcell.method import PAPER, Leaf
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress, silent
from cutcell.weights.paper_kernel import paper_kernel

from .body import Body, follow_nearest
from .frame import BaselineBinding, Run, bind_by
from .visibility import Blockers

NEAR_SHARE = 15.0
"""Per cent of the vertices that see a bone: they set how far it is seen from, see `reach`."""
APART = 8.0
"""Longest sides that are added to a straight distance to which no path over the surface leads."""
NO_PATH = "they see no bone, nor does any path over the surface lead to vertices that do"


def visibility(
    rig: Rig,
    *,
    reach: float | None = 1.3,
    alpha: float = 0.5,
    leaf: Leaf = "point",
    max_influences: int | None = None,
    threshold: float = 0.0,
    progress: Progress = silent,
) -> BaselineBinding:
    """Bind by RigNet's volumetric geodesic distance, with the paper's falloff.

    A vertex sees a bone if no triangle lies between it and the closest point of the bone: then its
    distance is straight. A vertex that does not see it goes over the surface to the nearest vertex
    that does, and from there straight. RigNet goes along a graph of points drawn from the surface;
    here it is along the edges of the mesh.

    Parameters
    ----------
    rig : Rig
    reach : float or None
        Vertices that are farther from a bone than this, times the 15th percentile of the distances
        of those that see it, do not see it; 1.3 in RigNet's published code, 1 to 1e6. None: as far
        as nothing is between.
    alpha : float
        Smoothness of the falloff, 0 to 1.
    leaf
        See `bone_segments`.
    max_influences, threshold
        See `skinning_weights`.
    progress : callable
        See `cutcell.runtime.progress`.

    Returns
    -------
    BaselineBinding
        Stages "visibility", "distances", "weights".

    Raises
    ------
    ParameterError
        A parameter is out of its range.

    References
    ----------
    Xu, Zhou, Kalogerakis, Landreth & Singh 2020, "RigNet: Neural Rigging for Articulated
    Characters", section 4.3, and the preparation of its data as published.
    """
    if reach is not None:
        reach = check_number("reach", reach, 1, 1e6)
    method = PAPER.with_options(
        alpha=alpha, leaf=leaf, max_influences=max_influences, threshold=threshold
    )

    def solve(body: Body, run: Run) -> NDArray[np.float64]:
        straight = body.straight()
        is_visible = visible(body, progress)
        if reach is not None:
            is_visible &= straight <= _farthest(straight, is_visible, reach)[:, None]
        run.end("visibility")
        distance = over_surface(body, straight, is_visible, progress)
        run.warnings += follow_nearest(body, distance, NO_PATH)
        run.end("distances")
        return paper_kernel(body.joint_minimum(distance), body.lattice.diagonal, alpha)

    return bind_by(solve, rig, method)


def visible(body: Body, progress: Progress = silent) -> NDArray[np.bool_]:
    """Return whether each welded vertex has line of sight to each bone, shape (b, k)."""
    blockers = Blockers(body.points, body.faces)
    every, count = np.arange(len(body.points)), len(body.bones.joint)
    is_visible = np.empty((count, len(every)), bool)
    for b in range(count):
        progress("visibility", b / count)
        is_visible[b] = ~blockers.blocked(every, body.closest_on(b))
    return is_visible


def over_surface(
    body: Body,
    straight: NDArray[np.float64],
    is_visible: NDArray[np.bool_],
    progress: Progress = silent,
) -> NDArray[np.float64]:
    """Measure over the surface from every bone to vertices without line of sight.

    Shapes: straight (b, k), seen (b, k); returns (b, k).
    """
    graph = _along_edges(body)
    distance = np.where(is_visible, straight, np.inf)
    for b, (row, to_bone, sees) in enumerate(zip(distance, straight, is_visible, strict=True)):
        progress("distances", b / len(is_visible))
        if not sees.any():
            continue
        length, _, nearest = dijkstra(
            graph,
            directed=False,
            indices=np.flatnonzero(sees),
            min_only=True,
            return_predecessors=True,
        )
        led = np.isfinite(length)
        row[led] = length[led] + to_bone[nearest[led]]
    blind = ~is_visible.any(axis=1)
    led = np.isfinite(distance).any(axis=0)
    distance[blind] = np.where(led, straight[blind], np.inf)
    no_path = ~np.isfinite(distance) & led
    distance[no_path] = straight[no_path] + APART
    return distance


def _farthest(
    straight: NDArray[np.float64], is_visible: NDArray[np.bool_], reach: float
) -> NDArray[np.float64]:
    """Return from how far each bone is seen, (b,)."""
    return np.array(
        [
            reach * np.percentile(to_bone[sees], NEAR_SHARE) if sees.any() else 0.0
            for to_bone, sees in zip(straight, is_visible, strict=True)
        ]
    )


def _along_edges(body: Body) -> csr_array:
    one, other = find_edges(body.faces).edges.T
    length = np.linalg.norm(body.points[one] - body.points[other], axis=1)
    return coo_array((length, (one, other)), shape=(len(body.points),) * 2).tocsr()
