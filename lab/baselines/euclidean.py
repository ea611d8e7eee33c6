"""Weights from straight distances, whatever lies between bone and surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cutcell.method import PAPER, Leaf
from cutcell.rig import Rig
from cutcell.weights.paper_kernel import paper_kernel

from .body import Body
from .frame import BaselineBinding, Run, bind_by


def euclidean(
    rig: Rig,
    *,
    alpha: float = 0.5,
    leaf: Leaf = "point",
    max_influences: int | None = None,
    threshold: float = 0.0,
) -> BaselineBinding:
    """Bind by the straight distance to each bone, with the paper's falloff.

    Parameters
    ----------
    rig : Rig
    alpha : float
        Smoothness of the falloff, 0 to 1.
    leaf
        See `bone_segments`.
    max_influences, threshold
        See `skinning_weights`.

    Returns
    -------
    BaselineBinding
        Stages "distances", "weights".

    Raises
    ------
    ParameterError
        A parameter is out of its range.
    """
    method = PAPER.with_options(
        alpha=alpha, leaf=leaf, max_influences=max_influences, threshold=threshold
    )

    def solve(body: Body, run: Run) -> NDArray[np.float64]:
        distance = body.joint_minimum(body.straight())
        run.end("distances")
        return paper_kernel(distance, body.lattice.diagonal, alpha)

    return bind_by(solve, rig, method)
