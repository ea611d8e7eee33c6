"""What is read of a state is recorded: by results, by the view, through properties and copies."""

import threading
from types import SimpleNamespace

import param
import pytest

from cutcell.errors import CutcellError
from cutcell_app.derive.engine import RULES, VIEW, WIDGETS
from cutcell_app.derive.reading import ReadOnlyState, Recorded
from cutcell_app.document import loading
from cutcell_app.features.learn import steps
from cutcell_app.features.learn.lesson import Answer, Lesson, Step
from cutcell_app.features.scenes import resolve
from cutcell_app.features.state import PANELS
from cutcell_app.shell.page import layout
from cutcell_app.shell.session import view_parts
from tests.app.test_engine import Page, doubled, powers, total
from tests.viewers.arm import arm_rig


class State(param.Parameterized):
    """Two choices, and their sum."""

    a = param.Integer(1)
    b = param.Integer(2)
    c = param.Integer(3)

    @property
    def sum(self):
        return self.a + self.b


def view_of(state):
    return ReadOnlyState(State, state)


def test_names_are_recorded_through_properties_other_views_and_changes():
    view = view_of(State())
    assert (view.sum, view.read_names) == (3, {"a", "b"})
    outer = view_of(State())
    assert outer.changed(a=5).sum == 7
    assert outer.read_names == {"b"}, "the other value does not depend on the state"
    copy = view_of(SimpleNamespace(a=1, b=10))
    assert copy.sum == 11


def test_a_view_can_only_be_read():
    with pytest.raises(AttributeError, match="a cannot be set"):
        view_of(State()).a = 2


def test_a_function_is_called_again_only_where_what_it_read_changes():
    state, calls = State(), []
    cell = Recorded(lambda view: calls.append(1) or (view.b if view.a > 1 else 0))
    assert cell.read(state) == cell.read(state) == 0
    assert not cell.forget({"b", "c"})
    state.a = 2
    assert cell.forget({"a"})
    assert cell.read(state) == 2
    assert cell.forget({"b"}), "it is read by now"
    assert len(calls) == 2


def test_an_error_is_raised_until_what_was_read_changes():
    state, calls = State(), []

    def inverse(view):
        calls.append(view.a)
        return 1 / view.a

    cell = Recorded(inverse)
    state.a = 0
    for _ in range(2):
        with pytest.raises(ZeroDivisionError):
            cell.read(state)
    state.a = 4
    assert cell.forget({"a"})
    assert (cell.read(state), calls) == (0.25, [0, 4])


def counted(page):
    """Count how often each result's inputs are read."""
    calls = []
    for entry in page.engine._entries.values():
        read = entry.inputs._function
        entry.inputs._function = lambda *a, e=entry, r=read: calls.append(e.key) or r(*a)
    return calls


def test_only_results_that_read_a_choice_are_looked_at_when_it_changes():
    page = Page(doubled(), total(), powers())
    page.engine.update()
    for _ in range(4):
        page.pool.run()
    calls = counted(page)
    page.state.shown = False
    assert calls == []
    page.state.b = 7
    assert calls == [("total",)]


def test_the_order_in_which_results_are_declared_does_not_matter():
    page = Page(total(), doubled())
    page.state.a = 4
    while page.pool.waiting:
        page.pool.run()
    assert page.state.total == 9


def test_what_follows_the_state_acts_by_levels_and_once_all_results_hold():
    page, seen = Page(doubled(immediate=lambda state: True)), []

    def note(level):
        return lambda names, is_reset: seen.append((level, page.state.b, page.state.doubled))

    def limit(names, is_reset):
        page.state.b = min(page.state.b, page.state.a)

    page.engine.follow(note("page"), WIDGETS)
    page.engine.follow(note("view"), VIEW)
    page.engine.follow(limit, RULES)
    page.state.param.update(a=3, b=9)
    assert seen == [("view", 3, 6), ("page", 3, 6)]


def test_something_is_done_when_a_value_changes():
    page, values = Page(), []
    page.engine.when(lambda state: state.a > 2, values.append)
    for a in (2, 3, 4, 1):
        page.state.a = a
    assert values == [True, False]


@pytest.fixture
def taught(session, loop):
    """Return a session with a lesson of three steps."""
    either = Answer("choice", options=["a", "b"])
    rays = "panel=graph&flat=rays&bone=elbow"
    session.state.resolution = 16
    session.state.lesson = Lesson(
        (
            Step("one", "q", "panel=distance&bone=elbow", either, plot="error", text="x"),
            Step("two", "q", rays, either),
            Step("three", "q", rays, either),
        )
    )
    loading.show_rig(session, arm_rig())
    loop.rest(session)
    return session


def test_the_plot_of_a_step_is_computed_once_it_is_answered(taught, loop):
    steps.go(taught, 0)
    loop.rest(taught)
    steps.answer(taught, "a")
    loop.rest(taught)
    assert taught.state.error_curves is not None


def test_each_step_has_a_flat_scene_of_its_own(taught, loop):
    sections = []
    for step in (1, 2):
        steps.go(taught, step)
        loop.rest(taught)
        sections.append(taught.state.flat_data)
    assert None not in sections
    assert sections[0] is not sections[1]


def test_handles_and_bones_of_a_large_character_come_with_its_scene(session, loop, monkeypatch):
    monkeypatch.setattr("cutcell_app.document.state.QUICK_MESH", 10)
    session.state.resolution = 16
    seen, present = [], session.view.present

    def noted(scene, **parts):
        present(scene, **parts)
        seen.append(("body" in scene.actors, session.view.last_sent("bones") is not None))

    monkeypatch.setattr(session.view, "present", noted)
    loading.show_rig(session, arm_rig())
    assert session.view.last_sent("bones") is None, "its scene is not described yet"
    loop.rest(session)
    assert seen
    assert all(has_body == has_bones for has_body, has_bones in seen)
    session.state.panel = "pose"
    assert session.view.last_sent("gizmo") is None
    loop.rest(session)
    assert session.view.last_sent("gizmo") is not None


def test_a_change_during_a_description_is_shown_and_no_other_is_described_again(
    session, loop, monkeypatch
):
    monkeypatch.setattr("cutcell_app.document.state.QUICK_MESH", 10)
    session.state.resolution = 16
    loading.show_rig(session, arm_rig())
    loop.rest(session)
    gate, described = threading.Event(), []

    def slow(state):
        gate.wait(60)
        described.append(state.joint)
        return resolve(state)

    monkeypatch.setattr(view_parts, "resolve", slow)
    session.state.joint = 0
    session.state.joint = 2
    session.state.added_value = "64"  # no scene reads it
    gate.set()
    loop.rest(session)
    assert described == [0, 2]


def test_a_scene_that_fails_is_reported_once_and_tried_again_after_a_change(
    session, loop, monkeypatch
):
    session.state.resolution = 16
    loading.show_rig(session, arm_rig())
    loop.rest(session)
    calls = []

    def fail(state):
        calls.append(state.joint)
        raise CutcellError("no such scene")

    with monkeypatch.context() as patched:
        patched.setattr(view_parts, "resolve", fail)
        session.state.joint = 0
        assert session.state.message == ("error", "No such scene.")
        assert calls == [0]
    before = session.view._next
    session.state.joint = 2
    assert session.view._next is not before


def test_the_page_of_every_panel_reads_nothing_but_the_state(bound, loop):
    layout(bound)
    for panel in PANELS:
        bound.state.panel = panel
        loop.rest(bound)
        assert bound.state.message is None, panel
