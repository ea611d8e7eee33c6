"""The graph inside the character, or one slice of the lattice that it comes from."""

from dataclasses import replace
from typing import Any

from cutcell import build_graph
from cutcell.graph import INTERIOR, MESH, SURFACE, CutCellGraph
from cutcell.runtime.progress import Progress, silent
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

from ..state import LAYERS, State
from .common import GRAPH_BODY_OPACITY, cells_of, character, cut_of, theme_of
from .distance import field_of, path_of
from .memo import Memo
from .section import field_section, winding_section

FACE_OPACITY = 0.82
"""How opaque the face of a cut is: the edges behind it are to be seen."""
FACE_CELLS = 1.5
"""How many cells behind a cut are its face: one or two layers of the lattice."""
KINDS = {
    "mesh_edges": "mesh: thin lines, balls",
    "interior_edges": "interior: thick lines, squares",
    "surface_edges": "surface: dashed lines, triangles",
}
"""Kinds of edges, and the colours of these and of their nodes."""
X_RAY = 0.5
"""How opaque each edge inside is where nothing is cut."""
SHELL = 0.5
"""How opaque the body is behind a slice."""


def graph(state: State, memo: Memo) -> Description:
    """Return the scene of the panel Graph: the layers of the graph, or a slice's rays."""
    if state.slicing:
        return _slice(state, memo)
    cut = cut_of(state)
    thick = slab_of(state) if cut is not None else {}
    actors = character(state, memo, visible=state.body, opacity=body_opacity(state))
    layers, legend = graph_layers(state, memo)
    actors |= layers
    if cut is not None and state.graph is not None:
        face, legend = _face(state, memo, cut, legend)
        actors |= face
    shown = state.shown_graph
    if state.node is not None and shown is not None and state.node < len(shown.nodes):
        inputs = (state.rig, shown, state.node, state.dark)
        actors |= memo("node", inputs, lambda: node_marks(*inputs[:3], theme_of(state)))
    path = sight_of(state, memo)
    if path is not None and len(path):
        places = to_scene(state.rig, state.graph.lattice.to_file(path))
        actors["path"] = memo("sight", (path,), lambda: path_tube(state.rig, places))
        hint = f"lines of sight that vertex {state.vertex:,} is measured along"
        swatches = ((MARK, hint), *(() if legend is None else legend.swatches))
        legend = replace(legend or Legend(_title(state)), swatches=swatches)
    for name, actor in actors.items():
        if actor.clipped:
            slab = thick.get("interior" if name.startswith("interior") else "rest", 0.0)
            actors[name] = replace(actor, slab=slab)
    return Description(actors, cut=cut, legend=legend)


def build_shown(inputs: tuple[Any, ...], progress: Progress = silent) -> CutCellGraph:
    """Return the graph that `GraphChoices.graph_inputs` describe."""
    mesh, resolution, connectivity, threshold, orient = inputs
    return build_graph(
        mesh,
        resolution,
        connectivity=connectivity,
        winding_threshold=threshold,
        orient=orient,
        progress=progress,
    )


def graph_layers(state: State, memo: Memo) -> tuple[dict[str, Actor], Legend | None]:
    """Return the graph's actors, and how to read their colours."""
    if state.shown_graph is None:
        return {}, None
    rig, lattice, theme = state.rig, state.shown_graph, theme_of(state)
    field, style, legend = _field(state, memo)
    drawn = memo(
        "graph",
        (rig, lattice, theme.name, field, style.get("shades", ""), style.get("colors")),
        lambda: graph_scene(rig, lattice, theme=theme, field=field, **style).actors,
    )
    layers = {
        name: replace(drawn[name], visible=getattr(state, layer), opacity=_thin(state, name))
        for layer, name in LAYERS.items()
        if name in drawn
    }
    for layer, name in LAYERS.items():
        nodes = name.replace("edges", "nodes")
        if nodes in drawn and nodes != name:
            layers[nodes] = replace(drawn[nodes], visible=state.nodes and getattr(state, layer))
    return layers, legend


def _face(
    state: State, memo: Memo, cut: Cut, legend: Legend | None
) -> tuple[dict[str, Actor], Legend | None]:
    """Return the face of the cut, if one is wanted, and the legend with how to read it."""
    swatches = () if legend is None else legend.swatches
    if state.graph_face == "winding":
        face, read = winding_section(state, memo, cut)
        legend = replace(read, swatches=(*swatches, *read.swatches))
    elif state.graph_face == "field" and (field := field_of(state)) is not None:
        limits = distance_limits(field)
        face = field_section(state, memo, cut, field, limits)
        legend = replace(distance_legend(state.rig, state.joint, limits), swatches=swatches)
    else:
        return {}, legend
    return {**face, "inside": replace(face["inside"], opacity=FACE_OPACITY)}, legend


def sight_of(state: State, memo: Memo) -> Any:
    """Return the straight pieces that the chosen vertex's distance is made of (p, 3), or None."""
    return path_of(state, memo) if state.connectivity == "any" else None


