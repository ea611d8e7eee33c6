"""A cut-cell graph in the paper's colours: mesh blue, interior orange, surface green."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from cutcell.graph import INTERIOR, MESH, SURFACE, CutCellGraph
from cutcell.rig import Rig

from . import palette
from .character import to_scene
from .description import Actor, Cut, Description
from .distance_scene import distance_limits, shown_distance

LAYERS = {"mesh edges": MESH, "interior edges": INTERIOR, "surface edges": SURFACE}
"""The names of the three actors, and the kind of edge that each shows."""

AXES = {"x": 0, "y": 1, "z": 2}


def graph_scene(
    rig: Rig,
    graph: CutCellGraph,
    *,
    layers: tuple[str, ...] = tuple(LAYERS),
    field: ArrayLike | None = None,
    kinds: tuple[int, ...] = (INTERIOR,),
    shades: str = "distance",
    cut: Cut | None = None,
    slab: float = 0.0,
    theme: palette.Theme = palette.LIGHT,
) -> Description:
    """Return the scene of a graph.

    Parameters
    ----------
    rig : Rig
        What the graph was built from; says which way is up.
    graph : CutCellGraph
    layers : tuple of str
        Which of `LAYERS` are seen.
    field : array_like, shape (N,), optional
        A distance at every node: edges are then coloured by it.
    kinds : tuple of int
        The kinds of edges that are.
    shades : str
        The colour map that it is shown with.
    cut : Cut, optional
        Takes away what lies before it, so that the interior is seen.
    slab : float
        With a cut, show interior edges only this far behind it, in the scene's units;
        0 shows all.
    theme : Theme

    Returns
    -------
    Description
        With the actors "mesh edges", "interior edges" and "surface edges".
    """
    nodes = to_scene(rig, graph.lattice.to_file(graph.nodes)).astype(np.float32)
    colors = (theme.mesh_edge, palette.INTERIOR, palette.SURFACE)
    actors = {}
    for (name, kind), color in zip(LAYERS.items(), colors, strict=True):
        edges = graph.edges[graph.edge_kind == kind]
        used, cells = np.unique(edges, return_inverse=True)
        scalars, limits = None, (0.0, 1.0)
        if field is not None and kind in kinds:
            limits = distance_limits(field)
            scalars = shown_distance(np.asarray(field)[used], limits)
        actors[name] = Actor(
            "lines",
            nodes[used],
            cells.reshape(-1, 2).astype(np.int32),
            color=color,
            scalars=scalars,
            colormap=shades,
            limits=limits,
            visible=name in layers,
            slab=slab if kind == INTERIOR else 0.0,
        )
    return Description(actors, cut=cut)


def depth_field(graph: CutCellGraph) -> NDArray[np.float64]:
    """Return how far each node lies below the surface, shape (N,), in unit-cube lengths."""
    inner = graph.node_kind == INTERIOR
    depth = np.zeros(len(graph.nodes))
    if inner.any():
        depth[inner] = cKDTree(graph.nodes[~inner]).query(graph.nodes[inner])[0]
    return depth


def cut_at(bounds: NDArray[np.float64], axis: str, position: float) -> Cut:
    """Return a plane across a box.

    Parameters
    ----------
    bounds : array, shape (2, 3)
    axis : {"x", "y", "z"}
        What the plane is perpendicular to; the larger side is taken away.
    position : float
        From 0, the lower end of the box, to 1, the upper.
    """
    k = AXES[axis]
    low, high = np.asarray(bounds, float)
    origin = (low + high) / 2
    origin[k] = low[k] + position * (high[k] - low[k])
    normal = tuple(float(k == i) for i in range(3))
    return Cut(tuple(origin.tolist()), normal)  # type: ignore[arg-type]
