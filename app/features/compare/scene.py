"""Two to four methods side by side, under one camera, in the same colours."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell_viewers.description import Actor, Description, Legend
from cutcell_viewers.error_scene import error_limits
from cutcell_viewers.marks import vertex_dots
from cutcell_viewers.short_names import short_names
from cutcell_viewers.skin import Skin
from cutcell_viewers.weights_scene import weight_colors

from ...document.state import State
from ...looks.character import character
from ...looks.methods import shown_title, weights_of
from ...looks.pose import pose_of

TOPS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5)
"""Ends of scales of differences below 1."""
WAITING = 0.28
"""Opacity of a body without weights."""


def scene(state: State) -> Description:
    """Return the scene of the panel Compare."""
    shared = character(state)
    if state.binding is None:
        return Description(shared, pose=pose_of(state))
    plain = shared.pop("body")
    names = list(state.methods)
    tables = {name: weights_of(state, name) for name in names}
    styles, legend = looks_of(state, tables)
    actors: dict[str, Actor] = {}
    for view, name in enumerate(names):
        key = f"body {view}" if view else "body"
        weights = tables[name]
        if weights is None:
            actors[key] = replace(plain, view=view, opacity=WAITING)
            continue
        skin = state.memo(f"skin {name}", (weights,), partial(Skin.of_weights, weights))
        actors[key] = replace(plain, view=view, skin=skin, **styles[name])
        actors |= region_dots(state, actors[key])
    captions = tuple(caption_of(state, name) for name in names)
    return Description({**actors, **shared}, pose=pose_of(state), legend=legend, views=captions)


def region_dots(state: State, body: Actor) -> dict[str, Actor]:
    """Return dots on the region that is looked at, in the view of a body."""
    regions = () if state.disagreement is None else state.disagreement.regions
    chosen = [one.vertices for one in regions if one.key == state.region]
    if not chosen:
        return {}
    inputs = body.points, body.skin, chosen[0]
    dots = state.memo(f"region {body.view}", inputs, lambda: vertex_dots(body, chosen[0]))
    return {f"region {body.view}": replace(dots, view=body.view)}


def caption_of(state: State, name: str) -> str:
    """Return the title of a method's view, with its progress, its error or what is subtracted."""
    title = shown_title(state, name)
    result = state.compared.get(name)
    if weights_of(state, name) is None:
        is_failed = result is not None and result.failed
        progress = "computing" if ("compared", name) in state.computing else "waiting"
        return f"{title} · {'failed' if is_failed else progress}"
    if field_shown(state) == "error" and (errors := errors_of(state, name)) is not None:
        return f"{title} · {10 * errors.mean**0.5:.0f} mm"  # the metric is in cm²
    if state.minus and subtracted(state) is not None:
        return f"{title} − {'itself' if name == state.minus else shown_title(state, state.minus)}"
    return title


def subtracted(state: State) -> Any:
    """Return the weights that are subtracted from all others, or None."""
    is_subtracted = state.minus in state.methods and field_shown(state) != "error"
    return weights_of(state, state.minus) if is_subtracted else None


def looks_of(
    state: State, tables: dict[str, Any]
) -> tuple[dict[str, dict[str, Any]], Legend | None]:
    """Return the colours of each method's body, and the legend of all."""
    computed = {name: table for name, table in tables.items() if table is not None}
    field, base, styles, legend = field_shown(state), subtracted(state), {}, None
    which = None if field == "all" else state.joint
    branch = field == "branch"
    if field == "error":
        return error_looks(state, computed)
    if base is not None:
        differences = {
            name: state.memo(
                f"apart {name}", (table, base, which), partial(_difference, table, base, which)
            )
            for name, table in computed.items()
        }
        top = round_top(max(float(np.abs(one).max()) for one in differences.values()))
        kind, low = ("error", 0.0) if which is None else ("difference", -top)
        styles = {name: _scalars(one, kind, (low, top)) for name, one in differences.items()}
        if which is None:
            return styles, Legend("Difference of the weights", "error", "0%", f"{top:.0%}")
        title = f"Weight of {short_names(state.rig.skeleton.names)[which]}, difference"
        return styles, Legend(title, "difference", f"−{top:g}", f"+{top:g}")
    for name, table in computed.items():
        styles[name], legend = state.memo(
            f"colors {name}",
            (table, which, branch),
            partial(weight_colors, state.rig, table, which, branch),
        )
    return styles, legend


def field_shown(state: State) -> str:
    """Return the choice of colours; without weights of the file there is no error."""
    has_error = state.compare_field != "error" or state.rig.weights is not None
    return state.compare_field if has_error else "bone"


def error_looks(
    state: State, cached: dict[str, Any]
) -> tuple[dict[str, dict[str, Any]], Legend | None]:
    """Return the colours of the deformation error, on one scale for all methods."""
    errors = {name: one for name in cached if (one := errors_of(state, name)) is not None}
    styles: dict[str, dict[str, Any]] = {name: {} for name in cached}
    if not errors:
        return styles, None
    # The metric is in cm².
    lengths = {name: np.asarray(10 * np.sqrt(one.vertex)) for name, one in errors.items()}
    limits = max(map(error_limits, lengths.values()))
    for name, values in lengths.items():
        styles[name] = _scalars(values, "error", limits)
    return styles, Legend("Largest error for 30° turns", "error", "0", f"{limits[1]:g} mm")


def errors_of(state: State, name: str) -> Any:
    """Return the DeformationError of a method's weights against the file's, if it is known."""
    result = state.compared.get(name)
    return None if result is None else result.errors


def _difference(table: NDArray, base: NDArray, joint: int | None) -> NDArray:
    """Return the difference of a joint's weights, or half of its sum over all joints, (n,)."""
    if joint is None:
        return np.abs(table - base).sum(axis=1) / 2
    return table[:, joint] - base[:, joint]


def round_top(largest: float) -> float:
    """Return the end of a scale, a round number from 0.01 to 1, for the largest difference."""
    return next((top for top in TOPS if largest <= top * (1 + 1e-6)), 1.0)


def _scalars(values: NDArray, colormap: str, limits: tuple[float, float]) -> dict[str, Any]:
    return {"scalars": values.astype(np.float32), "colormap": colormap, "limits": limits}
