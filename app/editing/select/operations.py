"""Change the weights of the selected vertices."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from cutcell.editing import Locked
from cutcell.editing.locks import locked_joints
from cutcell.editing.selections import Neighbours
from cutcell.editing.symmetry import Mirror, find_mirror
from cutcell.errors import CutcellError, ParameterError
from cutcell.rig import Rig
from cutcell_viewers.short_names import short_names

from ...document.selection import selected, selected_vertices
from ...document.session import Session
from ...document.state import State
from ...looks.selection import neighbours_of
from ..compute import operations as ops
from ..compute.mirror import side_is_positive
from ..compute.selected import Selected
from ..compute.stack import locked_names, locked_weights
from ..correct.commands import check_alone
from ..correct.moving import mirror_of
from ..layers.commands import put_content, put_rows

Rows = Callable[[Selected], NDArray[np.float64]]


def selected_rows(session: Session) -> Selected:
    """Return the selected vertices with what limits their weights.

    Raises
    ------
    ParameterError
        No vertex is selected, or the character is not bound yet.
    """
    state, chosen = session.state, selected(session.state)
    if state.binding is None:
        raise ParameterError("there are no weights to change yet; wait until they are computed")
    if chosen is None:
        raise ParameterError("no vertices are selected; select some, or all of them")
    return _limits(state, np.flatnonzero(chosen))


def _limits(state: State, vertices: NDArray[np.intp]) -> Selected:
    """Return vertices with what limits their weights."""
    names = locked_names(state.edits)
    masked = locked_weights(state.edits, state.rig, state.binding.graph)
    return Selected(state.rig, state.weights, vertices, names, state.max_influences, masked)


def change(session: Session, name: str, operation: Rows) -> None:
    """Change the weights of the selected vertices by an operation, in one step of undo."""
    change_all(session, name, lambda selected: ops.in_chunks(selected, operation))


def change_all(session: Session, name: str, operation: Callable[[Selected], csr_array]) -> None:
    """Change them by an operation that needs all selected vertices at once."""
    try:
        rows_of = selected_rows(session)
        rows = operation(rows_of)
    except CutcellError as error:
        session.fail(error)
        return
    put_rows(session, rows_of.vertices, rows, name)


def _name(rig: Rig, joint: int) -> str:
    return short_names(rig.skeleton.names)[joint]


def by_joint(name: str, operation: Callable[..., NDArray[np.float64]], sign: float = 1.0) -> Any:
    """Return a command that changes the weight of the chosen joint by the amount."""

    def act(session: Session) -> None:
        state = session.state
        title = f"{name} {_name(state.rig, state.joint)}"

        def rows_of(rows: Selected) -> csr_array:
            rows.check_unlocked(state.joint)
            joint, amount = state.joint, sign * state.amount
            return ops.in_chunks(rows, lambda part: operation(part, joint, amount))

        change_all(session, title, rows_of)

    return act


def source_joint(state: State) -> int | None:
    """Return the joint whose weight is moved; None for all."""
    names = state.rig.skeleton.names
    return names.index(state.move_from) if state.move_from in names else None


def move(session: Session) -> None:
    """Move weight of the selection, all that is unlocked or one joint's, to the chosen joint."""
    rig, target, source = session.state.rig, session.state.joint, source_joint(session.state)

    def moved(rows: Selected) -> NDArray[np.float64]:
        free = np.flatnonzero(~rows.is_locked & rig.skeleton.deform).tolist()
        return ops.move_weight(rows, free if source is None else [source], target)

    def checked(rows: Selected) -> csr_array:
        for joint in (target,) if source is None else (source, target):
            rows.check_unlocked(joint)
        if source == target:
            raise ParameterError(f"choose another bone than {_name(rig, target)} to move weight to")
        if source is not None and not rows.weights[rows.vertices, source].any():
            raise ParameterError(f"{_name(rig, source)} has no weight at the selected vertices")
        return ops.in_chunks(rows, moved)

    change_all(session, f"Move to {_name(rig, target)}", checked)


def smooth(session: Session, through: bool = False) -> None:
    """Smooth weights of the selection over the surface, or through the body."""
    state = session.state
    neighbours = neighbours_of(state)
    if through and state.binding is not None:
        graph = state.binding.graph
        neighbours = session.state.memo(
            "inner neighbours", (graph,), lambda: Neighbours.through(graph)
        )

    def smoothed(rows: Selected) -> csr_array:
        return ops.limited(rows, ops.smoothed(rows, neighbours, state.passes))

    change_all(session, "Smooth", smoothed)


