"""How long work reports itself, and how it is stopped."""

from collections.abc import Callable

Progress = Callable[[str, float], None]
"""Called with a stage's name and the fraction of it done, from 0 to 1.

Every stage calls it often enough for a bar to move. To cancel, raise
`cutcell.Cancelled` inside it: the stage stops there and the exception goes through.
"""


def silent(stage: str, fraction: float) -> None:
    """Report nothing."""
