"""Algebraic multigrid for the equations of large meshes, by smoothed aggregation.

The factors of a surface's matrix grow faster than the surface, while the solution hardly varies
from one vertex to the next. A coarser level has one unknown for each group of neighbours, and only
the coarsest is factorised: the work is in proportion to the size of the matrix.

References
----------
Vanek, Mandel & Brezina 1996, "Algebraic multigrid by smoothed aggregation for second and fourth
order elliptic problems". Baker, Falgout, Kolev & Yang 2011, "Multigrid smoothers for
ultraparallel computing" (scaling by the absolute row sums).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.linalg import SuperLU, splu

from ...runtime.compiled import compiled
from ...runtime.progress import Tell

RIGHT_SIDES = 8
"""Right sides that are solved for at once."""
MANY = 50_000
"""Unknowns up to which an equation is solved by factors of its matrix, which for few takes the
least time and is exact. The time for factors grows faster than the mesh: from about here on
multigrid takes less."""
COARSEST = 20_000
"""Unknowns of a level that is factorised, as that takes less time than one more level."""
MIN_COARSENING = 0.7
"""A level is the coarsest one if the next would have more than this part of its unknowns."""
TOLERANCE = 1e-4
"""Iterations end when the error that is left is estimated to be smaller, of values from 0 to 1."""
FIRST_RATE, SLOWEST_RATE = 0.5, 0.97
"""How much smaller each step is than the one before: what is assumed of the first, and at most."""
COARSE_TOLERANCE = 10 * TOLERANCE
"""The same for solutions of coarser levels, where a finer one begins."""
NEGLIGIBLE = TOLERANCE / 2
"""What is below this in the solution of the coarser level, and would be by itself, is zero on the
finer one."""
LEAST = 1e-300
"""Instead of zero, where a right side is zero."""
UNGROUPED = -(2**31)
"""The group of an unknown that is in none yet."""
MAX_STEPS = 30
"""On surfaces there are about five. After so many the rest is solved for by factors."""
STRONG = 0.08
"""Neighbours are grouped if the entry between them is at least this part of those on the diagonal:
what is coupled more weakly may have very different values."""
DENSE_ROW = 100
"""An unknown with more neighbours, as at the pole of a sphere, begins no group, and is interpolated
from its own group only: otherwise the coarser matrix would be dense."""


@dataclass(frozen=True, eq=False)
class Level:
    """A matrix, and how its unknowns are interpolated from those of the next coarser level.

    Parameters
    ----------
    matrix : csr_array, shape (k, k)
        Symmetric and positive definite.
    inverse : array, shape (k,)
        One over its diagonal.
    interpolation, restriction : csr_arrays, shapes (k, c) and (c, k)
        Transposes of each other.
    """

    matrix: csr_array
    inverse: NDArray[np.float64]
    interpolation: csr_array
    restriction: csr_array

    @classmethod
    def of(cls, matrix: csr_array) -> Level:
        """Interpolate constants from groups of unknowns, smoothed once by the matrix."""
        count = matrix.shape[0]
        diagonal = matrix.diagonal()
        group, groups = _group(matrix.indptr, matrix.indices, matrix.data, diagonal)
        constant = csr_array(
            (np.ones(count), group, np.arange(count + 1, dtype=np.int32)), (count, groups)
        )
        damping = 4 / 3 / np.add.reduceat(np.abs(matrix.data), matrix.indptr[:-1])
        damping[np.diff(matrix.indptr) > DENSE_ROW] = 0
        smoothing = matrix @ constant
        smoothing.data *= np.repeat(damping, np.diff(smoothing.indptr))
        interpolation = csr_array(constant - smoothing)
        return cls(matrix, 1 / diagonal, interpolation, interpolation.T.tocsr())

    def coarser(self) -> csr_array:
        """Return the matrix of the next level."""
        return csr_array(self.restriction @ (self.matrix @ self.interpolation))

    def subset(self, rows: NDArray[np.intp]) -> tuple[Level, NDArray[np.intp]]:
        """Return the level of some unknowns, and the coarser unknowns that it is left with.

        These have no part in other unknowns. So the coarser matrix is still that of this one, and
        no correction by it is too large.
        """
        interpolation = self.interpolation[rows]
        parts = np.bincount(interpolation.indices, minlength=interpolation.shape[1])
        coarser = np.flatnonzero(parts == np.diff(self.restriction.indptr))
        interpolation = interpolation[:, coarser]
        matrix = _block(self.matrix, rows)
        return Level(matrix, self.inverse[rows], interpolation, interpolation.T.tocsr()), coarser


def factorise(matrix: csr_array) -> SuperLU:
    """Factorise a symmetric positive definite matrix, shape (k, k)."""
    # Of many unknowns the minimum degree takes SuperLU minutes to find.
    order = "MMD_AT_PLUS_A" if matrix.shape[0] <= MANY else "COLAMD"
    options = {"SymmetricMode": True}
    return splu(matrix.tocsc(), order, diag_pivot_thresh=0.0, options=options)


@dataclass(frozen=True, eq=False)
class Multigrid:
    """A symmetric positive definite matrix, and coarser ones of the same equation.

    Parameters
    ----------
    levels : list of Level
        From the finest one on.
    coarsest : csr_array, shape (c, c)
        The coarsest matrix.
    factors : SuperLU
        Of the coarsest matrix.
    """

    levels: list[Level]
    coarsest: csr_array
    factors: SuperLU

    @classmethod
    def of(cls, matrix: csr_array) -> Multigrid:
        """Coarsen a matrix, shape (k, k), until it is small or has no neighbours left to group."""
        levels: list[Level] = []
        while matrix.shape[0] > COARSEST:
            level = Level.of(matrix)
            if level.interpolation.shape[1] > MIN_COARSENING * matrix.shape[0]:
                break
            levels.append(level)
            matrix = level.coarser()
        return cls(levels, matrix, factorise(matrix))

    def solve(
        self, right: NDArray[np.float64], report: Tell = lambda done: None
    ) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        """Solve for right sides, shape (k, RIGHT_SIDES), of solutions with values from 0 to 1.

        The coarser levels are solved first, in the same way. Then the solution is improved where
        it is not negligible: weights of a joint are zero on most of a character.

        Returns shapes (r,), (r, RIGHT_SIDES).
        """
        return self._solve(right, TOLERANCE, report)

    def _solve(
        self, right: NDArray[np.float64], tolerance: float, report: Tell
    ) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        if not self.levels:
            return np.arange(len(right)), self.factors.solve(right)
        level, *coarser = self.levels
        below = Multigrid(coarser, self.coarsest, self.factors)
        restricted = level.restriction @ right
        coarse = np.zeros_like(restricted)
        coarse_rows, values = below._solve(restricted, COARSE_TOLERANCE, lambda done: report(0.0))
        coarse[coarse_rows] = values
        guess = level.interpolation @ coarse
        rows = np.flatnonzero(_is_significant(guess, right, level.inverse))
        x, equation = guess[rows], self._subset(rows)
        residual = right[rows] - equation.matrix @ x
        return rows, x + equation._improve(residual, tolerance, report)

    @property
    def matrix(self) -> csr_array:
        """The matrix itself."""
        return self.levels[0].matrix if self.levels else self.coarsest

    def _subset(self, rows: NDArray[np.intp]) -> Multigrid:
        """Return the equation for some unknowns; the others stay as they are."""
        levels = []
        for level in self.levels:
            restricted, rows = level.subset(rows)
            levels.append(restricted)
        coarsest = _block(self.coarsest, rows)
        return Multigrid(levels, coarsest, factorise(coarsest))

    def _improve(
        self, residual: NDArray[np.float64], tolerance: float, report: Tell
    ) -> NDArray[np.float64]:
        """Solve by conjugate gradients with multigrid cycles as preconditioner.

        Steps become smaller by about the same factor each: so what is left is a geometric series.
        """
        matrix = self.matrix
        x, direction = np.zeros_like(residual), np.zeros_like(residual)
        before, last = np.ones(RIGHT_SIDES), np.inf
        for count in range(MAX_STEPS):
            report(count / MAX_STEPS)
            step = self._cycle(residual)
            size = max(step.max(initial=0), -step.min(initial=0))
            rate = min(size / last, SLOWEST_RATE) if count else FIRST_RATE
            if size * rate / (1 - rate) <= tolerance:
                x += step
                return x
            last = size
            now = _dot(residual, step)
            direction *= now / before
            direction += step
            product = matrix @ direction
            length = now / np.maximum(_dot(direction, product), LEAST)
            product *= length
            residual -= product
            x += np.multiply(direction, length, out=product)
            before = np.maximum(now, LEAST)
        x += factorise(matrix).solve(residual)
        return x

    def _cycle(self, right: NDArray[np.float64]) -> NDArray[np.float64]:
        """Solve roughly: smooth, correct by the coarser level, smooth the other way round."""
        if not self.levels:
            return self.factors.solve(right)
        level, *coarser = self.levels
        below = Multigrid(coarser, self.coarsest, self.factors)
        x = np.zeros_like(right)
        _smooth(level, right, x, 1)
        residual = level.restriction @ (right - level.matrix @ x)
        correction = below._cycle(residual)
        if coarser:  # a second cycle there, or the convergence here would be slower
            residual -= coarser[0].matrix @ correction
            correction += below._cycle(residual)
        x += level.interpolation @ correction
        _smooth(level, right, x, -1)
        return x


def _block(matrix: csr_array, rows: NDArray[np.intp]) -> csr_array:
    """Return some rows of a matrix, and the same columns."""
    return matrix[rows][:, rows]


@compiled
def _group(start, column, value, diagonal):
    """Group unknowns with their neighbours; return the group of each, and how many there are.

    A group begins as an unknown and all of its neighbours, where none of them is in a group yet.
    Those left over join the group of a neighbour, or are one by themselves.
    """
    count = len(start) - 1
    group, groups = np.full(count, UNGROUPED, np.int32), 0
    for v in range(count):
        is_free = start[v + 1] - start[v] <= DENSE_ROW
        for e in range(start[v], start[v + 1]):
            if _is_strong(value[e], diagonal[v], diagonal[column[e]]):
                is_free &= group[column[e]] == UNGROUPED
        if is_free:
            for e in range(start[v], start[v + 1]):
                if _is_strong(value[e], diagonal[v], diagonal[column[e]]):
                    group[column[e]] = groups
            group[v] = groups
            groups += 1
    for v in range(count):
        if group[v] == UNGROUPED:
            for e in range(start[v], start[v + 1]):
                u = column[e]
                if group[u] >= 0 and _is_strong(value[e], diagonal[v], diagonal[u]):
                    group[v] = ~group[u]  # joined; others next to it are to join those there were
                    break
    for v in range(count):
        if group[v] == UNGROUPED:
            group[v] = groups
            groups += 1
        elif group[v] < 0:
            group[v] = ~group[v]
    return group, groups


@compiled(inline="always")
def _is_strong(value, diagonal, other_diagonal):
    """Return whether two unknowns with these diagonal entries are strongly coupled."""
    return value * value >= STRONG * STRONG * diagonal * other_diagonal


def _smooth(
    level: Level, right: NDArray[np.float64], x: NDArray[np.float64], direction: int
) -> None:
    matrix = level.matrix
    _sweep(matrix.indptr, matrix.indices, matrix.data, level.inverse, right, x, direction)


@compiled
def _sweep(start, column, value, inverse, right, x, direction):
    """Improve x by a Gauss-Seidel sweep from the first row to the last (1) or back (-1)."""
    residual = np.empty(RIGHT_SIDES)
    for k in range(len(inverse)):
        v = k if direction > 0 else len(inverse) - 1 - k
        for i in range(RIGHT_SIDES):
            residual[i] = right[v, i]
        for e in range(start[v], start[v + 1]):
            for i in range(RIGHT_SIDES):
                residual[i] -= value[e] * x[column[e], i]
        for i in range(RIGHT_SIDES):
            x[v, i] += inverse[v] * residual[i]


@compiled
def _is_significant(guess, right, inverse):
    """Return which rows of a solution are not negligible, by a guess or their own side: (k,)."""
    significant = np.empty(len(guess), np.bool_)
    for v in range(len(guess)):
        significant[v] = False
        for i in range(RIGHT_SIDES):
            significant[v] |= max(abs(guess[v, i]), abs(right[v, i]) * inverse[v]) > NEGLIGIBLE
    return significant


def _dot(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.einsum("ij,ij->j", a, b)
