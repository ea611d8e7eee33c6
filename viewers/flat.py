"""One plane of the lattice as flat data: rays, crossings, pieces, nodes and edges.

The browser draws it and searches it without a server (`app/frontend/flat/scene.js`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.bones.bones import Sources
from cutcell.bones.nearest import NodeGrid
from cutcell.geodesics import Bones
from cutcell.geodesics.shortest_paths import shortest_paths
from cutcell.geodesics.solver import find_sources
from cutcell.geometry.welded import WeldedMesh
from cutcell.graph import MESH, SURFACE, CutCellGraph, build_graph
from cutcell.method import Method
from cutcell.rig import Rig

from .character import lattice_to_scene
from .distance_scene import unit_of
from .plane_section import plane_outline
from .ray_slice import RaySlice, slice_rays
from .slice_scene import file_axis, slice_place

MAX_NODES = 2000
MIN_RESOLUTION = 8
LOOKS = {"x": ("z", -1, "y", 1), "y": ("x", 1, "z", -1), "z": ("x", 1, "y", 1)}
"""By the plane's normal: the axis to the right and its direction, the axis up and its direction."""
DIGITS = 9
"""Decimals of positions that are drawn, and of winding numbers near integers. Others are exact."""


@dataclass(frozen=True, eq=False)
class FlatSection:
    """The part of a graph in one plane of its lattice, with the corners tied to it.

    Parameters
    ----------
    graph : CutCellGraph
        These nodes and edges alone, in the unit cube: corners of triangles, lattice points and
        crossings of the rays in the plane. Its `interior` remains that of the whole graph.
    rays : list of RaySlice
        Rays to the right, and rays upward.
    sources : Sources
        Nodes where the distances of the bones begin; none without bones.
    bones : Bones or None
        In the unit cube.
    outline : array, shape (s, 2, 3), float64
    origin : array, shape (3,), float64
        A point of the plane.
    axes : tuple of int
        The axes of the unit cube that point to the right and upward.
    flips : tuple of bool
        Whether each of these axes points the other way.
    rig : Rig
    """

    graph: CutCellGraph
    rays: list[RaySlice]
    sources: Sources
    bones: Bones | None
    outline: NDArray[np.float64]
    origin: NDArray[np.float64]
    axes: tuple[int, int]
    flips: tuple[bool, bool]
    rig: Rig

    def distances(self) -> NDArray[np.float64]:
        """Compute the distance of the bones at each node along these edges alone, shape (N,)."""
        if not len(self.graph.edges):
            return np.full(len(self.graph.nodes), np.inf)
        every = np.arange(len(self.graph.nodes), dtype=np.int32)
        joined = replace(self.sources, bone=np.zeros_like(self.sources.bone))
        return shortest_paths(self.graph, joined, 1, every)[0]

    def flat(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return places in the picture (..., 2) of points (..., 3) of the unit cube."""
        chosen = points[..., self.axes]
        return np.where(self.flips, 1 - chosen, chosen)

    def data(self) -> dict[str, Any]:
        """Return the section as JSON values for the browser; see `app/frontend/flat/scene.js`."""
        graph, outline = self.graph, self.flat(self.outline)
        margin = 1 / graph.lattice.resolution
        whole = self.flat(graph.lattice.to_unit(self.rig.mesh.bounds))
        corners = outline.reshape(-1, 2) if len(outline) else whole
        box = np.array([corners.min(axis=0) - margin, corners.max(axis=0) + margin])
        place = self.flat(graph.nodes)
        order = np.argsort(self.sources.bone, kind="stable")
        sources = zip(
            self.sources.node[order].tolist(), self.sources.distance[order].tolist(), strict=True
        )
        return {
            "resolution": graph.lattice.resolution,
            "tau": graph.winding_threshold,
            "size": graph.lattice.size,
            "unit": unit_of(self.rig),
            "box": box.round(DIGITS).ravel().tolist(),
            "frame": self._frame(),
            "outline": outline.reshape(-1, 4).round(DIGITS).tolist(),
            "rays": [ray for way in (0, 1) for ray in self._rays(way, box)],
            "nodes": place.round(DIGITS).tolist(),
            "kinds": graph.node_kind.tolist(),
            "edges": graph.edges.tolist(),
            "edgeKinds": graph.edge_kind.tolist(),
            "lengths": graph.lengths.tolist(),
            "sources": list(map(list, sources)),
            "bones": [] if self.bones is None else self._segments(self.bones),
        }

    def _segments(self, bones: Bones) -> list[list[float]]:
        ends = self.flat(np.stack([bones.start, bones.end], axis=1))
        return ends.reshape(-1, 4).round(DIGITS).tolist()  # type: ignore[no-any-return]

    def _frame(self) -> dict[str, list[float]]:
        """Return the scene's point at the picture's origin, and the steps to the right and up."""
        points = np.tile(self.origin, (3, 1))
        points[:, self.axes] = np.abs(np.array([[0, 0], [1, 0], [0, 1]]) - self.flips)
        origin, right, up = lattice_to_scene(self.rig, self.graph.lattice, points)
        return {
            name: at.tolist()
            for name, at in (("origin", origin), ("right", right - origin), ("up", up - origin))
        }

    def _rays(self, way: int, box: NDArray[np.float64]) -> list[dict[str, Any]]:
        """Return the rays to the right (0) or upward (1) that come near the body."""
        rays, is_flipped = self.rays[way], self.flips[way]
        low, high, hit = (self.flat(points) for points in (rays.low, rays.high, rays.crossing))
        low, high = (high, low) if is_flipped else (low, high)
        middle = (low + high) / 2
        near = ((middle > box[0]) & (middle < box[1])).all(axis=1)
        result = []
        for at in np.unique(low[near][:, 1 - way].round(DIGITS)):
            on_ray = np.flatnonzero(near & (np.abs(low[:, 1 - way] - at) < 1e-6))
            crossed = np.flatnonzero(np.abs(hit[:, 1 - way] - at) < 1e-6)
            if is_flipped:
                on_ray, crossed = on_ray[::-1], crossed[::-1]
            number = rays.winding[on_ray]
            number = np.where(np.abs(number - number.round()) < 0.1**DIGITS, number.round(), number)
            ends = np.stack([low[on_ray, way], high[on_ray, way]], axis=1).round(DIGITS)
            # +1 where the ray enters, so that their sum is the winding number.
            step = rays.sign[crossed] * (1 if is_flipped else -1)
            hits = np.stack([hit[crossed, way], step], axis=1)
            result.append(
                {
                    "way": way,
                    "at": float(at),
                    "pieces": np.column_stack([ends, number]).tolist(),
                    "crossings": hits.round(DIGITS).tolist(),
                }
            )
        return result


def flat_section(
    rig: Rig,
    method: Method,
    *,
    axis: str = "z",
    position: float = 0.5,
    bones: Bones | None = None,
) -> FlatSection:
    """Return one plane of the lattice of a character.

    Parameters
    ----------
    rig : Rig
    method : Method
        Its resolution counts, or the largest below it with at most 2,000 nodes in the plane.
    axis : {"x", "y", "z"}
        The plane's normal in the scene.
    position : float
        From 0 to 1 across the box of the faces.
    bones : Bones, optional
        In the unit cube: where distances begin.
    """
    if method.connectivity == "any":
        method = method.with_options(connectivity=6)  # these paths leave the edges
    while True:
        whole = build_graph(rig.mesh, method=method)
        normal, index, _ = slice_place(rig, axis, position, method.resolution)
        part = _part(whole, normal, (index + 0.5) / method.resolution)
        count = len(part.nodes)
        if count <= MAX_NODES or method.resolution <= MIN_RESOLUTION:
            break
        coarser = int(0.97 * method.resolution * np.sqrt(MAX_NODES / count))
        coarser = min(max(coarser, MIN_RESOLUTION), method.resolution - 1)
        method = method.with_options(resolution=coarser)
    right, to_right, up, upward = LOOKS[axis]
    (first, one), (second, other) = file_axis(rig, right), file_axis(rig, up)
    options: Any = {
        "normal": normal,
        "index": index,
        "winding_threshold": method.winding_threshold,
        "orient": method.orient,
    }
    rays = [slice_rays(rig.mesh, method.resolution, axis=a, **options) for a in (first, second)]
    vertices, origin = whole.nodes[: whole.first_point], np.zeros(3)
    origin[normal] = (index + 0.5) / method.resolution
    outline = plane_outline(vertices, whole.faces, origin, np.eye(3)[normal])
    flips = one * to_right < 0, other * upward < 0
    sources = _sources(part, bones, method.samples)
    return FlatSection(part, rays, sources, bones, outline, origin, (first, second), flips, rig)


def _part(graph: CutCellGraph, normal: int, level: float) -> CutCellGraph:
    """Return a graph of the nodes in a plane and of the corners of triangles tied to them."""
    chosen = (graph.node_kind != MESH) & (np.abs(graph.nodes[:, normal] - level) < 1e-9)
    crossings = np.flatnonzero(chosen & (graph.node_kind == SURFACE))
    chosen[graph.faces[graph.triangle[crossings]]] = True
    edges = chosen[graph.edges].all(axis=1)
    number = np.cumsum(chosen, dtype=np.int32) - 1
    corners = int(chosen[: graph.first_point].sum())
    return replace(
        graph,
        nodes=graph.nodes[chosen],
        node_kind=graph.node_kind[chosen],
        edges=number[graph.edges[edges]],
        lengths=graph.lengths[edges],
        edge_kind=graph.edge_kind[edges],
        triangle=graph.triangle[chosen],
        mesh=WeldedMesh.of(graph.nodes[chosen][:corners], graph.faces),
    )


def _sources(graph: CutCellGraph, bones: Bones | None, samples: int) -> Sources:
    """Return the nodes of a plane that are nearest to the bones' samples."""
    if bones is None or not len(graph.edges):
        none = np.empty(0, np.int32)
        return Sources(none, none, np.empty(0))
    return find_sources(graph, bones, samples, NodeGrid.of(graph))
