"""Symmetry: a sentence about its map, and the pairs of joints that tools mirror."""

from dataclasses import replace
from typing import Any

import numpy as np

from cutcell.editing import JointEdit
from cutcell.editing.symmetry import Mirror
from cutcell.errors import CutcellError
from cutcell.runtime.display import listed
from cutcell_viewers.short_names import short_names

from ...document.session import Session
from ...document.state import State
from ...widgets import controls as ui
from ...widgets.rows import Rows
from ..correct.commands import check_alone, correct
from ..correct.moving import mirror_of
from .results import is_wanted

AUTOMATIC, NOBODY = "By name and position", "None"


def about(state: State) -> str:
    """Describe the map, and list joints without a partner."""
    image = state.mirror_image
    if image is None:
        return "The mirror image is computed."
    if isinstance(image, str):
        return f"{image[:1].upper()}{image[1:]}."
    text = "Part of each vertex's weight that its mirror image gives to other joints."
    names = np.array(short_names(state.rig.skeleton.names))
    alone = names[(image.mirror.joint < 0) & state.rig.skeleton.deform].tolist()
    return f"{text} Joints without a partner: {listed(alone)}." if alone else text


def _pairs(state: State) -> list[tuple[int, int, str]]:
    """Return the joints of each pair, and what pairs them; -1 for the partner of one alone."""
    mirror = _mirror(state)
    if mirror is None:
        return []
    joints, deform = (
        enumerate(zip(mirror.joint.tolist(), mirror.how, strict=True)),
        state.rig.skeleton.deform,
    )
    return [(one, *pair) for one, pair in joints if pair[0] > one or (pair[0] < 0 and deform[one])]


def _rows(state: State) -> dict[str, Any]:
    """Return a row for each pair, and that of the chosen joint."""
    pairs, names = _pairs(state), [*short_names(_names(state)), "none"]
    rows = [(f"{names[one]} \u2013 {names[other]}", how, 0.0) for one, other, how in pairs]
    chosen = next((row for row, pair in enumerate(pairs) if state.joint in pair[:2]), -1)
    return {"rows": rows, "chosen": chosen}


def _choose(session: Session, row: int) -> None:
    session.state.joint = _pairs(session.state)[row][0]


def _names(state: State) -> tuple[str, ...]:
    return state.rig.skeleton.names if ui.has_joint(state) else ()


def _partner(state: State) -> int:
    """Return the place in the menu of what is set for the chosen joint."""
    names = _names(state)
    partner = state.rig.partners.get(names[state.joint]) if names else None
    return [None, "", *names].index(partner)


def set_partner(session: Session, place: int) -> None:
    """Set the partner of the chosen joint; both lose others that were set."""
    state, edits = session.state, session.state.edits
    name, partner = state.rig.skeleton.names[state.joint], (None, "", *_names(state))[place]
    pair = {name: partner, **({partner: name} if partner else {})}
    try:
        for one in pair:
            check_alone(state.rig.skeleton, state.rig.skeleton.names.index(one))
    except CutcellError as error:
        session.refuse(error)
        return
    joints = {
        one: replace(edit, partner=None) if edit.partner in pair else edit
        for one, edit in edits.joints.items()
    }
    for one, other in pair.items():
        joints[one] = replace(joints.get(one, JointEdit()), partner=other)
    correct(session, replace(edits, joints=joints))


def _label(state: State) -> str:
    return f"Partner of {ui.joint_title(state.rig, state.joint)}" if ui.has_joint(state) else ""


def _mirror(state: State) -> Mirror | None:
    return None if state.own is None or state.bare else mirror_of(state)


SYMMETRY = ui.caption(about, visible=lambda state: is_wanted(state))
"""The map of symmetry: the difference of weights between each vertex and its mirror image."""
PAIRS = ui.folded(
    "Pairs of joints",
    ui.caption("What mirror, swap, symmetry and brush take as sides. Click a pair to change it."),
    ui.column(
        ui.Control(Rows, act=_choose, shows=_rows, label="Pairs of joints", **ui.FULL),
        margin=ui.GAP, max_height=200, scroll="y",
    ),
    ui.pick(
        _label, lambda state: [AUTOMATIC, NOBODY, *short_names(_names(state))], _partner,
        set_partner, searchable=True, margin=(16, 0, 4, 0),
    ),
    visible=lambda state: _mirror(state) is not None,
)  # fmt: skip
