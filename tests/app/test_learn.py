"""The tour: every step finds what it needs, and shows it."""

import pytest

from app.actions.learn import camera_of, go, shown_panels
from app.scenes import resolve
from app.session import Session
from app.state import State
from app.tour import TOUR
from assets import DEMOS
from tests.app.loop import Loop


@pytest.fixture
def loop():
    return Loop()


@pytest.fixture
def session(loop):
    session = Session(loop)
    yield session
    session.close()


def test_every_step_can_be_told():
    demos = {demo.id for demo in DEMOS}
    for step in TOUR:
        assert step.demo in demos
        assert shown_panels() & set(step.panels), step.title
        assert step.text.count("\n\n") == 1, step.title
        assert len(step.text) < 700, step.title
        unknown = set(step.choices) - set(State().param)
        assert not unknown, f"{step.title}: the page has no {unknown}"


def computed_at(state, resolution):
    return state.binding is not None and state.binding.graph.lattice.resolution == resolution


def test_a_step_sets_the_scene_and_can_be_left_and_taken_up(session, loop):
    go(session, 5)
    state, step = session.state, TOUR[5]
    loop.run_until(lambda: computed_at(state, step.choices["resolution"]), 90)
    assert (state.tour, state.demo, state.panel) == (5, step.demo, "graph")
    assert state.rig.skeleton.names[state.joint] == step.bone
    assert session.view.camera == camera_of(session, step)
    assert "interior edges" in resolve(state).actors
    assert "step=6" in session.view._parts["address"]
    go(session, -1)
    assert (state.tour, state.panel) == (-1, "graph")
    go(session, 6)
    assert (state.tour, state.panel, state.resolution) == (6, "geodesics", 64)


def test_a_step_on_another_character_opens_it(session, loop):
    index = next(i for i, step in enumerate(TOUR) if step.demo == "biped_cape")
    go(session, index)
    loop.run_until(lambda: session.state.binding is not None)
    assert session.state.demo == "biped_cape"
    assert session.state.rig.skeleton.names[session.state.joint] == TOUR[index].bone


def test_a_link_to_a_step_goes_on_from_there(session, loop):
    session.arrive("?rig=biped&panel=graph&step=5&resolution=20", lambda: None)
    loop.run_until(lambda: session.state.binding is not None)
    assert session.state.tour == 4
    assert session.state.resolution == 20
