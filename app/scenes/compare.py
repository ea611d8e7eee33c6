"""Two to four methods side by side, under one camera, in the same colours."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell_lab.baselines import METHODS
from cutcell_viewers.description import Actor, Description, Legend
from cutcell_viewers.error_scene import error_limits
from cutcell_viewers.short_names import short_names
from cutcell_viewers.skin import skin_of_weights
from cutcell_viewers.weights_scene import weight_colors

from ..state import State
from ..state.compare import NOW
from .common import character
from .memo import Memo
from .pose import pose_of

TITLES = {
    NOW: "cutcell (current settings)",
    "artist": "From file",
    "bbw": "Bounded biharmonic",
    "cutcell": "cutcell (paper)",
    "cutcell_any": "Cut-cell, any angle",
    "cutcell_rig": "cutcell (animation)",
    "visibility": "RigNet's distance",
    "voxel": "Voxel binding",
    "voxel_unirig": "Voxel binding, UniRig's",
}
"""What methods are called where their names do not say it; trained networks have
titles of their own, and others join by themselves."""

WAITING = 0.28
"""How opaque a body is whose weights are not there."""


def compare(state: State, memo: Memo) -> Description:
    """Return the scene of the panel Compare."""
    shared = character(state, memo)
    if state.binding is None:
        return Description(shared, pose=pose_of(state))
    plain = shared.pop("body")
    names = list(state.methods)
    tables = {name: weights_of(state, name) for name in names}
    styles, legend = looks_of(state, tables, memo)
    actors: dict[str, Actor] = {}
    for view, name in enumerate(names):
        key = f"body {view}" if view else "body"
        weights = tables[name]
        if weights is None:
            actors[key] = replace(plain, view=view, opacity=WAITING)
            continue
        skin = memo(f"skin {name}", (weights,), partial(skin_of_weights, weights))
        actors[key] = replace(plain, view=view, skin=skin, **styles[name])
    captions = tuple(caption_of(state, name) for name in names)
    return Description({**actors, **shared}, pose=pose_of(state), legend=legend, views=captions)


def title_of(name: str) -> str:
    """Return what a method is called."""
    title = getattr(METHODS.get(name), "title", None)
    return TITLES.get(name) or title or name.replace("_", " ").capitalize()


def caption_of(state: State, name: str) -> str:
    """Return what stands over a method's view."""
    title = title_of(name)
    result = found_of(state, name)
    if weights_of(state, name) is None:
        if result is not None and result.failed:
            return f"{title} · failed"
        return f"{title} · {'computing' if state.comparing == name else 'waiting'}"
    if state.minus and subtracted(state) is not None:
        other = "itself" if name == state.minus else title_of(state.minus)
        return f"{title} − {other}"
    return title


def weights_of(state: State, name: str) -> Any:
    """Return the weights of a method, shape (n, j); None where there are none yet."""
    if name == NOW:
        return None if state.binding is None else state.binding.weights
    if name == "artist":
        return state.rig.weights
    result = found_of(state, name)
    return None if result is None else result.weights


def found_of(state: State, name: str) -> Any:
    """Return the Compared of a method, unless it is of another character or out of date."""
    result = state.compared.get(name)
    if result is None or result.rig is not state.rig:
        return None
    return None if name == NOW and result.source is not state.binding else result


def subtracted(state: State) -> Any:
    """Return the weights that are taken away from all others, or None."""
    return weights_of(state, state.minus) if state.minus in state.methods else None


def looks_of(
    state: State, tables: dict[str, Any], memo: Memo
) -> tuple[dict[str, dict[str, Any]], Legend | None]:
    """Return how each method's body is coloured, and the legend that holds for all."""
    computed = {name: table for name, table in tables.items() if table is not None}
    joint = state.joint
    field = field_shown(state)
    if field == "error":
        return error_looks(state, computed)
    base = subtracted(state)
    if base is not None and field == "bone":
        styles = {
            name: _difference(table[:, joint] - base[:, joint]) for name, table in computed.items()
        }
        title = f"Weight of {short_names(state.rig.skeleton.names)[joint]}, difference"
        return styles, Legend(title, "difference", "−1", "+1")
    if base is not None:
        styles = {
            name: memo(f"apart {name}", (table, base), partial(_sum_of_differences, table, base))
            for name, table in computed.items()
        }
        return styles, Legend("Difference of the weights", "error", "0%", "100%")
    which = joint if field == "bone" else None
    styles, legend = {}, None
    for name, table in computed.items():
        styles[name], legend = memo(
            f"colors {name}", (table, which), partial(weight_colors, state.rig, table, which)
        )
    return styles, legend


def field_shown(state: State) -> str:
    """Return what is seen of the methods: there may be no weights to tell an error against."""
    if state.compare_field == "error" and state.rig.weights is None:
        return "bone"
    return state.compare_field


def error_looks(
    state: State, cached: dict[str, Any]
) -> tuple[dict[str, dict[str, Any]], Legend | None]:
    """Return the colours of the deformation error, on one scale for all methods."""
    errors = {name: errors_of(state, name) for name in cached}
    measured = {name: one for name, one in errors.items() if one is not None}
    if not measured:
        return {name: {} for name in cached}, None
    limits = max(error_limits(_lengths(one)) for one in measured.values())
    styles: dict[str, dict[str, Any]] = {name: {} for name in cached}
    for name, one in measured.items():
        values = _lengths(one).astype(np.float32)
        styles[name] = {"scalars": values, "colormap": "error", "limits": limits}
    return styles, Legend("Largest error for 30° turns", "error", "0", f"{limits[1]:g} mm")


def _lengths(errors: Any) -> NDArray[np.float64]:
    """Return errors of positions in mm; the metric squares them, in cm²."""
    return np.asarray(10 * np.sqrt(errors.vertex))


def errors_of(state: State, name: str) -> Any:
    """Return the DeformationError of a method's weights against the file's, if it is known."""
    result = found_of(state, name)
    return None if result is None else result.errors


def _difference(values: NDArray[np.float64]) -> dict[str, Any]:
    return {"scalars": values.astype(np.float32), "colormap": "difference", "limits": (-1.0, 1.0)}


def _sum_of_differences(table: NDArray, base: NDArray) -> dict[str, Any]:
    values = np.abs(table - base).sum(axis=1) / 2
    return {"scalars": values.astype(np.float32), "colormap": "error", "limits": (0.0, 1.0)}
