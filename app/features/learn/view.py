"""What the lesson takes for answers, and the key that adds a step to a lesson."""

from .steps import watch
from .writing import save_view

__all__ = ["KEYS", "watch"]

KEYS = {"step": save_view}
