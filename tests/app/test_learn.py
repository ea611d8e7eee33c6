"""The tour: every step finds what it needs, and shows it."""

import numpy as np
import pytest

from cutcell_app.commands import arrival, loading
from cutcell_app.commands.tour import camera_of, go
from cutcell_app.layout.session import begin
from cutcell_app.scenes import resolve
from cutcell_app.state import PANELS, State
from cutcell_app.state.tour import TOUR
from cutcell_assets import DEMOS, demo_path


def test_every_step_has_its_demo_panel_and_choices():
    demos = {demo.id for demo in DEMOS}
    for step in TOUR:
        assert step.look.demo in demos
        assert step.look.panel in PANELS, step.title
        assert step.text.count("\n\n") == 1, step.title
        assert len(step.text) < 700, step.title
        unknown = set(step.look.choices) - set(State().param)
        assert not unknown, f"{step.title}: the page has no {unknown}"


def computed_at(state, resolution):
    return state.binding is not None and state.binding.graph.lattice.resolution == resolution


def test_a_step_sets_the_scene_and_can_be_left_and_taken_up(session, loop):
    go(session, 6)
    state, look = session.state, TOUR[6].look
    loop.run_until(lambda: state.binding is not None and state.shown_graph is not None, 90)
    assert state.shown_graph.lattice.resolution == look.choices["graph_resolution"] == 20
    assert state.graph.lattice.resolution == state.resolution == 64
    assert (state.tour, state.demo, state.panel) == (6, look.demo, "graph")
    assert state.rig.skeleton.names[state.joint] == look.bone
    assert session.view.camera == camera_of(session, look)
    assert "interior edges" in resolve(state).actors
    assert "step=7" in session.view._parts["address"]
    go(session, -1)
    assert (state.tour, state.panel) == (-1, "graph")  # there was no character before it
    go(session, 9)
    assert (state.tour, state.panel, state.resolution) == (9, "distance", 64)


def test_a_step_on_another_character_opens_it(session, loop):
    index = next(i for i, step in enumerate(TOUR) if step.look.demo == "biped_cape")
    go(session, index)
    loop.run_until(lambda: session.state.binding is not None)
    assert session.state.demo == "biped_cape"
    assert session.state.rig.skeleton.names[session.state.joint] == TOUR[index].look.bone


def test_a_link_to_a_step_alone_sets_its_scene(session, loop):
    arrival.arrive(session, "?panel=learn&step=10", lambda: pytest.fail("the step has a character"))
    state, look = session.state, TOUR[9].look
    loop.run_until(lambda: state.binding is not None)
    assert (state.tour, state.demo, state.panel) == (9, "biped", "distance")
    assert state.rig.skeleton.names[state.joint] == look.bone
    assert (state.connectivity, state.cut_axis) == (6, "z")
    assert session.view.camera == camera_of(session, look)
    assert not session.history.can_undo


def test_what_a_link_says_beside_a_step_is_set_on_its_scene(session, loop):
    arrival.arrive(
        session, "?panel=weights&step=6&resolution=20&camera=1,2,3,0,1,0&kitchen=1", lambda: None
    )
    state = session.state
    loop.run_until(lambda: computed_at(state, 20))
    assert (state.tour, state.panel, state.cut_axis) == (5, "weights", "z")
    assert session.view.camera.position == (1, 2, 3)
    assert "kitchen=1" in state.message[1]


def test_a_link_of_a_person_on_the_tour_brings_back_what_they_made_of_it(session, loop):
    go(session, 9)
    loop.run_until(lambda: session.state.binding is not None)
    session.state.param.update(connectivity="any", panel="learn")
    query = session.view.last_sent("address")
    again = begin(loop)
    arrival.arrive(again, query, lambda: None)
    loop.run_until(lambda: again.state.binding is not None)
    assert (again.state.tour, again.state.panel) == (9, "learn")
    assert again.state.connectivity == "any"
    again.close()


@pytest.mark.parametrize("step", ["0", "99", "-3", "two"])
def test_a_link_to_a_step_that_there_is_not_says_so(session, loop, step):
    arrival.arrive(session, f"?step={step}&rig=robot&resolution=16", lambda: None)
    loop.run_until(lambda: session.state.binding is not None)
    assert session.state.tour == -1
    assert f"step={step}" in session.state.message[1]


def test_the_vertex_of_a_step_lies_where_its_text_says(session, loop):
    go(session, 3)
    loop.run_until(lambda: session.state.rig is not None)
    state = session.state
    names, joints = state.rig.skeleton.names, state.rig.skeleton.joints
    assert names[state.rig.weights[state.vertex].argmax()] == "thigh.L"
    gap = state.rig.mesh.vertices[state.vertex] - joints[names.index("hand.L")]
    assert np.linalg.norm(gap) < 0.1


def test_two_steps_at_once_show_the_last(session, loop):
    go(session, 11)
    go(session, 0)
    loop.run_until(lambda: session.state.binding is not None)
    assert (session.state.tour, session.state.demo) == (0, TOUR[0].look.demo)
    go(session, 12)
    go(session, 13)
    loop.run_until(lambda: session.state.rig.name == "biped_soup", 60)
    assert session.state.tour == 13


def test_leaving_brings_back_the_character_the_choices_and_the_camera(session, loop):
    state = session.state
    arrival.arrive(
        session, "?rig=robot&panel=weights&resolution=24&camera=1,2,3,0,1,0", lambda: None
    )
    loop.run_until(lambda: state.binding is not None)
    go(session, 12)
    loop.run_until(lambda: state.binding is not None and state.demo == "biped_cape")
    go(session, -1)
    loop.run_until(lambda: state.demo == "robot" and computed_at(state, 24))
    assert (state.tour, state.panel) == (-1, "weights")
    go(session, 1)
    loop.run_until(lambda: state.demo == "biped" and state.binding is not None)
    go(session, 2)
    go(session, -1)
    loop.run_until(lambda: state.demo == "robot" and computed_at(state, 24))
    assert (state.tour, state.panel, state.resolution) == (-1, "weights", 24)


def test_a_character_that_a_person_opens_on_the_tour_stays_when_it_is_left(session, loop):
    state = session.state
    arrival.arrive(session, "?rig=robot&panel=weights&resolution=16", lambda: None)
    loop.run_until(lambda: state.binding is not None)
    go(session, 13)
    loop.run_until(lambda: state.rig.name == "biped_soup", 60)
    loading.load_files(session, [demo_path("rabbit")])
    loop.run_until(lambda: state.rig.name == "rabbit", 60)
    go(session, -1)
    loop.run_for(0.1)
    assert (state.tour, state.rig.name) == (-1, "rabbit")
    assert session.character == "~"
    assert "loading" not in state.stage


def test_back_and_forward_return_to_steps_with_their_scenes(session, loop):
    """The browser's buttons tell an address that the page made, with or without a step."""
    state = session.state
    visit = session.view._listeners["visit"]
    before = "?rig=robot&panel=weights&bone=hips&resolution=16"
    on_tour = "?rig=biped_cape&panel=distance&bone=chest&resolution=16&step=13"
    for query, step in ((before, -1), (on_tour, 12), (before, -1)):
        visit({"query": query})
        rig = "robot" if step < 0 else "biped_cape"
        loop.run_until(lambda rig=rig: state.rig is not None and state.rig.name == rig, 60)
        assert state.tour == step
        assert state.panel == ("weights" if step < 0 else "distance")
