"""Commands of the lesson: go to a step, answer it, press its buttons, leave."""

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell_viewers.camera import Camera

from ...document.address import camera_of, from_query
from ...document.document import Document, History
from ...document.look import set_camera
from ...document.opening import Opening, Request, motion
from ...document.selection import selected
from ...document.session import BeforeLesson, Session
from ...document.side_by_side import SINGLE, standard
from ...document.state import State
from ...looks.methods import shown_title, weights_of
from .lesson import Step
from .sliders import slide, sliders_of

MAX_ANSWER = 200
"""Letters of an answer."""
NO_PATH = "a point that no path reaches"
"""Answer by a click on a vertex that no path from a bone reaches."""


def watch(session: Session) -> None:
    """Take clicks on the body and on bones for answers where a step asks for them."""
    state = session.state
    follow = state.param.watch
    # A selection, say, is paint of the step before.
    unused = {name: state.param[name].default for name in state.tools}
    follow(lambda *events: _answer_by_click(session, "vertex"), "vertex")
    follow(lambda *events: _answer_by_click(session, "joint"), "joint")
    follow(lambda event: answer(session, event.new), "acted", onlychanged=False)
    follow(lambda *events: _prepare(session), "binding")
    follow(lambda event: _enter(session, event.new, unused), "step")


def _enter(session: Session, step: int, unused: dict[str, Any]) -> None:
    """Put the tools away; a lesson that is left begins anew, so that the next class is asked."""
    answers = {} if step < 0 else session.state.answers
    session.state.param.update(**unused, answers=answers)


def go(session: Session, index: int) -> None:
    """Show a step of the lesson; -1 leaves it and restores the page as it was before."""
    state = session.state
    if not 0 <= index < len(state.lesson):
        leave(session)
        return
    step = state.lesson[index]
    show(session, step.scene(index in state.answers), step=index)


def leave(session: Session) -> None:
    """End the lesson, and restore the character, the choices, the tools and the camera.

    A character that a person opened during the lesson stays, with its choices; one that a step is
    opening is not opened any more.
    """
    session.tasks.add(Opening(session, partial(_leave, session)))


def _leave(session: Session) -> Request | None:
    """Return what restores the page; where its character stays, leave at once."""
    state, step = session.state, session.state.lesson_step
    before = session.before_lesson
    of_lesson = step.characters if step else []
    if before is None or session.source not in (before.document.source, *of_lesson):
        session.before_lesson = None
        state.param.update(step=-1, staged=False)
        return None

    def note(now: Document) -> None:
        session.history, session.before_lesson = before.history, None
        session.history.replace_current(now)

    def restore_tools() -> None:
        state.param.update(**before.tools)  # a selection counts on its own mesh only

    return Request(
        before.document.source, document=before.document, camera=before.camera,
        arrival={"step": -1, "stage": False}, note=note, then=restore_tools,
    )  # fmt: skip


def answer(session: Session, value: Any) -> None:
    """Commit to an answer of the step; an empty text shows the answer without one."""
    state, step = session.state, session.state.lesson_step
    if step is None or state.step in state.answers:
        return
    if step.answer.kind == "paint" and value:
        value = painted_score(state, step)
    number = isinstance(value, int | float) and bool(np.isfinite(value))
    state.answers = {**state.answers, state.step: value if number else str(value)[:MAX_ANSWER]}
    view = session.view
    camera = None if view.at_home or "camera=" in step.reveal else view.camera
    state.brush = False
    show(session, step.scene(True), camera)


def offer(session: Session, index: int) -> None:
    """Apply the choices of a button of the step."""
    state = session.state
    queries = _offers(state)
    if 0 <= index < len(queries) and state.rig is not None:
        choices, arrival, _ = from_query(queries[index], state)
        if "rig" in arrival and state.lesson_step is not None:
            show(session, f"{state.lesson_step.scene(True)}&{queries[index]}")
            return
        moves = motion(session, choices.get("panel", state.panel), arrival)
        state.param.update(**choices, **of_character(state, arrival), **moves)
        if "camera" in arrival:
            set_camera(session, camera_of(arrival["camera"]))


def choose(session: Session, name: str, value: Any) -> None:
    """Set a choice that the text of the step names."""
    step = session.state.lesson_step
    if step is not None and name in step.named:
        slide(session, name, value)


def pressed_offers(state: State) -> list[bool]:
    """Return for each button of the step whether what it chooses is chosen."""
    pressed = []
    if state.rig is None:
        return [False for _ in _offers(state)]
    for query in _offers(state):
        choices, arrival, _ = from_query(query, state)
        choices = {**choices, **of_character(state, arrival)}
        is_open = state.demo == arrival.get("rig", state.demo)
        chosen = all(getattr(state, name) == value for name, value in choices.items())
        pressed.append(is_open and chosen)
    return pressed


