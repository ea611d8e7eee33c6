"""Paint weights with a brush, as artists do."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.checks import check_flag, check_integer, shown
from cutcell.errors import ParameterError, WeightsError
from cutcell.rig import Rig
from cutcell.rig.checks import as_array

from .mirror import joint_mirror
from .stroke import Brush, PaintSurface, Stroke

MAX_INFLUENCES = 2**15


def paint_weights(
    rig: Rig,
    weights: ArrayLike,
    joint: int | str,
    stroke: ArrayLike,
    brush: Brush,
    *,
    mirrored: bool = False,
    locked: Sequence[int | str] = (),
    max_influences: int | None = None,
    within: ArrayLike | None = None,
) -> NDArray[np.float64]:
    """Paint the weight of a joint along a stroke of a brush.

    Distances run over the surface, so that a brush on one leg does not reach the other, and no
    other connected component. Welded vertices get the same weights.

    Parameters
    ----------
    rig : Rig
    weights : array_like, shape (n, j)
        Rows sum to one.
    joint : int or str
        Painted joint, by its index or its name; the others share the remaining weight.
    stroke : array_like, shape (s,), int
        Vertices that the brush passes.
    brush : Brush
    mirrored : bool
        Paint the joint of the other side there in the same way.
    locked : sequence of int or str
        Joints whose weights stay, here the given ones.
    max_influences : int, optional
        Joints that a painted vertex may follow: the painted and the locked ones, then the
        strongest.
    within : array_like, shape (n,), bool, optional
        Which vertices may be painted; all of them when left out.

    Returns
    -------
    array, shape (n, j)
        Rows that the brush did not touch are as they were; others sum to one. A vertex that
        follows no other joint keeps its weight, since no joint could receive it.

    Raises
    ------
    ParameterError
        There is no such joint or vertex, or the joint is locked or may carry no weight.
    SkeletonError
        The stroke is to be mirrored, and the skeleton is not.
    WeightsError
        The weights, or `within`, are of another shape.

    Examples
    --------
    >>> brush = Brush(radius=0.1, strength=0.5)
    >>> painted = paint_weights(rig, weights, "Hand.L", [1017], brush)  # doctest: +SKIP
    """
    before = np.asarray(weights, float)
    count = len(rig.mesh.vertices)
    if before.shape != (count, len(rig.skeleton.names)):
        raise WeightsError(
            f"weights must have the shape ({count}, {len(rig.skeleton.names)}), one row a vertex "
            f"and one column a joint, not {before.shape}"
        )
    passed = np.asarray(stroke)
    if passed.ndim != 1 or not (passed.size and np.issubdtype(passed.dtype, np.integer)):
        raise ParameterError(f"stroke must be a list of vertices, not {shown(stroke)}")
    if passed.min() < 0 or passed.max() >= count:
        raise ParameterError(f"stroke must hold vertices from 0 to {count - 1}")
    mirror = joint_mirror(rig) if check_flag("mirrored", mirrored) else None
    if max_influences is not None:
        check_integer("max_influences", max_influences, 1, MAX_INFLUENCES)
    if within is not None:
        within = as_array(within, np.bool_, (count,), "within", WeightsError)
    begun = Stroke(
        PaintSurface(rig.mesh), rig, before, joint, brush, mirror=mirror,
        locked=locked, max_influences=max_influences, within=within,
    )  # fmt: skip
    begun.pass_over(passed[:, None], np.ones((len(passed), 1)))
    vertices, rows = begun.painted()
    result = before.copy()
    result[vertices] = rows
    return result
