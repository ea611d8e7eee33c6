"""Foundation of edits: their commands, their results and their controls on the page."""

from .compute.brush import paint_weights
from .compute.stroke import Brush

__all__ = ["Brush", "paint_weights"]
