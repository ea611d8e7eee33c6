"""The wavefront that runs in the browser."""

from .results import watch, wave_part

__all__ = ["PARTS", "watch"]

PARTS = {"animation": wave_part}
