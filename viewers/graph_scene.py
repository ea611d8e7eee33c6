"""A cut-cell graph in the paper's colours: mesh blue, interior orange, surface green."""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from cutcell.graph import INTERIOR, MESH, SURFACE, CutCellGraph
from cutcell.rig import Rig

from . import palette
from .character import cell_length, lattice_to_scene
from .description import Actor, Cut, Description, Reading
from .distance_scene import distance_limits, shown_distance

THICK = (0.08, 0.07, 0.16)
"""The radii of mesh, interior and surface edges, in the length of most edges of their kind."""
DASH = 0.3
"""Surface edges are dashed: the length of a dash and its gap, in the same unit."""
NODES = {"mesh nodes": MESH, "interior nodes": INTERIOR, "surface nodes": SURFACE}
"""The names of the actors of nodes, and the kind that each shows."""
FORMS: tuple[Literal["round", "square", "triangle"], ...] = ("round", "square", "triangle")
"""Shapes of mesh, interior and surface nodes."""
NODE_THICK = (0.12, 0.09, 0.16)
"""The radii of mesh nodes, in the length of most mesh edges, and of the others, in cells."""
WIDTH, NODE_WIDTH = 1.5, 4.0
"""A sixth of the pixels that lines and points are wide at most."""
KINDS = ("mesh", "interior", "surface")
"""Names of the kinds of nodes and edges."""

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
    colors: ArrayLike | None = None,
    cut: Cut | None = None,
    slab: float = 0.0,
    theme: palette.Theme = palette.LIGHT,
) -> Description:
    """Return the scene of a graph.

    Parameters
    ----------
    rig : Rig
        The rig that the graph was built from.
    graph : CutCellGraph
    layers : tuple of str
        The visible ones of `LAYERS`.
    field : array_like, shape (N,), optional
        A distance at every node: edges are then coloured by it.
    kinds : tuple of int
        The kinds of edges that are coloured by it.
    shades : str
        The colour map of the field.
    colors : array_like, shape (N, 3), uint8, optional
        A colour for every node: edges of all kinds are then coloured by it.
    cut : Cut, optional
        Clips the near side, so that the interior is visible.
    slab : float
        With a cut, show interior edges only this far behind it, in the scene's units;
        0 shows all.
    theme : Theme

    Returns
    -------
    Description
        With the actors "mesh edges", "interior edges" and "surface edges", thin, thick and dashed,
        and "mesh nodes", "interior nodes" and "surface nodes", hidden: balls, squares, triangles.
    """
    nodes = lattice_to_scene(rig, graph.lattice, graph.nodes).astype(np.float32)
    cell = cell_length(rig, graph.lattice)
    spacing = {kind: _usual_length(nodes, graph, kind) for kind in LAYERS.values()}
    point_colors = None if colors is None else np.asarray(colors, np.uint8)
    actors = {}
    for (name, kind), color in zip(LAYERS.items(), theme.edges, strict=True):
        edges = graph.edges[graph.edge_kind == kind]
        used, cells = np.unique(edges, return_inverse=True)
        scalars, limits = None, (0.0, 1.0)
        if field is not None and kind in kinds:
            limits = distance_limits(field)
            scalars = shown_distance(np.asarray(field)[used], limits)
        actors[name] = Actor(
            "lines",
            nodes[used],
            cells.reshape(-1, 2),
            color=color,
            colors=None if point_colors is None else point_colors[used],
            scalars=scalars,
            colormap=shades,
            limits=limits,
            width=WIDTH,
            thick=THICK[kind] * spacing[kind],
            dash=DASH * spacing[kind] if kind == SURFACE else 0.0,
            visible=name in layers,
            slab=slab if kind == INTERIOR else 0.0,
        )
    for (name, kind), color in zip(NODES.items(), theme.edges, strict=True):
        which = np.flatnonzero((graph.node_kind == kind) & graph.connected)
        actors[name] = Actor.dots(
            nodes[which],
            clipped=True,
            color=color,
            colors=None if point_colors is None else point_colors[which],
            width=NODE_WIDTH,
            thick=NODE_THICK[kind] * (spacing[kind] if kind == MESH else cell),
            form=FORMS[kind],
            reading=Reading(f"{KINDS[kind]} node ", which),
            visible=False,
        )
    return Description(actors, cut=cut)


