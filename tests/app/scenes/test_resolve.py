"""From state to scene, without a browser."""

from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell_app.derive.memo import Memo
from cutcell_app.document.framing import bones_part, first_joint
from cutcell_app.editing.binding.bound import build_shown
from cutcell_app.features.distance.scene import wants_field
from cutcell_app.features.graph.choices import LAYERS
from cutcell_app.features.scenes import RIGID, following, resolve
from cutcell_app.features.state import PANELS, PageState
from cutcell_app.looks.character import GRAPH_BODY_OPACITY, cells_of
from cutcell_app.looks.pose import clip_of, clip_part, pose_of
from cutcell_viewers.palette import DARK, LIGHT


@pytest.fixture
def state(rig, binding):
    return PageState(rig=rig, binding=binding, joint=1, resolution=16, graph_resolution=0)


def visible(state):
    return {name for name, actor in resolve(state).actors.items() if actor.visible}


def test_without_a_character_there_is_an_empty_scene():
    assert resolve(PageState()).actors == {}


@pytest.mark.parametrize("panel", sorted(set(PANELS) - {"weights", "pose", "learn"}))
def test_before_anything_is_computed_the_character_stands_there_plain(rig, panel):
    scene = resolve(PageState(rig=rig, panel=panel))
    assert set(scene.actors) == {"body", "bones", "bone outlines", "attachment 0"}
    assert scene.actors["body"].scalars is None
    assert scene.actors["body"].colors is None
    assert scene.legend is None


@pytest.mark.parametrize("panel", ["weights", "pose", "learn"])
def test_before_anything_is_computed_the_files_own_weights_are_seen(rig, panel):
    scene = resolve(PageState(rig=rig, panel=panel, weights_shown="bone", joint=1))
    np.testing.assert_allclose(scene.actors["body"].scalars, rig.weights[:, 1], atol=1e-6)
    assert scene.legend.title.startswith("In the file")
    plain = resolve(PageState(rig=rig.with_weights(None), panel=panel))
    assert plain.actors["body"].scalars is None
    assert plain.legend is None


FIELDS = {
    "distance": {"cut_axis": "z"},
    "weights": {"weights_shown": "bone"},
    "graph": {"edge_colors": "depth"},
    "compare": {"compare_field": "bone"},
}


@pytest.mark.parametrize("panel", FIELDS)
def test_a_colour_map_is_that_of_the_field_its_cut_and_its_legend(state, panel):
    state.param.update(panel=panel, field=state.binding.distances.field(1), **FIELDS[panel])
    before = resolve(state)
    state.colormap = "viridis"
    after = resolve(state)
    changed = {n for n, actor in after.actors.items() if actor.colormap.endswith(":viridis")}
    assert changed == {n for n, actor in before.actors.items() if actor.scalars is not None}
    assert changed >= ({"body", "inside"} if panel == "distance" else set())
    assert after.legend.colormap == f"{before.legend.colormap}:viridis"
    assert following(state).actors["body"].colormap == after.actors["body"].colormap


def test_a_colour_map_does_not_change_what_is_no_such_field(state):
    state.param.update(panel="weights", weights_shown="count")
    before = resolve(state)
    state.colormap = "viridis"
    assert resolve(state).legend == before.legend


def test_either_side_may_be_seen_alone_and_taken_for_the_truth(state, rig, binding):
    state.param.update(panel="weights", weights_shown="bone", weights_of="file")
    seen = resolve(state)
    np.testing.assert_allclose(seen.actors["body"].scalars, rig.weights[:, 1], atol=1e-6)
    assert seen.legend.title.startswith("In the file")
    state.param.update(weights_shown="bone_difference", truth="file")
    more = resolve(state).actors["body"].scalars
    np.testing.assert_allclose(more, (binding.weights - rig.weights)[:, 1], atol=1e-6)
    state.truth = "ours"
    np.testing.assert_allclose(resolve(state).actors["body"].scalars, -more, atol=1e-6)


