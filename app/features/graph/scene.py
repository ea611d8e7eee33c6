"""The graph inside the character, or one slice of its lattice."""

from dataclasses import replace
from typing import Any

from cutcell.graph import INTERIOR, MESH, SURFACE
from cutcell_viewers.character import to_scene
from cutcell_viewers.description import Actor, Cut, Description, Legend
from cutcell_viewers.distance_scene import distance_legend, distance_limits, file_units
from cutcell_viewers.graph_scene import (
    component_colors,
    depth_field,
    graph_scene,
    nearest_nodes,
    node_marks,
)
from cutcell_viewers.marks import path_tube
from cutcell_viewers.palette import MARK
from cutcell_viewers.ray_slice import RaySlice, slice_rays
from cutcell_viewers.slice_scene import file_axis, slice_place, slice_scene

from ...document.framing import theme_of
from ...document.state import State
from ...looks.character import GRAPH_BODY_OPACITY, cells_of, character, cut_of
from ...looks.paths import path_of
from ...looks.section import field_section, winding_section
from .choices import LAYERS

FACE_OPACITY = 0.82
"""Opacity of the face of a cut, so that the edges behind it are visible."""
FACE_CELLS = 1.5
"""Thickness of the face of a cut: one or two layers of the lattice."""
KINDS = {
    "mesh_edges": "mesh: thin lines, balls",
    "interior_edges": "interior: thick lines, squares",
    "surface_edges": "surface: dashed lines, triangles",
}
"""Kinds of edges, and the look of these and of their nodes."""
X_RAY = 0.5
"""Opacity of edges inside a whole body, which else merge into one orange blob."""
SHELL = 0.5
"""Opacity of the body behind a slice."""


def scene(state: State) -> Description:
    """Return the scene of the panel Graph: the layers of the graph, or a slice's rays."""
    if state.slicing:
        return _slice(state)
    cut = cut_of(state)
    thick = (0.0, 0.0) if cut is None else slab_of(state)
    actors = character(state, visible=state.body, opacity=body_opacity(state))
    layers, legend = graph_layers(state)
    actors |= layers
    if cut is not None and state.graph is not None:
        face, legend = _face(state, cut, legend)
        actors |= face
    graph = state.shown_graph
    if state.node is not None and graph is not None and state.node < len(graph.nodes):
        inputs = (state.rig, graph, state.node, state.dark)
        actors |= state.memo("node", inputs, lambda: node_marks(*inputs[:3], theme_of(state)))
    path = sight_of(state)
    if path is not None and len(path):
        places = to_scene(state.rig, state.graph.lattice.to_file(path))
        actors["path"] = state.memo("sight", (path,), lambda: path_tube(state.rig, places))
        hint = f"lines of sight that vertex {state.vertex:,} is measured along"
        swatches = ((MARK, hint), *(() if legend is None else legend.swatches))
        legend = replace(legend or Legend(_title(state)), swatches=swatches)
    for name, actor in actors.items():
        if actor.clipped:
            slab = thick[0] if name.startswith("interior") else thick[1]
            actors[name] = replace(actor, slab=slab)
    return Description(actors, cut=cut, legend=legend)


def graph_layers(state: State) -> tuple[dict[str, Actor], Legend | None]:
    """Return the graph's actors, and the legend of their colours."""
    rig, graph, theme = state.rig, state.shown_graph, theme_of(state)
    if graph is None:
        return {}, None
    field, style, legend = _field(state)
    drawn = state.memo(
        "graph",
        (rig, graph, theme.name, field, style.get("shades", ""), style.get("colors")),
        lambda: graph_scene(rig, graph, theme=theme, field=field, **style).actors,
    )
    is_whole = state.cut_across == "off" and state.edge_colors == "kind"
    layers = {}
    for layer, name in LAYERS.items():
        visible, nodes = getattr(state, layer), name.replace("edges", "nodes")
        if name in drawn:
            opacity = X_RAY if is_whole and name == "interior edges" else 1.0
            layers[name] = replace(drawn[name], visible=visible, opacity=opacity)
        if nodes in drawn and nodes != name:
            layers[nodes] = replace(drawn[nodes], visible=state.nodes and visible)
    return layers, legend


def _face(state: State, cut: Cut, legend: Legend | None) -> tuple[dict[str, Actor], Legend | None]:
    """Return the face of the cut, if one is chosen, and the legend with its colours."""
    swatches = () if legend is None else legend.swatches
    if state.graph_face == "winding":
        face, legend = winding_section(state, cut)
        legend = replace(legend, swatches=(*swatches, *legend.swatches))
    elif state.graph_face == "field" and (field := state.field) is not None:
        limits = distance_limits(field)
        face = field_section(state, cut, field, limits)
        legend = replace(distance_legend(state.rig, state.joint, limits), swatches=swatches)
    else:
        return {}, legend
    return {**face, "inside": replace(face["inside"], opacity=FACE_OPACITY)}, legend


