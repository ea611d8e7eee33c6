"""Correct the binding: joints, parts and single vertices; save the corrections, open others."""

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.editing.correct import corrected_rig, correction_steps, locked_by
from cutcell.editing.corrections import Corrections, JointCorrection, PartCorrection
from cutcell.editing.locks import locked_joints
from cutcell.errors import CutcellError, ParameterError
from cutcell.graph import CutCellGraph
from cutcell.method import ANIMATION
from cutcell.rig import Rig, Skeleton
from cutcell.rig.deform_joints import DeformJoints, deform_joints
from cutcell.runtime.display import shown_name
from cutcell.weights.context import Context, run
from cutcell.weights.rig_falloff.surface_operators import SurfaceOperators

from ..files.receive import safe_name
from ..state.corrections import changes, renamed, tidy
from .session import Session


def correct(session: Session, corrections: Corrections) -> None:
    """Replace the corrections; report and refuse those that are impossible."""
    state, corrections = session.state, tidy(corrections)
    if corrections == state.corrections:
        return
    try:
        state.param.update(**corrected_state(session, corrections))
    except CutcellError as error:
        session.fail(error)
        state.param.trigger("corrections")  # reset the controls


def corrected_state(session: Session, corrections: Corrections) -> dict[str, Any]:
    """Return the values of the state that corrections of the open character change.

    Raises
    ------
    CutcellError
        It cannot be corrected so.
    """
    state = session.state
    rig = corrected_rig(state.own, corrections)
    locked_joints(rig, locked_by(corrections))
    return changes(state, rig, corrections)


def correct_joint(session: Session, joint: int, **changed: Any) -> None:
    """Change some of what is corrected of a joint; see `JointCorrection`."""
    state = session.state
    name = state.rig.skeleton.names[joint]
    if "deform" in changed and changed["deform"] == bool(state.own_skeleton.deform[joint]):
        changed["deform"] = None
    corrected = state.corrections.joints
    try:
        check_alone(state.rig.skeleton, joint)
        one = replace(corrected.get(name, JointCorrection()), **changed)
    except CutcellError as error:
        session.fail(error)
        state.param.trigger("corrections")
        return
    correct(session, replace(state.corrections, joints={**corrected, name: one}))


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
        session.fail(error)
        state.param.trigger("corrections")
        return
    correct(session, renamed(state.corrections, old, name))


def check_alone(skeleton: Skeleton, joint: int) -> None:
    """Refuse a joint that another one shares its name with: corrections go by names."""
    name = skeleton.names[joint]
    if skeleton.names.index(name) != joint:
        raise ParameterError(f'two joints are called "{name}"; rename one to correct it')


def choose_deform(session: Session, joints: Collection[int]) -> None:
    """Choose the joints that may carry weight."""
    state = session.state
    deform = np.zeros(len(state.rig.skeleton.joints), bool)
    deform[list(joints)] = True
    if not deform.any():
        session.fail(ParameterError("no joint is left that may carry weight; keep at least one"))
        state.param.trigger("corrections")
        return
    corrected = dict(state.corrections.joints)
    for joint, name in enumerate(state.rig.skeleton.names):
        override = (
            None if deform[joint] == state.own_skeleton.deform[joint] else bool(deform[joint])
        )
        corrected[name] = replace(corrected.get(name, JointCorrection()), deform=override)
    correct(session, replace(state.corrections, joints=corrected))


def guess(session: Session, done: Any) -> None:
    """Guess from names and places which joints deform; `done` is called with a `DeformJoints`."""
    rig = session.state.rig

    def work(progress: Any) -> DeformJoints:
        return deform_joints(rig.mesh, rig.skeleton)

    session.tasks.newest("deform").do(work, done)


def correct_part(session: Session, vertices: Collection[int], part: PartCorrection | None) -> None:
    """Bind a connected component, all of its vertices, in another way; None for as computed."""
    state = session.state
    corrected = {v: one for v, one in state.corrections.parts.items() if v not in vertices}
    if part is not None:
        corrected[int(min(vertices))] = part
    correct(session, replace(state.corrections, parts=corrected))


def overrule(session: Session, vertex: int, weights: Mapping[int, float] | None) -> None:
    """Give a vertex weights, by joint; None for those that are computed.

    Vertices in the same place get the same: the skin would tear there else.
    """
    state = session.state
    node = state.binding.graph.vertex_node
    together = np.flatnonzero(node == node[vertex])
    overrides = None
    if weights is not None:
        overrides = {state.rig.skeleton.names[joint]: w for joint, w in weights.items() if w}
        if state.rig.allowed is not None:
            stored = state.rig.allowed[together][:, [j for j, w in weights.items() if w]]
            together = together[stored.all(axis=1) | (together == vertex)]
    corrected = {v: row for v, row in state.corrections.vertices.items() if v not in together}
    if overrides is not None:
        corrected.update(dict.fromkeys(together.tolist(), overrides))
    try:
        corrections = replace(state.corrections, vertices=corrected)
    except CutcellError as error:
        session.fail(error)
        return
    correct(session, corrections)


