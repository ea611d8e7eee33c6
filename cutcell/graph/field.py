"""Fields: harmonic functions around a place, to second order, right within an error.

A field is a row of SIZE numbers: a value, its gradient (x, y, z), the second derivatives
(xx, yy, xy, xz, yz), of which zz = -xx - yy is the last, and the error.
"""

from __future__ import annotations

from ..compiled import compiled

SIZE = 10
ERROR = SIZE - 1


@compiled(inline="always")
def value_at(field, x, y, z):
    """Return the value at a way (x, y, z) from the place."""
    linear = field[1] * x + field[2] * y + field[3] * z
    square = field[4] * (x * x - z * z) + field[5] * (y * y - z * z)
    return field[0] + linear + square / 2 + field[6] * x * y + field[7] * x * z + field[8] * y * z


@compiled(inline="always")
def move(field, x, y, z):
    """Make it a field around the place a way (x, y, z) off."""
    field[0] = value_at(field, x, y, z)
    field[1] += field[4] * x + field[6] * y + field[7] * z
    field[2] += field[6] * x + field[5] * y + field[8] * z
    field[3] += field[7] * x + field[8] * y - (field[4] + field[5]) * z


@compiled(inline="always")
def change(field, half):
    """Return how much the value changes at most in a cube around the place, of that half side."""
    linear = abs(field[1]) + abs(field[2]) + abs(field[3])
    square = (abs(field[4]) + abs(field[5]) + abs(field[4] + field[5])) / 2
    return half * (linear + half * (square + abs(field[6]) + abs(field[7]) + abs(field[8])))
