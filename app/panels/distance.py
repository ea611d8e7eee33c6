"""Geodesics: how far the chosen bone is, through the body."""

from typing import Any

import panel as pn
import panel_material_ui as pmui

from ..commands.distance import find_errors
from ..commands.session import Session
from ..state import State
from ..state.distance import CONVERGED, MAX_MEASURES, MEASURES
from .controls import (
    button,
    caption,
    choice,
    column,
    intro,
    play_button,
    section,
    slider,
    switch,
    weightless,
    when,
)  # fmt: skip
from .cutting import cutting
from .error_curves import error_curves


def distance(session: Session) -> pmui.Column:
    """Return the controls of the panel Geodesics."""
    state = session.state
    idle = caption(
        "This bone does not deform the mesh, so it has no distance field.",
        visible=when(weightless, state.param.rig, state.param.joint),
    )
    return column(
        intro("Distance to the selected bone, along the shortest path through the body."),
        section("", idle, _one(session), margin=(8, 20, 4, 20)),
        section("Shown with it", *_more(state)),
        section("Wavefront", *_wave(state)),
        section("Measures side by side", *_comparison(state)),
        section("Error and time over R", *_errors(session)),
    )


def _face(state: State) -> Any:
    faces = {"Distance": "field", "Winding number": "winding"}
    has_cut = when(lambda axis: axis not in ("auto", "off"), state.param.cut_axis)
    return choice(state.param.cut_face, faces, visible=has_cut)


def _one(session: Session) -> pmui.Column:
    """Return what there is with one view only: a cut through the body."""
    state = session.state
    return column(
        *cutting(session),
        _face(state),
        visible=when(lambda *chosen: not any(chosen), *_switches(state)),
    )


def _switches(state: State) -> list[Any]:
    return [state.param[f"beside_{name}"] for name in MEASURES]


def _comparison(state: State) -> list[Any]:
    """Return a switch for each measure, of which four at most can be on, and their R."""
    all_on = _switches(state)

    def full(on: bool, *chosen: bool) -> bool:
        return not on and sum(chosen) >= MAX_MEASURES

    switches = [switch(one, disabled=when(full, one, *all_on)) for one in all_on]
    any_chosen = when(lambda *chosen: any(chosen), *_switches(state))
    rate = choice(
        state.param.beside_resolution,
        {f"R = {n}": n for n in state.param.beside_resolution.objects},
        visible=any_chosen,
    )
    hint = (
        "Up to four, on one scale. The last four use the cut-cell graph. Click the body to draw "
        "the paths."
    )
    return [caption(hint), *switches, rate]


def _errors(session: Session) -> list[Any]:
    """Return a button that measures errors over R, and the curves."""
    state = session.state

    def curves(errors: Any, binding: Any, joint: int) -> pmui.Column:
        is_of_this = errors and binding and errors[:2] == (binding.distances, joint)
        return column(*error_curves(errors[2])) if is_of_this else column()

    measure = button(
        when(lambda runs: "Measuring" if runs else "Measure", state.param.measuring_errors),
        lambda: find_errors(session),
        disabled=when(
            lambda runs, binding, rig, joint: runs or binding is None or weightless(rig, joint),
            state.param.measuring_errors,
            state.param.binding,
            state.param.rig,
            state.param.joint,
        ),
    )
    plots = pn.bind(curves, state.param.error_curves, state.param.binding, state.param.joint)
    return [
        caption(f"Mean error against any angle at R = {CONVERGED}, and seconds."),
        measure,
        pn.panel(plots, margin=0, sizing_mode="stretch_width"),
    ]


def _more(state: State) -> list[Any]:
    hint = caption(
        "Click the body to draw the shortest path from there to the bone.",
        visible=when(
            lambda vertex, path: path and vertex is None, state.param.vertex, state.param.path
        ),
    )
    explain = caption(
        "Graph nodes nearest to the bone. Each starts at its straight distance to the bone.",
        visible=state.param.starts,
    )
    starts = column(
        switch(state.param.starts),
        explain,
        visible=when(lambda *chosen: not any(chosen), *_switches(state)),
    )
    return [switch(state.param.path), hint, starts]


def _wave(state: State) -> list[Any]:
    def play() -> None:
        state.param.update(wave=True, animating=not state.animating)

    button = play_button(state.param.animating, play, " the wave")
    front = slider(
        state.param.front,
        "Progress",
        step=0.005,
        visible=when(lambda on, runs: on and not runs, state.param.wave, state.param.animating),
    )
    return [switch(state.param.wave), front, button]
