"""Each panel on a file from elsewhere, used as a person uses it.

Where the file is absent, since it is not part of the project, a demo character stands in.
"""

import numpy as np
import pytest

import cutcell
from cutcell.pose import axis_rotation
from cutcell_assets import demo_path
from cutcell_viewers.character import pose_in_scene
from cutcell_viewers.pose_scene import joint_turns
from cutcell_viewers.short_names import short_names
from tests.app.browser import changed
from tests.app.test_browser_accessibility import TITLES
from tests.conftest import SHARED_RIGS

pytestmark = pytest.mark.nightly

RESOLUTION = 24
REAL = SHARED_RIGS / "makehuman_clothed_mixamo.glb"
SOURCE = REAL if REAL.exists() else demo_path("biped_cape")


def test_every_panel_on_a_file_from_elsewhere(visit):
    rig = cutcell.load(SOURCE)
    binding = cutcell.bind(rig, RESOLUTION)
    visit.go(f"?rig=small&resolution={RESOLUTION}")
    visit.open(SOURCE)
    if visit.button("Close").is_visible():
        visit.dismiss()
    if visit.button("Computed").is_visible():
        visit.button("Computed").click()
        visit.settle()
    looks_at_weights(visit, rig, binding)
    follows_the_distance(visit, rig, binding)
    turns_a_joint(visit, rig, binding)
    for title in TITLES:
        visit.panel(title)


def looks_at_weights(visit, rig, binding):
    visit.panel("Weights")
    mixed = visit.look()
    vertex = visit.click_vertex()
    strongest = int(binding.weights[vertex].argmax())
    name, weight = rig.skeleton.names[strongest], binding.weights[vertex, strongest]
    row = visit.card.get_by_role("button", name=f"{name}: weight {weight:.2f}")
    row.click()
    visit.expect_text(f"Weight of {short_names(rig.skeleton.names)[strongest]}")
    assert changed(mixed, visit.look()) > 0.002
    visit.close_card()
    visit.choose("Colour by", "Difference from the file's")
    visit.expect_text("Difference to the file's weights")


def follows_the_distance(visit, rig, binding):
    visit.panel("Distance")
    name = visit.bone.inner_text()
    visit.expect_text(f"Distance from {name}")
    shown = "Array.from(__cutcell.renderer.actors.get('body').values)"
    visit.settle()
    values = np.array(visit.page.evaluate(shown))
    field = binding.distances.on_mesh(short_names(rig.skeleton.names).index(name))
    # What is far was not measured here.
    near = np.isfinite(field) & (binding.distances.fallback == 0)
    assert near.mean() > 0.01
    np.testing.assert_allclose(values[near], field[near], atol=1e-5)


def turns_a_joint(visit, rig, binding):
    visit.panel("Pose")
    still = visit.points()
    visit.slide("About Z", "ArrowRight", 20)
    visit.settle()
    joint = short_names(rig.skeleton.names).index(visit.bone.inner_text())
    turns = joint_turns(rig, {joint: axis_rotation("z", 20)})
    scene = pose_in_scene(rig, cutcell.forward_kinematics(rig.skeleton, turns))
    expected = cutcell.linear_blend_skinning(still, binding.weights, scene)
    assert np.abs(expected - still).max() > 1e-3 * np.ptp(still)
    np.testing.assert_allclose(visit.points(), expected, atol=1e-4 * np.ptp(still))
    visit.button("Rest pose").click()
