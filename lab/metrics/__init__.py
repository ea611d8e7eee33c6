"""Errors of weights that only comparisons measure: weight across gaps, and errors over clips."""

from .clips import ClipError, clip_error
from .crosstalk import Crosstalk, crosstalk, find_gaps

__all__ = ["ClipError", "Crosstalk", "clip_error", "crosstalk", "find_gaps"]
