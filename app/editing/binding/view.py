"""What follows the weights: choices to go back to, and messages that wait for them."""

from .recovery import watch

__all__ = ["watch"]
