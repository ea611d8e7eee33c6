"""Weights from distances, and the whole way from a rig to its weights."""

from .bind import Binding, bind
from .kernels import kernels_are_compiled, load_kernels
from .refine import refine_weights
from .weights import DEFAULT_LEAF, FALLOFFS, keep_strongest, skinning_weights

__all__ = [
    "DEFAULT_LEAF",
    "FALLOFFS",
    "Binding",
    "bind",
    "keep_strongest",
    "kernels_are_compiled",
    "load_kernels",
    "refine_weights",
    "skinning_weights",
]
