"""Films of a scene: a turn around it, a motion or a sweep; as MP4, GIF, or a single picture."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageColor

from cutcell.errors import FileError, ParameterError
from cutcell.pose import pose_at
from cutcell.rig.clip import Clip
from cutcell.runtime.progress import Progress, silent
from cutcell.runtime.writing import check_place, write_all

from .camera import PAGE_HEIGHT, Camera, around, sees
from .description import Description
from .encoders import find_ffmpeg, write_gif, write_mp4
from .palette import THEMES, Theme

if TYPE_CHECKING:
    from .studio import Studio

PICTURES = (".png", ".jpg", ".jpeg")
FILMS = (".mp4", ".gif")
FIGURES = (".pdf", ".svg", ".png")
"""Formats of figures: of several panels, or of one with its text as text."""
MAX_PANELS = 6
TURN_SECONDS = 6.0
LONGEST = 20.0
"""Longest film of a motion, in seconds."""
PROBED = 24
"""Largest number of poses that are sampled to frame a motion."""
FRAMES = {".mp4": 30, ".gif": 20}
"""Frames a second of each kind of film."""


@dataclass(frozen=True, eq=False)
class Order:
    """A request for a picture, or for a film where it turns or moves.

    Parameters
    ----------
    description : Description
    theme : {"light", "dark"}
    size : (int, int)
        Width and height in pixels.
    camera : Camera, optional
        If it sees the whole character, it steps back to see the whole motion.
    direction : tuple of float, optional
        Direction of the view, where no camera is given.
    turntable : bool
        Whether the camera circles the character once.
    motion : Clip, optional
        In the scene's space; see `pose_scene.clip_in_scene`.
    legend : bool
    page_height : float
        Height of a page's canvas that looks the same, in its pixels: widths of lines follow.
    background : str
        A colour of CSS instead of the theme's background; or "transparent", in PNG.
    scenes : tuple of Description
        The frames of a film, instead of a motion. The camera and the legend's place are those of
        `description`.
    panels : tuple of Description
        A figure of these instead, each a picture of `size`; each view is a panel.
    captions : tuple of str
        Of all panels; by default the titles of legends that differ.
    """

    description: Description
    theme: str = "light"
    size: tuple[int, int] = (1600, 1200)
    camera: Camera | None = None
    direction: tuple[float, float, float] | None = None
    turntable: bool = False
    motion: Clip | None = None
    legend: bool = True
    page_height: float = PAGE_HEIGHT
    background: str = ""
    scenes: tuple[Description, ...] = ()
    panels: tuple[Description, ...] = ()
    captions: tuple[str, ...] = ()

    def check(self, path: Path) -> str:
        """Return the ending of the file's name; see `check_picture_file`."""
        moves = self.turntable or self.motion is not None or bool(self.scenes)
        return check_picture_file(path, moves, len(self.panels))


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
        from .figures import draw_figure

        draw_figure(order, path, progress)
        progress("drawing", 1.0)
        return
    # A film's frames have even sides: MP4 stores colours for two by two pixels at once.
    width, height = (side - side % 2 for side in order.size) if kind in FILMS else order.size
    from .studio import Studio  # a server orders pictures, and loads no VTK for that

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


def ground(name: str, background: str, kind: str = ".png") -> tuple[Theme, bool]:
    """Return a theme with a background of one colour, and whether there is none.

    Raises
    ------
    ParameterError
        The colour cannot be read, or a file of that kind cannot be transparent.
    """
    theme, clear = THEMES[name], background == "transparent"
    if clear and kind != ".png":
        raise ParameterError(f"only PNG pictures can be transparent, not {kind}")
    if not background or clear:
        return theme, clear
    try:
        red, green, blue, *_ = ImageColor.getrgb(background)
    except ValueError:
        raise ParameterError(
            f'background must be a colour, such as white or #f4f4f4, not "{background}"'
        ) from None
    plain = (red / 255, green / 255, blue / 255)
    return replace(theme, top=plain, bottom=plain), False


def check_picture_file(path: Path, moves: bool = False, panels: int = 0) -> str:
    """Return the ending of the name of a picture, film or figure, in small letters.

    Raises
    ------
    FileError
        An ending that cannot be drawn or does not fit, or a missing folder.
    ParameterError
        A figure has too many panels, or moves.
    MissingLibraryError
        MP4 without ffmpeg.
    """
    kind = path.suffix.lower()
    if panels > MAX_PANELS:
        raise ParameterError(f"a figure has at most {MAX_PANELS} panels, not {panels}")
    if panels and moves:
        raise ParameterError("a figure of panels does not move: leave out what makes a film")
    fitting = FILMS if moves else FIGURES if panels else (*PICTURES, *FIGURES[:2])
    if kind not in fitting:
        what = "films" if moves else "figures of panels" if panels else "pictures"
        wrong = f", not as {kind}" if kind else ""
        advice = "; ask for a turntable, a clip or a sweep" if kind in FILMS and not panels else ""
        raise FileError(f"{path.name}: {what} are saved as {' or '.join(fitting)}{wrong}{advice}")
    if kind == ".mp4":
        find_ffmpeg()
    check_place(path)
    return kind


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
    if not sees(camera, _points(order.description, [pose]), studio.shape):
        return camera
    if sees(camera, _points(order.description, _poses(order)), studio.shape):
        return camera
    way = np.array(camera.position) - np.array(camera.focal_point)
    return studio.camera(tuple(way.tolist()), box_of(order.description, _poses(order)))


def _poses(order: Order) -> list[Any]:
    """Return the poses of an order, or some of them; None for rest."""
    if order.motion is None:
        return [order.description.pose]
    probed = min(len(order.motion.times), PROBED)
    return list(order.motion.sample(np.linspace(0, order.motion.duration, probed)))


def _points(description: Description, poses: list[Any]) -> NDArray[np.float64]:
    """Return the points of all actors but overlays in some poses, shape (n, 3)."""
    whole = [actor for actor in description.actors.values() if not actor.overlay]
    points = [a.points_in(pose, description.blending) for a in whole for pose in poses]
    return np.concatenate([np.empty((0, 3)), *points])


def box_of(description: Description, poses: list[Any]) -> NDArray[np.float64]:
    """Return the lowest and highest corner of some poses, shape (2, 3)."""
    points = _points(description, poses)
    if not len(points):
        return description.bounds
    return np.stack([points.min(axis=0), points.max(axis=0)])


def _length(order: Order) -> float:
    if order.motion is None:
        return TURN_SECONDS
    duration = order.motion.duration
    if order.turntable:
        # Whole rounds of the motion, so that the film closes.
        return duration * max(round(TURN_SECONDS / duration), 1) if duration else TURN_SECONDS
    return min(max(duration, 0.1), LONGEST)


def _write_picture(path: Path, pixels: NDArray[np.uint8]) -> None:
    # In memory first: on a full disk Pillow leaves half a JPEG, and raises nothing.
    written = BytesIO()
    kind = Image.registered_extensions()[path.suffix.lower()]
    Image.fromarray(pixels).save(written, format=kind, quality=92)
    write_all({path: written.getvalue()})
