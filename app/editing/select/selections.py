"""Select vertices of the open character."""

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from cutcell.errors import CutcellError, ParameterError

from ...document.look import pick
from ...document.selection import selected
from ...document.session import Session
from ...document.state import State
from ...looks.histogram import in_bars
from ...looks.selection import neighbours_of
from ...server.protocol.received import Lasso, PickStrongest
from ...server.protocol.sent import Through
from ..brush.strokes import clear_selection, invert_selection, select
from ..compute.condition import vertices_where

MOSTLY = 0.5
"""Weight of a joint and its children from which a vertex is theirs."""


def watch(session: Session) -> None:
    """Connect lasso and keys of the view, and put one tool down when another is taken."""
    state, view = session.state, session.view
    state.param.watch(lambda *events: state.param.update(condition=""), "own")
    view.listen(Lasso, lambda message: lasso(session, message))
    view.listen(PickStrongest, lambda message: strongest(session, message.vertex))
    state.param.watch(lambda *events: _take_lasso(session), "lasso")
    state.param.watch(
        lambda *events: state.param.update(lasso=state.lasso and not _has_handle(state)),
        ["brush", "joint_handle"],
    )
    state.param.watch(lambda *events: state.param.update(bars=None, table_page=0),
                      ["brush_selection", "joint", "histogram"])  # fmt: skip


def _has_handle(state: State) -> bool:
    return bool(state.brush or state.joint_handle)


def _take_lasso(session: Session) -> None:
    if session.state.lasso:
        session.state.param.update(brush=False, joint_handle=False)


def can_select(state: State) -> bool:
    """Whether vertices can be selected here: weights are in sight."""
    is_ready = state.rig is not None and not state.bare and state.rows is not None
    return bool(is_ready and state.open_panel.paints)


def lasso_part(state: State) -> Through | None:
    """Return the lasso's settings for the view; None while it is off."""
    if not (state.lasso and can_select(state) and not state.playing):
        return None
    return {"through": state.lasso_through}


def choose(session: Session, vertices: NDArray[np.bool_], mode: str = "replace") -> None:
    """Select vertices, shape (n,), bool; or add them to the selection, or subtract them."""
    before = selected(session.state)
    if before is not None and mode in ("add", "subtract"):
        vertices = before | vertices if mode == "add" else before & ~vertices
    elif mode == "subtract":
        return
    select(session, vertices)


def lasso(session: Session, message: Lasso) -> None:
    """Select the vertices inside a line that was drawn in the view."""
    if not can_select(session.state):
        return
    inside = np.asarray(message.vertices, np.int64)
    vertices = np.zeros(len(session.state.rig.mesh.vertices), np.bool_)
    vertices[inside[(inside >= 0) & (inside < len(vertices))]] = True
    choose(session, vertices, message.mode)


def strongest(session: Session, vertex: int) -> None:
    """Choose the joint that is strongest at a vertex."""
    state = session.state
    if can_select(state) and 0 <= vertex < len(state.weights):
        pick(session, int(state.weights[vertex].argmax()))


def select_all(session: Session) -> None:
    """Select all vertices."""
    select(session, np.ones(len(session.state.rig.mesh.vertices), np.bool_))


def grow(session: Session) -> None:
    """Add the neighbours of selected vertices."""
    chosen = selected(session.state)
    if chosen is not None:
        select(session, neighbours_of(session.state).grown(chosen))


def shrink(session: Session) -> None:
    """Remove the rim of the selection."""
    chosen = selected(session.state)
    if chosen is not None:
        select(session, neighbours_of(session.state).shrunk(chosen))


def select_joint(session: Session) -> None:
    """Select all vertices that the chosen joint moves."""
    _choose_some(session, session.state.weights[:, session.state.joint] > 0)


