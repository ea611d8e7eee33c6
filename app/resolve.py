"""From the state to what is seen: pure functions, tested without a browser."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from cutcell.rig import Clip, Rig
from viewers.character import attachments, body, bones, drawn_segments, pose_in_scene
from viewers.description import Actor, Cut, Description, Legend
from viewers.distance_scene import distance_colors
from viewers.graph_scene import cut_at, graph_scene
from viewers.palette import THEMES, Theme
from viewers.pose_scene import joint_turns, swing, turn
from viewers.weights_scene import weight_colors

from .state import LAYERS, State

SWING_DEGREES = 50.0
SEE_THROUGH = 0.22
"""How opaque the body is while the graph inside it is looked at."""


class Memo:
    """Keeps the last result of each costly step, for as long as its inputs are the same."""

    def __init__(self) -> None:
        self._kept: dict[str, tuple[tuple[Any, ...], Any]] = {}

    def __call__(self, name: str, inputs: tuple[Any, ...], make: Callable[[], Any]) -> Any:
        """Return what `make` returned when it was last called with the same inputs.

        Numbers and texts are compared by value, all else by identity.
        """
        kept = self._kept.get(name)
        if kept is None or not _same_inputs(kept[0], inputs):
            kept = self._kept[name] = (inputs, make())
        return kept[1]


def resolve(state: State, memo: Memo | None = None) -> Description:
    """Return the scene that a state stands for.

    Parameters
    ----------
    state : State
    memo : Memo, optional
        Speeds up a series of calls; changes nothing in what comes out.
    """
    if state.rig is None:
        return Description()
    memo = memo or Memo()
    rig, cut = state.rig, cut_of(state)
    colors, legend = coloring(state, memo)
    plain = memo("body", (rig, state.weights), lambda: body(rig, state.weights))
    hung = memo("attachments", (rig,), lambda: attachments(rig))
    seen = {"visible": state.body, "opacity": body_opacity(state)}
    actors: dict[str, Actor] = {"body": replace(plain, **colors, **seen)}
    actors |= {name: replace(actor, **seen) for name, actor in hung.items()}
    actors |= graph_layers(state, cut, memo)
    actors["bones"] = memo(
        "bones",
        (rig, state.joint, state.skeleton),
        lambda: bones(rig, state.joint, state.skeleton),
    )
    return Description(actors, pose=pose_of(state), cut=cut, legend=legend)


def coloring(state: State, memo: Memo) -> tuple[dict[str, Any], Legend | None]:
    """Return how the body is coloured, and the legend; plain before anything is computed."""
    rig, binding, joint = state.rig, state.binding, state.joint
    if binding is None or state.coloring == "plain":
        return {}, None
    if state.coloring == "distance":
        make = lambda: distance_colors(rig, binding.distances.joint[joint], joint)  # noqa: E731
        return memo("distance", (binding, joint), make)
    which = joint if state.coloring == "weights" else None
    return memo("weights", (binding, which), lambda: weight_colors(rig, binding.weights, which))


def graph_layers(state: State, cut: Cut | None, memo: Memo) -> dict[str, Actor]:
    """Return the graph's actors; they are seen at rest only, since the graph is of the rest."""
    if state.binding is None:
        return {}
    rig, graph, theme = state.rig, state.binding.graph, theme_of(state)
    field = field_of(state)
    drawn = memo(
        "graph",
        (rig, graph, field, theme.name),
        lambda: graph_scene(rig, graph, field=field, theme=theme).actors,
    )
    slab = slab_of(state) if cut is not None and state.thin else 0.0
    result = {}
    for layer, name in LAYERS.items():
        if name in drawn:
            visible = getattr(state, layer) and not state.posed
            behind = slab if name == "interior edges" else 0.0
            result[name] = replace(drawn[name], visible=visible, slab=behind)
    return result


def wants_field(state: State) -> bool:
    """Whether the graph inside would be coloured by a distance field, were it there."""
    return (
        state.binding is not None
        and bool(state.rig.skeleton.deform[state.joint])
        and state.coloring == "distance"
        and state.interior_edges
        and not state.posed
    )


