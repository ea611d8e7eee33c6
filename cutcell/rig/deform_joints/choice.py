"""Joints that may carry weight, chosen by a person."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from difflib import get_close_matches
from fnmatch import fnmatchcase

import numpy as np
from numpy.typing import NDArray

from ...errors import ParameterError
from ..names import folded
from ..rig import Rig
from ..skeleton import Skeleton
from .guess import deform_joints


def choose_deform(
    rig: Rig, deform: Sequence[str] = (), no_deform: Sequence[str] = (), *, fresh: bool = False
) -> Rig:
    """Return the same rig with other joints that may carry weight.

    Parameters
    ----------
    rig : Rig
    deform, no_deform : sequences of str
        Names of joints that shall, or shall not, carry weight. ``*`` and ``?`` stand for any
        letters and for one; upper and lower case are the same, and so are full and half width.
        A joint that both name carries none.
    fresh : bool
        Forget the file's weights first, and which joints they are of: `deform_joints` says.

    Returns
    -------
    Rig

    Raises
    ------
    ParameterError
        A name that no joint has, or no joint left that may carry weight.

    Examples
    --------
    >>> rig = cutcell.choose_deform(rig, no_deform=["*_IK", "Root"])  # doctest: +SKIP
    """
    skeleton = rig.skeleton
    chosen = skeleton.deform.copy()
    is_chosen = np.zeros(len(chosen), np.bool_)
    for patterns, value in ((deform, True), (no_deform, False)):
        for pattern in patterns:
            joints = _named(skeleton, pattern)
            chosen[joints], is_chosen[joints] = value, True
    if fresh and len(chosen):
        guess = deform_joints(rig.mesh, skeleton)
        chosen = np.where(is_chosen, chosen, guess.deform)
        warnings = guess_warnings(skeleton, chosen, guess.doubtful & ~is_chosen)
        rig = replace(rig.with_weights(None), warnings=(*rig.warnings, *warnings))
    if len(chosen) and not chosen.any():
        raise ParameterError("no joint is left that may carry weight; choose fewer to leave out")
    return replace(rig, skeleton=replace(skeleton, deform=chosen))


def guess_warnings(
    skeleton: Skeleton, deform: NDArray[np.bool_], doubtful: NDArray[np.bool_]
) -> list[str]:
    """Name the joints that were guessed to carry no weight, and the doubtful ones; (j,) each."""
    warnings = []
    if not deform.all():
        warnings.append(
            f"{(~deform).sum()} of {len(deform)} joints are taken for controls, end markers or "
            f"roots and get no weight: {skeleton.listed(~deform)}"
        )
    if doubtful.any():
        warnings.append(
            f"{doubtful.sum()} joints that may be controls or end markers get weight: "
            f"{skeleton.listed(doubtful)}; exclude those that move no skin by --no-deform, or by "
            "their switches on Weights"
        )
    return warnings


def _named(skeleton: Skeleton, pattern: str) -> list[int]:
    sought, names = folded(pattern), [folded(name) for name in skeleton.names]
    matches = [j for j, name in enumerate(names) if name == sought]
    # A name may hold what stands for other letters; then it means itself.
    matches = matches or [j for j, name in enumerate(names) if fnmatchcase(name, sought)]
    if not matches:
        near = get_close_matches(sought, names, 3, 0.4)
        close = [skeleton.names[names.index(name)] for name in near]
        hint = f"; did you mean {' or '.join(close)}?" if close else ""
        raise ParameterError(f'no joint is called "{pattern}"{hint}')
    return matches
