"""Errors of weights by named definitions: the paper's, RigNet's and UniRig's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cutcell.rig import Rig
from cutcell.rig.mesh import vertex_shares
from cutcell.runtime.progress import Progress, silent

from .deformation import deformation_error
from .poses import pose_error
from .weight_error import precision_recall, weight_l1

RIGNET_THRESHOLD = 1e-4
UNIRIG_SIDE = 2.0
"""Longest side of UniRig's meshes, which are scaled into the cube from -1 to 1."""


@dataclass(frozen=True)
class Measure:
    """One number of a definition.

    Parameters
    ----------
    heading : str
        Its name in tables.
    form : str
        Format of the number, such as ".3f".
    """

    heading: str
    form: str


@dataclass(frozen=True)
class Definition:
    """Measures that are defined together.

    Parameters
    ----------
    title : str
    text : str
        What is measured, in a few words.
    measures : mapping of str to Measure
    """

    title: str
    text: str
    measures: Mapping[str, Measure]


DEFINITIONS: dict[str, Definition] = {
    "paper": Definition(
        "Paper",
        "L1 summed over joints; precision and recall above 0.001; deformation error in cm² as "
        "each joint turns by 30°, longest side 1 m. Welded vertices.",
        {
            "l1": Measure("L1", ".3f"),
            "precision": Measure("precision", ".3f"),
            "recall": Measure("recall", ".3f"),
            "deformation": Measure("deformation cm²", ".2f"),
        },
    ),
    "rignet": Definition(
        "RigNet",
        "L1 summed over joints; precision and recall above 0.0001; distance in 10 random poses, "
        "longest side 1. Vertices of the file.",
        {
            "l1": Measure("avg L1", ".3f"),
            "precision": Measure("precision", ".3f"),
            "recall": Measure("recall", ".3f"),
            "mean_distance": Measure("avg dist", ".4f"),
            "largest_distance": Measure("max dist", ".4f"),
        },
    ),
    "unirig": Definition(
        "UniRig",
        "L1 averaged over joints; mean squared error of coordinates in 10 random poses, longest "
        "side 2. Vertices of the file.",
        {
            "l1": Measure("L1 loss", ".5f"),
            "vertex_loss": Measure("vertex loss", ".2e"),
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
    turns = deformation_error(rig, predicted, reference, joints="all", progress=progress)
    welded, even = vertex_shares(rig.mesh), vertex_shares(rig.mesh, "vertices")
    precision, recall = precision_recall(predicted, reference, welded)
    paper: dict[str, float | None] = {
        "l1": weight_l1(predicted, reference, welded),
        "precision": _number(precision),
        "recall": _number(recall),
        "deformation": turns.mean,
    }
    poses = pose_error(rig, predicted, reference)
    l1 = weight_l1(predicted, reference, even)
    precision, recall = precision_recall(predicted, reference, even, threshold=RIGNET_THRESHOLD)
    rignet: dict[str, float | None] = {
        "l1": l1,
        "precision": _number(precision),
        "recall": _number(recall),
        "mean_distance": poses.mean,
        "largest_distance": poses.largest,
    }
    unirig: dict[str, float | None] = {
        "l1": l1 / len(rig.skeleton.joints),
        "vertex_loss": UNIRIG_SIDE**2 * poses.mean_square / 3,
    }
    return {"paper": paper, "rignet": rignet, "unirig": unirig}


def _number(value: float) -> float | None:
    return None if np.isnan(value) else value
