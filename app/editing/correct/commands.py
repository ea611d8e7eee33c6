"""Edit joints, parts and single vertices; save the edits, open others."""

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from cutcell.editing import Edits, JointEdit, Painted
from cutcell.editing.layers.contents import Content
from cutcell.errors import CutcellError, ParameterError
from cutcell.rig import Skeleton
from cutcell.rig.deform_joints import deform_joints
from cutcell.runtime.display import shown_name

from ...document.document import put
from ...document.edits import renamed, tidy
from ...document.method import chosen_by, stored_method
from ...document.session import Session
from ...document.state import State
from ...files.receive import safe_name
from ..compute import stack


def correct(session: Session, edits: Edits) -> None:
    """Replace the edits; report and refuse those that are impossible."""
    state, edits = session.state, tidy(edits)
    if edits == state.edits:
        return
    try:
        put(state, edits=edits)
    except CutcellError as error:
        session.refuse(error)


def correct_joint(session: Session, joint: int, **changed: Any) -> None:
    """Change some of what is edited of a joint: "locked", "gain", "radius", or see `JointEdit`."""
    state = session.state
    name = state.rig.skeleton.names[joint]
    if "deform" in changed and changed["deform"] == bool(state.own_skeleton.deform[joint]):
        changed["deform"] = None
    edited = state.edits.joints
    try:
        check_alone(state.rig.skeleton, joint)
        edits, reach = state.edits, state.edits.reach
        if "locked" in changed:
            edits = stack.with_locks(edits, [name], changed.pop("locked"))
        if changed.keys() & {"gain", "radius"}:
            gain = changed.pop("gain", reach.gain.get(name, 1.0))
            radius = changed.pop("radius", reach.radius.get(name))
            edits = stack.with_reach(edits, name, gain, radius)
        one = replace(edited.get(name, JointEdit()), **changed)
    except CutcellError as error:
        session.refuse(error)
        return
    correct(session, replace(edits, joints={**edited, name: one}))


def rename(session: Session, joint: int, name: str) -> None:
    """Call a joint otherwise."""
    state, name = session.state, name.strip()
    old = state.rig.skeleton.names[joint]
    if name == old:
        return
    try:
        check_alone(state.rig.skeleton, joint)
        if not name:
            raise ParameterError("a joint needs a name")
        if name in state.rig.skeleton.names:
            raise ParameterError(
                f'another joint is called "{shown_name(name)}" already; choose another name'
            )
    except CutcellError as error:
        session.refuse(error)
        return
    correct(session, renamed(state.edits, old, name))


def check_alone(skeleton: Skeleton, joint: int) -> None:
    """Refuse a joint that another one shares its name with: edits go by names."""
    name = skeleton.names[joint]
    if skeleton.names.index(name) != joint:
        raise ParameterError(f'two joints are called "{name}"; rename one to correct it')


def choose_deform(session: Session, joints: Collection[int]) -> None:
    """Choose the joints that may carry weight."""
    state = session.state
    deform = np.zeros(len(state.rig.skeleton.joints), bool)
    deform[list(joints)] = True
    if not deform.any():
        session.refuse(ParameterError("no joint is left that may carry weight; keep at least one"))
        return
    edited = dict(state.edits.joints)
    own = state.own_skeleton.deform.tolist()
    for name, on, before in zip(state.rig.skeleton.names, deform.tolist(), own, strict=True):
        override = None if on == before else on
        edited[name] = replace(edited.get(name, JointEdit()), deform=override)
    correct(session, replace(state.edits, joints=edited))


def guess(session: Session, done: Any) -> None:
    """Guess from names and places which joints deform; `done` is called with a `DeformJoints`."""
    rig = session.state.rig
    session.work.newest("deform", lambda progress: deform_joints(rig.mesh, rig.skeleton), done)


def correct_part(session: Session, vertices: Collection[int], content: Content | None) -> None:
    """Bind a connected component, all of its vertices, in another way; None for as computed."""
    correct(session, stack.with_part(session.state.edits, vertices, content))


def overrule(session: Session, vertex: int, weights: Mapping[int, float] | None) -> None:
    """Give a vertex weights, by joint; None for those that are computed.

    Vertices in the same place get the same: the skin would tear there else.
    """
    state = session.state
    node = state.binding.graph.vertex_node
    together = np.flatnonzero(node == node[vertex])
    if weights is None:
        correct(session, stack.without_painted(state.edits, together))
        return
    joints = [joint for joint, weight in weights.items() if weight]
    if state.rig.allowed is not None:
        stored = state.rig.allowed[together][:, joints]
        together = together[stored.all(axis=1) | (together == vertex)]
    try:
        names = [state.rig.skeleton.names[joint] for joint in joints]
        row = np.array([[weights[joint] for joint in joints]])
        painting = Painted(together, names, np.repeat(row, len(together), axis=0))
        edits, place = stack.painted(state.edits, painting, state.layer, "")
    except CutcellError as error:
        session.fail(error)
        return
    correct(session, edits)
    state.layer = place


def uses_file(state: State) -> bool:
    """Return whether the layers begin from the file's weights."""
    return bool(state.edits.base == "file")


def choose_file(session: Session, from_file: bool) -> None:
    """Begin from the file's weights, or from computed ones."""
    correct(session, stack.with_base(session.state.edits, from_file))


def lock(session: Session, joints: Collection[int]) -> None:
    """Lock joints to the file's weights."""
    state = session.state
    try:
        for joint in joints:
            check_alone(state.rig.skeleton, joint)
    except CutcellError as error:
        session.fail(error)
        return
    names = [state.rig.skeleton.names[joint] for joint in joints]
    correct(session, stack.with_locks(state.edits, names))


def leave_out(session: Session, joints: Collection[int]) -> None:
    """Exclude some joints from carrying weight, and report it."""
    state = session.state
    names = [shown_name(state.rig.skeleton.names[j]) for j in joints]
    carrying = set(np.flatnonzero(state.rig.skeleton.deform).tolist())
    before = state.edits
    choose_deform(session, carrying - set(joints))
    if state.edits != before:
        subject = names[0] if len(names) == 1 else f"{len(names)} joints"
        verb = "carries" if len(names) == 1 else "carry"
        session.state.message = (
            "info",
            f"{subject} {verb} no weight any more; undo takes it back.",
        )


def clear(session: Session) -> None:
    """Correct nothing any more; a file's own weights stay the base."""
    correct(session, Edits(base=session.state.opening.base))


def save(session: Session) -> None:
    """Hand the edits over as a file, with the method of the weights."""
    session.view.offer(file_name(session), stored(session))


def stored(session: Session) -> bytes:
    """Return the content of the file of edits."""
    edits = replace(session.state.edits, method=stored_method(session.state))
    return (edits.to_json() + "\n").encode()


def file_name(session: Session) -> str:
    """Return the name of the file of edits."""
    return f"{safe_name(session.state.rig.name).rsplit('.', 1)[0]}.layers.json"


def open_text(session: Session, text: str) -> None:
    """Take the edits, and the method, that a file holds."""
    try:
        edits = Edits.from_json(text)
        put(session.state, edits=tidy(replace(edits, method={})), **chosen_by(edits.method))
    except CutcellError as error:
        session.fail(error)
