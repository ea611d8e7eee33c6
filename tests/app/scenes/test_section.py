"""The face of the cut on Distance and Graph, and findings in their poses."""

from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell.diagnosis.finding import Finding, Pose
from cutcell_app.features.scenes import resolve
from cutcell_app.features.state import PageState
from cutcell_viewers.finding_scene import camera_on, camera_on_marks
from tests.viewers.arm import arm_rig


@pytest.fixture(scope="module")
def state():
    rig = arm_rig()
    state = PageState(rig=rig, panel="distance")
    state.binding = cutcell.bind(rig, 16)
    distances = state.binding.distances
    state.joint = 1
    state.field = distances.field(1)
    return state


def test_the_face_shows_what_is_chosen(state):
    state.param.update(panel="distance", cut_axis="free", cut_face="field")
    scene = resolve(state)
    face = scene.actors["inside"]
    away = (face.points - np.array(scene.cut.origin)) @ np.array(scene.cut.normal)
    assert np.abs(away).max() < 1e-5
    assert scene.legend.title.startswith("Distance from")
    assert resolve(state).actors["inside"].points is face.points
    state.cut_face = "winding"
    scene = resolve(state)
    assert scene.legend.title == "Winding number"
    assert scene.actors["body"].scalars is None
    state.param.update(panel="graph", graph_resolution=0, cut_axis="y", graph_face="open")
    assert "inside" not in resolve(state).actors
    for face, title in (("field", "Distance from"), ("winding", "Winding number")):
        state.graph_face = face
        scene = resolve(state)
        assert scene.actors["inside"].opacity < 1
        assert scene.legend.title.startswith(title)
        assert any("interior" in text for _, text in scene.legend.swatches)


def test_a_finding_is_shown_in_its_pose(state):
    rig = state.rig
    result = Finding(
        "stretched-edges", "warning", "", "", vertices=np.arange(30, 40), joints=np.array([1]),
        pose=Pose(1, "z", 60.0),
    )  # fmt: skip
    state.param.update(panel="check", diagnosis={result.code: result}, finding=result.code)
    scene = resolve(state)
    assert scene.pose is not None
    assert scene.actors["body"].skin is not None
    marks = [actor for name, actor in scene.actors.items() if name.startswith("finding")]
    assert marks
    assert all(len(actor.skin.weights) == len(actor.points) for actor in marks)
    assert any("turned by 60°" in text for _, text in scene.legend.swatches)
    one = camera_on(rig, result, scene.bounds)
    at_rest = camera_on(rig, replace(result, pose=None), scene.bounds)
    assert one.focal_point != at_rest.focal_point
    np.testing.assert_allclose(camera_on_marks(scene, 1.2).focal_point, one.focal_point, atol=0.05)
