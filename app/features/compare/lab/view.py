"""What follows the results of the laboratory."""

from .results import watch

__all__ = ["watch"]
