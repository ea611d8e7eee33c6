"""The keys that step through the pairs, and what follows an audit."""

from functools import partial

from .results import step, watch

__all__ = ["KEYS", "watch"]

KEYS = {"next": partial(step, count=1), "previous": partial(step, count=-1)}
