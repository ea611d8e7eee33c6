"""Clips: sampled at any time, from frames or from whatever else knows where joints are."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cutcell import Clip, ParameterError
from cutcell.pose import pose_at


def slides(*way):
    """Return transforms of one joint that slides along x."""
    transforms = np.tile(np.eye(4), (len(way), 1, 1, 1))
    transforms[:, 0, 0, 3] = way
    return transforms


RAMP = Clip("ramp", [0, 1, 2], slides(0, 10, 40))


class Spin:
    """A motion that is not made of frames."""

    joints, duration = 3, 2.0
    times = np.linspace(0, 2.0, 5)

    def sample(self, seconds):
        result = np.tile(np.eye(4), (len(seconds), 3, 1, 1))
        result[:, :, 0, 3] = seconds[:, None]
        return result


@pytest.mark.parametrize(
    ("seconds", "x"), [(-1, 0), (0, 0), (0.5, 5), (1, 10), (1.5, 25), (2, 40), (7, 40)]
)
def test_before_and_after_its_time_a_clip_stands_still(seconds, x):
    result = RAMP.sample(seconds)
    assert result.shape == (1, 4, 4)
    assert result[0, 0, 3] == pytest.approx(x)


def test_many_times_are_sampled_at_once():
    result = RAMP.sample([0.5, 1.5])
    assert_array_equal(result, [RAMP.sample(0.5), RAMP.sample(1.5)])
    assert RAMP.sample([]).shape == (0, 1, 4, 4)


def test_the_end_is_a_moment_of_its_own_even_after_a_jump():
    jump = Clip("jump", [0, 1, 1], slides(0, 10, 40))
    assert jump.sample(1)[0, 0, 3] == pose_at(jump, 1)[0, 0, 3] == 40
    assert pose_at(jump, 0.5)[0, 0, 3] == 5
    assert pose_at(RAMP, 2)[0, 0, 3] == 40
    assert pose_at(RAMP, 2.5)[0, 0, 3] == 5


def test_a_motion_need_not_be_frames():
    clip = Clip("spin", motion=Spin())
    assert (clip.joints, clip.duration) == (3, 2)
    assert_array_equal(clip.times, [0, 0.5, 1, 1.5, 2])
    assert clip.transforms.shape == (5, 3, 4, 4)
    assert pose_at(clip, 2.25)[2, 0, 3] == 0.25


def test_a_clip_can_be_renamed_and_packed_and_not_changed():
    other = replace(RAMP, name="other")
    assert other.motion is RAMP.motion
    again = pickle.loads(pickle.dumps(RAMP))
    assert_allclose(again.transforms, RAMP.transforms)
    with pytest.raises(ValueError, match="read-only"):
        RAMP.transforms[0] = 0
    with pytest.raises(AttributeError):
        RAMP.name = "other"


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Clip("a"), "needs times and transforms, or else a motion"),
        (lambda: Clip("a", [0]), "needs times and transforms, or else a motion"),
        (lambda: Clip("a", [0], slides(0), motion=Spin()), "or else a motion"),
        (lambda: Clip("a", [0, 1], slides(0)), r"transforms have the shape \(1, 1, 4, 4\), but ti"),
        (lambda: Clip("a", 0, slides(0)), r"but times, \(\), need"),
        (lambda: Clip("a", [0], np.eye(4)), r"transforms have the shape \(4, 4\)"),
        (lambda: Clip("a", [], slides()).sample(0), "a clip without frames cannot be played"),
        (lambda: RAMP.sample(np.nan), "seconds must be finite"),
        (lambda: RAMP.sample([0, np.inf]), "seconds must be finite"),
    ],
)
def test_what_is_no_motion_is_told(make, message):
    with pytest.raises(ParameterError, match=message):
        make()
