"""The scene of the panel Learn is that of the weights."""

from .weights import weights as learn

__all__ = ["learn"]
