"""Bone heat on the surface: weights in equilibrium between conduction and the pull of bones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import splu

from ...runtime.compiled import compiled
from ...runtime.progress import Tell
from ...runtime.threads import in_threads, parts
from .surface_operators import SurfaceOperators

SHARPNESS = 2.5
"""c: weights spread over about 1 / sqrt(c) of the distance from surface to bone."""
MIN_CELLS = 0.25
"""Lattice cells: a vertex on a bone itself would keep its weights whatever is around it."""
MIN_SCREENING = 1e-12
"""Minimum part of the matrix's diagonal: less would be rounded away and leave it singular."""
MANY = 50_000
"""Unknowns up to which the equation is solved by factors of its matrix. The time for factors grows
faster than the mesh."""
NEGLIGIBLE = 1e-4
"""Weight below which a vertex has none, if that is so of all joints that are solved for."""
RIGHT_SIDES = 8
"""Right sides that are solved for at once."""
SMOOTHING_STEPS = 2
"""Gauss-Seidel sweeps over a level, after the solution of the coarser one was taken over."""
MIN_COARSENING = 0.7
"""A level is the coarsest one if the next would have more than this part of its vertices."""
STRONG = 0.08
"""Neighbours are grouped if their entry is at least this part of those on the diagonal. Those that
are coupled more weakly may have very different weights."""
DENSE_ROW = 100
"""A vertex with more neighbours, as at the pole of a sphere, begins no group: that would be too
large."""


class Level(NamedTuple):
    """An equation, and the groups of vertices that are the vertices of the next coarser level.

    Parameters
    ----------
    matrix : csr_array, shape (k, k)
        Symmetric and positive definite.
    group : array, shape (k,)
    """

    matrix: csr_array
    group: NDArray[np.int32]


Columns: TypeAlias = tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]
"""Start of each column, then the rows, ascending, and values of all columns."""


class Factors(NamedTuple):
    """Triangular factors L and U of a matrix A, shape (k, k), with its rows and columns permuted.

    Parameters
    ----------
    lower, upper : Columns
        L, with ones on the diagonal, and U.
    row, column : arrays, shape (k,), int32
        Where each row and each column of A is in L U.
    """

    lower: Columns
    upper: Columns
    row: NDArray[np.int32]
    column: NDArray[np.int32]

    @classmethod
    def of(cls, matrix: csr_array) -> Factors:
        """Factorise a symmetric positive definite matrix."""
        # For many unknowns SuperLU takes minutes to find the minimum degree.
        order = "MMD_AT_PLUS_A" if matrix.shape[0] <= MANY else "COLAMD"
        options = {"SymmetricMode": True}
        lu = splu(matrix.tocsc(), order, diag_pivot_thresh=0.0, options=options)
        # The arrays are copies: SuperLU frees its memory only in the thread that allocated it
        # (https://github.com/scipy/scipy/issues/15921).
        return cls(_columns(lu.L), _columns(lu.U), lu.perm_r.copy(), lu.perm_c.copy())


def _columns(matrix: csc_array) -> Columns:
    """Return the columns of a matrix, shape (k, k), with ascending rows."""
    matrix.sort_indices()
    return matrix.indptr, matrix.indices, matrix.data


