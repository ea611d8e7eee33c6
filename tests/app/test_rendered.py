"""What a browser may ask of the process that draws the canvas."""

import pytest

from cutcell_app.document.look import pick_vertex
from cutcell_app.server.protocol.reading import read
from cutcell_app.shell.session.rendered import MAX_SIDE, MAX_TILES, _frame_options


def message(**changes):
    usual = {
        "type": "draw-frame", "count": 1,
        "size": [800, 600], "ratio": 1, "tiles": [[0, 0, 400, 600], [400, 0, 400, 600]],
        "centre": [0, 0], "position": [0, 0, 5], "focal_point": [0, 0, 0], "fine": True,
    }  # fmt: skip
    return read({**usual, **changes})


def test_tiles_are_scaled_with_the_frame():
    options = _frame_options(message(ratio=2))
    assert options["size"] == (1600, 1200)
    assert options["tiles"] == ((0, 0, 800, 1200), (800, 0, 800, 1200))


@pytest.mark.parametrize(
    "tile", [[0, 0, 60_000, 60_000], [-50, -50, 10, 10], [9e9, 9e9, 5, 5], [0, 0, -5, 0]]
)
def test_no_tile_is_larger_than_the_frame(tile):
    options = _frame_options(message(tiles=[tile] * 40, size=[1e5, 1e5]))
    assert max(options["size"]) <= MAX_SIDE
    assert len(options["tiles"]) <= MAX_TILES
    for left, top, width, height in options["tiles"]:
        assert 0 <= left < left + width <= options["size"][0]
        assert 0 <= top < top + height <= options["size"][1]


@pytest.mark.parametrize("place", [float("nan"), float("inf"), "x", None])
def test_what_is_no_number_is_refused(place):
    for changes in (
        {"tiles": [[0, 0, place, 1]]},
        {"size": [place, 1]},
        {"position": [0, 0, place]},
    ):
        with pytest.raises((ValueError, OverflowError, TypeError)):
            _frame_options(message(**changes))


@pytest.mark.parametrize("vertex", [-1, 10**9])
def test_a_vertex_that_the_mesh_does_not_have_is_not_chosen(bound, vertex):
    pick_vertex(bound, vertex)
    assert bound.state.vertex is None