def select_branch(session: Session) -> None:
    """Select the vertices that mostly follow the chosen joint and its children."""
    state = session.state
    branch = state.rig.skeleton.subtree[state.joint]
    _choose_some(session, state.weights[:, branch].sum(axis=1) > MOSTLY)


def select_component(session: Session) -> None:
    """Select the connected components of the selection, of the isolated part or of the vertex."""
    state = session.state
    component = state.rig.mesh.welded.component[state.rig.mesh.welded.index]
    chosen = selected(state)
    if state.part is not None or state.vertex is not None:
        chosen = component == component[state.part if state.part is not None else state.vertex]
    if chosen is None:
        session.fail(ParameterError("no part is chosen; click a vertex of it, or select one"))
        return
    select(session, np.isin(component, component[chosen]))


def select_mesh(session: Session) -> None:
    """Select the meshes of the file that the selection, or the clicked vertex, is a part of."""
    state = session.state
    chosen = selected(state)
    vertices = np.flatnonzero(chosen) if chosen is not None else np.empty(0, np.intp)
    if state.vertex is not None:
        vertices = np.array([state.vertex])
    if not len(vertices):
        session.fail(ParameterError("no part is chosen; click a vertex of it, or select one"))
        return
    starts = [part.vertices.start for part in state.rig.parts]
    mesh = np.searchsorted(starts, np.arange(len(state.rig.mesh.vertices)), "right")
    select(session, np.isin(mesh, mesh[vertices]))


def finding_vertices(state: State) -> NDArray[np.intp]:
    """Return the vertices of the finding that is looked at, and of its faces, shape (k,)."""
    finding = state.selected_finding
    if finding is None:
        return np.empty(0, np.intp)
    corners = state.rig.mesh.faces[finding.faces].ravel()
    return np.union1d(finding.vertices, corners).astype(np.intp)


def select_finding(session: Session) -> None:
    """Select the vertices and the corners of faces that the chosen finding names."""
    state = session.state
    chosen = np.zeros(len(state.rig.mesh.vertices), np.bool_)
    chosen[finding_vertices(state)] = True
    if not chosen.any():
        session.fail(ParameterError("no finding with vertices is chosen; choose one in Check"))
        return
    state.panel = "weights"
    select(session, chosen)


def select_where(session: Session, condition: str) -> None:
    """Select the vertices that a condition holds for; report one that cannot be read."""
    state = session.state
    state.condition = condition.strip()
    if not state.condition:
        return
    distances = None if state.binding is None else state.binding.distances
    try:
        chosen = vertices_where(
            state.condition,
            state.rig,
            state.weights,
            distances=distances,
        )
    except CutcellError as error:
        session.fail(error)
        return
    _choose_some(session, chosen)


def select_bars(session: Session) -> None:
    """Select the vertices of the chosen bars of the histogram."""
    chosen = in_bars(session.state)
    if chosen is not None:
        _choose_some(session, chosen)


def _choose_some(session: Session, chosen: NDArray[np.bool_]) -> None:
    if not chosen.any():
        session.state.message = ("info", "No vertices fit. The selection has not changed.")
        return
    select(session, chosen)


def isolate(session: Session) -> None:
    """Hide all but the selection, or show all again."""
    session.state.isolated = not session.state.isolated


def take_lasso(session: Session) -> None:
    """Take the lasso, or put it down."""
    session.state.lasso = not session.state.lasso


SELECTIONS: dict[str, Callable[[Session], None]] = {
    "All": select_all,
    "None": clear_selection,
    "Invert": invert_selection,
    "Grow": grow,
    "Shrink": shrink,
    "Vertices of the bone": select_joint,
    "Bone and its children": select_branch,
    "Connected part": select_component,
    "Mesh of the file": select_mesh,
    "Finding chosen in Check": select_finding,
    "Left side": partial(select_where, condition="side = left"),
    "Right side": partial(select_where, condition="side = right"),
    "Middle": partial(select_where, condition="side = middle"),
}
"""By their names in the menu."""
