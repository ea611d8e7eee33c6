"""Several methods on several rigs, measured against weights by artists."""

from .markdown import comparison_markdown
from .run import compare
from .scores import MEASURES, Comparison, MethodScore, RigScore, Statistic

__all__ = [
    "MEASURES",
    "Comparison",
    "MethodScore",
    "RigScore",
    "Statistic",
    "compare",
    "comparison_markdown",
]
