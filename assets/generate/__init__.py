"""Random rigged characters for training and tests."""

from .characters import KINDS, Kind, generate

__all__ = ["KINDS", "Kind", "generate"]
