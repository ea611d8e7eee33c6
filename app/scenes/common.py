"""Elements shared by the scenes of all panels: body, bones, cut, theme."""

import re
from dataclasses import replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from cutcell.rig import Rig
from cutcell.runtime.display import shown_name
from cutcell_viewers.camera import Camera, framing
from cutcell_viewers.character import attachments, body, bones, drawn_segments, to_scene
from cutcell_viewers.description import Actor, Cut, Description
from cutcell_viewers.graph_scene import cut_at
from cutcell_viewers.joint_colors import colors_of
from cutcell_viewers.marks import vertex_mark
from cutcell_viewers.palette import THEMES, Theme, to_hex
from cutcell_viewers.skin import skin_of_weights

from ..state import PANELS, State
from .memo import Memo

FAINT = 0.25
"""How opaque bones are that are not to hide what is behind them."""

BODY_OPACITY_WITH_PATH = 0.42
"""How opaque the body is while a path inside it is to be seen."""

GRAPH_BODY_OPACITY = 0.22
"""How opaque the body is while what lies inside is looked at."""


def character(
    state: State, memo: Memo, *, bones_coloured: bool = False, **look: Any
) -> dict[str, Actor]:
    """Return the body, its attachments, the bones, and the mark of the chosen vertex.

    Parameters
    ----------
    state : State
        With a rig.
    memo : Memo
    bones_coloured : bool
        Whether each bone has the colour that its weights are shown in.
    **look
        Fields of the body's `Actor`; those of its appearance apply to attachments
        it as well.
    """
    rig = state.rig
    plain = memo("body", (rig.mesh, rig.weights, rig.world), lambda: body(rig))
    skin = None
    if PANELS[state.panel].poses and state.weights is not None:
        skin = memo("skin", (rig, state.weights), lambda: skin_of_weights(state.weights))
    hung = memo("attachments", (rig.attachments, rig.world), lambda: attachments(rig))
    mark, vertex = {}, state.vertex
    if vertex is not None and vertex < len(rig.mesh.vertices):
        weights = state.weights if skin is not None else None
        of = (rig, weights, vertex)
        mark["vertex"] = memo("vertex", of, lambda: vertex_mark(rig, vertex, weights))
    visibility = {name: look[name] for name in ("visible", "opacity", "clipped") if name in look}
    return {
        "body": replace(plain, skin=skin, edges=state.wireframe, **look),
        **{name: replace(actor, **visibility) for name, actor in hung.items()},
        **mark,
        **_skeleton(state, memo, bones_coloured),
    }


def _skeleton(state: State, memo: Memo, coloured: bool) -> dict[str, Actor]:
    if state.bare:
        return {}
    rig = state.rig
    segments = memo("segments", (rig,), lambda: drawn_segments(rig))
    visible_bones = _behind_cut(state, *segments) if PANELS[state.panel].cuts else None

    def make() -> dict[str, Actor]:
        colors = colors_of(rig) if coloured else None
        return bones(rig, state.joint, state.skeleton, colors, visible_bones)

    inputs = (
        rig,
        state.joint,
        state.skeleton,
        coloured,
        None if visible_bones is None else visible_bones.tobytes(),
    )
    actors = memo("bones", inputs, make)
    opacity = FAINT if state.faint_skeleton else 1.0
    return {name: replace(actor, opacity=opacity) for name, actor in actors.items()}


def _behind_cut(state: State, start: NDArray, end: NDArray, joint: NDArray) -> NDArray | None:
    """Return which bones are left by a cut: the chosen one, all not before it; None: all."""
    cut = cut_of(state)
    if cut is None:
        return None
    nearer = np.minimum((start - cut.origin) @ cut.normal, (end - cut.origin) @ cut.normal)
    is_behind = (nearer <= 0) | (joint == state.joint)
    return None if is_behind.all() else is_behind


def plain(state: State, memo: Memo) -> Description:
    """Return the scene of the character alone."""
    return Description(character(state, memo))


def cut_of(state: State) -> Cut | None:
    """Return the cutting plane, across the box of the body; none through bodies side by side."""
    if state.cut_across == "off" or (state.panel == "distance" and state.measures):
        return None
    across = cut_normal(state) if state.cut_across == "free" else state.cut_across
    return cut_at(bounds_of(state), across, state.cut_position)


