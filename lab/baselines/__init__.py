"""Other methods to bind a rig, all with one signature, for comparison."""

from .frame import BaselineBinding
from .methods import METHODS, Baseline

__all__ = ["METHODS", "Baseline", "BaselineBinding"]
