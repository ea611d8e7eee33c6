"""Pictures and films of whole scenes: views, captions, legend, files that can be played."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from PIL.ImageSequence import Iterator

import cutcell_viewers.process
from cutcell import Clip
from cutcell.errors import Cancelled, FileError, MissingLibraryError
from cutcell_viewers.camera import Camera, around, framing, sees
from cutcell_viewers.character import pose_in_scene
from cutcell_viewers.encoders import find_ffmpeg
from cutcell_viewers.film import _camera, draw
from cutcell_viewers.order import FRAMES, Order
from cutcell_viewers.palette import DARK, LIGHT
from cutcell_viewers.process import draw_isolated
from cutcell_viewers.studio import Studio
from cutcell_viewers.weights_scene import weights_scene

pytestmark = pytest.mark.slow

SIZE = (160, 120)
FFMPEG = """#!/bin/sh
for out; do :; done
exec /bin/cat >"${out#file:}"
"""
"""A program that stands for ffmpeg: it copies what it is given."""


@pytest.fixture(scope="module")
def scene(rig):
    return weights_scene(rig, rig.weights, 1)


@pytest.fixture(scope="module")
def motion(rig):
    clip = rig.clips[0]
    return Clip(clip.name, 0.3 * clip.times, pose_in_scene(rig, clip.transforms))


def picture(scene, **options):
    with Studio(scene, options.pop("theme", LIGHT), options.pop("size", SIZE), **options) as studio:
        return studio.draw(studio.camera()).astype(int)


def apart(one, other):
    return float((np.abs(one - other).max(axis=2) > 8).mean())


def test_the_legend_stands_in_the_lower_left_corner(scene):
    plain, written = (picture(scene, size=(640, 480), legend=legend) for legend in (False, True))
    differs = np.abs(plain - written).max(axis=2) > 0
    assert differs[320:, :240].mean() > 0.2
    assert not differs[:320].any()
    assert not differs[:, 240:].any()


def test_each_view_shows_its_own_actors_and_all_show_the_shared_ones(scene):
    body = scene.actors["body"]
    two = replace(scene, views=("One", "Two"), legend=None)
    own = replace(two, actors={**scene.actors, "body": replace(body, view=0)})
    both, left = picture(two, size=(320, 120)), picture(own, size=(320, 120))
    assert apart(both[:, :160], left[:, :160]) == 0
    assert apart(both[:, 160:], left[:, 160:]) > 0.05
    # What follows the captions is the same on both sides.
    assert apart(both[40:, 1:160], both[40:, 161:]) < 0.01


def test_a_name_that_is_too_long_is_shortened(scene):
    title = "a very long name of a bone that no picture has room for " * 4
    long = replace(scene, legend=replace(scene.legend, title=title), views=(title, title))
    assert picture(long, theme=DARK).shape == (120, 160, 3)


def test_a_turntable_goes_around_once_and_shows_other_sides(scene, tmp_path):
    path = tmp_path / "turn.gif"
    draw(Order(scene, size=(80, 60), turntable=True), path)
    with Image.open(path) as film:
        count = film.n_frames
        assert count > 60
        assert film.info["duration"] == 1000 // FRAMES[".gif"]
        film.seek(0)
        first = np.asarray(film.convert("RGB")).astype(int)
        film.seek(count // 4)
        quarter = np.asarray(film.convert("RGB")).astype(int)
        film.seek(count - 1)
        last = np.asarray(film.convert("RGB")).astype(int)
    assert apart(first, quarter) > 0.02
    assert apart(first, last) < apart(first, quarter)


def test_a_film_of_scenes_shows_each_and_its_legend_stays(scene, tmp_path):
    """The legend is in the corner that the whole scene leaves free, on all frames."""
    empty = replace(scene, actors={})
    camera = Camera((1.2, 1.0, 7.0), (1.2, 1.0, 0.0))  # the body is at the lower left
    draw(Order(scene, size=SIZE, camera=camera, scenes=(empty, scene)), tmp_path / "a.gif")
    with Image.open(tmp_path / "a.gif") as film:
        assert film.n_frames == 2
        first, last = (np.asarray(one.convert("RGB")).astype(int) for one in Iterator(film))
    with Studio(scene, size=SIZE) as studio:
        whole = studio.draw(camera).astype(int)
        studio.show(empty)
        alone = studio.draw(camera).astype(int)
    assert apart(last, whole) < 0.02
    assert apart(first, last) > 0.02
    lower_left = np.s_[90:, :60]
    assert np.ptp(alone[lower_left], axis=(0, 1)).max() > 100
    assert np.ptp(first[lower_left], axis=(0, 1)).max() < 20


def test_a_motion_can_be_played_as_mp4(scene, motion, tmp_path):
    path = tmp_path / "motion.mp4"
    reports = []
    draw(Order(scene, size=(81, 61), motion=motion), path, lambda *now: reports.append(now))
    command = [find_ffmpeg(), "-v", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    film = subprocess.run(command, check=True, capture_output=True).stdout
    frames = np.frombuffer(film, np.uint8).reshape(-1, 60, 80, 3).astype(int)
    assert len(frames) == round(0.3 * FRAMES[".mp4"])
    assert apart(frames[0], frames[-1]) > 0.01
    fractions = [fraction for _, fraction in reports]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0


def test_going_around_keeps_height_and_distance():
    camera = Camera((1.0, 2.0, 3.0), (0.0, 1.0, 1.0))
    other = around(camera, np.pi)
    np.testing.assert_allclose(other.position, (-1.0, 2.0, -1.0), atol=1e-12)
    assert other.focal_point == camera.focal_point


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("a.bmp", {}, "bmp"),
        ("a.mp4", {}, "turntable"),
        ("a.png", {"turntable": True}, r"\.mp4 or \.gif"),
        ("missing/a.png", {}, "no folder"),
    ],
)
def test_what_cannot_be_stored_is_told_before_it_is_drawn(scene, tmp_path, name, options, words):
    order = Order(scene, size=SIZE, **options)
    for act in (draw, draw_isolated):
        with pytest.raises(FileError, match=words):
            act(order, tmp_path / name)


@pytest.fixture
def without_films(monkeypatch):
    """Leave out the extra `films`, and what is on the PATH."""
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    monkeypatch.setenv("PATH", "")


def test_without_ffmpeg_mp4_says_how_to_install_it(scene, motion, tmp_path, without_films):
    order = Order(scene, size=(64, 48), motion=motion)
    for act in (draw, draw_isolated):
        with pytest.raises(MissingLibraryError, match="pip install"):
            act(order, tmp_path / "a.mp4")
    draw(order, tmp_path / "a.gif")


def test_the_ffmpeg_on_the_path_will_do(scene, motion, tmp_path, monkeypatch, without_films):
    (tmp_path / "bin").mkdir()
    ffmpeg = tmp_path / "bin" / "ffmpeg"
    ffmpeg.write_text(FFMPEG)
    ffmpeg.chmod(0o755)
    monkeypatch.setenv("PATH", str(ffmpeg.parent))
    draw(Order(scene, size=(64, 48), motion=motion), tmp_path / "a.mp4")
    assert (tmp_path / "a.mp4").stat().st_size == round(0.3 * FRAMES[".mp4"]) * 64 * 48 * 3


def test_what_ffmpeg_complains_of_is_told(scene, motion, tmp_path, monkeypatch):
    monkeypatch.setattr("cutcell_viewers.encoders.ENCODING", ["-c:v", "none"])
    with pytest.raises(FileError, match="encoder 'none'"):
        draw(Order(scene, size=(64, 48), motion=motion), tmp_path / "a.mp4")
    assert not list(tmp_path.iterdir())


def test_drawing_apart_draws_the_same_and_tells_how_far_it_is(scene, tmp_path):
    here, there = tmp_path / "here.png", tmp_path / "there.png"
    reports = []
    draw(Order(scene, size=SIZE), here)
    draw_isolated(Order(scene, size=SIZE), there, lambda *now: reports.append(now))
    with Image.open(here) as one, Image.open(there) as other:
        np.testing.assert_array_equal(np.asarray(one), np.asarray(other))
    assert reports[-1] == ("drawing", 1.0)


def test_a_film_that_is_no_longer_wanted_is_stopped_at_once(scene, tmp_path, monkeypatch):
    started = []
    begin = subprocess.Popen

    def remembered(*arguments, **options):
        started.append(begin(*arguments, **options))
        return started[-1]

    def cancel(stage, fraction):
        if fraction > 0:
            raise Cancelled

    monkeypatch.setattr(cutcell_viewers.process.subprocess, "Popen", remembered)
    path = tmp_path / "turn.gif"
    with pytest.raises(Cancelled):
        draw_isolated(Order(scene, size=SIZE, turntable=True), path, cancel)
    assert started[0].poll() is not None
    assert not path.exists()
    monkeypatch.undo()


def test_a_process_that_dies_without_reason_is_told(scene, tmp_path, monkeypatch):
    monkeypatch.setattr("cutcell_viewers.process.sys.executable", "false")
    monkeypatch.setattr("cutcell_viewers.process._can_draw", lambda: True)
    with pytest.raises(RuntimeError, match="exit code 1"):
        draw_isolated(Order(scene, size=SIZE), tmp_path / "a.png")


def test_a_film_has_room_for_all_of_its_motion(scene, motion, tmp_path):
    """A body that leaps by twice its height is seen at the top of its leap, and none is cut."""
    leap = np.tile(np.eye(4), (2, motion.joints, 1, 1))
    leap[1, :, 1, 3] = 2 * np.ptp(scene.bounds[:, 1])
    seen = []
    path = tmp_path / "leap.gif"
    draw(Order(scene, size=SIZE, motion=Clip("leap", [0.0, 0.5], leap), legend=False), path)
    with Image.open(path) as film:
        for at in range(film.n_frames):
            film.seek(at)
            pixels = np.asarray(film.convert("RGB")).astype(int)
            inked = (np.ptp(pixels, axis=2) > 40).any(axis=1)
            assert not inked[[0, -1]].any()
            seen.append(np.flatnonzero(inked).mean())
    assert min(seen) < SIZE[1] / 2 < max(seen)


def test_a_camera_steps_back_for_a_motion_if_it_saw_the_whole_character(scene, motion):
    leap = np.tile(np.eye(4), (2, motion.joints, 1, 1))
    leap[1, :, 1, 3] = 2 * np.ptp(scene.bounds[:, 1])
    whole = framing(scene.bounds, direction=(1.0, 0.2, 0.4))
    position, target = np.array(whole.position), np.array(whole.focal_point)
    close = Camera(tuple((target + 0.2 * (position - target)).tolist()), whole.focal_point)
    with Studio(scene, size=(120, 120)) as studio:
        far = _camera(Order(scene, camera=whole, motion=Clip("leap", [0, 1], leap)), studio)
        assert sees(far, np.concatenate([scene.bounds, scene.bounds + leap[1, 0, :3, 3]]))
        way = np.array(far.position) - np.array(far.focal_point)
        assert np.dot(way, position - target) == pytest.approx(
            np.linalg.norm(way) * np.linalg.norm(position - target)
        )
        assert np.linalg.norm(way) > np.linalg.norm(position - target)
        for camera, poses in ((close, leap), (whole, leap[:1])):
            moving = Order(scene, camera=camera, motion=Clip("leap", range(len(poses)), poses))
            assert _camera(moving, studio) is camera


def test_a_picture_of_a_pose_sees_the_pose(scene, motion):
    away = np.tile(np.eye(4), (motion.joints, 1, 1))
    away[:, 0, 3] = 5 * np.ptp(scene.bounds[:, 0])
    posed = replace(scene, pose=away)
    with Studio(posed, size=(120, 120)) as studio:
        assert sees(_camera(Order(posed), studio), scene.bounds + away[0, :3, 3])
        assert not sees(_camera(Order(scene), studio), scene.bounds + away[0, :3, 3])
