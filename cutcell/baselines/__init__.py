"""Other ways to bind a rig, all with one signature, to measure ours against."""

from .methods import METHODS, Method
from .result import BaselineBinding

__all__ = ["METHODS", "BaselineBinding", "Method"]
