"""Symmetry: a sentence about its map, and the pairs of joints that tools mirror."""

from dataclasses import replace
from typing import Any

import numpy as np

from cutcell.editing import JointEdit
from cutcell.editing.symmetry import Mirror
from cutcell.errors import CutcellError
from cutcell_viewers.short_names import short_names

from ...document.session import Session
from ...widgets import controls as ui
from ...widgets.follow import Reader
from ...widgets.rows import Rows
from ..correct.commands import check_alone, correct
from ..correct.moving import mirror_of
from .results import is_wanted

MAX_NAMES = 6
"""Number of joints that a sentence names."""
AUTOMATIC, NOBODY = "By name and position", "None"


def about(state: Any) -> str:
    """Return what the map shows, and which joints have no partner."""
    image = state.mirror_image
    if image is None:
        return "The mirror image is computed."
    if isinstance(image, str):
        return f"{image[:1].upper()}{image[1:]}."
    text = "Part of each vertex's weight that its mirror image gives to other joints."
    alone = np.flatnonzero((image.mirror.joint < 0) & state.rig.skeleton.deform)
    names = [ui.joint_title(state.rig, joint) for joint in alone[:MAX_NAMES]]
    names += [f"and {len(alone) - MAX_NAMES} more"] if len(alone) > MAX_NAMES else []
    return f"{text} Joints without a partner: {', '.join(names)}." if names else text


def _pairs(state: Any) -> list[tuple[int, int]]:
    """Return the joints of each pair, -1 where one that may carry weight has no partner."""
    mirror: Mirror | None = mirror_of(state)
    if mirror is None:
        return []
    joints = enumerate(mirror.joint.tolist())
    deform = state.rig.skeleton.deform
    return [(one, other) for one, other in joints if other > one or (other < 0 and deform[one])]


def _rows(state: Any) -> dict[str, Any]:
    """Return a row for each pair, with what it follows from, and the row of the chosen joint."""
    pairs, mirror = _pairs(state), mirror_of(state)
    names = [*short_names(state.rig.skeleton.names), "none"] if pairs else []
    how = mirror.how if mirror else ()
    rows = [(f"{names[one]} \u2013 {names[other]}", how[one], 0.0) for one, other in pairs]
    chosen = next((row for row, pair in enumerate(pairs) if state.joint in pair), -1)
    return {"rows": rows, "chosen": chosen}


def _choose(session: Session, row: int) -> None:
    session.state.joint = _pairs(Reader(session))[row][0]


def _partners(state: Any) -> list[str]:
    names = () if state.rig is None else state.rig.skeleton.names
    return [AUTOMATIC, NOBODY, *short_names(names)]


def _partner(state: Any) -> int:
    """Return the place in the menu of what is set for the chosen joint."""
    if not ui.has_joint(state):
        return 0
    names = state.rig.skeleton.names
    partner = next((other if one == names[state.joint] else one
                    for one, other in state.rig.partners.items()
                    if names[state.joint] in (one, other)), None)  # fmt: skip
    return 0 if partner is None else names.index(partner) + 2 if partner else 1


def set_partner(session: Session, place: int) -> None:
    """Set the partner of the chosen joint; both lose others that were set."""
    state = session.state
    names = state.rig.skeleton.names
    name, partner = names[state.joint], (None, "", *names)[place]
    try:
        for joint in (state.joint, place - 2)[: 1 + (place > 1)]:
            check_alone(state.rig.skeleton, joint)
    except CutcellError as error:
        session.refuse(error)
        return
    joints = {
        one: replace(edit, partner=None) if {one, edit.partner} & {name, partner or name} else edit
        for one, edit in state.edits.joints.items()
    }
    joints[name] = replace(joints.get(name, JointEdit()), partner=partner)
    correct(session, replace(state.edits, joints=joints))


def _label(state: Any) -> str:
    return f"Partner of {ui.joint_title(state.rig, state.joint)}" if ui.has_joint(state) else ""


def _is_mirrored(state: Any) -> bool:
    return state.own is not None and not state.bare and mirror_of(state) is not None


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
        _label,
        _partners, _partner, set_partner, searchable=True, margin=(16, 0, 4, 0),
    ),
    visible=_is_mirrored,
)  # fmt: skip
