"""Orders of pictures, films and figures. A server makes them, and loads no VTK for that."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from PIL import ImageColor

from cutcell.errors import FileError, ParameterError
from cutcell.rig.clip import Clip
from cutcell.runtime.writing import check_place

from .camera import PAGE_HEIGHT, Camera
from .description import Description
from .encoders import find_ffmpeg
from .palette import THEMES, Theme
from .tiles import Tile

PICTURES = (".png", ".jpg", ".jpeg")
FILMS = (".mp4", ".gif")
FIGURES = (".pdf", ".svg", ".png")
"""Formats of figures: of several panels, or of one with its text as text."""
MAX_PANELS = 6
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
    tiles : tuple of Tile
        The rectangle of each view, as on a page's canvas; by default views share the picture.
    fine : bool
        Whether corners are darkened by ambient occlusion and edges are smooth.
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
    tiles: tuple[Tile, ...] = ()
    fine: bool = False

    def check(self, path: Path) -> str:
        """Return the ending of the file's name; see `check_picture_file`."""
        moves = self.turntable or self.motion is not None or bool(self.scenes)
        return check_picture_file(path, moves, len(self.panels))


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