def test_the_colours_of_the_weights_stay_while_it_moves(state, binding):
    state.param.update(panel="pose", weights_shown="bone", turns={1: (0, 0, 40)})
    scene = resolve(state)
    assert scene.pose is not None
    np.testing.assert_allclose(scene.actors["body"].scalars, binding.weights[:, 1], atol=1e-6)
    state.pose_colors = "plain"
    assert resolve(state).actors["body"].scalars is None


@pytest.mark.parametrize("layer", LAYERS)
def test_each_layer_of_the_graph_is_switched_by_its_own_name(state, layer):
    state.param.update(panel="graph", **{layer: False})
    before = visible(state)
    setattr(state, layer, True)
    assert visible(state) - before >= {LAYERS[layer]}


def test_what_hangs_on_the_body_is_hidden_with_it(state):
    state.param.update(panel="graph", body=False)
    assert "attachment 0" not in visible(state)


def test_turned_joints_make_a_pose(state, rig):
    assert pose_of(state) is None
    state.turns = {1: (0, 90, 0)}
    pose = pose_of(state)
    np.testing.assert_allclose(pose[0], np.eye(4), atol=1e-12)
    np.testing.assert_allclose(pose[2], pose[1], atol=1e-12)
    wrist = pose[1] @ [1, 0, 0, 1]
    np.testing.assert_allclose(wrist, [0, 0, -1, 1], atol=1e-12)
    state.moving = True
    assert pose_of(state) is None


def test_motions_are_the_rigs_or_a_swing(state, rig):
    state.param.update(moving=True, clip=0)
    assert clip_of(state) is None
    state.panel = "pose"
    assert clip_of(state) is rig.clips[0]
    state.clip = -1
    assert clip_of(state).name == "swing"
    part = clip_part(state, clip_of(state))
    assert part["matrices"].shape == (len(part["times"]) * 3 * 16,)
    assert part["matrices"].dtype == np.float32
    assert clip_part(state, None) is None
    empty = cutcell.Clip("empty", np.zeros(0), np.zeros((0, 3, 4, 4)))
    assert clip_part(state, empty) is None


def test_the_theme_changes_the_ink_of_the_mesh(state):
    state.panel = "graph"
    assert resolve(state).actors["mesh edges"].color == LIGHT.mesh_edge
    state.dark = True
    assert resolve(state).actors["mesh edges"].color == DARK.mesh_edge


def test_a_memo_changes_nothing_and_makes_nothing_twice(state):
    state.panel = "graph"
    once = resolve(state)
    state.cut_axis = "z"
    again = resolve(state)
    for name in once.actors:
        assert again.actors[name].points is once.actors[name].points
        fresh = resolve(state).actors[name]
        np.testing.assert_array_equal(again.actors[name].points, fresh.points)
        np.testing.assert_array_equal(again.actors[name].cells, fresh.cells)


def test_a_memo_tells_inputs_apart():
    memo = Memo()
    array = np.zeros(3)
    assert memo("a", (array, 1), lambda: "first") == "first"
    assert memo("a", (array, 1), lambda: "second") == "first"
    assert memo("a", (array, True), lambda: "second") == "second"
    assert memo("a", (array.copy(), True), lambda: "third") == "third"
    assert memo("b", (array.copy(), True), lambda: "fourth") == "fourth"


def test_bones_can_be_picked_where_they_are_drawn(state):
    part = bones_part(state)
    assert part["names"] == ["shoulder", "elbow", "wrist"]
    assert part["start"].shape == part["end"].shape == (9,)
    assert part["joint"].tolist() == [0, 1, 2]


def test_the_first_joint_is_an_arm_or_a_long_bone(rig):
    assert first_joint(rig) == 1
    names = ("root", "LeftForeArm", "hand")
    assert first_joint(replace(rig, skeleton=replace(rig.skeleton, names=names))) == 1


