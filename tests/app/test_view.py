"""What is sent to the browser: all at first, then only what changed."""

from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell_app.document.framing import camera_part, theme_part
from cutcell_app.server.protocol.reading import MessageError
from cutcell_app.server.protocol.received import Pick
from cutcell_app.widgets.changes import changes, painted
from cutcell_app.widgets.view import SceneView
from cutcell_viewers.camera import framing
from cutcell_viewers.description import Cut, Description
from cutcell_viewers.graph_scene import graph_scene
from cutcell_viewers.palette import DARK
from cutcell_viewers.weights_scene import weights_scene


@pytest.fixture(scope="module")
def scene(rig):
    return weights_scene(rig, rig.weights, 1)


@pytest.fixture
def view():
    view = SceneView()
    view.picked = []
    view.listen(Pick, lambda message: view.picked.append(message.joint))
    view.sent = []
    view._send_msg = view.sent.append
    return view


def test_everything_is_sent_at_first(scene):
    message = changes(Description(), scene, set())
    body = message["actors"]["body"]
    assert body["kind"] == "surface"
    np.testing.assert_array_equal(body["points"], scene.actors["body"].points.ravel())
    assert body["skin"]["count"] == scene.actors["body"].skin.joints.shape[1]
    assert body["scalars"].dtype == np.float32
    assert body["table"].dtype == np.uint8
    assert message["legend"]["title"] == scene.legend.title


def test_nothing_is_sent_when_nothing_changed(scene, rig):
    sent = set(scene.actors)
    assert changes(scene, scene, sent) == {}
    assert changes(scene, weights_scene(rig, rig.weights, 1), sent) == {}


def test_other_weights_send_values_not_geometry(scene, rig):
    message = changes(scene, weights_scene(rig, rig.weights, 2), set(scene.actors))
    assert set(message["actors"]["body"]) == {"scalars", "table", "limits", "reading"}
    assert set(message["actors"]["bones"]) == {"colors"}


def other_rows(rig, count):
    """Return weights of which the last rows are others, with as many influences."""
    weights = rig.weights.copy()
    weights[-count:] = weights[0]
    return weights


