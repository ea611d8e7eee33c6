"""One bone's distance by several measures side by side, in the same colours, waves in step."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from cutcell.rig import Rig
from cutcell_lab.baselines.measured_distance import Measure, MeasuredDistance, mean_error
from cutcell_viewers.character import to_scene
from cutcell_viewers.description import Actor, Description
from cutcell_viewers.distance_scene import (
    distance_colors,
    distance_limits,
    distance_look,
    file_units,
)
from cutcell_viewers.marks import path_tube
from cutcell_viewers.palette import BODY

from ...document.state import State
from ...looks.character import BODY_OPACITY_WITH_PATH, character
from ...looks.measures import CONVERGED, MEASURES

WAITING = 0.28
"""Opacity of a body without distances."""
INSIDE_VOXELS = 0.06
"""Opacity of a body in transparent voxels."""
WITH_RESOLUTION = ("voxel", "6", "26", "any")


def side_by_side(state: State) -> Description:
    """Return the scene of some measures, one view each."""
    names, rig, joint = state.measures, state.rig, state.joint
    results = {name: state.measured.get(name) for name in names}
    computed = [one for one in results.values() if one is not None]
    converged = results.get("converged")
    farthest = max((distance_limits(one.vertices)[1] for one in computed), default=1.0)
    limits = (0.0, state.scale_end or farthest)
    shared = character(state)
    plain = shared.pop("body")
    actors: dict[str, Actor] = {}
    legend, captions = None, []
    for view, name in enumerate(names):
        body, one = f"body {view}" if view else "body", results[name]
        title = title_of(name, state.beside_resolution)
        if one is None:
            runs = ("measured", name) in state.computing
            actors[body] = replace(plain, view=view, opacity=WAITING)
            captions.append(f"{title} · {'computing' if runs else 'waiting'}")
            continue
        colors, legend = state.memo(
            f"measure {name}",
            (rig, one, joint, limits),
            partial(distance_colors, rig, one.vertices, joint, limits),
        )
        if converged is not None and name != "converged":
            title += f" · error {mean_error(one, converged):.1%}"
        path = _path(state, name, one)
        if path is not None and len(path):
            tube = state.memo(f"tube {name}", (rig, path), partial(path_tube, rig, path))
            actors[f"path {view}"] = replace(tube, view=view)
            title += f" · {file_units(one.vertices[state.vertex], rig)}"
        elif path is not None:
            title += " · no path"
        see = 1.0 if path is None else BODY_OPACITY_WITH_PATH
        if len(one.sides):
            voxels = state.memo("voxels", (rig, one, limits), partial(_voxels, rig, one, limits))
            actors["voxels"] = replace(voxels, view=view, follows_wavefront=state.wave, opacity=see)
            see = see if see == 1 else INSIDE_VOXELS
        actors[body] = replace(
            plain, view=view, follows_wavefront=state.wave, opacity=see, **colors
        )
        captions.append(title)
    if legend is not None and state.wave:
        legend = replace(legend, swatches=(*legend.swatches, (BODY, "not reached yet")))
    front = state.front * limits[1] if state.wave else None
    return Description({**actors, **shared}, legend=legend, front=front, views=tuple(captions))


def title_of(name: Measure, resolution: int) -> str:
    """Return the title of a measure's view."""
    if name == "converged":
        resolution = CONVERGED
    elif name not in WITH_RESOLUTION:
        return MEASURES[name]
    return f"{MEASURES[name]}, R = {resolution}"


def _path(state: State, name: str, one: MeasuredDistance) -> Any:
    """Return the path from the clicked vertex in the scene's space, (p, 3), or None."""
    if not state.path or state.vertex is None:
        return None
    rig, vertex = state.rig, state.vertex
    return state.memo(
        f"path {name}", (rig, one, vertex), lambda: to_scene(rig, one.path_from(vertex))
    )


def _voxels(rig: Rig, one: MeasuredDistance, limits: tuple[float, float]) -> Actor:
    """Return the outside of the voxels, each in the colour of its distance."""
    points = to_scene(rig, one.sides.reshape(-1, 3)).astype(np.float32)
    a, b, c, _ = points.reshape(-1, 4, 3).transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    first = 4 * np.arange(len(one.sides), dtype=np.int32)[:, None]
    halves = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    cells = np.concatenate([first + half for half in halves])
    style, _ = distance_look(one.side_distance.ravel(), limits)
    return Actor("surface", points, cells, np.repeat(normals, 4, axis=0), **style)