def test_the_weights_of_all_bones_or_of_one(state, binding):
    state.panel = "weights"
    assert resolve(state).actors["body"].colors is not None
    state.weights_shown = "bone"
    scene = resolve(state)
    np.testing.assert_allclose(scene.actors["body"].scalars, binding.weights[:, 1], atol=1e-6)
    assert "elbow" in scene.legend.title


def test_the_distance_on_the_surface(state, binding):
    state.panel = "distance"
    at_once = resolve(state)  # what lies inside comes later
    known = binding.distances.joint[state.joint]
    np.testing.assert_allclose(at_once.actors["body"].scalars, known, rtol=1e-6)
    state.field = binding.distances.field(1)
    scene = resolve(state)
    distance = binding.distances.on_mesh(1)
    np.testing.assert_allclose(scene.actors["body"].scalars, distance, rtol=1e-5, atol=1e-6)
    assert "elbow" in scene.legend.title
    state.joint = 2
    assert "wrist" in resolve(state).legend.title


def test_the_graph_opens_cut_away_with_all_its_kinds_and_easy_to_read(rig, binding):
    state = PageState(rig=rig, binding=binding, panel="graph", resolution=16)
    assert not visible(state) & set(LAYERS.values()) - {"body"}  # it is still to be built
    state.easy_graph = build_shown(state.graph_inputs)
    seen = visible(state)
    assert seen > {"mesh edges", "interior edges", "surface edges", "surface nodes"}
    scene = resolve(state)
    assert scene.cut is not None
    assert scene.legend.title == "Graph, R = 40 (weights: 16)"
    assert len(scene.actors["interior nodes"].cells) > 40
    state.param.update(edge_colors="distance", field=binding.distances.field(0))
    assert resolve(state).actors["interior edges"].scalars is not None
    state.param.update(graph_resolution=0, edge_colors="kind")
    assert resolve(state).legend.title == "Graph, R = 16"


def test_widths_follow_the_spacing_of_each_kind(state):
    state.panel = "graph"
    coarse = resolve(state).actors
    state.graph_resolution = 48
    state.easy_graph = build_shown(state.graph_inputs)
    fine = resolve(state).actors
    assert fine["mesh edges"].thick == coarse["mesh edges"].thick
    for name in ("interior edges", "interior nodes", "surface nodes"):
        assert coarse[name].thick / fine[name].thick == pytest.approx(3, rel=0.05)


def test_the_body_is_see_through_only_where_it_would_hide_the_graph(state):
    def opacity():
        return resolve(state).actors["body"].opacity

    state.param.update(panel="graph", cut_axis="off", interior_edges=False, surface_edges=False)
    assert opacity() == 1
    state.interior_edges = True
    assert opacity() == GRAPH_BODY_OPACITY
    state.cut_axis = "x"
    assert opacity() == 1
    state.param.update(cut_axis="off", panel="weights")
    assert opacity() == 1


def test_the_cut_and_its_slab(state):
    state.panel = "graph"
    assert resolve(state).cut.normal == (0, 0, 1)
    state.cut_axis = "off"
    assert resolve(state).cut is None
    state.param.update(cut_axis="x", cut_position=1.0)
    scene = resolve(state)
    assert scene.cut.origin[0] == pytest.approx(1.5)
    assert scene.actors["interior edges"].slab == pytest.approx(1.5 * 3.0 / 16)
    assert scene.actors["interior edges"].slab == cells_of(state, 1.5)
    assert scene.actors["mesh edges"].slab == 0
    state.cut_keeps = "half"
    assert resolve(state).actors["interior edges"].slab == 0
    state.param.update(cut_keeps="slab", slab=0.2)
    scene = resolve(state)
    for name in ("body", "mesh edges", "interior edges"):
        assert scene.actors[name].slab == pytest.approx(0.2 * 3.0)
    assert not scene.actors["bones"].clipped


