"""Regions where two sets of weights differ in motion, and the reason of each."""

from .reasons import REASONS
from .regions import Disagreement, Region, disagreement

__all__ = ["REASONS", "Disagreement", "Region", "disagreement"]