def _thin(state: State, name: str) -> float:
    """Return how opaque edges are: those inside a whole body would else be one orange blob."""
    whole = state.cut_across == "off" and name == "interior edges"
    return X_RAY if whole and state.edge_colors == "kind" else 1.0


def _field(state: State, memo: Memo) -> tuple[Any, dict[str, Any], Legend | None]:
    """Return what edges are coloured by: values at nodes, how they are shown, the legend."""
    shown = state.shown_graph
    if state.edge_colors == "depth":
        depth = memo("depth", (shown,), lambda: depth_field(shown))
        most = distance_limits(depth)[1]
        high = f"{file_units(most, state.rig)} in the file's units"
        legend = Legend("Depth below the surface", "depth", "0", high)
        return depth, {"shades": "depth"}, legend
    if state.edge_colors == "component":
        colors, count = memo("parts", (shown,), lambda: component_colors(shown))
        legend = Legend(f"{count:,} connected component{'s' * (count != 1)}")
        return None, {"colors": colors}, legend
    field = field_of(state) if state.edge_colors == "distance" else None
    if field is None:
        return None, {}, kinds_legend(state)
    legend = distance_legend(state.rig, state.joint, distance_limits(field))
    if shown is not state.graph:
        of_weights = field
        nearest = memo("nearest", (shown, state.graph), lambda: nearest_nodes(shown, state.graph))
        field = memo("field there", (field, nearest), lambda: of_weights[nearest])
    return field, {"kinds": (MESH, INTERIOR, SURFACE)}, legend


def kinds_legend(state: State) -> Legend | None:
    """Return the legend of the visible layers of edges."""
    colored = zip(theme_of(state).edges, KINDS.items(), strict=True)
    layers = tuple((color, text) for color, (name, text) in colored if getattr(state, name))
    return Legend(_title(state), swatches=layers) if layers else None


def _title(state: State) -> str:
    resolution = state.graph_resolution or state.resolution
    return f"Graph, R = {resolution}" + (
        "" if resolution == state.resolution else f" (weights: {state.resolution})"
    )


def body_opacity(state: State) -> float:
    """Return how opaque the body is: see-through where the graph would else be hidden."""
    whole = state.cut_across == "off"
    looks_inside = whole and (state.interior_edges or state.surface_edges)
    return GRAPH_BODY_OPACITY if looks_inside and state.shown_graph is not None else 1.0


def slab_of(state: State) -> dict[str, float]:
    """Return how much is kept behind the cut, of the interior and of the rest; 0 is all."""
    if state.shown_graph is None or state.cut_keeps == "half":
        return {}
    if state.cut_keeps == "face":
        return {"interior": cells_of(state, FACE_CELLS)}
    thick = cells_of(state, state.slab * state.shown_graph.lattice.resolution)
    return {"interior": thick, "rest": thick}


def _slice(state: State, memo: Memo) -> Description:
    """Return the scene of one slice: its rays, and the body behind it."""
    rig, theme = state.rig, theme_of(state)
    resolution = state.graph_resolution or state.resolution
    place = slice_place(rig, state.slice_axis, state.slice_position, resolution)
    normal, index, cut = place
    axis, _ = file_axis(rig, state.slice_rays)
    if axis == normal:
        axis = (normal + 1) % 3
    inputs = (rig, resolution, axis, normal, index, state.winding_threshold, state.orient)

    def cast(name: str, *libraries: str) -> RaySlice:
        """Divide the rays by our own means, or by libraries."""
        options = dict(zip(("rays", "winding"), libraries, strict=False))
        return memo(
            name,
            (*inputs, *libraries),
            lambda: slice_rays(
                rig.mesh,
                resolution,
                axis=axis,
                normal=normal,
                index=index,
                winding_threshold=state.winding_threshold,
                orient=state.orient,
                **options,
            ),
        )

    chosen = state.slice_caster, state.slice_winding
    reference = None if chosen == ("raster", "exact") else cast("slice")
    rays = cast("slice by libraries", *chosen) if reference else cast("slice")
    actors, legend = memo(
        "slice scene",
        (rays, reference, theme.name),
        lambda: slice_scene(rig, rays, theme, reference),
    )
    shell = character(state, memo, visible=state.body, opacity=SHELL)
    for name in {"bones", "bone outlines"} & shell.keys():
        shell[name] = replace(shell[name], visible=False)  # they would hide the slice
    return Description({**shell, **actors}, cut=_pulled(cut, state), legend=legend)


def _pulled(cut: Cut, state: State) -> Cut:
    """Move a cut half a cell back, so that the slice stands clear of the body."""
    back = cells_of(state, 0.25)
    origin = tuple(o - back * n for o, n in zip(cut.origin, cut.normal, strict=True))
    return Cut(origin, cut.normal)  # type: ignore[arg-type]
