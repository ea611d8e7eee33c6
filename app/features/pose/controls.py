"""Turn joints, play motions, and see where other weights would put the skin."""

from typing import Any

import numpy as np
from bokeh.models import PrintfTickFormatter

from cutcell.io.materials.transfer import has_materials
from cutcell_viewers.short_names import short_names

from ...document.session import Session
from ...document.state import State
from ...editing.brush.controls import BRUSH
from ...editing.select.controls import SELECTION
from ...looks.controls import REST
from ...looks.pose import SWING, play
from ...widgets import controls as ui
from ...widgets.rows import Rows
from . import results as actions
from .pose_list import SAVED
from .poses import motions
from .scene import error_of, has_rival

AXES = ("x", "y", "z")
RING_COLORS = ("#e5484d", "#30a46c", "#3e83f8")
FEW_NOTES = 3
"""Largest number of faults of materials that are listed one by one."""
SAME_WEIGHTS = "Same weights. Joints bulge slightly instead of collapsing."
WORST = 8
"""How many of the worst turns are listed."""
WORST_TEXT = "Largest errors for 30° rotations (root mean square). Click to show."


def _how_to_turn(state: State) -> str:
    if not ui.has_joint(state):
        return ""
    name = ui.joint_title(state.rig, state.joint)
    if state.brush:
        return f"Use the sliders to rotate {name}. The rings are hidden while painting."
    return f"Drag the rings or the sliders to rotate {name}."


def _angle(axis: int) -> Any:
    """Return the slider that turns the chosen joint about an axis."""
    color = RING_COLORS[axis]
    return ui.slider(
        "",
        label=f"About {AXES[axis].upper()}",
        act=lambda session, angle: actions.turn_joint(session, axis, float(angle)),
        value=lambda state: float(round(state.turns.get(state.joint, (0, 0, 0))[axis])),
        start=-180, end=180, step=1, format=PrintfTickFormatter(format="%d°"),
        margin=0, track=False,
        sx={"& .MuiSlider-thumb": {"bgcolor": color}, "& .MuiSlider-root": {"color": color}},
    )  # fmt: skip


def _colours(state: State) -> dict[str, Any]:
    """Return the choices of colours, and the chosen one."""
    names = {"Weights": "weights", "Plain": "plain"}
    if state.rig is None or has_materials(state.rig):
        names["Materials"] = "materials"
    is_offered = state.pose_colors in names.values()
    return {"options": names, "value": state.pose_colors if is_offered else "weights"}


def notes_text(state: State) -> str:
    """List the faults of the shown materials, in sentences."""
    if state.materials is None:
        return ""
    notes = state.materials.notes
    more = [f"and {len(notes) - FEW_NOTES} more"] if len(notes) > FEW_NOTES else []
    return " ".join(f"{note.rstrip('.')}." for note in [*notes[:FEW_NOTES], *more])


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


def _show_worst(session: Session, row: int) -> None:
    one = _worst(session.state)[row]
    actions.show_turn(session, one.joint, one.axis)


def _worst(state: State) -> list[Any]:
    return [] if state.errors is None else state.errors.worst(WORST)


CONTROLS = ui.column(
    ui.intro("Pose bones by hand or play a motion."),
    ui.section(
        "", ui.caption(_how_to_turn, margin=0), [_angle(axis) for axis in range(3)], REST, top=8
    ),
    ui.section(
        "",
        ui.pick(
            "Motion",
            lambda s: [*motions(s).values()],
            lambda s: [*motions(s)].index(s.clip if s.clip in motions(s) else SWING),
            lambda session, place: session.state.param.update(
                clip=[*motions(session.state)][place]
            ),
        ),
        ui.choice("axis", visible=lambda s: s.clip == SWING),
        ui.play_button(play, variant="contained"),
        top=2,
    ),
    SAVED,
    ui.section(
        "Blending",
        ui.choice("blending"),
        ui.caption(lambda s: SAME_WEIGHTS, visible=lambda s: s.blending == "dual"),
    ),
    ui.section(
        "Colours of the body",
        ui.choice("pose_colors", shows=_colours),
        ui.caption(notes_text, visible=lambda s: bool(notes_text(s))),
    ),
    BRUSH,
    SELECTION,
    ui.section(
        "Compare with original weights",
        ui.choice("rival"),
        ui.switch("heat", margin=ui.GAP),
        ui.caption(lambda s: error_text(s, error_of(s))),
        ui.caption(lambda s: WORST_TEXT if _worst(s) else "", margin=(6, 0, 2, 0)),
        ui.Control(
            Rows,
            act=_show_worst,
            shows=lambda s: {"rows": worst_rows(s), "chosen": chosen_row(s)},
            label="Largest errors",
            margin=(0, -8),
            **ui.WIDE,
        ),
        visible=lambda s: s.rig is not None and has_rival(s),
    ),
)
