"""Add joints to the skeleton, remove them, hang them on others."""

from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Any

import numpy as np

from cutcell.editing.corrections import Corrections, JointCorrection, PartCorrection
from cutcell.errors import CutcellError, ParameterError
from cutcell.rig import Rig

from .correct import check_alone, correct, corrected_state
from .moving import mirror_of, moves_along, rounded
from .session import Session

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
    mirror, partner = mirror_of(session), moves_along(session)
    # Where one side is an ancestor of the other, the other stays.
    independent = partner is not None and not (on >= 0 and skeleton.subtree[partner][on])
    if mirror is not None and partner is not None and independent:
        across = int(mirror.joint[on]) if on >= 0 else -1
        hung[partner] = across if across >= 0 else on
    corrected = dict(state.corrections.joints)
    try:
        for one, above in hung.items():
            check_alone(skeleton, one)
            name = skeleton.names[one]
            to = skeleton.names[above] if above >= 0 else ""
            corrected[name] = replace(corrected.get(name, JointCorrection()), parent=to)
    except CutcellError as error:
        session.fail(error)
        state.param.trigger("corrections")  # the menu shows again what there is
        return
    correct(session, replace(state.corrections, joints=corrected))


def may_hang_on(rig: Rig, joint: int) -> list[str]:
    """List the possible parents of a joint: all but itself and its descendants."""
    below = rig.skeleton.subtree[joint]
    return [name for name, is_below in zip(rig.skeleton.names, below, strict=True) if not is_below]


def with_child(rig: Rig, corrections: Corrections, name: str) -> tuple[Corrections, str]:
    """Return corrections with a joint more, and its name.

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
    new = _unused(name, {*skeleton.names, *corrections.joints})
    put = tuple(np.asarray(rounded(rig, place)).tolist())
    joints = {**corrections.joints, new: JointCorrection(added=True, position=put, parent=name)}
    if len(children) == 1:
        child = skeleton.names[children[0]]
        joints[child] = replace(joints.get(child, JointCorrection()), parent=new)
    return replace(corrections, joints=joints), new


def without(rig: Rig, corrections: Corrections, name: str) -> tuple[Corrections, str]:
    """Return corrections without a joint, and its parent, which takes over.

    Raises
    ------
    ParameterError
        It is the only one.
    """
    skeleton = rig.skeleton
    if len(skeleton.names) < 2:
        raise ParameterError(f'"{name}" is the only joint; at least one has to stay')
    above = int(skeleton.parents[skeleton.names.index(name)])
    heir = skeleton.names[above] if above >= 0 else ""

    def now(joint: Any) -> Any:
        return heir if joint == name else joint

    one = corrections.joints.get(name, JointCorrection())
    joints = {
        key: replace(other, parent=now(other.parent))
        for key, other in corrections.joints.items()
        if key != name
    }
    parts: dict[int, PartCorrection] = {
        vertex: replace(part, joint=now(part.joint))
        for vertex, part in corrections.parts.items()
        if heir or part.joint != name
    }
    vertices: dict[int, dict[str, float]] = {}
    for vertex, weights in corrections.vertices.items():
        similarity: dict[str, float] = {}
        for joint, weight in weights.items():
            if heir or joint != name:
                similarity[now(joint)] = similarity.get(now(joint), 0.0) + weight
        if any(similarity.values()):
            vertices[vertex] = similarity
    removed = corrections.removed if one.added else (*corrections.removed, one.was or name)
    left = replace(corrections, joints=joints, parts=parts, vertices=vertices, removed=removed)
    return left, heir


def _unused(name: str, names: Collection[str]) -> str:
    """Return a name that no joint has, after that of the joint before it."""
    stem, _, number = name.rpartition("_")
    stem = stem if stem and number.isdigit() else name
    count = 1
    while f"{stem}_{count}" in names:
        count += 1
    return f"{stem}_{count}"


def _change(
    session: Session, change: Callable[[Rig, Corrections, str], tuple[Corrections, str]]
) -> None:
    """Change the chosen joint and the one on the other side; choose what the first leads to."""
    state = session.state
    names, partner = state.rig.skeleton.names, moves_along(session)
    corrections, chosen = state.corrections, []
    try:
        for joint in (state.joint, *([] if partner is None else [partner])):
            check_alone(state.rig.skeleton, joint)
            corrections, leads_to = change(state.rig, corrections, names[joint])
            chosen.append(leads_to)
        changed = corrected_state(session, corrections)
    except CutcellError as error:
        session.fail(error)
        return
    names = changed["rig"].skeleton.names
    changed["joint"] = names.index(chosen[0]) if chosen[0] in names else 0
    state.param.update(**changed)  # at once: it is one step to undo
