"""Add joints to the skeleton, remove them, hang them on others."""

from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Any

import numpy as np
from param.parameterized import batch_call_watchers

from cutcell.editing import Computed, Edits, JointEdit, Locked
from cutcell.editing.layers.contents import Content
from cutcell.errors import CutcellError, ParameterError
from cutcell.rig import Rig

from ...document.document import put
from ...document.session import Session
from ..compute.stack import changed
from .commands import check_alone, correct
from .moving import mirror_of, moves_along, rounded

BEYOND = 0.5
"""Length of the bone to a joint that is added behind a last one, relative to the bone before it."""


def add(session: Session) -> None:
    """Add a joint behind the chosen one, in the middle of its bone if it has one, and choose it."""
    _change(session, with_child)


def remove(session: Session) -> None:
    """Remove the chosen joint; its children move to its parent, which is chosen then."""
    _change(session, without)


def hang_on(session: Session, parent: str) -> None:
    """Hang the chosen joint on another, by its name, and its partner alike; "" for none."""
    state = session.state
    skeleton, joint = state.rig.skeleton, state.joint
    on = skeleton.names.index(parent) if parent else -1
    if on == int(skeleton.parents[joint]):
        return
    hung = {joint: on}
    mirror, partner = mirror_of(state), moves_along(state)
    # Where one side is an ancestor of the other, the other stays.
    independent = partner is not None and not (on >= 0 and skeleton.subtree[partner][on])
    if mirror is not None and partner is not None and independent:
        across = int(mirror.joint[on]) if on >= 0 else -1
        hung[partner] = across if across >= 0 else on
    edited = dict(state.edits.joints)
    try:
        for one, above in hung.items():
            check_alone(skeleton, one)
            name = skeleton.names[one]
            to = skeleton.names[above] if above >= 0 else ""
            edited[name] = replace(edited.get(name, JointEdit()), parent=to)
    except CutcellError as error:
        session.refuse(error)
        return
    correct(session, replace(state.edits, joints=edited))


def may_hang_on(rig: Rig, joint: int) -> list[str]:
    """List the possible parents of a joint: all but itself and its descendants."""
    below = rig.skeleton.subtree[joint]
    return [name for name, is_below in zip(rig.skeleton.names, below, strict=True) if not is_below]


def with_child(rig: Rig, edits: Edits, name: str) -> tuple[Edits, str]:
    """Return edits with a joint more, and its name.

    On a joint with a single child it splits the bone and becomes the child's parent.
    """
    skeleton = rig.skeleton
    joint = skeleton.names.index(name)
    children, parent = skeleton.children[joint], int(skeleton.parents[joint])
    start = skeleton.joints[joint]
    if len(children) == 1:
        place = (start + skeleton.joints[children[0]]) / 2
    elif parent >= 0:
        place = start + BEYOND * (start - skeleton.joints[parent])
    else:
        place = start + BEYOND * (rig.mesh.bounds.mean(axis=0) - start)
    new = _unused(name, {*skeleton.names, *edits.joints})
    put = tuple(np.asarray(rounded(rig, place)).tolist())
    joints = {**edits.joints, new: JointEdit(added=True, position=put, parent=name)}
    if len(children) == 1:
        child = skeleton.names[children[0]]
        joints[child] = replace(joints.get(child, JointEdit()), parent=new)
    return replace(edits, joints=joints), new


def without(rig: Rig, edits: Edits, name: str) -> tuple[Edits, str]:
    """Return edits without a joint, and its parent, which takes over; the only one must stay."""
    skeleton = rig.skeleton
    if len(skeleton.names) < 2:
        raise ParameterError(f'"{name}" is the only joint; at least one has to stay')
    above = int(skeleton.parents[skeleton.names.index(name)])
    heir = skeleton.names[above] if above >= 0 else ""

    def now(joint: Any) -> Any:
        return heir if joint == name else joint

    one = edits.joints.get(name, JointEdit())
    joints = {
        key: replace(
            other,
            parent=now(other.parent),
            partner=None if other.partner == name else other.partner,
        )
        for key, other in edits.joints.items()
        if key != name
    }
    removed = edits.removed if one.added else (*edits.removed, one.was or name)

    def left(content: Content) -> Content | None:
        own = None if isinstance(content, Computed | Locked) else heir or None
        return content.renamed(lambda joint: own if joint == name else joint)

    return replace(changed(edits, left), joints=joints, removed=removed), heir


def _unused(name: str, names: Collection[str]) -> str:
    """Return a name that no joint has, after that of the joint before it."""
    stem, _, number = name.rpartition("_")
    stem = stem if stem and number.isdigit() else name
    count = 1
    while f"{stem}_{count}" in names:
        count += 1
    return f"{stem}_{count}"


def _change(session: Session, change: Callable[[Rig, Edits, str], tuple[Edits, str]]) -> None:
    """Change the chosen joint and the one on the other side; choose what the first leads to."""
    state = session.state
    names, partner = state.rig.skeleton.names, moves_along(state)
    edits, chosen = state.edits, []
    try:
        for joint in (state.joint, *([] if partner is None else [partner])):
            check_alone(state.rig.skeleton, joint)
            edits, leads_to = change(state.rig, edits, names[joint])
            chosen.append(leads_to)
        with batch_call_watchers(state):  # at once: it is one step to undo
            put(state, edits=edits)
            names = state.rig.skeleton.names
            state.joint = names.index(chosen[0]) if chosen[0] in names else 0
    except CutcellError as error:
        session.fail(error)
