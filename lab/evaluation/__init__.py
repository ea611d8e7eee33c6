"""Predicted weights in files, measured against those of other files."""

from .report import evaluation_markdown, left_out_lines, print_evaluation
from .run import evaluate
from .scores import Evaluation, RigErrors

__all__ = [
    "Evaluation",
    "RigErrors",
    "evaluate",
    "evaluation_markdown",
    "left_out_lines",
    "print_evaluation",
]