@dataclass(frozen=True, eq=False)
class Diffusion:
    """The screened Poisson equation of bone heat.

        (L + M H) w = M H p,    H = c / depth²

    The right side p is the surface as it was divided among the joints by distance. Each joint
    then bends the surface over a stretch about as long as the limb is thick there.

    Up to `MANY` welded vertices the solution is exact. In larger meshes weights hardly vary from
    one vertex to the next: groups of neighbours become the vertices of a coarser mesh, until they
    are few. Its solution is taken over by all vertices of a group, and smoothed.

    Parameters
    ----------
    screening : array, shape (k,)
        The diagonal of M H.
    levels : tuple of Level
        The finest first; empty for up to `MANY` welded vertices.
    factors : Factors
        Of the coarsest matrix.

    References
    ----------
    Baran & Popović 2007, "Automatic rigging and animation of 3D characters", section 4. Vanek,
    Mandel & Brezina 1996, "Algebraic multigrid by smoothed aggregation for second and fourth order
    elliptic problems" (the groups).
    """

    screening: NDArray[np.float64]
    levels: tuple[Level, ...]
    factors: Factors

    @classmethod
    def over(
        cls, surface: SurfaceOperators, depth: NDArray[np.float64], resolution: int
    ) -> Diffusion:
        """Factorise the equation's matrix: depth (k,)."""
        depth = np.maximum(depth, MIN_CELLS / resolution)
        # A vertex without area conducts nothing; any positive number makes it keep its own weights.
        screening = np.maximum(surface.areas, 1e-12) * SHARPNESS / depth**2
        start, _, value = surface.stiffness
        screening = coarse = np.maximum(screening, MIN_SCREENING * value[start[:-1]])
        levels: list[Level] = []
        while True:
            start, column, value = surface.stiffness
            value = value.copy()
            value[start[:-1]] += coarse
            matrix = csr_array((value, column, start), (len(coarse),) * 2)
            if len(coarse) <= MANY:
                break
            group, groups = _group(*surface.stiffness)
            if groups > MIN_COARSENING * len(coarse):
                break
            levels.append(Level(matrix, group))
            size, coarse = np.bincount(group), np.bincount(group, coarse)
            points = [np.bincount(group, axis) / size for axis in surface.points.T]
            surface = SurfaceOperators.over(np.stack(points, axis=1), group[surface.faces])
        return cls(screening, tuple(levels), Factors.of(matrix))

    def spread(
        self, weights: NDArray[np.float64], report: Tell = lambda done: None
    ) -> NDArray[np.float64]:
        """Return the equilibrium of weights p, shape (k, j); rows sum to one before and after."""
        spread = self.equilibrium(weights, report)
        self.normalise(spread, weights)
        return spread

    def normalise(self, spread: NDArray[np.float64], weights: NDArray[np.float64]) -> None:
        """Scale the rows of an equilibrium of weights to sum to one, in place."""

        def normalise(part: slice) -> None:
            total = spread[part].sum(axis=1, keepdims=True)
            # Next to needle triangles rounding may leave nothing: the vertex keeps its own weights.
            is_positive = np.isfinite(total) & (total > 0)
            if is_positive.all():
                spread[part] /= total
            else:
                normalised = weights[part].copy()
                spread[part] = np.divide(spread[part], total, out=normalised, where=is_positive)

        in_threads(normalise, parts(len(spread)))

    def equilibrium(
        self, weights: NDArray[np.float64], report: Tell = lambda done: None
    ) -> NDArray[np.float64]:
        """Return the equilibrium, where rounding leaves rows that do not quite sum to one."""
        spread = np.zeros(weights.shape)
        self.solve(weights, np.flatnonzero(weights.max(axis=0)), spread, report)
        return spread

    def solve(
        self,
        weights: NDArray[np.float64],
        joints: NDArray[np.intp],
        spread: NDArray[np.float64],
        report: Tell = lambda done: None,
    ) -> None:
        """Write the equilibrium of the weights of some joints into their columns."""

        def solve(group: NDArray[np.intp]) -> None:
            right = self.screening[:, None] * weights[:, group]
            solution = self._solve(np.ascontiguousarray(right))
            spread[:, group] = np.maximum(solution, 0.0, out=solution)

        groups = [joints[i : i + RIGHT_SIDES] for i in range(0, len(joints), RIGHT_SIDES)]
        in_threads(solve, groups, report)

    def _solve(self, right: NDArray[np.float64], level: int = 0) -> NDArray[np.float64]:
        """Solve for right sides (k, s) on one level."""
        if level == len(self.levels):
            return _substitute(*self.factors, right)
        matrix, group = self.levels[level]
        sums = csr_array((np.ones(len(group)), group, np.arange(len(group) + 1, dtype=np.int32)))
        x = self._solve(sums.T @ right, level + 1)[group]
        for _ in range(SMOOTHING_STEPS):
            _smooth(matrix.indptr, matrix.indices, matrix.data, right, x)
        return x


@compiled
def _substitute(lower, upper, row, column, right):
    """Solve by triangular factors for right sides (k, s)."""
    start, index, value = lower
    x = np.empty_like(right)
    for v in range(len(x)):
        x[row[v]] = right[v]
    for v in range(len(x)):
        for e in range(start[v] + 1, start[v + 1]):
            for i in range(x.shape[1]):
                x[index[e], i] -= value[e] * x[v, i]
    start, index, value = upper
    for v in range(len(x) - 1, -1, -1):
        for i in range(x.shape[1]):
            x[v, i] /= value[start[v + 1] - 1]
        for e in range(start[v], start[v + 1] - 1):
            for i in range(x.shape[1]):
                x[index[e], i] -= value[e] * x[v, i]
    return x[column]


@compiled
def _smooth(start, column, value, right, x):
    """Improve a solution (k, s) by a Gauss-Seidel sweep; the diagonal comes first in each row."""
    for v in range(len(x)):
        diagonal, largest = value[start[v]], 0.0
        for i in range(x.shape[1]):
            largest = max(largest, x[v, i], right[v, i] / diagonal)
            x[v, i] = 0.0
        if largest < NEGLIGIBLE:  # as on most of a character
            continue
        for e in range(start[v] + 1, start[v + 1]):
            for i in range(x.shape[1]):
                x[v, i] -= value[e] * x[column[e], i]
        for i in range(x.shape[1]):
            x[v, i] = (x[v, i] + right[v, i]) / diagonal


@compiled
def _group(start, column, value):
    """Group neighbours that are strongly coupled; return each unknown's group, and their number.

    A group begins as an unknown and all of its neighbours, where none of them is in a group yet.
    Those left over join the group of a neighbour, or form one by themselves.
    """
    count = len(start) - 1
    group, groups = np.full(count, -1, np.int32), 0
    for v in range(count):
        is_free = start[v + 1] - start[v] <= DENSE_ROW
        for e in range(start[v], start[v + 1]):
            is_free &= group[column[e]] < 0 or not _is_strong(start, value, v, e, column[e])
        if is_free:
            for e in range(start[v], start[v + 1]):
                if _is_strong(start, value, v, e, column[e]):
                    group[column[e]] = groups
            groups += 1
    seeds = group.copy()
    for v in range(count):
        if seeds[v] < 0:
            for e in range(start[v], start[v + 1]):
                if _is_strong(start, value, v, e, column[e]):
                    group[v] = max(group[v], seeds[column[e]])
            if group[v] < 0:
                group[v] = groups
                groups += 1
    return group, groups


@compiled(inline="always")
def _is_strong(start, value, v, e, u):
    """Return whether the entry e of unknowns v and u is large, beside those on the diagonal."""
    return value[e] * value[e] >= STRONG * STRONG * value[start[v]] * value[start[u]]
