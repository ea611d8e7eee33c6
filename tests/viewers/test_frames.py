"""One process draws the frames of a server's pages."""

import io
import threading

import numpy as np
import pytest
from PIL import Image

from cutcell_viewers import process as drawing_process
from cutcell_viewers.camera import Camera, framing
from cutcell_viewers.description import Actor, Description
from cutcell_viewers.order import Order
from cutcell_viewers.process import DrawingProcess

SIZE = (200, 120)


@pytest.fixture(scope="module")
def drawing():
    process = DrawingProcess()
    yield process
    process.close()


def plate(color, view=None):
    points = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
    cells = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    return Actor("surface", points, cells, color=color, view=view)


def pixels(process, scene, camera=None, **options):
    camera = camera or Camera((0.0, 0.0, 8.0), (0.0, 0.0, 0.0))
    canvas = {"size": SIZE, "tiles": ((0, 0, *SIZE),), "page_height": SIZE[1], "fine": True}
    picture = process.draw(Order(scene, camera=camera, **{**canvas, **options}))
    return np.asarray(Image.open(io.BytesIO(picture))).astype(int)


@pytest.mark.parametrize("fine", [True, False])
def test_a_frame_shows_the_scene_on_a_transparent_ground(drawing, fine):
    drawn = pixels(drawing, Description({"plate": plate((1.0, 0.0, 0.0))}), fine=fine)
    assert drawn.shape == (120, 200, 4)
    red, green, blue, alpha = drawn[60, 100]
    assert red > 150 > 60 > max(green, blue)
    assert alpha == 255
    assert drawn[5, 5, 3] == 0


def test_the_camera_sees_its_target_where_it_says(drawing):
    scene = Description({"plate": plate((1.0, 0.0, 0.0))})
    aside = Camera((0.0, 0.0, 8.0), (0.0, 0.0, 0.0), centre=(0.5, 0.0))
    column = pixels(drawing, scene, aside)[60, :, 3]
    assert np.flatnonzero(column).mean() == pytest.approx(150, abs=1)


def test_each_view_has_its_own_tile(drawing):
    actors = {"a": plate((1.0, 0.0, 0.0), 0), "b": plate((0.0, 0.0, 1.0), 1)}
    scene = Description(actors)
    drawn = pixels(drawing, scene, tiles=((0, 0, 100, 120), (100, 0, 100, 120)))
    assert drawn[60, 50, 0] > 150 > drawn[60, 50, 2]
    assert drawn[60, 150, 2] > 150 > drawn[60, 150, 0]


def test_many_may_ask_at_once(drawing):
    scenes = [Description({"plate": plate((k / 3, 0.0, 1 - k / 3))}) for k in range(4)]
    drawn = {}
    threads = [
        threading.Thread(target=lambda k=k: drawn.update({k: pixels(drawing, scenes[k])}))
        for k in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    reds = [drawn[k][60, 100, 0] for k in range(4)]
    assert reds == sorted(reds)
    assert reds[0] < reds[3]


def test_the_process_ends_when_idle_and_starts_again(monkeypatch):
    monkeypatch.setattr(drawing_process, "IDLE_SECONDS", 0.01)
    process = DrawingProcess()
    scene = Description({"plate": plate((1.0, 0.0, 0.0))})
    first = pixels(process, scene, framing(scene.bounds))
    timer = process._timer
    assert timer is not None
    timer.join()
    assert process._process is None
    np.testing.assert_array_equal(pixels(process, scene, framing(scene.bounds)), first)
    process.close()


def test_after_a_sudden_end_the_next_frame_is_drawn(drawing):
    scene = Description({"plate": plate((1.0, 0.0, 0.0))})
    pixels(drawing, scene)
    drawing._process.kill()
    drawing._process.wait()
    with pytest.raises(RuntimeError):
        pixels(drawing, scene)
    assert pixels(drawing, scene)[60, 100, 3] == 255