def by_mirror(name: str, operation: Callable[[Selected, Mirror], Any]) -> Any:
    """Return a command that gives vertices rows, both found with the plane of symmetry."""

    def act(session: Session) -> None:
        try:
            vertices, rows = operation(selected_rows(session), _mirror(session))
        except CutcellError as error:
            session.fail(error)
            return
        put_rows(session, vertices, rows, name)

    return act


def _mirror(session: Session) -> Mirror:
    """Return the plane of symmetry, and pairs of vertices and joints."""
    rig = session.state.rig

    def find() -> Mirror | None:
        try:
            return find_mirror(rig)
        except CutcellError:
            return mirror_of(session.state)  # joints are mirrored, the mesh is not

    plane: Mirror | None = session.state.memo("mirror of vertices", (rig,), find)
    if plane is None:
        raise ParameterError("no joint has a partner on the other side")
    return plane


def take_side(side: str) -> Any:
    """Return a command that takes one side of the selection, "left" or "right", for both."""

    def rows_of(chosen: Selected, plane: Mirror) -> Any:
        return ops.mirrored(chosen, plane, side_is_positive(chosen.rig, plane, side[0]))

    return by_mirror(f"Take the {side} side", rows_of)


def swapped(chosen: Selected, plane: Mirror) -> Any:
    """Return vertices, and their rows with left and right joints exchanged."""
    swap = plane.swap
    return chosen.vertices, ops.in_chunks(chosen, lambda part: part.finished(part.rows[:, swap]))


def copy(session: Session) -> None:
    """Remember points and weights of the selection."""
    try:
        rows_of = selected_rows(session)
    except CutcellError as error:
        session.fail(error)
        return
    points = session.state.rig.mesh.vertices[rows_of.vertices]
    rows = ops.in_chunks(rows_of, lambda part: part.rows)
    session.state.copied = session.state.rig.skeleton.names, points, rows


def paste(session: Session, by: str = "nearest") -> None:
    """Give the selection the weights that were copied, from the nearest point or in their order."""
    names, points, rows = session.state.copied or ((), np.zeros([0, 3]), csr_array((0, 0)))
    if len(points) and names != session.state.rig.skeleton.names:
        session.fail(ParameterError("weights of another skeleton were copied; copy them again"))
        return
    change_all(session, "Paste", lambda into: ops.limited(into, ops.pasted(into, points, rows, by)))


def edit(session: Session, vertex: int, joint: int, value: float) -> None:
    """Give one vertex, with its copies at a seam, a weight."""
    state = session.state
    welded = neighbours_of(state).welded
    vertices = np.flatnonzero(welded == welded[vertex])
    try:
        rows_of = _limits(state, vertices)
        rows_of.check_unlocked(joint)
        rows = ops.fill(rows_of, joint, value)
    except CutcellError as error:
        session.refuse(error)
        return
    put_rows(session, vertices, rows, f"Edit {_name(state.rig, joint)}")


def lock(session: Session) -> None:
    """Lock the chosen joint to the file's weights at the selection."""
    state = session.state

    def content() -> Locked:
        locked_joints(state.rig, [state.joint])
        check_alone(state.rig.skeleton, state.joint)
        return Locked([state.rig.skeleton.names[state.joint]])

    put_content(session, selected_vertices(state), content)


OPERATIONS: dict[str, Callable[[Session], None]] = {
    "Fill with amount": by_joint("Fill", ops.fill),
    "Add amount": by_joint("Add to", ops.add),
    "Subtract amount": by_joint("Subtract from", ops.add, -1),
    "Scale by amount": by_joint("Scale", ops.scale),
    "Smooth": smooth,
    "Smooth through the body": partial(smooth, through=True),
    "Remove below amount": lambda session: change(
        session, "Prune", lambda rows: ops.prune(rows, session.state.amount)
    ),
    "Normalise": lambda session: change(session, "Normalise", ops.normalise),
    "Take the left side": take_side("left"),
    "Take the right side": take_side("right"),
    "Swap left and right": by_mirror("Swap left and right", swapped),
    "Transfer from the rest": lambda session: change_all(session, "Transfer", ops.transferred),
    "Copy weights": copy,
    "Paste by nearest point": paste,
    "Paste in vertex order": partial(paste, by="order"),
    "Lock the bone to file weights": lock,
}
"""By their names in the menu."""
