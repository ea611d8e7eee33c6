"""Measures of settings as curves, for `frontend/tables/curves.js`."""

import math
from collections.abc import Callable, Sequence
from typing import Any

from .rows import Setting, number

STEPS = (1, 2, 5)
"""Steps between the marks of an axis, but for powers of ten."""
MARKS = 5
"""Largest number of marks of a vertical axis."""

Scale = Callable[[float], float]
"""Returns the place on an axis, from 0 to 1, of a value."""


def plot(
    settings: Sequence[Setting],
    measure: str,
    title: str,
    is_chosen: Callable[[Setting], bool],
    x: str = "",
    logarithmic: bool = False,
) -> dict[str, Any]:
    """Return a plot of one measure of some settings; those without the measure are left out.

    `x` is the choice along the horizontal axis, a number; empty for one place a setting, by its
    title. `logarithmic` is of the vertical axis; the resolution's always is.
    """
    measured = [one for one in settings if one.values.get(measure) is not None]
    places = _places(measured, x)
    values = [float(one.values[measure] or 0) for one in measured]
    up, y_ticks = _axis(values, logarithmic)
    points = [
        {
            "id": one.id,
            "title": one.title,
            "text": number(one.values[measure]),
            "at": [place, up(value)],
            "chosen": is_chosen(one),
        }
        for one, place, value in zip(measured, places, values, strict=True)
    ]
    curves = [
        {
            "name": name,
            "points": [p for p, s in zip(points, measured, strict=True) if s.curve == name],
        }
        for name in dict.fromkeys(one.curve for one in measured)
    ]
    ticks = {
        place: str(one.choices[x]) if x else one.title
        for one, place in zip(measured, places, strict=True)
    }
    return {
        "title": title,
        "curves": curves,
        "x_ticks": [[place, text] for place, text in ticks.items()],
        "y_ticks": y_ticks,
    }


def _places(settings: Sequence[Setting], x: str) -> list[float]:
    """Return where the settings are along the horizontal axis, from 0 to 1."""
    values = [float(one.choices[x]) if x else k for k, one in enumerate(settings)]
    scale = _between(min(values), max(values), x == "resolution")
    return [scale(value) for value in values]


def _axis(values: Sequence[float], logarithmic: bool) -> tuple[Scale, list[list[Any]]]:
    """Return the scale of a vertical axis, and the place and text of its marks."""
    low, high = min(values), max(values)
    if logarithmic and low > 0:
        decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
        marks = [10.0**k for k in decades]
        scale = _between(marks[0], marks[-1], True)
    else:
        step = _step((high - low) or abs(high) or 1.0)
        first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
        marks = [k * step for k in range(first, max(last, first + 1) + 1)]
        scale = _between(marks[0], marks[-1], False)
    return scale, [[scale(mark), f"{mark:.4g}"] for mark in marks]


def _step(span: float) -> float:
    """Return the smallest round step that leaves few marks."""
    power = 10.0 ** math.floor(math.log10(span / MARKS))
    return next(k * power for k in (*STEPS, 10) if k * power * (MARKS - 1) >= span * (1 - 1e-9))


def _between(low: float, high: float, logarithmic: bool) -> Scale:
    """Return a scale; equal ends are in the middle."""
    if low == high:
        return lambda value: 0.5
    if logarithmic:
        return lambda value: math.log(value / low) / math.log(high / low)
    return lambda value: (value - low) / (high - low)
