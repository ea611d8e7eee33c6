"""Colours of the faces of a rig, of any file format.

Images are handed over as they are stored; nothing is decoded here.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import CutcellError

REPEAT, CLAMP, MIRROR = 0, 1, 2
"""How an image goes on beyond its border."""
BLENDED = 9
"""Added to how an image goes on, where what is behind shines through by alpha."""
OPAQUE = 255
CUTOFF = 0.5
"""Default threshold of alpha at which a surface is cut."""


@dataclass(frozen=True)
class StoredImage:
    """An image as a file stores it: its label and its bytes."""

    name: str
    content: bytes


@dataclass(frozen=True)
class Layer:
    """A way in which an image is used."""

    image: int
    nearest: bool = False  # whether its pixels are to be seen as squares
    cutoff: float | None = None
    """Nothing is there where its alpha is less; None where alpha cuts nothing."""
    blended: bool = False  # whether what is behind shines through by its alpha
    color: tuple[int, ...] | None = None
    """Red, green and blue shown in place of an unreadable image; the tints when left out."""


@dataclass(frozen=True, eq=False)
class FaceColors:
    """Colours of the corners of faces."""

    corners: NDArray[np.float32]
    """(m, 3, 4): of each corner: its position in the image, from the upper left corner; the number
    of the layer, -1 for none; and how the image goes on, 3 across + down (see `REPEAT`), `BLENDED`
    added where alpha counts for what is behind."""
    tints: NDArray[np.uint8]
    """(m, 3, 3): what the image is multiplied by, or the colour where there is none; sRGB."""
    opacity: NDArray[np.uint8]
    """(m, 3): what the image's alpha is multiplied by; less than 255 only where `BLENDED` is
    added."""
    materials: NDArray[np.int32]
    """(m,): the number of each face's material among `Materials.names`, -1 for none."""

    def of(self, rows: slice) -> FaceColors:
        """Return those of some faces, as views."""
        return FaceColors(
            self.corners[rows], self.tints[rows], self.opacity[rows], self.materials[rows]
        )


@dataclass(frozen=True, eq=False)
class Materials:
    """The base colours of a rig."""

    body: FaceColors  # of the faces of `rig.mesh`
    attachments: tuple[FaceColors, ...]  # of those of each attachment
    layers: tuple[Layer, ...]
    images: tuple[StoredImage, ...]
    notes: tuple[str, ...] = ()  # what could not be read, in sentences
    names: tuple[str, ...] = ()  # of the materials; empty where one has no name


class Collected:
    """Images, their uses, names of materials and notes, as `Materials` lists them; each once."""

    def __init__(self, notes: Iterable[str] = ()) -> None:
        self.layers: dict[Layer, int] = {}
        self.images: list[StoredImage] = []
        self.names: list[str] = []
        self.notes = dict.fromkeys(notes)
        self._materials: dict[Hashable, int] = {}
        self._images: dict[int, int] = {}

    def material(self, key: Hashable, name: str) -> int:
        """Return the number of a material; `key` is the file's own."""
        if key not in self._materials:
            self._materials[key] = len(self.names)
            self.names.append(name)
        return self._materials[key]

    def layer(self, use: Layer, stored: Callable[[], StoredImage]) -> int:
        """Return the number of a use of an image."""
        if use.image not in self._images:
            self.images.append(stored())
            self._images[use.image] = len(self.images) - 1
        use = replace(use, image=self._images[use.image])
        return self.layers.setdefault(use, len(self.layers))

    def note(self, label: str, error: Exception) -> None:
        """Record that a material could not be read completely."""
        why = str(error) if isinstance(error, CutcellError) else "it is malformed"
        self.notes[f"{label} is used without what could not be read of it: {why}"] = None


Paint = Callable[[Any, NDArray, FaceColors], None]
"""Fills the colours of one piece of a mesh, given what colours it, and its faces by the vertices'
own numbers there."""


def face_colors(
    faces: NDArray[np.int32], pieces: Iterable[tuple[Any, int, slice]], paint: Paint
) -> FaceColors | None:
    """Return the colours of faces. Shapes: faces (m, 3)."""
    colors = FaceColors(
        np.zeros((len(faces), 3, 4), np.float32),
        np.full((len(faces), 3, 3), OPAQUE, np.uint8),
        np.full((len(faces), 3), OPAQUE, np.uint8),
        np.full(len(faces), -1, np.int32),
    )
    colors.corners[..., 2] = -1
    end = 0
    for piece, first, rows in pieces:
        if rows.start != end or rows.stop > len(faces):
            return None
        end = rows.stop
        with np.errstate(all="ignore"):  # a file may hold any number
            paint(piece, faces[rows] - first, colors.of(rows))
    np.nan_to_num(colors.corners, copy=False)
    return colors if end == len(faces) else None