def _usual_length(nodes: NDArray[np.float32], graph: CutCellGraph, kind: int) -> float:
    ends = nodes[graph.edges[graph.edge_kind == kind]]
    return float(np.median(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1))) if len(ends) else 0.0


def nearest_nodes(graph: CutCellGraph, other: CutCellGraph) -> NDArray[np.intp]:
    """Return for each node of a graph the nearest node of another one, shape (N,)."""
    tree = cKDTree(other.lattice.to_file(other.nodes[other.connected]))
    near = tree.query(graph.lattice.to_file(graph.nodes))[1]
    return np.flatnonzero(other.connected)[near]


def component_colors(graph: CutCellGraph) -> tuple[NDArray[np.uint8], int]:
    """Return a colour (N, 3) for each node by its connected component, and their number.

    The largest components have distinct colours.
    """
    count, label = connected_components(graph.csr(), directed=False)
    rank = np.empty(count, int)
    rank[np.argsort(-np.bincount(label, minlength=count), kind="stable")] = np.arange(count)
    colors = np.array(palette.JOINT_COLORS, np.uint8)
    used = np.bincount(label[graph.connected], minlength=count) > 0
    return colors[rank[label] % len(colors)], int(used.sum())


def node_marks(rig: Rig, graph: CutCellGraph, node: int, theme: palette.Theme) -> dict[str, Actor]:
    """Return the mark of a node, the edges that lead from it, and the nodes they lead to."""
    indptr, indices, _ = graph.adjacency
    ring = np.asarray(indices[indptr[node] : indptr[node + 1]])
    points = lattice_to_scene(rig, graph.lattice, graph.nodes[[node, *ring]])
    cell, ink = cell_length(rig, graph.lattice), theme.ink
    ends = np.stack([np.broadcast_to(points[:1], points[1:].shape), points[1:]], axis=1)
    reading = Reading("node ", ring)
    return {
        "node ring": Actor.segments(ends, color=ink, width=2.5, thick=0.03 * cell, overlay=True),
        "node neighbours": Actor.dots(
            points[1:], color=ink, width=7, thick=0.1 * cell, reading=reading, overlay=True
        ),
        "node": Actor.dots(
            points[:1], color=palette.MARK, width=12, thick=0.12 * cell, overlay=True
        ),
    }


def depth_field(graph: CutCellGraph) -> NDArray[np.float64]:
    """Return the depth of each node below the surface, shape (N,), in unit-cube lengths."""
    inner = graph.node_kind == INTERIOR
    depth = np.zeros(len(graph.nodes))
    if inner.any():
        depth[inner] = cKDTree(graph.nodes[~inner]).query(graph.nodes[inner])[0]
    return depth


def cut_at(bounds: NDArray[np.float64], axis: str | ArrayLike, position: float) -> Cut:
    """Return a plane across a box.

    Parameters
    ----------
    bounds : array, shape (2, 3)
    axis : {"x", "y", "z"} or array_like, shape (3,)
        The plane's normal, whose side is cut away.
    position : float
        From 0, the lower end of the box, to 1, the upper.
    """
    normal = np.eye(3)[AXES[axis]] if isinstance(axis, str) else np.asarray(axis, float)
    middle, half = box_across(bounds, normal)
    origin = middle + (2 * position - 1) * half * normal
    return Cut(tuple(origin.tolist()), tuple(normal.tolist()))


def box_across(
    bounds: NDArray[np.float64], normal: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """Return the middle of a box, and its half extent along a direction."""
    low, high = np.asarray(bounds, float)
    return (low + high) / 2, float(np.abs(normal) @ (high - low)) / 2