def field_of(state: State) -> Any:
    """Return the distance at every graph node, shape (N,), if it is there and wanted."""
    if not wants_field(state) or state.field is None:
        return None
    binding, joint, field = state.field
    return field if binding is state.binding and joint == state.joint else None


def body_opacity(state: State) -> float:
    """Return how opaque the body is: see-through where the interior would else be hidden."""
    looks_inside = state.interior_edges and state.cut_axis == "off" and not state.posed
    return SEE_THROUGH if looks_inside and state.binding is not None else 1.0


def cut_of(state: State) -> Cut | None:
    """Return the cutting plane, across the box of the body."""
    if state.cut_axis == "off":
        return None
    return cut_at(bounds_of(state), state.cut_axis, state.cut_position)


def slab_of(state: State) -> float:
    """Return the thickness of a thin slice: three cells of the lattice."""
    resolution = state.binding.graph.lattice.resolution
    return 3 * float(np.ptp(bounds_of(state), axis=0).max()) / resolution


def bounds_of(state: State) -> np.ndarray:
    """Return the lowest and highest corner of the body at rest, shape (2, 3)."""
    rig = state.rig
    points = rig.mesh.vertices[np.unique(rig.mesh.faces)] @ rig.world[:3, :3].T
    points += rig.world[:3, 3]
    return np.stack([points.min(axis=0), points.max(axis=0)])


def theme_of(state: State) -> Theme:
    """Return the theme that the state asks for."""
    return THEMES["dark" if state.dark else "light"]


def pose_of(state: State) -> np.ndarray | None:
    """Return the pose that the sliders make, shape (j, 4, 4); None at rest or in motion."""
    from cutcell import forward_kinematics

    if state.moving or not state.posed:
        return None
    rotations = {
        joint: turn("z", z) @ turn("y", y) @ turn("x", x)
        for joint, (x, y, z) in state.turns.items()
        if any((x, y, z))
    }
    transforms = forward_kinematics(state.rig.skeleton, joint_turns(state.rig, rotations))
    return pose_in_scene(state.rig, transforms)


def clip_of(state: State) -> Clip | None:
    """Return the motion that is on: a clip of the rig, or a swing of the chosen joint."""
    if not state.moving or state.rig is None:
        return None
    if 0 <= state.clip < len(state.rig.clips):
        return state.rig.clips[state.clip]
    return swing(state.rig, state.joint, state.axis, SWING_DEGREES)


def clip_part(state: State, clip: Clip | None) -> dict[str, Any] | None:
    """Return a motion as the view is told it."""
    if clip is None or not len(clip.times):
        return None
    matrices = pose_in_scene(state.rig, clip.transforms).astype(np.float32)
    return {"times": clip.times.astype(np.float32), "matrices": matrices.ravel()}


def bones_part(state: State) -> dict[str, Any]:
    """Return the bones as the view needs them for picking."""
    start, end, joint = drawn_segments(state.rig)
    return {
        "start": start.ravel(),
        "end": end.ravel(),
        "joint": joint.astype(np.int32),
        "names": list(state.rig.skeleton.names),
    }


def first_joint(rig: Rig) -> int:
    """Return the joint to begin with: an arm if there is one, else the longest bone."""
    skeleton = rig.skeleton
    start, end, joint = drawn_segments(rig)
    inner = np.array([len(skeleton.children[j]) > 0 for j in joint])
    useful = skeleton.deform[joint] & inner & (skeleton.parents[joint] >= 0)
    arm = np.array([bool(_ARM.search(skeleton.names[j])) for j in joint])
    score = np.linalg.norm(end - start, axis=1) * (useful + 1e-6) * (1 + 100 * arm)
    return int(joint[np.argmax(score)])


_ARM = re.compile(r"arm", re.IGNORECASE)


def _same_inputs(a: tuple[Any, ...], b: tuple[Any, ...]) -> bool:
    return len(a) == len(b) and all(
        x is y or (isinstance(x, int | float | str) and type(x) is type(y) and x == y)
        for x, y in zip(a, b, strict=True)
    )