def has_field(state: State) -> bool:
    """Whether the chosen bone has distances: it was bound, and may carry weight."""
    return state.binding is not None and bool(state.rig.skeleton.deform[state.joint])


def in_scene(state: State, points: np.ndarray) -> np.ndarray:
    """Bring points of the graph's unit cube, shape (p, 3), into the scene's space."""
    return to_scene(state.rig, state.binding.graph.lattice.to_file(points))


def cut_normal(state: State) -> NDArray[np.float64]:
    """Return where a free plane looks to, shape (3,), of length 1."""
    yaw, pitch = np.radians([state.cut_yaw, state.cut_pitch])
    out = [np.cos(pitch) * np.sin(yaw), np.sin(pitch), np.cos(pitch) * np.cos(yaw)]
    return np.array(out)


def cells_of(state: State, count: float) -> float:
    """Return the length of some cells of the lattice, in the scene's units."""
    resolution = state.graph_resolution or state.resolution
    return count * float(np.ptp(bounds_of(state), axis=0).max()) / resolution


def bounds_of(state: State) -> np.ndarray:
    """Return the lowest and highest corner of the body at rest, shape (2, 3)."""
    rig = state.rig
    if rig not in _bounds_of_rig:
        points = rig.mesh.vertices[np.unique(rig.mesh.faces)] @ rig.world[:3, :3].T
        points += rig.world[:3, 3]
        bounds = np.stack([points.min(axis=0), points.max(axis=0)])
        bounds.flags.writeable = False
        _bounds_of_rig[rig] = bounds
    return _bounds_of_rig[rig]


_bounds_of_rig: WeakKeyDictionary[Rig, np.ndarray] = WeakKeyDictionary()


def theme_of(state: State) -> Theme:
    """Return the theme that the state asks for."""
    return THEMES["dark" if state.dark else "light"]


def bones_part(state: State) -> dict[str, Any]:
    """Return the bones as the view needs them for picking."""
    start, end, joint = drawn_segments(state.rig)
    return {
        "start": start.ravel(),
        "end": end.ravel(),
        "joint": joint.astype(np.int32),
        "names": [shown_name(name) for name in state.rig.skeleton.names],
    }


def theme_part(theme: Theme) -> dict[str, str]:
    """Return a theme as a message for the view."""
    card = "rgba(255,255,255,.72)" if theme.name == "light" else "rgba(24,28,36,.72)"
    top, bottom, ink = to_hex(theme.top), to_hex(theme.bottom), to_hex(theme.ink)
    paper = "#ffffff" if theme.name == "light" else "#1b2028"
    return {"top": top, "bottom": bottom, "ink": ink, "card": card, "paper": paper}


def camera_part(camera: Camera) -> dict[str, Any]:
    """Return a camera as a message for the view."""
    return {"position": list(camera.position), "focal_point": list(camera.focal_point)}


def camera_on_bone(
    state: State, part: float, aspect: float, direction: tuple[float, float, float]
) -> Camera:
    """Return a camera on the chosen bone at rest that sees some part of the longest side."""
    start, end, joint = drawn_segments(state.rig)
    bounds = bounds_of(state)
    of_bone = joint == state.joint
    ends = np.concatenate([start[of_bone], end[of_bone]]) if of_bone.any() else bounds
    half = part / 2 * float(np.ptp(bounds, axis=0).max())
    middle = ends.mean(axis=0)
    return framing(np.stack([middle - half, middle + half]), aspect, direction)


def first_joint(rig: Rig) -> int:
    """Return the joint to begin with: an arm if there is one, else the longest bone."""
    skeleton = rig.skeleton
    start, end, joint = drawn_segments(rig)
    if not len(joint):
        return 0  # of a mesh without a skeleton: nothing asks which
    inner = np.array([len(skeleton.children[j]) > 0 for j in joint])
    useful = skeleton.deform[joint] & inner & (skeleton.parents[joint] >= 0)
    arm = np.array([bool(_ARM.search(skeleton.names[j])) for j in joint])
    score = np.linalg.norm(end - start, axis=1) * (useful + 1e-6) * (1 + 100 * arm)
    return int(joint[np.argmax(score)])


_ARM = re.compile(r"arm", re.IGNORECASE)
