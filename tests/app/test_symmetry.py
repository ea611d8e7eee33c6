"""The map of symmetry as colours on the panel Weights, without a browser."""

from dataclasses import replace

import numpy as np
import pytest

from cutcell import Skeleton
from cutcell_app.document import loading
from cutcell_app.editing.correct.commands import rename
from cutcell_app.editing.correct.moving import mirror_of
from cutcell_app.editing.symmetry.asymmetry import asymmetry, mirror_image
from cutcell_app.editing.symmetry.controls import PAIRS, about, set_partner
from cutcell_app.features.scenes import resolve
from cutcell_app.looks.weights import painted_colors
from cutcell_app.widgets.controls import draw
from cutcell_app.widgets.rows import Rows
from tests.app.loop import settled
from tests.app.small import small_rig
from tests.viewers.arm import arm_rig


@pytest.fixture
def mapped(session, loop):
    """Let a session show the symmetry of the small figure."""
    session.state.param.update(resolution=16, panel="weights", weights_shown="symmetry")
    loading.show_rig(session, small_rig())
    loop.run_until(lambda: session.state.asymmetry is not None)
    settled(session, loop)
    return session


def test_the_map_is_that_of_the_core(mapped):
    state = mapped.state
    image = mirror_image(state.rig)
    np.testing.assert_allclose(
        state.asymmetry.values, asymmetry(state.binding.weights, image), atol=1e-12
    )
    description = resolve(state)
    assert description.legend.title == "Difference to the mirror image"
    assert about(state).startswith("Part of each vertex's weight")
    assert painted_colors(state, np.arange(3), state.binding.weights[:3]) == {}


def test_weights_of_the_file_have_a_map_of_their_own(mapped, loop):
    state = mapped.state
    weights = np.tile(np.eye(len(state.rig.skeleton.names))[3], (len(state.rig.mesh.vertices), 1))
    loading.show_rig(mapped, small_rig().with_weights(weights))
    settled(mapped, loop)
    state.weights_of = "file"
    settled(mapped, loop)
    assert np.nanmin(state.asymmetry.values) == 1


def test_joints_without_a_partner_are_listed(session, loop):
    rig = small_rig()
    names = [name.replace("hand.L", "hook") for name in rig.skeleton.names]
    joints = rig.skeleton.joints.copy()
    joints[names.index("hook")] += [0, 0.3, 0]
    skeleton = Skeleton(joints, rig.skeleton.parents, names)
    session.state.param.update(resolution=16, panel="weights", weights_shown="symmetry")
    loading.show_rig(session, replace(rig, skeleton=skeleton, clips=()))
    loop.run_until(lambda: session.state.mirror_image is not None)
    assert "Joints without a partner: hook, hand.R." in about(session.state)


def test_a_character_that_is_not_mirrored_says_so(session, loop):
    session.state.param.update(resolution=16, panel="weights", weights_shown="symmetry")
    loading.show_rig(session, arm_rig())
    loop.run_until(lambda: session.state.mirror_image is not None)
    settled(session, loop)
    assert "not mirrored" in about(session.state)
    assert session.state.asymmetry is None
    assert "Difference" not in resolve(session.state).legend.title


def test_a_pair_of_joints_is_changed_undone_and_renamed(mapped, loop):
    state, names = mapped.state, mapped.state.rig.skeleton.names
    (rows,) = draw(mapped, PAIRS).select(Rows)
    assert ("hand.L \u2013 hand.R", "name", 0.0) in [tuple(row) for row in rows.rows]
    rows.click([row[0] for row in rows.rows].index("hand.L \u2013 hand.R"))
    assert state.joint == names.index("hand.L")
    set_partner(mapped, 2 + names.index("forearm.R"))
    settled(mapped, loop)
    assert mirror_of(mapped.state).joint[state.joint] == names.index("forearm.R")
    assert state.mirror_image.mirror.joint[state.joint] == names.index("forearm.R")
    assert ("hand.L \u2013 forearm.R", "set", 0.0) in [tuple(row) for row in rows.rows]
    state.joint = names.index("forearm.R")
    rename(mapped, names.index("forearm.R"), "claw")
    assert state.edits.partners == {"hand.L": "claw", "claw": "hand.L"}
    set_partner(mapped, 0)
    assert state.edits.partners == {}
    set_partner(mapped, 1)
    assert mirror_of(mapped.state).joint[state.joint] == -1


def test_before_a_character_is_there_no_pairs_are(session):
    (rows,) = draw(session, PAIRS).select(Rows)
    assert rows.rows == []
