"""Bind rigs by several methods, and measure each against weights by artists."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.checks import check_choice
from cutcell.errors import Cancelled, CutcellError, ParameterError, WeightsError, comes_from_ctrl_c
from cutcell.graph import build_graph
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress, silent

from ...metrics import METRICS, TURNED, Measured, Turned, find_gaps
from .. import METHODS, Baseline, BaselineBinding
from ..methods import accepted_options
from .scores import Comparison, MethodScore, RigScore

GAP_RESOLUTION = 64
"""Resolution of the graph for distances through the body between parts."""


def compare(
    rigs: Iterable[Rig],
    methods: Sequence[str] | Mapping[str, Baseline] | None = None,
    *,
    resolution: int = 64,
    max_influences: int | None = None,
    turned: Turned = "deform",
    progress: Progress = silent,
) -> Comparison:
    """Bind every rig by every method and measure all against the weights of the rigs.

    Parameters
    ----------
    rigs : iterable of Rig
        Each with the weights of its artist; may load them one by one.
    methods : sequence of str, or mapping of names to methods, optional
        Names in `cutcell_lab.baselines.METHODS`, or methods of one's own; all of the former
        when left out.
    resolution : int
        R, for the methods that have a lattice.
    max_influences : int or None
        Joints a vertex may follow; None for no limit.
    turned : {"deform", "all"}
        Which joints the deformation error turns; see `deformation_error`.
    progress : callable
        See `cutcell.runtime.progress`; each rig is a stage.

    Returns
    -------
    Comparison

    Raises
    ------
    ParameterError
        An unknown method, a parameter out of range, or no rigs.
    SkeletonError, WeightsError
        A rig without joints or without weights.
    """
    chosen = _chosen(methods, {"resolution": resolution, "max_influences": max_influences})
    check_choice("turned", turned, TURNED)
    scores = [_compare_rig(rig, chosen, turned, progress) for rig in rigs]
    if not scores:
        raise ParameterError("there are no rigs to compare methods on")
    return Comparison(tuple(scores), tuple(chosen))


def _chosen(
    methods: Sequence[str] | Mapping[str, Baseline] | None, options: Mapping[str, Any]
) -> dict[str, Baseline]:
    """Look methods up, and bind the options that each accepts."""
    if methods is None:
        methods = METHODS
    if not isinstance(methods, Mapping):
        methods = {name: METHODS[check_choice("method", name, METHODS)] for name in methods}
    if not methods:
        raise ParameterError("there are no methods to compare")
    return {
        name: partial(method, **accepted_options(method, **options))
        for name, method in methods.items()
    }


def _compare_rig(
    rig: Rig, methods: Mapping[str, Baseline], turned: Turned, progress: Progress
) -> RigScore:
    rig.require_joints()
    if rig.weights is None:
        raise WeightsError(f'rig "{rig.name}" has no weights of its own to compare with')
    progress(rig.name, 0.0)
    gaps = find_gaps(build_graph(rig.mesh, GAP_RESOLUTION, connectivity=6))
    scores = []
    for done, (name, method) in enumerate(methods.items()):
        progress(rig.name, (done + 1) / (len(methods) + 1))
        binding = _attempt(method, rig)
        scores.append(_score(name, rig, binding, gaps, turned))
    progress(rig.name, 1.0)
    joints = int(rig.skeleton.deform.sum())
    counts = (len(rig.mesh.vertices), joints, len(rig.clips), len(gaps))
    return RigScore(rig.name, *counts, tuple(scores))


def _attempt(method: Baseline, rig: Rig) -> BaselineBinding:
    """Bind by one method; report a failure instead of raising it."""
    try:
        return method(rig)
    except (ParameterError, Cancelled):
        raise  # the same for all rigs
    except CutcellError as error:
        return BaselineBinding(None, failed=str(error))
    except Exception as error:
        if comes_from_ctrl_c(error):
            raise
        return BaselineBinding(None, failed=f"{type(error).__name__}: {error}".rstrip(": "))


def _score(
    name: str,
    rig: Rig,
    binding: BaselineBinding,
    gaps: NDArray[np.int32],
    turned: Turned,
) -> MethodScore:
    if binding.weights is None or rig.weights is None:
        values = dict.fromkeys(METRICS) | {"seconds": float(sum(binding.seconds.values()))}
        return MethodScore(name, binding.failed, values, binding.warnings)
    measured = Measured(rig, binding.weights, rig.weights, binding, turned=turned, gaps=gaps)
    worst = tuple(measured.turns.worst(3))
    return MethodScore(name, "", measured.values(METRICS), binding.warnings, worst)
