"""Images as a GLB takes them in: PNG and JPEG as they are, others as PNG."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...isolated.run import WorkFailedError, run_isolated
from ..materials.face_colors import StoredImage
from ..materials.gltf_images import SIGNATURES

EVERYWHERE = ("image/png", "image/jpeg")
"""What every reader of glTF knows."""
SECONDS, SECONDS_A_MEGABYTE = 30.0, 10.0
MEMORY = 2**31
"""What decoding may take: three times that of the largest image."""


@dataclass(frozen=True)
class Embedded:
    """An image of a GLB.

    Parameters
    ----------
    kind : str
        Its media type; empty where it cannot be taken in.
    content : bytes
    problem : str
        Why it cannot be.
    """

    kind: str = ""
    content: bytes = b""
    problem: str = ""


def embedded(images: Sequence[StoredImage]) -> tuple[Embedded, ...]:
    """Return images as a GLB takes them in."""
    others = tuple(one.content for one in images if not _kind(one))
    made = iter(_as_png(others) if others else ())
    return tuple(Embedded(kind, i.content) if (kind := _kind(i)) else next(made) for i in images)


def image_notes(images: Sequence[StoredImage]) -> tuple[str, ...]:
    """Say which images a GLB cannot take in."""
    return tuple(
        f"{image.name} is not saved, and its material has its colour alone: {one.problem}"
        for image, one in zip(images, embedded(images), strict=True)
        if one.problem
    )


def _kind(image: StoredImage) -> str:
    """Return the media type of an image that is taken in as it is, else nothing."""
    found = (kind for start, kind in SIGNATURES.items() if image.content.startswith(start))
    return next((kind for kind in found if kind in EVERYWHERE), "")


@lru_cache(maxsize=1)
def _as_png(contents: tuple[bytes, ...]) -> tuple[Embedded, ...]:
    """Decode images apart. Who saves a file and then asks for its notes asks for them twice."""
    data = b"".join(contents)
    job = {
        "data": np.frombuffer(data, np.uint8),
        "ends": np.cumsum([len(content) for content in contents]),
    }
    seconds = SECONDS + SECONDS_A_MEGABYTE * len(data) / 2**20
    try:
        found = run_isolated("images", job, seconds, "the decoder of images", MEMORY)
    except WorkFailedError as error:
        return tuple(Embedded(problem=str(error)) for _ in contents)
    return tuple(
        Embedded("image/png", found[f"png_{k}"].tobytes())
        if f"png_{k}" in found
        else Embedded(problem=str(found[f"problem_{k}"]))
        for k in range(len(contents))
    )
