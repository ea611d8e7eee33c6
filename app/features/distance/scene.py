"""The distance from the chosen bone: its field, its sources, and the shortest path to it."""

from dataclasses import replace
from typing import Any

from cutcell_viewers.description import Actor, Description, Legend
from cutcell_viewers.distance_scene import distance_colors, distance_limits, file_units
from cutcell_viewers.marks import path_tube
from cutcell_viewers.palette import BODY, MARK, SOURCE
from cutcell_viewers.start_scene import first_distances, start_scene

from ...document.framing import theme_of
from ...document.state import State
from ...looks.character import BODY_OPACITY_WITH_PATH, character, cut_of, has_field, in_scene
from ...looks.paths import path_of
from ...looks.section import field_section, winding_section
from .measures import side_by_side


def scene(state: State) -> Description:
    """Return the scene of the panel Distance: a bone's field, on the surface and inside."""
    if state.binding is None:
        return Description(character(state))
    if has_field(state) and state.measures:
        return side_by_side(state)
    cut = cut_of(state)
    if cut is not None and state.cut_face == "winding":
        colors, legend, limits = dict[str, Any](), Legend(""), (0.0, 1.0)
    elif has_field(state):
        colors, legend, limits = _surface(state)
    else:
        return Description(character(state), cut=cut)
    path = path_of(state)
    inside = (path is not None and len(path) > 0) or state.starts
    see = BODY_OPACITY_WITH_PATH if inside and cut is None else 1.0
    actors = character(state, **colors, follows_wavefront=state.wave, opacity=see)
    swatches = legend.swatches
    if cut is not None and state.cut_face == "winding":
        face, legend = winding_section(state, cut)
        actors |= face
        swatches = legend.swatches
    elif cut is not None:
        face = field_section(state, cut, state.field, limits)
        actors |= {
            name: replace(actor, follows_wavefront=state.wave) for name, actor in face.items()
        }
    if state.starts and has_field(state):
        parts, swatch = _starts(state)
        actors |= parts
        swatches += (swatch,)
    if path is not None and not len(path):
        swatches += ((MARK, "no path leads from the vertex to the bone"),)
    elif path is not None:
        rig = state.rig
        actors["path"] = state.memo(
            "tube", (rig, path), lambda: path_tube(rig, in_scene(state, path))
        )
        length = state.field[state.binding.graph.vertex_node[state.vertex]]
        swatches += ((MARK, f"shortest path, {file_units(length, rig)}"),)
    if state.wave:
        swatches += ((BODY, "not reached yet"),)
    front = state.front * limits[1] if state.wave else None
    return Description(actors, cut=cut, legend=replace(legend, swatches=swatches), front=front)


def _surface(state: State) -> tuple[dict[str, Any], Legend, tuple[float, float]]:
    """Return the colours of the body, the legend and the field's limits.

    Distances at vertices are available at once; those inside follow and may be larger.
    """
    rig, binding, joint, field = state.rig, state.binding, state.joint, state.field
    end = state.scale_end

    def make() -> tuple[dict[str, Any], Legend, tuple[float, float]]:
        if field is None:
            distances = binding.distances.at(joint, slice(None))
            limits = distance_limits(distances)
        else:
            distances, limits = field[binding.graph.vertex_node], distance_limits(field)
        limits = (limits[0], end or limits[1])
        return *distance_colors(rig, distances, joint, limits), limits

    return state.memo("distance", (rig, binding.distances, field, joint, end), make)


def _starts(state: State) -> tuple[dict[str, Actor], tuple[Any, str]]:
    """Return the samples and sources, and their swatch in the legend."""
    rig, distances, joint, theme = state.rig, state.binding.distances, state.joint, theme_of(state)
    inputs = (rig, distances, joint, theme.name)
    parts = state.memo("starts", inputs, lambda: start_scene(rig, distances, joint, theme))
    first = first_distances(distances, joint)
    most = float(first.max(initial=0))
    return parts, (SOURCE, f"{len(first)} sources, up to {file_units(most, rig)} from the bone")


def farthest(state: State) -> float | None:
    """Return the greatest visible distance, where the wavefront ends; None if none is known."""
    if state.measures:
        measured = [one for name in state.measures if (one := state.measured.get(name)) is not None]
        return max((distance_limits(one.vertices)[1] for one in measured), default=None)
    field = state.field
    return None if field is None else distance_limits(field)[1]


def wants_field(state: State) -> bool:
    """Return whether the scene needs the distance of every node of the graph."""
    if state.panel == "graph":
        has_path = state.vertex is not None and state.path
        has_face = state.cut_across != "off" and state.graph_face == "field"
        is_needed = state.edge_colors == "distance" or has_path or has_face
    else:
        is_needed = state.panel == "distance" and not state.measures
    return is_needed and has_field(state)
