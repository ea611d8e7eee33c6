"""Turn joints, play motions, and see where other weights would put the skin."""

from typing import Any

import numpy as np
import panel_material_ui as pmui
from bokeh.models import PrintfTickFormatter

from cutcell.io.materials.transfer import has_materials
from cutcell_viewers.short_names import short_names

from ..commands import pose as actions
from ..commands.session import Session
from ..scenes.pose import error_of, has_rival
from ..state import State
from ..widgets.rows import Rows
from .brush import brush
from .controls import (
    BUTTONS,
    GAP,
    as_text,
    caption,
    choice,
    column,
    follow,
    intro,
    joint_title,
    offer,
    play_button,
    rest_button,
    section,
    select_box,
    switch,
    unique_names,
    when,
)  # fmt: skip

AXES = ("x", "y", "z")
RING_COLORS = ("#e5484d", "#30a46c", "#3e83f8")
SWING = "Swing the bone"
FEW_NOTES = 3
"""Largest number of faults of materials that are listed one by one."""
WORST = 8
"""How many of the worst turns are listed."""


def pose(session: Session) -> pmui.Column:
    """Return the controls of the panel Pose."""
    return column(
        intro("Pose bones by hand or play a motion."),
        _turning(session),
        _motion(session),
        _colours(session),
        brush(session),
        _comparison(session),
    )


def _turning(session: Session) -> pmui.Column:
    state = session.state
    about = caption(
        when(_how_to_turn, state.param.rig, state.param.joint, state.param.brush),
        margin=0,
    )
    angles = [_angle(session, axis) for axis in range(3)]
    return section("", about, *angles, rest_button(session), margin=(8, 20, 4, 20))


def _how_to_turn(rig: Any, joint: int, brush: bool) -> str:
    if rig is None or joint >= len(rig.skeleton.names):
        return ""
    name = joint_title(rig, joint)
    if brush:
        return f"Use the sliders to rotate {name}. The rings are hidden while painting."
    return f"Drag the rings or the sliders to rotate {name}."


def _angle(session: Session, axis: int) -> pmui.FloatSlider:
    state = session.state
    color = RING_COLORS[axis]
    slider = pmui.FloatSlider(
        label=f"About {AXES[axis].upper()}",
        value=0,
        start=-180,
        end=180,
        step=1,
        format=PrintfTickFormatter(format="%d°"),
        size="small",
        margin=(0, 0),
        track=False,
        sizing_mode="stretch_width",
        sx={"& .MuiSlider-thumb": {"bgcolor": color}, "& .MuiSlider-root": {"color": color}},
    )

    def turned(event: Any) -> None:
        if event.new != round(shown_angle()):
            actions.turn_joint(session, axis, float(event.new))

    def shown_angle() -> float:
        return float(state.turns.get(state.joint, (0, 0, 0))[axis])

    def update(*events: Any) -> None:
        slider.value = float(round(shown_angle()))

    slider.param.watch(turned, "value")
    state.param.watch(update, ["turns", "joint"])
    update()
    return slider


def _motion(session: Session) -> pmui.Column:
    state = session.state
    motion = select_box("Motion")

    def listed(*events: Any) -> None:
        clips = state.rig.clips if state.rig is not None else ()
        names = [clip.name or f"clip {i}" for i, clip in enumerate(clips)]
        offer(motion, unique_names([*names, SWING]), state.clip)  # the last one is number -1

    def chosen(event: Any) -> None:
        if event.new is not None:
            index = motion.options.index(event.new)
            state.clip = index if index < len(motion.options) - 1 else -1

    state.param.watch(listed, ["rig", "clip"])
    motion.param.watch(chosen, "value")
    listed()
    axis = choice(state.param.axis, {"about X": "x", "about Y": "y", "about Z": "z"})
    axis.visible = when(lambda clip: clip < 0, state.param.clip)
    play = play_button(state.param.playing, lambda: actions.play(session), variant="contained")
    return section("", motion, axis, play, margin=(2, 20, 4, 20))


