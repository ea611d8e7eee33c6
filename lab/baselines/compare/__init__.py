"""Several methods on several rigs, measured against weights by artists."""

from .markdown import comparison_markdown
from .run import compare
from .scores import Comparison, MethodScore, RigScore, Statistic

__all__ = [
    "Comparison",
    "MethodScore",
    "RigScore",
    "Statistic",
    "compare",
    "comparison_markdown",
]
