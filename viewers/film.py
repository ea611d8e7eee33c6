"""Films of a scene: a turn around it, a motion or a sweep; as MP4, GIF, or a single picture."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from cutcell.pose import pose_at
from cutcell.runtime.progress import Progress, silent
from cutcell.runtime.writing import write_all

from .camera import Camera, around, sees
from .encoders import write_gif, write_mp4
from .figures import draw_figure
from .order import FILMS, FRAMES, PICTURES, Order, ground
from .studio import Studio, box_of, points_of

TURN_SECONDS = 6.0
MAX_SECONDS = 20.0
"""Longest film of a motion, in seconds."""
MAX_POSES = 24
"""Largest number of poses that are sampled to frame a motion."""


def draw(order: Order, path: str | Path, progress: Progress = silent) -> None:
    """Draw an order into a file.

    Parameters
    ----------
    order : Order
    path : str or Path
        Its ending selects the format: .png or .jpg, or .mp4 or .gif for a film, or .pdf, .svg
        or .png for a figure.
    progress : callable
        See `cutcell.runtime.progress`; may raise to stop.

    Raises
    ------
    FileError
        Another ending, a film without motion, a missing folder, or a file that cannot be written.
    MissingLibraryError
        MP4 without ffmpeg.
    """
    path = Path(path)
    kind = order.check(path)
    progress("drawing", 0.0)
    if order.panels or kind not in (*PICTURES, *FILMS):
        draw_figure(order, path, progress)
        progress("drawing", 1.0)
        return
    # A film's frames have even sides: MP4 stores colours for two by two pixels at once.
    width, height = (side - side % 2 for side in order.size) if kind in FILMS else order.size
    theme, clear = ground(order.theme, order.background, kind)
    look = order.legend, order.page_height, clear
    with Studio(order.description, theme, (width, height), *look) as studio:
        camera = _camera(order, studio)
        if kind in PICTURES:
            _write_picture(path, studio.draw(camera))
        else:
            write = write_mp4 if kind == ".mp4" else write_gif
            write(path, _frames(order, studio, camera, FRAMES[kind], progress), FRAMES[kind])
    progress("drawing", 1.0)


def _frames(
    order: Order, studio: Studio, camera: Camera, fps: int, progress: Progress
) -> Iterator[NDArray[np.uint8]]:
    count = len(order.scenes) or max(round(_length(order) * fps), 2)
    if order.scenes:
        studio.is_steady = True
        studio.draw(camera)
    for k in range(count):
        progress("drawing", k / count)
        if order.motion is not None:
            pose = pose_at(order.motion, k / fps)
            studio.show(replace(order.description, pose=pose))
        elif order.scenes:
            studio.show(order.scenes[k])
        angle = 2 * np.pi * k / count if order.turntable else 0.0
        yield studio.draw(around(camera, angle))


def _camera(order: Order, studio: Studio) -> Camera:
    """Return the first camera of an order."""
    camera, pose = order.camera, order.description.pose
    if camera is None:
        return studio.camera(order.direction, box_of(order.description, _poses(order)))
    if order.motion is None:
        return camera
    # A close view of a part of the character stays on that part.
    if not sees(camera, points_of(order.description, [pose]), studio.shape):
        return camera
    if sees(camera, points_of(order.description, _poses(order)), studio.shape):
        return camera
    direction = np.array(camera.position) - np.array(camera.focal_point)
    return studio.camera(tuple(direction.tolist()), box_of(order.description, _poses(order)))


def _poses(order: Order) -> list[Any]:
    """Return the poses of an order, or some of them; None for rest."""
    if order.motion is None:
        return [order.description.pose]
    probed = min(len(order.motion.times), MAX_POSES)
    return list(order.motion.sample(np.linspace(0, order.motion.duration, probed)))


def _length(order: Order) -> float:
    if order.motion is None:
        return TURN_SECONDS
    duration = order.motion.duration
    if order.turntable:
        # Whole rounds of the motion, so that the film closes.
        return duration * max(round(TURN_SECONDS / duration), 1) if duration else TURN_SECONDS
    return min(max(duration, 0.1), MAX_SECONDS)


def _write_picture(path: Path, pixels: NDArray[np.uint8]) -> None:
    # In memory first: on a full disk Pillow leaves half a JPEG, and raises nothing.
    written = BytesIO()
    kind = Image.registered_extensions()[path.suffix.lower()]
    Image.fromarray(pixels).save(written, format=kind, quality=92)
    write_all({path: written.getvalue()})
