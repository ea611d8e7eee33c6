"""Images as PNG. Decoders of many formats meet a stranger's bytes here."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import numpy as np
from PIL import Image

FORMATS = ("WEBP", "BMP", "TGA")
LARGEST = 2**26
"""Pixels of an image: 8192 by 8192."""


def as_png(data, ends):
    """Encode images of other formats.

    Shapes: data (b,), ends (k,).
    """
    found: dict[str, Any] = {}
    start = 0
    for k, end in enumerate(ends.tolist()):
        try:
            found[f"png_{k}"] = np.frombuffer(_as_png(data[start:end].tobytes()), np.uint8)
        except ValueError as error:
            found[f"problem_{k}"] = str(error)
        start = end
    return found


def _as_png(content):
    packed = BytesIO()
    try:
        with Image.open(BytesIO(content), formats=FORMATS) as image:
            large = image.width * image.height > LARGEST
            if not large:
                has_alpha = "A" in image.getbands() or "transparency" in image.info
                image.convert("RGBA" if has_alpha else "RGB").save(packed, "PNG")
    except MemoryError:
        large = True
    except Exception:  # whatever Pillow's readers make of it
        raise ValueError("it is no PNG, JPEG, WebP, BMP or TGA, or damaged") from None
    if large:
        raise ValueError("it has more than 67 million pixels")
    return packed.getvalue()