def sight_of(state: State) -> Any:
    """Return the straight pieces of the path to the chosen vertex (p, 3), or None."""
    return path_of(state) if state.connectivity == "any" else None


def _field(state: State) -> tuple[Any, dict[str, Any], Legend | None]:
    """Return the colouring of edges: values at nodes, options of `graph_scene`, the legend."""
    graph = state.shown_graph
    if state.edge_colors == "depth":
        depth = state.memo("depth", (graph,), lambda: depth_field(graph))
        most = distance_limits(depth)[1]
        legend = Legend("Depth below the surface", "depth", "0", file_units(most, state.rig))
        return depth, {"shades": "depth"}, legend
    if state.edge_colors == "component":
        colors, count = state.memo("parts", (graph,), lambda: component_colors(graph))
        legend = Legend(f"{count:,} connected component{'s' * (count != 1)}")
        return None, {"colors": colors}, legend
    field = state.field if state.edge_colors == "distance" else None
    if field is None:
        return None, {}, kinds_legend(state)
    legend = distance_legend(state.rig, state.joint, distance_limits(field))
    if graph is not state.graph:
        of_weights = field
        nearest = state.memo(
            "nearest", (graph, state.graph), lambda: nearest_nodes(graph, state.graph)
        )
        field = state.memo("field there", (field, nearest), lambda: of_weights[nearest])
    return field, {"kinds": (MESH, INTERIOR, SURFACE)}, legend


def kinds_legend(state: State) -> Legend | None:
    """Return the legend of the visible layers of edges."""
    colored = zip(theme_of(state).edges, KINDS.items(), strict=True)
    layers = tuple((color, text) for color, (name, text) in colored if getattr(state, name))
    return Legend(_title(state), swatches=layers) if layers else None


def _title(state: State) -> str:
    resolution = state.graph_resolution or state.resolution
    other = "" if resolution == state.resolution else f" (weights: {state.resolution})"
    return f"Graph, R = {resolution}{other}"


def body_opacity(state: State) -> float:
    """Return the opacity of the body, which is transparent if it would hide the graph."""
    whole = state.cut_across == "off"
    looks_inside = whole and (state.interior_edges or state.surface_edges)
    return GRAPH_BODY_OPACITY if looks_inside and state.shown_graph is not None else 1.0


def slab_of(state: State) -> tuple[float, float]:
    """Return the thickness behind the cut of the interior and of the rest; 0 is unlimited."""
    if state.shown_graph is None or state.cut_keeps == "half":
        return 0.0, 0.0
    if state.cut_keeps == "face":
        return cells_of(state, FACE_CELLS), 0.0
    return (cells_of(state, state.slab * state.shown_graph.lattice.resolution),) * 2


def _slice(state: State) -> Description:
    """Return the scene of one slice: its rays, and the body behind it."""
    rig, theme = state.rig, theme_of(state)
    resolution = state.graph_resolution or state.resolution
    normal, index, cut = slice_place(rig, state.slice_axis, state.slice_position, resolution)
    axis, _ = file_axis(rig, state.slice_rays)
    options = {
        "axis": (normal + 1) % 3 if axis == normal else axis,
        "normal": normal,
        "index": index,
        "winding_threshold": state.winding_threshold,
        "orient": state.orient,
        "fill": state.connectivity != 6,
    }

    def cast(name: str, **libraries: str) -> RaySlice:
        chosen = {**options, **libraries}
        inputs = (rig, resolution, *chosen.values())
        return state.memo(name, inputs, lambda: slice_rays(rig.mesh, resolution, **chosen))

    chosen = {"rays": state.slice_caster, "winding": state.slice_winding}
    is_own = [*chosen.values()] == ["raster", "exact"]
    reference = None if is_own else cast("slice")
    rays = cast("slice") if is_own else cast("slice by libraries", **chosen)
    actors, legend = state.memo(
        "slice scene",
        (rays, reference, theme.name),
        lambda: slice_scene(rig, rays, theme, reference),
    )
    shell = character(state, visible=state.body, opacity=SHELL)
    for name in {"bones", "bone outlines"} & shell.keys():
        shell[name] = replace(shell[name], visible=False)  # they would hide the slice
    return Description({**shell, **actors}, cut=_pulled(cut, state), legend=legend)


def _pulled(cut: Cut, state: State) -> Cut:
    """Move a cut a quarter of a cell back, so that the slice is clear of the body."""
    back = cells_of(state, 0.25)
    origin = tuple(o - back * n for o, n in zip(cut.origin, cut.normal, strict=True))
    return Cut(origin, cut.normal)  # type: ignore[arg-type]
