"""Errors of weights by named definitions: the paper's, RigNet's and UniRig's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from numpy.typing import ArrayLike

from cutcell.rig import Rig
from cutcell.runtime.progress import Progress, silent

from .deformation import checked_fit
from .table import METRICS, Measured, Metric

RIGNET_THRESHOLD = 1e-4
UNIRIG_SIDE = 2.0
"""Longest side of UniRig's meshes, which are scaled into the cube from -1 to 1."""


@dataclass(frozen=True)
class Definition:
    """Measures that are defined together.

    Parameters
    ----------
    title : str
    text : str
        What is measured, in a few words.
    measures : mapping of str to Metric
    """

    title: str
    text: str
    measures: Mapping[str, Metric]


def _mean_over_joints(one: Measured) -> float:
    return METRICS["l1"].measure(one) / len(one.rig.skeleton.joints)


def _vertex_loss(one: Measured) -> float:
    return UNIRIG_SIDE**2 * one.poses.mean_square / 3


DEFINITIONS: dict[str, Definition] = {
    "paper": Definition(
        "Paper",
        "L1 summed over joints; precision and recall above 0.001; deformation error in cm² as "
        "each joint turns by 30°, longest side 1 m. Welded vertices.",
        {
            **{name: METRICS[name] for name in ("l1", "precision", "recall")},
            "deformation": replace(METRICS["deformation"], form=".2f"),
        },
    ),
    "rignet": Definition(
        "RigNet",
        "L1 summed over joints; precision and recall above 0.0001; distance in 10 random poses, "
        "longest side 1. Vertices of the file.",
        {
            "l1": replace(METRICS["l1"], heading="avg L1"),
            **{name: METRICS[name] for name in ("precision", "recall")},
            "mean_distance": Metric("avg dist", lambda one: one.poses.mean, form=".4f"),
            "largest_distance": Metric("max dist", lambda one: one.poses.largest, form=".4f"),
        },
    ),
    "unirig": Definition(
        "UniRig",
        "L1 averaged over joints; mean squared error of coordinates in 10 random poses, longest "
        "side 2. Vertices of the file.",
        {
            "l1": Metric("L1 loss", _mean_over_joints, form=".5f"),
            "vertex_loss": Metric("vertex loss", _vertex_loss, form=".2e"),
        },
    ),
}
"""The definitions by name."""


def errors_by_definition(
    rig: Rig,
    predicted: ArrayLike,
    reference: ArrayLike,
    *,
    progress: Progress = silent,
) -> dict[str, dict[str, float | None]]:
    """Measure weights by each of `DEFINITIONS`.

    Parameters
    ----------
    rig : Rig
    predicted, reference : array_like, shape (n, j)
        Rows sum to one, or to zero.
    progress : callable
        See `cutcell.runtime.progress`; the stage is called "deformation".

    Returns
    -------
    dict of dicts of float or None
        By definition and measure. None: there is nothing to take a share of.

    Raises
    ------
    SkeletonError
        No joints.
    WeightsError
        Weights that do not fit the rig or each other.

    References
    ----------
    Paper section 4.3; Xu et al. 2020 (RigNet); Zhang et al. 2025 (UniRig), `skin_l1_loss` and
    `vertex_loss` of its code. `docs/networks.md` lists what they leave open.
    """
    predicted, reference = checked_fit(rig, predicted, reference)
    welded = Measured(rig, predicted, reference, turned="all", progress=progress)
    even = Measured(
        rig, predicted, reference, count="vertices", threshold=RIGNET_THRESHOLD, progress=progress
    )
    measured = {"paper": welded, "rignet": even, "unirig": even}
    return {name: measured[name].values(of.measures) for name, of in DEFINITIONS.items()}