@pytest.mark.parametrize("panel", ["graph", "distance", "weights"])
def test_the_character_rests_where_it_is_not_posed(state, panel):
    state.param.update(panel="pose", turns={1: (0, 0, 45)})
    assert resolve(state).pose is not None
    state.panel = panel
    assert resolve(state).pose is None


def test_a_cut_shows_the_field_once_it_is_there(state, binding):
    assert not wants_field(state)
    state.param.update(panel="distance", cut_axis="x")
    assert wants_field(state)
    assert "inside" not in resolve(state).actors
    state.field = binding.distances.field(1)
    assert "inside" in resolve(state).actors


def test_a_joint_without_weight_has_no_field(state, rig):
    skeleton = replace(rig.skeleton, deform=np.array([True, False, True]))
    state.param.update(rig=replace(rig, skeleton=skeleton), panel="distance", cut_axis="x")
    assert not wants_field(state)
    assert resolve(state).actors["body"].scalars is None


@pytest.mark.parametrize("panel", ["distance", "weights", "compare"])
def test_grey_parts_are_named_where_colours_tell_something(state, rig, panel):
    state.panel = panel
    named = [text for _, text in resolve(state).legend.swatches]
    assert named.count(RIGID) == 1
    state.rig = replace(rig, attachments=())
    assert RIGID not in [text for _, text in resolve(state).legend.swatches]


def test_the_legend_of_a_motion_names_only_what_moves(state, binding):
    state.param.update(panel="graph", mesh_edges=True)
    assert resolve(state).legend is not None
    assert following(state).legend is None
    assert resolve(state).legend.title == "Graph, R = 16"
    state.body = False
    for name in ("body", "attachment 0"):
        moving = following(state).actors[name]
        assert (moving.visible, moving.opacity) == (True, 1.0)
    field = binding.distances.field(1)
    state.param.update(panel="distance", starts=True, vertex=0)
    state.field = field
    whole, moving = resolve(state).legend, following(state).legend
    assert {text for _, text in whole.swatches} > {RIGID}
    assert [text for _, text in moving.swatches] == [RIGID]
    assert moving.title == whole.title


def test_the_graph_is_told_apart_by_form_and_its_nodes_can_be_looked_at(state, binding):
    state.param.update(panel="graph", mesh_edges=True, surface_edges=True, nodes=True)
    actors = resolve(state).actors
    edges = [actors[f"{kind} edges"] for kind in ("mesh", "interior", "surface")]
    assert [edge.dash > 0 for edge in edges] == [False, False, True]
    nodes = [actors[f"{kind} nodes"] for kind in ("mesh", "interior", "surface")]
    assert [node.form for node in nodes] == ["round", "square", "triangle"]
    assert all(node.visible for node in nodes)
    reports = np.concatenate([node.reading.values for node in nodes]).astype(int)
    np.testing.assert_array_equal(np.sort(reports), np.flatnonzero(binding.graph.connected))
    state.node = int(reports[-1])
    ring = resolve(state).actors["node ring"]
    assert len(ring.cells) == np.diff(binding.graph.adjacency[0])[state.node]
    state.edge_colors = "component"
    assert "1 connected component" in resolve(state).legend.title
    assert resolve(state).actors["mesh edges"].colors is not None


def test_any_angle_shows_the_lines_of_sight_of_a_vertex(state, binding):
    state.param.update(panel="graph", vertex=0, joint=2, connectivity="any")
    assert wants_field(state)
    state.field = binding.distances.field(2)
    scene = resolve(state)
    assert "path" in scene.actors
    assert "lines of sight" in scene.legend.swatches[0][1]
    state.connectivity = 6
    assert "path" not in resolve(state).actors


def test_a_wireframe_and_faint_bones_can_be_switched_on(state):
    state.panel = "weights"
    assert not resolve(state).actors["body"].edges
    state.param.update(wireframe=True, faint_skeleton=True)
    actors = resolve(state).actors
    assert actors["body"].edges
    assert 0 < actors["bones"].opacity < 0.5
