"""The scene of the panel Weights: the character with its weights."""

from ...looks.weights import scene

__all__ = ["scene"]