def named_values(state: State) -> dict[str, dict[str, Any]]:
    """Return the choices that the text of the step names, as sliders of `sentence.js`."""
    step = state.lesson_step
    return {} if step is None else sliders_of(state, step.text)


def show(
    session: Session, query: str, camera: Camera | None = None, step: int | None = None
) -> None:
    """Show the scene of an address, and its character; a camera replaces that of the address.

    `step` is the step that is gone to; None for the one that is shown.
    """
    state = session.state

    def request() -> Request:
        choices, arrival, _ = from_query(query, state)
        demo = arrival.pop("rig", "")
        for name in ("step", "answer"):
            arrival.pop(name, None)
        if step is not None:
            arrival["step"] = step
            arrival |= {"answer": state.answers[step]} if step in state.answers else {}
        before = None
        if state.step < 0 and state.rig is not None:
            tools = {name: getattr(state, name) for name in state.tools}
            at = None if session.view.at_home else session.view.camera
            before = partial(BeforeLesson, camera=at, tools=tools)

        def note(now: Document) -> None:
            if before is not None and session.history.now is not None:
                session.before_lesson = before(session.history, session.history.now)
            session.history = History(now)

        source = f"demo {demo}" if demo else session.source
        if source != session.source:
            arrival.setdefault("methods", standard(None))
        return Request(
            source, fresh=True, choices=choices, arrival=arrival, camera=camera, note=note,
            then=lambda: _prepare(session),
        )  # fmt: skip

    session.tasks.add(Opening(session, request))


def of_character(state: State, arrival: dict[str, Any]) -> dict[str, Any]:
    """Return an address's entries for the open character, as parameters of the state."""
    names = list(state.rig.skeleton.names)
    own = ("vertex", "clip", "methods", *SINGLE, "settled", "turns")
    plain: dict[str, Any] = {name: arrival[name] for name in own if name in arrival}
    if arrival.get("bone") in names:
        plain["joint"] = names.index(arrival["bone"])
    return plain


def _prepare(session: Session) -> None:
    """Give the brush where the step asks for paint."""
    state, step = session.state, session.state.lesson_step
    if step is None or step.answer.kind != "paint" or state.step in state.answers:
        return
    if state.binding is None or state.brush:
        return
    colors = state.pose_colors
    state.brush_selection = None
    state.param.update(brush=True, brush_mode="select", brush_mirrored=False)  # one side is asked
    state.pose_colors = colors  # the brush shows weights: they would be the answer


def painted_score(state: State, step: Step) -> float:
    """Return the agreement of the painted vertices with what a joint and those below it move.

    It is the number of vertices in both, over that of vertices in either.
    """
    painted = selected(state)
    if painted is None or state.weights is None:
        return 0.0
    return _agreement(painted, branch_weights(state, step.answer.joint))


def painted_scores(state: State) -> dict[str, float]:
    """Return the same for each method that is compared, by its caption."""
    step, painted = state.lesson_step, selected(state)
    if step is None or step.answer.kind != "paint" or painted is None or state.panel != "compare":
        return {}
    tables = {name: weights_of(state, name) for name in state.methods}
    return {
        shown_title(state, name): _agreement(
            painted, branch_weights(state, step.answer.joint, table)
        )
        for name, table in tables.items()
        if table is not None
    }


def _agreement(painted: NDArray[np.bool_], weights: NDArray[np.float64]) -> float:
    moves = weights > 0.5
    return float((painted & moves).sum()) / max(int((painted | moves).sum()), 1)


def branch_weights(
    state: State, name: str, weights: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """Return the weight of a joint and of all joints below it, shape (n,)."""
    skeleton, file = state.rig.skeleton, state.rig.weights
    below = skeleton.subtree[skeleton.names.index(name)]
    table = weights if weights is not None else state.weights if file is None else file
    total: NDArray[np.float64] = table[:, below].sum(1)
    return total


def _answer_by_click(session: Session, kind: str) -> None:
    state, step = session.state, session.state.lesson_step
    if (
        session.history.is_restoring
        or step is None
        or step.answer.kind != kind
        or state.rig is None
    ):
        return
    index = state.joint
    if kind == "vertex":
        if state.vertex is None or state.weights is None:
            return
        index = followed(state)[state.vertex]
    answer(session, clickable(state)[index])


def clickable(state: State) -> list[str]:
    """Return the answers that clicks give: the joints, and `NO_PATH`."""
    return [*state.rig.skeleton.names, NO_PATH]


def followed(state: State) -> NDArray[np.uint16]:
    """Return the answer by a click on each vertex, as an index of `clickable`, shape (n,)."""
    joints = state.weights.argmax(axis=1)
    if state.binding is not None:
        joints[state.binding.distances.fallback != 0] = len(state.rig.skeleton.names)
    return joints.astype(np.uint16)


def _offers(state: State) -> list[str]:
    step = state.lesson_step
    return [] if step is None else list(step.offers.values())
