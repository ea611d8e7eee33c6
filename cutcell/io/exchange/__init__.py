"""Weights without their rig, as other programs read and write them."""

from .files import WEIGHT_FILES
from .rigs import save_weights, with_saved_weights

__all__ = ["WEIGHT_FILES", "save_weights", "with_saved_weights"]
