"""Whole pictures: every view of a description, its captions and its legend."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .camera import PAGE_HEIGHT, Camera, framing
from .description import Description, in_view
from .lettering import free_corner, legend_card, put_card, write_captions
from .palette import LIGHT, Theme, to_bytes
from .scene import Scene
from .tiles import Tile, shape_of, tiles

SAME = 4
"""Largest difference, of 255, from the background of a pixel that shows nothing."""


class Studio(AbstractContextManager["Studio"]):
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
    page_height : float
        Height of a page's canvas that looks the same, in its pixels.
    transparent : bool
        Whether pictures have a fourth channel instead of a background.
    tiles : tuple of Tile, optional
        The rectangle of each view.
    fine : bool
        See `Scene`.

    Attributes
    ----------
    is_steady : bool
        Whether the legend keeps its place on the next picture.
    """

    def __init__(
        self,
        description: Description,
        theme: Theme = LIGHT,
        size: tuple[int, int] = (1600, 1200),
        legend: bool = True,
        page_height: float = PAGE_HEIGHT,
        transparent: bool = False,
        tiles: tuple[Tile, ...] = (),
        fine: bool = False,
    ) -> None:
        self.theme, self.size, self.legend = theme, size, legend
        self.is_steady = False
        self._transparent, self._ratio = transparent, size[1] / page_height
        self._given_tiles, self._fine = tiles, fine
        self._scenes: list[Scene] = []
        self._description = description
        self._legend_place: tuple[int, int] | None = None
        self._divide(size)

    def _divide(self, size: tuple[int, int]) -> None:
        """Divide the upper part of the picture among the views."""
        for scene in self._scenes:
            scene.close()
        count, shape = max(len(self._description.views), 1), shape_of(self._description.bounds)
        self._tiles = list(self._given_tiles) or tiles(count, size, shape)
        self._scenes = [
            Scene(self.theme, tile[2:], self._fine, self._ratio) for tile in self._tiles
        ]
        self.show(self._description)

    def show(self, description: Description) -> None:
        """Show a description in all views."""
        self._description = description
        for view, scene in enumerate(self._scenes):
            scene.show(in_view(description, view))

    def camera(
        self,
        direction: tuple[float, float, float] | None = None,
        bounds: NDArray[np.float64] | None = None,
    ) -> Camera:
        """Return a camera that sees all of each view, or of given bounds; see `framing`."""
        bounds = self._description.bounds if bounds is None else bounds
        return framing(bounds, self.shape, direction)

    def draw(self, camera: Camera) -> NDArray[np.uint8]:
        """Draw a picture, shape (height, width, 3 or 4), uint8."""
        picture, covered = self._draw_views(camera)
        legend = self._description.legend if self.legend else None
        if legend is None:
            return picture
        card = legend_card(legend, self.theme, self.size)
        place = self._legend_place or free_corner(covered, card)
        if place is None:
            # No corner is free: the legend gets a strip below the figures.
            self._divide((self.size[0], max(self.size[1] - round(1.25 * card.height), 16)))
            picture, covered = self._draw_views(camera)
            place = free_corner(covered, card) or (0, self.size[1] - card.height)
        if self.is_steady:
            self._legend_place = place
        return put_card(picture, card, place)

    def _draw_views(self, camera: Camera) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
        """Return the picture without a legend, and a mask of the pixels that show something."""
        ground = (*to_bytes(self.theme.bottom), 0)[: 4 if self._transparent else 3]
        picture = np.full((self.size[1], self.size[0], len(ground)), ground, np.uint8)
        covered = np.zeros(picture.shape[:2], bool)
        for scene, (left, top, width, height) in zip(self._scenes, self._tiles, strict=True):
            scene.set_camera(camera)
            where = slice(top, top + height), slice(left, left + width)
            if self._transparent:
                part = scene.render_clear()
                covered[where] = part[:, :, 3] > 0
            else:
                part = scene.render_png()
                differences = np.abs(part - _ground(self.theme, height))
                covered[where] = differences.max(axis=2) > SAME
            picture[where] = part
        if self._description.views:
            plain = picture
            picture = write_captions(picture, self._description.views, self._tiles, self.theme)
            covered |= (picture != plain).any(axis=2)
        return picture, covered

    @property
    def shape(self) -> float:
        """Width over height of each view; of the narrowest where they differ."""
        return min(width / height for _, _, width, height in self._tiles)

    def close(self) -> None:
        """Free the windows."""
        for scene in self._scenes:
            scene.close()

    def __exit__(self, *error: object) -> None:
        self.close()


def _ground(theme: Theme, height: int) -> NDArray[np.float32]:
    """Return the colours of each row of an empty picture, shape (height, 1, 3)."""
    part = (np.arange(height, dtype=np.float32) + 0.5)[:, None, None] / height
    top, bottom = (255 * np.array(color, np.float32) for color in (theme.top, theme.bottom))
    return top + part * (bottom - top)


def points_of(description: Description, poses: list[Any]) -> NDArray[np.float64]:
    """Return the points of all actors but overlays in some poses, shape (n, 3)."""
    whole = [actor for actor in description.actors.values() if not actor.overlay]
    points = [a.points_in(pose, description.blending) for a in whole for pose in poses]
    return np.concatenate([np.empty((0, 3)), *points])


def box_of(description: Description, poses: list[Any]) -> NDArray[np.float64]:
    """Return the lowest and highest corner of some poses, shape (2, 3)."""
    points = points_of(description, poses)
    if not len(points):
        return description.bounds
    return np.stack([points.min(axis=0), points.max(axis=0)])
