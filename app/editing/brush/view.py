"""The brush in the view, and its keys."""

from functools import partial

from .strokes import brush_part, deactivate, resize, strengthen, toggle, watch

__all__ = ["KEYS", "PARTS", "watch"]

PARTS = {"brush": brush_part}
KEYS = {
    "brush": toggle,
    "brush away": deactivate,
    "brush larger": partial(resize, steps=1),
    "brush smaller": partial(resize, steps=-1),
    "brush stronger": partial(strengthen, steps=1),
    "brush weaker": partial(strengthen, steps=-1),
}
