"""Elements shared by the scenes of all panels: body, bones, cut, theme."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell_viewers.character import attachments, body, bones, drawn_segments, to_scene
from cutcell_viewers.description import Actor, Cut, Description
from cutcell_viewers.graph_scene import cut_at
from cutcell_viewers.joint_colors import colors_of
from cutcell_viewers.marks import vertex_mark
from cutcell_viewers.skin import Skin

from ..document.framing import bounds_of
from ..document.state import State

FAINT = 0.25
"""Opacity of faint bones."""
BODY_OPACITY_WITH_PATH = 0.42
"""Opacity of the body while a path inside it is visible."""
GRAPH_BODY_OPACITY = 0.22
"""Opacity of the body while the graph inside it is visible."""


def character(state: State, *, bones_coloured: bool = False, **look: Any) -> dict[str, Actor]:
    """Return the body, its attachments, the bones, and the mark of the chosen vertex.

    Bones may have the colours of their weights. The look consists of fields of the body's `Actor`;
    opacity and visibility apply to attachments, too.
    """
    rig = state.rig
    plain = state.memo("body", (rig.mesh, rig.weights, rig.world), lambda: body(rig))
    skin = None
    if state.open_panel.poses and state.weights is not None:
        skin = state.memo("skin", (rig, state.weights), lambda: Skin.of_weights(state.weights))
    hung = state.memo("attachments", (rig.attachments, rig.world), lambda: attachments(rig))
    mark, vertex = {}, state.vertex
    if vertex is not None and vertex < len(rig.mesh.vertices):
        weights = state.weights if skin is not None else None
        of = (rig, weights, vertex)
        mark["vertex"] = state.memo("vertex", of, lambda: vertex_mark(rig, vertex, weights))
    visibility = {name: look[name] for name in ("visible", "opacity", "clipped") if name in look}
    return {
        "body": replace(plain, skin=skin, edges=state.wireframe, **look),
        **{name: replace(actor, **visibility) for name, actor in hung.items()},
        **mark,
        **_skeleton(state, bones_coloured),
    }


def _skeleton(state: State, coloured: bool) -> dict[str, Actor]:
    if state.bare:
        return {}
    rig = state.rig
    segments = state.memo("segments", (rig,), lambda: drawn_segments(rig))
    visible_bones = _behind_cut(state, *segments) if state.open_panel.cuts else None

    def make() -> dict[str, Actor]:
        colors = colors_of(rig) if coloured else None
        return bones(rig, state.joint, state.skeleton, colors, visible_bones)

    visible = None if visible_bones is None else visible_bones.tobytes()
    actors = state.memo("bones", (rig, state.joint, state.skeleton, coloured, visible), make)
    opacity = FAINT if state.faint_skeleton else 1.0
    return {name: replace(actor, opacity=opacity) for name, actor in actors.items()}


def _behind_cut(state: State, start: NDArray, end: NDArray, joint: NDArray) -> NDArray | None:
    """Return which bones a cut leaves: the chosen one, and those behind it; None for all."""
    cut = cut_of(state)
    if cut is None:
        return None
    nearer = np.minimum((start - cut.origin) @ cut.normal, (end - cut.origin) @ cut.normal)
    is_behind = (nearer <= 0) | (joint == state.joint)
    return None if is_behind.all() else is_behind


def plain(state: State) -> Description:
    """Return the scene of the character alone."""
    return Description(character(state))


def cut_of(state: State) -> Cut | None:
    """Return the cutting plane, across the box of the body; none through bodies side by side."""
    if state.cut_across == "off" or (state.panel == "distance" and state.measures):
        return None
    across = cut_normal(state) if state.cut_across == "free" else state.cut_across
    return cut_at(bounds_of(state), across, state.cut_position)


def has_field(state: State) -> bool:
    """Return whether the chosen bone has distances: it is bound, and may carry weight."""
    return state.binding is not None and bool(state.rig.skeleton.deform[state.joint])


def in_scene(state: State, points: np.ndarray) -> np.ndarray:
    """Bring points of the graph's unit cube, shape (p, 3), into the scene's space."""
    return to_scene(state.rig, state.binding.graph.lattice.to_file(points))


def cut_normal(state: State) -> NDArray[np.float64]:
    """Return the direction of a free plane, shape (3,), of length 1."""
    return spherical(*np.radians([state.cut_yaw, state.cut_pitch]))


def spherical(yaw: float, pitch: float) -> NDArray[np.float64]:
    """Return the direction of two angles, around the upright axis and up, of length 1."""
    return np.array([np.cos(pitch) * np.sin(yaw), np.sin(pitch), np.cos(pitch) * np.cos(yaw)])


def cells_of(state: State, count: float) -> float:
    """Return the length of some cells of the lattice, in the scene's units."""
    resolution = state.graph_resolution or state.resolution
    return count * float(np.ptp(bounds_of(state), axis=0).max()) / resolution