def uses_file(session: Session) -> bool:
    """Return whether every part of the mesh has the file's weights."""
    state, parts = session.state, session.state.corrections.parts
    expected = set(parts) if state.graph is None else set(_first_vertices(session))
    return bool(parts) and expected <= {v for v, part in parts.items() if part.how == "file"}


def choose_file(session: Session, from_file: bool) -> None:
    """Give every part of the mesh the file's weights, to correct these, or compute all again."""
    corrections = session.state.corrections
    if from_file:
        corrections = with_file_parts(session)
    else:
        parts = {v: part for v, part in corrections.parts.items() if part.how != "file"}
        corrections = replace(corrections, parts=parts)
    correct(session, corrections)


def with_file_parts(session: Session) -> Corrections:
    """Return the corrections with the file's weights for every part of the mesh."""
    parts = dict.fromkeys(_first_vertices(session), PartCorrection("file"))
    return replace(session.state.corrections, parts=parts)


def _first_vertices(session: Session) -> list[int]:
    """Return the first vertex of each connected component of the mesh."""
    graph = session.state.graph

    def find() -> list[int]:
        component = SurfaceOperators.of(graph).component[graph.vertex_node]
        first: list[int] = np.unique(component, return_index=True)[1].tolist()
        return first

    vertices: list[int] = session.memo("first vertices", (graph,), find)
    return vertices


def keep_file_vertices(session: Session, vertices: NDArray[np.intp]) -> None:
    """Give some vertices the file's weights; those without weights there stay as they are."""
    state = session.state
    names, weights = state.rig.skeleton.names, state.rig.weights[vertices]
    rows: dict[int, dict[str, float]] = {}
    try:
        for joint in np.flatnonzero(weights.any(axis=0)):
            check_alone(state.rig.skeleton, int(joint))
        for row, joint in zip(*np.nonzero(weights), strict=True):
            rows.setdefault(int(vertices[row]), {})[names[joint]] = float(weights[row, joint])
        corrections = replace(state.corrections, vertices={**state.corrections.vertices, **rows})
    except CutcellError as error:
        session.fail(error)
        return
    correct(session, corrections)


def lock(session: Session, joints: Collection[int]) -> None:
    """Lock joints to the file's weights."""
    state = session.state
    corrected = dict(state.corrections.joints)
    try:
        for joint in joints:
            check_alone(state.rig.skeleton, joint)
            name = state.rig.skeleton.names[joint]
            corrected[name] = replace(corrected.get(name, JointCorrection()), locked=True)
    except CutcellError as error:
        session.fail(error)
        return
    correct(session, replace(state.corrections, joints=corrected))


def leave_out(session: Session, joints: Collection[int]) -> None:
    """Exclude some joints from carrying weight, and report it."""
    state = session.state
    names = [shown_name(state.rig.skeleton.names[j]) for j in joints]
    carrying = set(np.flatnonzero(state.rig.skeleton.deform).tolist())
    before = state.corrections
    choose_deform(session, carrying - set(joints))
    if state.corrections != before:
        subject = names[0] if len(names) == 1 else f"{len(names)} joints"
        verb = "carries" if len(names) == 1 else "carry"
        session.binder.notice = f"{subject} {verb} no weight any more; undo takes it back."


def clear(session: Session) -> None:
    """Correct nothing any more."""
    correct(session, Corrections())


def save(session: Session) -> None:
    """Hand the corrections over as a file."""
    state = session.state
    stem = safe_name(state.rig.name).rsplit(".", 1)[0]
    session.view.offer(f"{stem}.corrections.json", (state.corrections.to_json() + "\n").encode())


def open_text(session: Session, text: str) -> None:
    """Take the corrections that a file holds."""
    try:
        corrections = Corrections.from_json(text)
    except CutcellError as error:
        session.fail(error)
        return
    correct(session, corrections)


def finished(
    rig: Rig,
    graph: CutCellGraph,
    weights: NDArray[np.float64],
    corrections: Corrections,
    max_influences: int | None,
) -> NDArray[np.float64]:
    """Return weights after what is corrected of them last, as `cutcell.bind` does."""
    method = ANIMATION.with_options(max_influences=max_influences)
    context = Context(method, graph=graph, weights=weights)
    return run(correction_steps(rig, corrections), context).weights
