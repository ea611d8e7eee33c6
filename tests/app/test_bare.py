"""A mesh without a skeleton on the page: its graph is there, the rest says why it is not."""

import numpy as np
import pytest

from cutcell.errors import SkeletonError
from cutcell_app.document import loading, look
from cutcell_app.document.address import to_query
from cutcell_app.features.scenes import resolve
from cutcell_app.features.state import PANELS
from cutcell_app.headless import Choices, describe
from cutcell_app.shell.bone import BONE
from cutcell_app.shell.export_controls import EXPORT
from cutcell_app.shell.session import keys
from cutcell_app.shell.sidebar import NO_SKELETON, panels
from cutcell_app.shell.status import messages, summary
from cutcell_app.widgets.controls import draw
from tests.viewers.arm import arm_rig, bare_arm


@pytest.fixture
def after_a_rig(bound, loop):
    """Return a session on which a bare mesh stands, with all panels built for a rig before."""
    bound.built = [panels(bound), draw(bound, BONE), draw(bound, EXPORT), messages(bound)]
    for panel in PANELS:
        bound.state.panel = panel
    loading.show_rig(bound, bare_arm())
    loop.rest(bound)
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
        loop.rest(after_a_rig)
        assert state.message is None, panel
        assert "body" in resolve(state).actors, panel
        reports = [one.object for one in place.objects if one.visible and hasattr(one, "object")]
        assert (reports == [NO_SKELETON]) == (panel not in ("graph", "check", "learn")), panel


@pytest.mark.parametrize("panel", [name for name, panel in PANELS.items() if not panel.needs_audit])
def test_a_panel_that_needs_no_skeleton_stays_and_shows_its_own_scene(bare, loop, panel):
    bare.state.panel = panel
    loading.show_rig(bare, bare_arm())
    loop.rest(bare)
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
    loop.rest(bare)
    assert state.message is None


def test_another_resolution_builds_again(bare, loop):
    before = bare.state.built_graph
    bare.state.resolution = 24
    loop.run_until(lambda: bare.state.built_graph is not before)
    assert bare.state.built_graph.lattice.resolution == 24
    bare.state.resolution = 10_000
    loop.run_until(lambda: bare.state.message is not None)
    assert bare.state.message[0] == "error"
    assert bare.state.resolution == 24


def test_a_character_after_it_is_bound_as_ever(bare, loop):
    loading.show_rig(bare, arm_rig())
    loop.run_until(lambda: bare.state.binding is not None)
    assert bare.state.graph is bare.state.binding.graph
    assert np.isfinite(bare.state.weights).all()
    assert "bones" in resolve(bare.state).actors


def test_a_picture_of_its_graph():
    scene = describe(bare_arm(), Choices("graph"), resolution=16)
    assert "interior edges" in scene.actors
    for panel in ("weights", "distance", "pose", "compare"):
        with pytest.raises(SkeletonError, match="the rig has no skeleton; export the mesh"):
            describe(bare_arm(), Choices(panel), resolution=16)
