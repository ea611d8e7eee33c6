"""Turn a joint, play a motion, go back to rest."""

from __future__ import annotations

from typing import Any

import panel_material_ui as pmui

from ..session import Session
from .parts import GAP, caption, choice, section, when

AXES = ("x", "y", "z")


def pose(session: Session) -> pmui.Column:
    """Return the controls of the panel Pose."""
    state = session.state
    axis = choice(state.param.axis, {"about X": "x", "about Y": "y", "about Z": "z"})
    motion = pmui.Select(
        label="Motion", options={}, size="small", margin=GAP, sizing_mode="stretch_width"
    )

    def listed(*events: Any) -> None:
        clips = state.rig.clips if state.rig is not None else ()
        options = {clip.name or f"clip {i}": i for i, clip in enumerate(clips)}
        motion.param.update(options={**options, "Swing the bone": -1}, value=state.clip)

    def chosen(event: Any) -> None:
        if event.new is not None:
            state.clip = event.new

    state.param.watch(listed, ["rig", "clip"])
    motion.param.watch(chosen, "value")
    listed()

    def play(event: Any) -> None:
        state.param.update(moving=True, playing=not state.playing)

    def rest(event: Any) -> None:
        state.param.update(turns={}, moving=False, playing=False)

    buttons = pmui.Row(
        pmui.Button(
            label=when(lambda on: "Pause" if on else "Play", state.param.playing),
            icon=when(lambda on: "pause" if on else "play_arrow", state.param.playing),
            size="small",
            on_click=play,
            margin=(4, 8, 4, 0),
            sizing_mode="stretch_width",
        ),
        pmui.Button(
            label="Rest pose",
            variant="outlined",
            size="small",
            on_click=rest,
            margin=(4, 0),
            sizing_mode="stretch_width",
            disabled=when(lambda *_: not state.posed, state.param.turns, state.param.moving),
        ),
        sizing_mode="stretch_width",
        margin=0,
    )
    turned = caption(
        when(
            lambda rig, joint: "" if rig is None else f"Turn {rig.skeleton.names[joint]}",
            state.param.rig,
            state.param.joint,
        ),
        margin=0,
    )
    return section("Pose", turned, axis, _angle(session), motion, buttons)


def _angle(session: Session) -> pmui.IntSlider:
    state = session.state
    slider = pmui.IntSlider(
        label="Angle",
        value=0,
        start=-120,
        end=120,
        step=1,
        format="0°",
        size="small",
        margin=GAP,
        sizing_mode="stretch_width",
    )

    def turned(event: Any) -> None:
        k = AXES.index(state.axis)
        angles = list(state.turns.get(state.joint, (0, 0, 0)))
        if angles[k] == event.new:
            return
        angles[k] = event.new
        turns = {**state.turns, state.joint: tuple(angles)}
        state.param.update(turns=turns, moving=False, playing=False)

    def shown(*events: Any) -> None:
        slider.value = state.turns.get(state.joint, (0, 0, 0))[AXES.index(state.axis)]

    slider.param.watch(turned, "value")
    state.param.watch(shown, ["turns", "joint", "axis"])
    return slider
