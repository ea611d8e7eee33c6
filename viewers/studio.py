"""Whole pictures: every view of a description, its captions and its legend."""

from __future__ import annotations

from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from .camera import Camera, framing
from .description import Description, in_view
from .lettering import write_captions, write_legend
from .palette import LIGHT, Theme
from .scene import Scene
from .tiles import Tile, shape_of, tiles


class Studio:
    """Draws one description after another, under any camera; frees its windows at the end.

    Parameters
    ----------
    description : Description
        The first; those after it have as many views.
    theme : Theme
    size : (int, int)
        Width and height of the pictures, in pixels.
    legend : bool
        Whether the legend is written on them.

    Examples
    --------
    >>> with Studio(description, size=(800, 600)) as studio:  # doctest: +SKIP
    ...     pixels = studio.draw(studio.camera())
    """

    def __init__(
        self,
        description: Description,
        theme: Theme = LIGHT,
        size: tuple[int, int] = (1600, 1200),
        legend: bool = True,
    ) -> None:
        self.theme, self.size, self.legend = theme, size, legend
        self._tiles = tiles(max(len(description.views), 1), size, shape_of(description.bounds))
        self._scenes = [Scene(theme, (width, height)) for _, _, width, height in self._tiles]
        self.show(description)

    def show(self, description: Description) -> None:
        """Make every view what a description says."""
        self._drawn = description
        for view, scene in enumerate(self._scenes):
            scene.show(in_view(description, view))

    def camera(
        self,
        direction: tuple[float, float, float] | None = None,
        bounds: NDArray[np.float64] | None = None,
    ) -> Camera:
        """Return a camera that sees all of each view, or of given bounds; see `framing`."""
        bounds = self._drawn.bounds if bounds is None else bounds
        return framing(bounds, self.shape, direction)

    def draw(self, camera: Camera) -> NDArray[np.uint8]:
        """Draw all.

        Parameters
        ----------
        camera : Camera

        Returns
        -------
        array, shape (height, width, 3), uint8
        """
        picture = np.empty((self.size[1], self.size[0], 3), np.uint8)
        for scene, (left, top, width, height) in zip(self._scenes, self._tiles, strict=True):
            scene.set_camera(camera)
            picture[top : top + height, left : left + width] = scene.render_png()
        if self._drawn.views:
            picture = write_captions(picture, self._drawn.views, self._tiles, self.theme)
        if self.legend and self._drawn.legend is not None:
            picture = write_legend(picture, self._drawn.legend, self.theme)
        return picture

    @property
    def shape(self) -> float:
        """Width over height of each view; of the narrowest where they differ."""
        return min(width / height for _, _, width, height in self._tiles)

    @property
    def places(self) -> list[Tile]:
        """The rectangle of each view in the picture."""
        return self._tiles

    def close(self) -> None:
        """Free the windows."""
        for scene in self._scenes:
            scene.close()

    def __enter__(self) -> Studio:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
