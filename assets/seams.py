"""Sharp borders between colours: mesh edges are laid along them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .body import Body
from .meshing import onto_surface, relaxed
from .remesh import collapse_short_edges, edges_of, flip_thin


def with_seams(
    body: Body, vertices: NDArray, faces: NDArray, detail: float = 1.0
) -> tuple[NDArray, NDArray, NDArray]:
    """Move vertices onto the borders of the body's colours, so that faces do not cross them.

    Of every edge between two colours, the end nearer to the border moves there.

    Returns
    -------
    vertices : array, shape (n, 3)
    faces : array, shape (m, 3)
    colours : array, shape (m,), str
        Each face's colour.
    """
    # Twice: vertices that came too close to each other on a border are joined in between.
    vertices, _, _ = _snapped(body, vertices, faces)
    wanted = detail * body.edge_length(vertices)
    vertices, faces, _ = collapse_short_edges(vertices, faces, 0.5 * wanted)
    vertices, labels, pinned = _snapped(body, vertices, faces)
    colours = _face_colours(body, vertices, faces, labels, pinned)
    wanted = detail * body.edge_length(vertices)
    for _ in range(4):
        free = onto_surface(body, relaxed(vertices, faces, wanted))
        vertices = np.where(pinned[:, None], vertices, free)
    faces, colours = flip_thin(vertices, faces, colours)
    return vertices, faces, colours


def _snapped(body: Body, vertices: NDArray, faces: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Return the vertices moved, their colours before, and which are on a border now."""
    labels = body.colours(vertices)
    edges, _ = edges_of(faces)
    edges = edges[labels[edges[:, 0]] != labels[edges[:, 1]]]
    fraction = _border(body, vertices, edges, labels)
    near = np.where(fraction < 0.5, edges[:, 0], edges[:, 1])
    a, b = vertices[edges[:, 0]], vertices[edges[:, 1]]
    goal = a + fraction[:, None] * (b - a)
    uses = np.bincount(near, minlength=len(vertices))
    pinned = uses > 0
    vertices = vertices.copy()
    for k in range(3):
        total = np.bincount(near, goal[:, k], len(vertices))
        vertices[pinned, k] = total[pinned] / uses[pinned]
    return onto_surface(body, vertices), labels, pinned


def _border(body: Body, vertices: NDArray, edges: NDArray, labels: NDArray) -> NDArray:
    """Return how far along each edge its first end's colour reaches, by halving."""
    low, high = np.zeros(len(edges)), np.ones(len(edges))
    a, b = vertices[edges[:, 0]], vertices[edges[:, 1]]
    for _ in range(8):
        middle = (low + high) / 2
        same = body.colours(a + middle[:, None] * (b - a)) == labels[edges[:, 0]]
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return (low + high) / 2


def _face_colours(
    body: Body, vertices: NDArray, faces: NDArray, labels: NDArray, pinned: NDArray
) -> NDArray:
    free = ~pinned[faces]
    corner = free.argmax(axis=1)
    colours = labels[faces[np.arange(len(faces)), corner]]
    # A triangle with all corners on borders has the colour of its middle.
    rest = ~free.any(axis=1)
    if rest.any():
        colours[rest] = body.colours(vertices[faces[rest]].mean(axis=1))
    return colours
