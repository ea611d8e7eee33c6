"""The scene of the panel Learn: the character with its weights."""

from ..weights.scene import scene

__all__ = ["scene"]