def _colours(session: Session) -> pmui.Column:
    state = session.state
    colours = pmui.RadioButtonGroup(**BUTTONS)

    def offered() -> tuple[dict[str, str], str]:
        names = {"Weights": "weights", "Plain": "plain"}
        if state.rig is None or has_materials(state.rig):
            names["Materials"] = "materials"
        is_weight_color = state.pose_colors in names.values()
        return names, state.pose_colors if is_weight_color else "weights"

    follow(colours, state, "pose_colors", offered, ["rig"])
    message = state.param.materials
    notes = caption(
        when(lambda *_: notes_text(state), message),
        visible=when(lambda *_: bool(notes_text(state)), message),
    )
    return section("Colours of the body", colours, notes)


def notes_text(state: State) -> str:
    """Return what could not be read of the materials that are seen, in sentences."""
    if state.materials is None or state.materials[1] is None:
        return ""
    notes = state.materials[1].notes
    more = [f"and {len(notes) - FEW_NOTES} more"] if len(notes) > FEW_NOTES else []
    return " ".join(f"{note.rstrip('.')}." for note in [*notes[:FEW_NOTES], *more])


def _comparison(session: Session) -> pmui.Column:
    state = session.state
    views = {"Alone": "alone", "Ghost": "ghost", "Side by side": "beside"}
    heat = switch(state.param.heat, label="Error as colours", margin=GAP)
    now = caption(
        when(
            lambda *_: error_text(state, error_of(state, session.memo)),
            state.param.turns,
            state.param.moving,
            state.param.clip,
            state.param.motion_error,
            state.param.binding,
        )
    )
    worst = Rows(
        lambda row: actions.show_turn(session, *_turn_of(state, row)),
        label="Largest errors",
        sizing_mode="stretch_width",
        margin=(0, -8),
    )
    heading = caption(margin=(6, 0, 2, 0))

    def listed(*events: Any) -> None:
        rows = worst_rows(state)
        worst.param.update(rows=rows, chosen=chosen_row(state))
        heading.object = as_text(WORST_TEXT if rows else "")

    state.param.watch(listed, ["errors", "binding", "turns", "joint"])
    listed()
    with_rival = when(
        lambda rig, binding: rig is not None and has_rival(state),
        state.param.rig,
        state.param.binding,
    )
    return section(
        "Compare with original weights",
        choice(state.param.rival, views), heat, now, heading, worst,
        visible=with_rival,
    )  # fmt: skip


WORST_TEXT = "Largest errors for 30° rotations (root mean square). Click to show."


def error_text(state: State, error: tuple[float, float] | None) -> str:
    """Return the text of the error of the visible pose."""
    if error is None:
        return 'Turn on "Error as colours" to measure the motion.' if not state.heat else ""
    if not state.posed:
        return "No error in the rest pose. Lengths are for a longest side of 1 m."
    rms, largest = error
    where = "over the motion" if state.moving else "in this pose"
    return f"RMS {rms:.3g} mm {where}, at most {largest:.3g} mm (longest side 1 m)."


def worst_rows(state: State) -> list[tuple[str, str, float]]:
    """Return the rows of the list of the worst turns."""
    turns = _worst(state)
    top = turns[0].mean if turns else 1.0
    names = state.rig.skeleton.names if turns else ()
    shorts = dict(zip(names, short_names(names), strict=True))
    return [
        (
            f"{shorts[one.name]} about {one.axis.upper()}",
            f"{10 * np.sqrt(one.mean):.3g} mm",
            float(np.sqrt(one.mean / top)),
        )
        for one in turns
    ]


def chosen_row(state: State) -> int:
    """Return which of the worst turns the character shows; -1 if none."""
    turned = {joint: angles for joint, angles in state.turns.items() if any(angles)}
    for row, one in enumerate(_worst(state)):
        expected = tuple(actions.TURN_DEGREES * float(one.axis == axis) for axis in AXES)
        if turned == {one.joint: expected}:
            return row
    return -1


def _turn_of(state: State, row: int) -> tuple[int, str]:
    one = _worst(state)[row]
    return one.joint, one.axis


def _worst(state: State) -> list[Any]:
    if state.errors is None or state.errors[0] is not state.binding:
        return []
    return state.errors[1].worst(WORST)
