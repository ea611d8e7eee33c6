"""Weights from distances, and the whole way from a rig to its weights."""

from .bind import Binding, bind
from .refine import refine_weights
from .weights import FALLOFFS, skinning_weights

__all__ = ["FALLOFFS", "Binding", "bind", "refine_weights", "skinning_weights"]
