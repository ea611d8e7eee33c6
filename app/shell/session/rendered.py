"""Rendered: the canvas as PyVista draws it on the server, once the view rests."""

from dataclasses import replace
from typing import Any

from cutcell.errors import CutcellError
from cutcell_viewers.camera import Camera
from cutcell_viewers.order import Order
from cutcell_viewers.process import DrawingProcess
from cutcell_viewers.tiles import Tile

from ...document.session import Session
from ...server.protocol.received import DrawFrame
from .export import Seen

PROCESS = DrawingProcess()
"""The one process of a server that draws frames; sessions take turns."""

MAX_SIDE = 4096
MAX_TILES = 16


def watch(session: Session) -> None:
    """Draw a frame when the browser asks for one."""
    session.view.listen(DrawFrame, lambda message: draw(session, message))


def draw(session: Session, message: DrawFrame) -> None:
    """Draw the scene as the browser shows it, and send the picture."""
    scene, options = Seen.now(session), _frame_options(message)

    def work(progress: Any) -> bytes | CutcellError:
        try:
            return PROCESS.draw(Order(replace(scene.posed(), views=()), **options))
        except CutcellError as error:
            return error

    def done(picture: bytes | CutcellError) -> None:
        if isinstance(picture, CutcellError):
            session.state.rendered = False
            session.fail(picture)
        else:
            session.view.answer(frame={"count": message.count, "picture": picture})

    session.work.newest("rendered", work, done)


def _frame_options(message: DrawFrame) -> dict[str, Any]:
    """Return the camera and the sizes of a frame, within the limits of the server."""
    width, height = message.size
    ratio = min(message.ratio, MAX_SIDE / max(width, height, 1.0))
    size = (max(round(ratio * width), 1), max(round(ratio * height), 1))
    tiles = [_tile_within(size, ratio, tile) for tile in message.tiles[:MAX_TILES]]
    across, above = message.centre
    camera = Camera(message.position, message.focal_point, centre=(across, above))
    return {
        "camera": camera,
        "size": size,
        "tiles": tuple(tiles),
        "page_height": max(height, 1.0),
        "fine": message.fine,
    }


def _tile_within(size: tuple[int, int], ratio: float, tile: list[float]) -> Tile:
    """Return a tile of the page (left, top, width, height) in pixels of a frame, and inside it."""
    left, top, width, height = (round(ratio * side) for side in tile)
    left, top = min(max(left, 0), size[0] - 1), min(max(top, 0), size[1] - 1)
    return left, top, min(max(width, 1), size[0] - left), min(max(height, 1), size[1] - top)
