"""The scene of the panel Learn: the character with its weights."""

from ...looks.weights import scene

__all__ = ["scene"]
