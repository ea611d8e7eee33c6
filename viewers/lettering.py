"""Texts on a picture: the legend in its corner, captions over its views."""

from functools import cache
from math import ceil
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from cutcell.runtime.display import printable

from .description import Legend
from .palette import Color, Theme, colormap, to_bytes
from .tiles import Tile

CARD = {"light": (255, 255, 255, 216), "dark": (24, 28, 36, 216)}
MAX_LETTERS = 200
"""Largest number of letters of a text; far fewer fit."""
MAX_SHRINKING = 1.4
"""Largest factor by which captions are shrunk to fit."""
LINE = {"light": (31, 38, 50, 40), "dark": (232, 236, 243, 40)}


def legend_card(legend: Legend, theme: Theme, size: tuple[int, int]) -> Image.Image:
    """Return a legend as a card whose sizes follow those of a picture."""
    unit = _unit(size)
    title, ends = _font(1.25 * unit), _font(1.1 * unit)
    pad, bar = round(1.1 * unit), round(0.75 * unit)
    least = ends.getlength(f"{legend.low}     {legend.high}")
    indent = 2 * bar + round(0.6 * unit)
    swatches = [(color, printable(text, MAX_LETTERS)) for color, text in legend.swatches]
    least = max([least, *(indent + ends.getlength(text) for _, text in swatches)])
    needed = max(18 * unit, title.getlength(printable(legend.title, MAX_LETTERS)), least)
    width = ceil(min(needed, size[0] - 4 * pad))
    name = _shortened(printable(legend.title, MAX_LETTERS), title, width)
    scale = bar + round(0.6 * unit) + _height(ends) if legend.colormap else 0
    row = _height(ends) + round(0.4 * unit)
    height = _height(title) + round(0.7 * unit) + scale + row * len(swatches)
    image = Image.new("RGBA", (width + 2 * pad, height + 2 * pad))
    draw = ImageDraw.Draw(image)
    box = (0, 0, image.width - 1, image.height - 1)
    draw.rounded_rectangle(box, round(0.7 * unit), fill=CARD[theme.name])
    ink, left, top = _ink(theme.ink), pad, pad
    draw.text((left, top), name, font=title, fill=ink)
    top += _height(title) + round(0.7 * unit)
    if legend.colormap:
        strip = Image.fromarray(colormap(legend.colormap)[np.newaxis], "RGB").resize(
            (width, bar), Image.Resampling.BILINEAR
        )
        image.paste(strip, (left, top), _rounded(width, bar))
        below = top + bar + round(0.6 * unit)
        draw.text((left, below), legend.low, font=ends, fill=ink)
        draw.text((left + width, below), legend.high, font=ends, fill=ink, anchor="ra")
    top += scale
    for color, text in swatches:
        middle = top + row // 2
        patch = (left, middle - bar // 2, left + 2 * bar, middle + bar // 2)
        draw.rounded_rectangle(patch, bar // 3, fill=_ink(color))
        draw.text((left + indent, middle), text, font=ends, fill=ink, anchor="lm")
        top += row
    return image


def free_corner(covered: NDArray[np.bool_], card: Image.Image) -> tuple[int, int] | None:
    """Return an empty corner of a picture for a card; None if there is none.

    `covered`, shape (height, width), marks the pixels that show something.
    """
    height, width = covered.shape
    gap = round(1.1 * _unit((width, height)))
    left, right = gap, width - card.width - gap
    top, bottom = gap, height - card.height - gap
    for x, y in ((left, bottom), (right, bottom), (left, top), (right, top)):
        if not covered[max(y, 0) : y + card.height, max(x, 0) : x + card.width].any():
            return x, y
    return None


def put_card(
    picture: NDArray[np.uint8], card: Image.Image, place: tuple[int, int]
) -> NDArray[np.uint8]:
    """Return a picture with a card on it."""
    mode = "RGBA" if picture.shape[2] == 4 else "RGB"
    image = Image.fromarray(np.ascontiguousarray(picture)).convert("RGBA")
    image.alpha_composite(card, (max(place[0], 0), max(place[1], 0)))
    return np.asarray(image.convert(mode))


def write_captions(
    picture: NDArray[np.uint8], captions: tuple[str, ...], places: list[Tile], theme: Theme
) -> NDArray[np.uint8]:
    """Write each view's caption at its upper edge, and draw a line between the views.

    If captions are too wide for their views, all are written smaller, or else shortened.
    """
    unit = _unit(picture.shape[1::-1])
    font, pad = _font(1.25 * unit), round(0.7 * unit)
    names = [printable(text, MAX_LETTERS) for text in captions]
    room = max(min(width for _, _, width, _ in places) - 7 * pad, 1)
    longest = max(map(font.getlength, names))
    font = _font(1.25 * unit / min(max(longest / room, 1), MAX_SHRINKING))
    image = Image.fromarray(np.ascontiguousarray(picture))
    draw = ImageDraw.Draw(image, "RGBA")
    for text, (left, top, width, height) in zip(names, places, strict=True):
        if left:
            draw.line((left, top, left, top + height), fill=LINE[theme.name], width=1)
        if top:
            draw.line((left, top, left + width, top), fill=LINE[theme.name], width=1)
        name = _shortened(text, font, width - 6 * pad)  # widths of letters are rounded
        half = font.getlength(name) / 2 + 1.4 * pad
        middle, upper = left + width / 2, top + 1.6 * pad
        box = (middle - half, upper, middle + half, upper + _height(font) + 1.6 * pad)
        draw.rounded_rectangle(box, pad, fill=CARD[theme.name])
        draw.text((middle, upper + 0.8 * pad), name, font=font, fill=_ink(theme.ink), anchor="ma")
    return np.asarray(image)


def _unit(size: tuple[int, ...]) -> float:
    width, height = size
    return max(min(height, width * 1.2) / 65, 5.0)


def _ink(color: Color) -> tuple[int, int, int]:
    red, green, blue = to_bytes(color).tolist()
    return (red, green, blue)


@cache
def _font(size: float) -> ImageFont.FreeTypeFont:
    # DejaVu, which comes with PyVista's own needs, has the letters of many scripts.
    from matplotlib import get_data_path

    return ImageFont.truetype(Path(get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf", size)


def _height(font: ImageFont.FreeTypeFont) -> int:
    return sum(font.getmetrics())


def _shortened(text: str, font: ImageFont.FreeTypeFont, width: float) -> str:
    if font.getlength(text) <= width:
        return text
    while text and font.getlength(text + "…") > width:
        text = text[:-1]
    return text + "…"


def _rounded(width: int, height: int) -> Image.Image:
    mask = Image.new("L", (4 * width, 4 * height), 0)
    ImageDraw.Draw(mask).rounded_rectangle(
        (0, 0, 4 * width - 1, 4 * height - 1), 2 * height, fill=255
    )
    return mask.resize((width, height), Image.Resampling.LANCZOS)
