"""Rows of eight numbers that stay in the SIMD registers: one for each right side of an equation.

They are written out: in a loop each number would be written before the next is read.
"""

from __future__ import annotations

from ...runtime.compiled import compiled

RIGHT_SIDES = 8
"""Right sides that are solved for at once."""
NOTHING = (0.0,) * RIGHT_SIDES


@compiled(inline="always")
def row_of(right, k):
    """Return a row of an array, shape (k, RIGHT_SIDES)."""
    return (
        right[k, 0],
        right[k, 1],
        right[k, 2],
        right[k, 3],
        right[k, 4],
        right[k, 5],
        right[k, 6],
        right[k, 7],
    )


@compiled(inline="always")
def set_row(right, k, here):
    """Write a row of an array."""
    right[k, 0], right[k, 1], right[k, 2], right[k, 3] = here[0], here[1], here[2], here[3]
    right[k, 4], right[k, 5], right[k, 6], right[k, 7] = here[4], here[5], here[6], here[7]


@compiled(inline="always")
def minus(here, times, there):
    """Subtract a multiple of one row from another."""
    return (
        here[0] - times * there[0],
        here[1] - times * there[1],
        here[2] - times * there[2],
        here[3] - times * there[3],
        here[4] - times * there[4],
        here[5] - times * there[5],
        here[6] - times * there[6],
        here[7] - times * there[7],
    )
