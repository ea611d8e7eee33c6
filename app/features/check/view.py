"""What follows the findings."""

from .results import watch

__all__ = ["watch"]
