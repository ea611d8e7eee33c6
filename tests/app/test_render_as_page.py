"""`cutcell render` draws what the page shows: the same actors for the same choices."""

import pytest

from cutcell_app.document import loading
from cutcell_app.features.compare.disagreement.results import look_at
from cutcell_app.headless.choices import RENDERED, Choices
from cutcell_app.headless.scene import describe
from cutcell_app.shell.session.begin import begin
from tests.app.loop import Loop
from tests.viewers.arm import arm_rig

RESOLUTION = 16
CHOICES = {
    **{panel: {"panel": panel} for panel in RENDERED},
    "explained vertex": {"panel": "weights", "vertex": 7, "explain": True},
    "symmetry": {"panel": "weights", "weights_shown": "symmetry"},
    "measures": {"panel": "distance", "beside_straight": True, "beside_voxel": True},
    "path": {"panel": "distance", "path": True, "vertex": 7, "starts": True},
    "cut": {"panel": "graph", "cut_axis": "x", "graph_face": "winding"},
    "slice": {"panel": "graph", "slicing": True},
    "easy graph": {"panel": "graph", "graph_resolution": 8},
    "error": {"panel": "pose", "heat": True, "turns": {1: (0.0, 0.0, 40.0)}},
    "rival": {"panel": "pose", "rival": "beside", "turns": {1: (0.0, 0.0, 40.0)}},
}


@pytest.fixture(scope="module")
def page():
    loop = Loop()
    session = begin(loop)
    session.state.param.update(
        resolution=RESOLUTION, graph_resolution=0, beside_resolution=RESOLUTION
    )
    loading.show_rig(session, arm_rig())
    loop.rest(session)
    yield session, loop
    session.close()


def check_same(page, choices):
    """Compare the page's scene for some choices with the one that is rendered."""
    session, loop = page
    state = session.state
    initial = {name: state.param[name].default for name in ("vertex", "explain", *choices)}
    try:
        state.param.update(choices)
        loop.rest(session)
        settings = {"graph_resolution": 0, "weights_shown": state.weights_shown, **choices}
        chosen = Choices(
            settings.pop("panel"),
            bone=state.rig.skeleton.names[state.joint],
            methods=state.methods,
            settings={**settings, "compare_field": state.compare_field},
        )
        drawn = describe(state.rig, chosen, binding=state.binding, resolution=RESOLUTION)
        assert drawn.actors.keys() == session.view._next.actors.keys()
        assert drawn.views == session.view._next.views
    finally:
        state.param.update(initial)
        loop.rest(session)


@pytest.mark.parametrize("name", CHOICES)
def test_a_picture_has_the_actors_of_the_page(page, name):
    check_same(page, CHOICES[name])


def test_a_picture_has_the_marks_of_a_disagreement(page):
    session, loop = page
    session.state.panel = "compare"
    loop.rest(session)
    key = session.state.disagreement.regions[0].key
    look_at(session, key)
    loop.rest(session)
    assert any(name.startswith("region") for name in session.view._next.actors)
    check_same(page, {"panel": "compare", "region": key, "turns": session.state.turns})
