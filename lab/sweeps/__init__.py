"""Sweeps: one option of the method over several values, each measured on one character."""

from .run import (
    MEASURES,
    OPTIONS,
    Sweep,
    SweepPoint,
    bind_setting,
    measure_setting,
    points_csv,
    sweep,
    value_text,
)
from .values import parsed_values

__all__ = [
    "MEASURES",
    "OPTIONS",
    "Sweep",
    "SweepPoint",
    "bind_setting",
    "measure_setting",
    "parsed_values",
    "points_csv",
    "sweep",
    "value_text",
]
