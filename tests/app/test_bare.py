"""A mesh without a skeleton on the page: its graph is there, the rest says why it is not."""

import numpy as np
import pytest

from cutcell.errors import SkeletonError
from cutcell.rig import Rig, Skeleton
from cutcell_app.commands import keys, loading, look
from cutcell_app.layout.sidebar import NO_SKELETON, panels
from cutcell_app.layout.status import messages, summary
from cutcell_app.panels.bone import bone
from cutcell_app.panels.export import export
from cutcell_app.render import Choices, describe
from cutcell_app.scenes import resolve
from cutcell_app.state import PANELS
from cutcell_app.state.url import to_query
from tests.viewers.arm import arm_rig


def bare_arm():
    rig = arm_rig()
    return Rig(rig.mesh, Skeleton([], []), name="statue", warnings=("it has no skin",))


@pytest.fixture
def bare(session, loop):
    """Return a session on which a bare mesh stands."""
    session.state.resolution = 16
    show_bare(session, loop)
    return session


def show_bare(session, loop):
    loading.show_rig(session, bare_arm())
    loop.run_until(lambda: session.state.bare_graph is not None)
    loop.run_until(lambda: not session.tasks.running)


@pytest.fixture
def after_a_rig(bound, loop):
    """Return a session on which a bare mesh stands, with all panels built for a rig before."""
    bound.built = [panels(bound), bone(bound), export(bound), messages(bound)]
    for panel in PANELS:
        bound.state.panel = panel
    show_bare(bound, loop)
    return bound


def test_the_panel_graph_opens_and_shows_it(after_a_rig):
    state = after_a_rig.state
    assert state.panel == "graph"
    assert state.binding is None
    assert "0 joints" in summary(state)
    assert not summary(state).endswith("|  ")
    assert not after_a_rig.built[1].visible
    assert f"{len(state.graph.nodes):,} nodes" in summary(state)
    actors = resolve(state).actors
    assert "interior edges" in actors
    assert "bones" not in actors
    assert "bone" not in to_query(state)


def test_every_panel_can_be_looked_at(after_a_rig, loop):
    state, (_, place) = after_a_rig.state, after_a_rig.built[0]
    for panel in PANELS:
        state.panel = panel
        loop.run_for(0.1)
        assert state.message is None, panel
        assert "body" in resolve(state).actors, panel
        told = [one.object for one in place.objects if one.visible and hasattr(one, "object")]
        assert (told == [NO_SKELETON]) == (panel not in ("graph", "check", "learn")), panel


@pytest.mark.parametrize("panel", [panel.id for panel in PANELS.values() if not panel.needs_audit])
def test_a_panel_that_needs_no_skeleton_stays_and_shows_its_own_scene(bare, loop, panel):
    bare.state.panel = panel
    show_bare(bare, loop)
    stays = PANELS[panel].works_without_skeleton
    assert bare.state.panel == (panel if stays else "graph")
    assert ("interior edges" in resolve(bare.state).actors) == (bare.state.panel == "graph")


def test_check_is_rendered_without_a_skeleton():
    shown = describe(bare_arm(), Choices("check"), resolution=16)
    assert set(shown.actors) == {"body"}


def test_cuts_slices_and_keys_do_no_harm(after_a_rig, loop):
    bare, state = after_a_rig, after_a_rig.state
    for change in (
        {"cut_axis": "x"},
        {"slicing": True},
        {"slicing": False, "edge_colors": "depth"},
    ):
        state.param.update(**change)
        assert resolve(state).actors
    state.edge_colors = "distance"
    assert resolve(state).actors
    for act in ("play", "parent", "child", "reset"):
        keys.act(bare, act)
    keys.step(bare, 1)
    look.pick(bare, 0)
    look.pick_vertex(bare, 0)
    assert state.vertex is None
    assert not state.moving
    loop.run_for(0.1)
    assert state.message is None


def test_another_resolution_builds_again(bare, loop):
    before = bare.state.bare_graph
    bare.state.resolution = 24
    loop.run_until(lambda: bare.state.bare_graph is not before)
    assert bare.state.bare_graph.lattice.resolution == 24
    bare.state.resolution = 10_000
    loop.run_until(lambda: bare.state.message is not None)
    assert bare.state.message[0] == "error"
    assert bare.state.resolution == 24


def test_a_character_after_it_is_bound_as_ever(bare, loop):
    loading.show_rig(bare, arm_rig())
    loop.run_until(lambda: bare.state.binding is not None)
    assert bare.state.bare_graph is None
    assert np.isfinite(bare.state.weights).all()
    assert "bones" in resolve(bare.state).actors


def test_a_picture_of_its_graph():
    scene = describe(bare_arm(), Choices("graph"), resolution=16)
    assert "interior edges" in scene.actors
    for panel in ("weights", "distance", "pose", "compare"):
        with pytest.raises(SkeletonError, match="the rig has no skeleton; export the mesh"):
            describe(bare_arm(), Choices(panel), resolution=16)
