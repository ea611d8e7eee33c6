"""Selected vertices in the scene: their marks, and the rest hidden."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.editing.selections import Neighbours
from cutcell_viewers.description import Actor
from cutcell_viewers.marks import outline, vertex_dots
from cutcell_viewers.palette import BONE_EDGE
from cutcell_viewers.weights_scene import columns_of

from ..document.selection import selected
from ..document.state import State
from .histogram import in_bars

OUTLINE_WIDTH = 1.5
"""In pixels of the screen."""


def neighbours_of(state: State) -> Neighbours:
    """Return the neighbours of the vertices of the open character."""
    mesh = state.rig.mesh
    neighbours: Neighbours = state.memo("neighbours", (mesh,), lambda: Neighbours.of(mesh))
    return neighbours


def selection_marks(state: State, body: Actor) -> dict[str, Actor]:
    """Return dots on the selected vertices, or on those of the chosen bars of the histogram."""
    chosen = in_bars(state)
    chosen = selected(state) if chosen is None else chosen
    if chosen is None or not chosen.any():
        return {}
    inputs = body.points, body.normals, body.skin, chosen
    dots = state.memo("selection", inputs, lambda: vertex_dots(body, np.flatnonzero(chosen)))
    return {"selection": dots}


def isolated(state: State, actors: dict[str, Actor]) -> dict[str, Actor]:
    """Return actors of which only triangles with selected vertices are visible."""
    chosen = selected(state) if state.isolated else None
    if chosen is None:
        return actors
    bodies = {name: actor for name, actor in actors.items() if name in ("body", "part")}
    for name, body in bodies.items():
        inputs = body.cells, chosen
        cells = state.memo(f"isolated {name}", inputs, lambda: _within(body.cells, chosen))  # noqa: B023
        bodies[name] = replace(body, cells=cells, closed=False)
    others = {name: one for name, one in actors.items() if not name.startswith("attachment")}
    return {**others, **bodies}


def _within(cells: NDArray[Any], chosen: NDArray[np.bool_]) -> NDArray[Any]:
    return np.ascontiguousarray(cells[chosen[cells].any(axis=1)])


def outlined(state: State, body: Actor, weights: Any, colors: str) -> dict[str, Actor]:
    """Return an outline of the vertices that follow the chosen joint, where its weight is shown."""
    if colors != "bone" or not state.weight_outline:
        return {}
    inputs = body.points, body.cells, weights, state.joint

    def make() -> Actor:
        welded = neighbours_of(state).welded
        inside = columns_of(weights, [state.joint])[:, 0] > 0
        return outline(body, welded, inside, color=BONE_EDGE, width=OUTLINE_WIDTH)

    lines = state.memo("weight outline", inputs, make)
    return {"weight outline": lines} if len(lines.points) else {}
