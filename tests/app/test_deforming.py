"""The list of joints that deform, on the page."""

import numpy as np

from cutcell_app.panels.deform import HIDDEN, SHOWN, deforming


def parts(section):
    """Return the caption, both buttons, the place of the list, and the boxes in it."""
    _, counts, buttons, place = section.objects
    return counts, *buttons.objects, place


def test_a_joint_is_left_out_and_taken_back(bound, loop):
    state = bound.state
    _, opener, guesser, place = parts(deforming(bound))
    assert not place.visible
    opener.clicks += 1
    assert (place.visible, opener.label) == (True, SHOWN)
    loop.run_until(lambda: place.objects)
    (boxes,) = place.objects
    names = state.rig.skeleton.names
    assert [option.split(" — ")[0] for option in boxes.options] == list(names)

    before = state.binding
    boxes.value = boxes.value[:-1]
    loop.run_until(lambda: state.binding is not before)
    assert not state.rig.skeleton.deform[-1]
    assert not state.binding.weights[:, -1].any()
    np.testing.assert_allclose(state.binding.weights.sum(axis=1), 1)

    guesser.clicks += 1
    loop.run_until(lambda: state.rig.skeleton.deform.all())
    assert len(boxes.value) == len(names)
    opener.clicks += 1
    assert (place.visible, opener.label) == (False, HIDDEN)


def test_the_last_joint_stays(bound, loop):
    _, opener, _, place = parts(deforming(bound))
    opener.clicks += 1
    loop.run_until(lambda: place.objects)
    (boxes,) = place.objects
    before = bound.state.rig
    boxes.value = []
    assert "No joint is left" in bound.state.message[1]
    assert bound.state.rig is before
    assert len(boxes.value) == before.skeleton.deform.sum()
