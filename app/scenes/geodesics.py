"""The distance from the chosen bone: the field, where it begins, and the shortest path to it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from cutcell.geodesics import path_length, shortest_path
from cutcell_viewers.character import to_scene
from cutcell_viewers.description import Actor, Cut, Description, Legend
from cutcell_viewers.distance_scene import distance_colors, distance_limits
from cutcell_viewers.marks import path_tube
from cutcell_viewers.palette import BODY, MARK, SOURCE
from cutcell_viewers.section_scene import section, section_rays, section_resolution
from cutcell_viewers.slice_scene import slice_place
from cutcell_viewers.start_scene import first_distances, start_scene

from ..state import State
from .common import character, theme_of
from .memo import Memo

SEE_PATH = 0.42
"""How opaque the body is while something inside it is to be seen."""


def geodesics(state: State, memo: Memo) -> Description:
    """Return the scene of the panel Geodesics: a bone's field, on the surface and inside."""
    if state.binding is None:
        return Description(character(state, memo))
    normal, index, cut = _cut(state)
    if not has_field(state):
        return Description(character(state, memo), cut=cut)
    colors, legend, limits = _surface(state, memo)
    path = path_of(state, memo)
    inside = (path is not None and len(path) > 0) or state.starts
    see = SEE_PATH if inside and cut is None else 1.0
    actors = character(state, memo, **colors, film=state.wave, opacity=see)
    swatches = legend.swatches
    if cut is not None:
        actors |= _section(state, memo, normal, index, limits)
    if state.starts:
        parts, swatch = _starts(state, memo)
        actors |= parts
        swatches += (swatch,)
    if path is not None and not len(path):
        swatches += ((MARK, "no path leads from the vertex to the bone"),)
    elif path is not None:
        rig = state.rig
        actors["path"] = memo("tube", (rig, path), lambda: path_tube(rig, _in_scene(state, path)))
        swatches += ((MARK, f"shortest path, {path_length(path):.3f} long"),)
    if state.wave:
        swatches += ((BODY, "not reached yet"),)
    front = state.front * limits[1] if state.wave else None
    return Description(actors, cut=cut, legend=replace(legend, swatches=swatches), front=front)


def _surface(state: State, memo: Memo) -> tuple[dict[str, Any], Legend, tuple[float, float]]:
    """Return the colours of the body, the legend and the field's limits.

    The vertices' distances are known at once; those inside follow, and may reach farther.
    """
    rig, binding, joint, field = state.rig, state.binding, state.joint, field_of(state)

    def make() -> tuple[dict[str, Any], Legend, tuple[float, float]]:
        if field is None:
            known = binding.distances.joint[joint]
            limits = distance_limits(known)
        else:
            known, limits = field[binding.graph.vertex_node], distance_limits(field)
        return *distance_colors(rig, known, joint, limits), limits

    return memo("distance", (rig, binding.distances, field, joint), make)


def _cut(state: State) -> tuple[int, int, Cut | None]:
    """Return the cut, along the lattice's own axes, so that rays lie in its plane."""
    if state.cut_axis == "off":
        return 0, 0, None
    return slice_place(
        state.rig, state.cut_axis, state.cut_position, section_resolution(state.binding.graph)
    )


def _section(
    state: State, memo: Memo, normal: int, index: int, limits: tuple[float, float]
) -> dict[str, Actor]:
    """Return the inside of the cut; nothing before the field is there."""
    rig, graph, field = state.rig, state.binding.graph, field_of(state)
    if field is None:
        return {}
    tau, orient = state.winding_threshold, state.orient
    rays = memo(
        "section rays",
        (rig, graph, normal, index, tau, orient),
        lambda: section_rays(rig, graph, normal, index, tau, orient),
    )
    inside = memo("section", (rays, field), lambda: section(rig, graph, rays, normal, field))
    return {"inside": replace(inside, colormap="distance", limits=limits, film=state.wave)}


def _starts(state: State, memo: Memo) -> tuple[dict[str, Actor], tuple[Any, str]]:
    """Return the samples and sources, and what to write about them."""
    rig, distances, joint, theme = state.rig, state.binding.distances, state.joint, theme_of(state)
    parts = memo(
        "starts",
        (rig, distances, joint, theme.name),
        lambda: start_scene(rig, distances, joint, theme),
    )
    first = first_distances(distances, joint)
    most = float(first.max(initial=0))
    return parts, (SOURCE, f"{len(first)} sources, up to {most:.3f} from the bone")


def path_of(state: State, memo: Memo) -> Any:
    """Return the shortest path from the clicked vertex to the bone (p, 3), or None."""
    field = field_of(state)
    if not state.path or state.vertex is None or field is None:
        return None
    distances, joint, vertex = state.binding.distances, state.joint, state.vertex
    return memo(
        "path",
        (distances, joint, vertex, field),
        lambda: shortest_path(distances, joint, vertex, field),
    )


def _in_scene(state: State, path: np.ndarray) -> np.ndarray:
    return to_scene(state.rig, state.binding.graph.lattice.to_file(path))


def has_field(state: State) -> bool:
    """Whether the chosen bone has distances: it was bound, and may carry weight."""
    return state.binding is not None and bool(state.rig.skeleton.deform[state.joint])


def wants_field(state: State) -> bool:
    """Whether the distance is to be known at every node of the graph."""
    wanted = state.panel == "geodesics" or (
        state.panel == "graph"
        and (state.edge_colors == "distance" or (state.vertex is not None and state.path))
    )
    return wanted and has_field(state)


def field_of(state: State) -> Any:
    """Return the distance at every graph node, shape (N,), if it is there."""
    if state.field is None:
        return None
    distances, joint, field = state.field
    current = state.binding is not None and distances is state.binding.distances
    return field if current and joint == state.joint else None
