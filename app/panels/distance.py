"""Geodesics: how far the chosen bone is, through the body."""

from __future__ import annotations

from typing import Any

import panel_material_ui as pmui

from ..commands.session import Session
from ..state import State
from ..state.distance import MAX_MEASURES, MEASURES
from .controls import GAP, caption, choice, intro, section, slider, weightless, when
from .cutting import cutting


def distance(session: Session) -> pmui.Column:
    """Return the controls of the panel Geodesics."""
    state = session.state
    idle = caption(
        "This bone does not deform the mesh, so it has no distance field.",
        visible=when(
            weightless,
            state.param.rig,
            state.param.joint,
        ),
    )
    return pmui.Column(
        intro("Distance to the selected bone, along the shortest path through the body."),
        section("", idle, _one(session), margin=(8, 20, 4, 20)),
        section("Shown with it", *_more(state)),
        section("Wavefront", *_wave(state)),
        section("Measures side by side", *_comparison(state)),
        margin=0,
        sizing_mode="stretch_width",
    )


def _face(state: State) -> Any:
    faces = {"Distance": "field", "Winding number": "winding"}
    has_cut = when(lambda axis: axis != "off", state.param.cut_axis)
    return choice(state.param.cut_face, faces, visible=has_cut)


def _one(session: Session) -> pmui.Column:
    """Return what there is with one view only: a cut through the body."""
    state = session.state
    return pmui.Column(
        *cutting(session), _face(state), margin=0, sizing_mode="stretch_width",
        visible=when(lambda *chosen: not any(chosen), *_switches(state)),
    )  # fmt: skip


def _switches(state: State) -> list[Any]:
    return [state.param[f"beside_{name}"] for name in MEASURES]


def _comparison(state: State) -> list[Any]:
    """Return a switch for each measure, of which four at most can be on, and their R."""
    switches = []
    for parameter in _switches(state):
        one = switch(parameter)
        full = when(
            lambda on, *chosen: not on and sum(chosen) >= MAX_MEASURES,
            parameter,
            *_switches(state),
        )
        one.disabled = full
        switches.append(one)
    any_chosen = when(lambda *chosen: any(chosen), *_switches(state))
    rate = choice(
        state.param.beside_resolution,
        {f"R = {n}": n for n in state.param.beside_resolution.objects},
        visible=any_chosen,
    )
    hint = (
        "Up to four, on one scale. The last three use the cut-cell graph. Click the body to draw "
        "the paths."
    )
    return [caption(hint), *switches, rate]


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
    starts = pmui.Column(
        switch(state.param.starts), explain, margin=0, sizing_mode="stretch_width",
        visible=when(lambda *chosen: not any(chosen), *_switches(state)),
    )  # fmt: skip
    return [switch(state.param.path), hint, starts]


def _wave(state: State) -> list[Any]:
    def play(event: Any) -> None:
        state.param.update(wave=True, animating=not state.animating)

    button = pmui.Button(
        label=when(lambda on: "Pause the wave" if on else "Play the wave", state.param.animating),
        icon=when(lambda on: "pause" if on else "play_arrow", state.param.animating),
        size="small",
        variant="outlined",
        on_click=play,
        margin=GAP,
        sizing_mode="stretch_width",
    )
    front = slider(
        state.param.front,
        "Progress",
        step=0.005,
        visible=when(lambda on, runs: on and not runs, state.param.wave, state.param.animating),
    )
    return [
        switch(state.param.wave),
        front,
        button,
    ]


def switch(parameter: Any) -> pmui.Switch:
    """Return a switch that follows a parameter, under the parameter's own label."""
    return pmui.Switch.from_param(
        parameter, label=parameter.label, size="small", margin=(3, 0), description=""
    )