@pytest.mark.parametrize("joint", [1, None])
def test_of_a_few_other_weights_only_these_are_sent(scene, rig, joint):
    count = len(rig.weights)
    before, few, many = (
        weights_scene(rig, weights, joint)
        for weights in (rig.weights, other_rows(rig, 3), other_rows(rig, count // 2))
    )
    body = changes(before, few, set(before.actors))["actors"]["body"]
    assert set(body) == {"repainted"}
    rows, shown = body["repainted"], few.actors["body"]
    assert set(rows["vertices"]) <= set(range(count - 3, count))
    shown_before = painted(before.actors["body"], rows)
    np.testing.assert_array_equal(shown_before.skin.joints, shown.skin.joints)
    np.testing.assert_array_equal(shown_before.skin.weights, shown.skin.weights)
    np.testing.assert_array_equal(shown_before.scalars, shown.scalars)
    np.testing.assert_array_equal(shown_before.colors, shown.colors)
    if joint is None:
        np.testing.assert_array_equal(rows["readings"], shown.reading.values[rows["vertices"]])
    assert "repainted" not in changes(before, many, set(before.actors))["actors"]["body"]


def test_what_a_stroke_has_shown_is_not_sent_again(view, scene):
    body = scene.actors["body"]
    scalars = body.scalars.copy()
    scalars[-3:] += 0.5
    after = replace(scene, actors={**scene.actors, "body": replace(body, scalars=scalars)})
    view.present(scene)
    view._handle_msg({"type": "ready"})
    vertices = np.arange(len(scalars) - 5, len(scalars), dtype=np.uint32)
    rows = {"vertices": vertices, "scalars": scalars[-5:]}
    view.answer(painted=rows)
    view.answer(painted=rows)
    first, second = (message["painted"] for message in view.sent[-2:])
    np.testing.assert_array_equal(first["vertices"], vertices[-3:])
    assert second == {}
    count = len(view.sent)
    view.present(after)
    assert len(view.sent) == count
    view.present(scene)
    back = view.sent[-1]["actors"]["body"]["repainted"]
    np.testing.assert_array_equal(back["vertices"], vertices[-3:])
    np.testing.assert_array_equal(back["scalars"], body.scalars[-3:])


def test_a_stroke_may_widen_the_influences_of_its_points(scene):
    body = scene.actors["body"]
    joints, weights = np.array([[0, 1] * 4], np.uint16), np.full((1, 8), 1 / 8, np.float32)
    rows = {"vertices": np.array([2]), "joints": joints.ravel(), "weights": weights.ravel()}
    skin = painted(body, {**rows, "count": 8}).skin
    width = body.skin.joints.shape[1]
    np.testing.assert_array_equal(skin.joints[2], joints[0])
    np.testing.assert_array_equal(skin.weights[3, :width], body.skin.weights[3])
    assert not skin.weights[3, width:].any()


def test_from_values_to_colours_and_back(scene, rig):
    every = weights_scene(rig, rig.weights)
    there = changes(scene, every, set(scene.actors))["actors"]["body"]
    assert set(there) == {"colors", "reading"}
    back = changes(every, scene, set(scene.actors))["actors"]["body"]
    assert set(back) == {"scalars", "table", "limits", "reading"}


def test_a_hidden_actor_waits_until_it_is_seen(rig):
    graph = cutcell.build_graph(rig.mesh, 8)
    hidden = graph_scene(rig, graph, layers=())
    sent = set()
    assert changes(Description(), hidden, sent) == {}
    seen = graph_scene(rig, graph, layers=("mesh edges",))
    message = changes(hidden, seen, sent)
    assert list(message["actors"]) == ["mesh edges"]
    assert "points" in message["actors"]["mesh edges"]
    assert changes(seen, hidden, sent)["actors"] == {"mesh edges": {"visible": False}}


def test_actors_that_are_gone_are_removed(scene):
    sent = set(scene.actors)
    message = changes(scene, Description(), sent)
    assert set(message["remove"]) == set(scene.actors)
    assert not sent
    assert message["legend"] is None


def test_an_actor_that_turns_into_another_kind_is_sent_anew(scene):
    body = scene.actors["body"]
    other = replace(body, kind="points", cells=np.arange(3, dtype=np.int32)[:, None])
    part = changes(scene, Description({"body": other}), {"body"})["actors"]["body"]
    assert part["kind"] == "points"
    assert "points" in part


def test_a_pose_is_sixteen_numbers_a_joint(scene):
    pose = np.tile(np.eye(4), (3, 1, 1))
    message = changes(scene, replace(scene, pose=pose), set(scene.actors))
    assert list(message) == ["pose"]
    assert message["pose"].nbytes == 3 * 16 * 4
    assert changes(replace(scene, pose=pose), scene, set(scene.actors)) == {"pose": None}


def test_a_cut_is_six_numbers(scene):
    cut = Cut((0.0, 1.0, 2.0), (1.0, 0.0, 0.0))
    message = changes(scene, replace(scene, cut=cut), set(scene.actors))
    assert message == {"cut": {"origin": cut.origin, "normal": cut.normal}}


def test_nothing_is_sent_before_the_browser_is_ready(view, scene):
    view.send(theme=theme_part(DARK))
    view.present(scene)
    assert view.sent == []
    view._handle_msg({"type": "ready", "width": 900})
    assert view.window_width == 900
    (first,) = view.sent
    assert {"lights", "actors", "legend", "theme"} <= set(first)
    assert first["id"] == 1


def test_a_browser_that_comes_again_gets_everything_again(view, scene):
    view.present(scene)
    view.send(camera=camera_part(framing(scene.bounds)))
    view._handle_msg({"type": "ready"})
    view._handle_msg({"type": "ready"})
    first, second = view.sent
    assert first["actors"].keys() == second["actors"].keys()
    assert first["camera"] == second["camera"]


def test_what_a_person_does_is_told(view):
    view._handle_msg({"type": "pick", "joint": 2})
    assert view.picked == [2]
    view._handle_msg({"type": "camera-moved", "position": [1, 2, 3], "focal_point": [0, 0, 0]})
    assert view.camera.position == (1, 2, 3)
    view._handle_msg({"type": "time", "time": 0.5})
    assert view.time == 0.5
    with pytest.raises(MessageError, match="nonsense"):
        view._handle_msg({"type": "nonsense"})
