"""What happens on the page beside opening and binding, one file a panel.

Each `watch(session)` here makes a new session act when its state changes; the other functions
are what the panels call.
"""

from __future__ import annotations

from . import compare, diagnosis, geodesics, habits, pose, rest, weights

WATCHERS = (
    geodesics.watch, pose.watch, compare.watch, weights.watch, habits.watch, rest.watch,
    diagnosis.watch,
)  # fmt: skip
