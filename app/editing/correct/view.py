"""The handle that moves the chosen joint."""

from .moving import handle_part, watch

__all__ = ["PARTS", "watch"]

PARTS = {"mover": handle_part}
