"""Joints that may carry weight, chosen by a person."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from difflib import get_close_matches
from fnmatch import fnmatchcase

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
    if fresh and len(chosen):
        rig = rig.with_weights(None)
        chosen = deform_joints(rig.mesh, skeleton).deform.copy()
    for patterns, value in ((deform, True), (no_deform, False)):
        for pattern in patterns:
            chosen[_named(skeleton, pattern)] = value
    if len(chosen) and not chosen.any():
        raise ParameterError("no joint is left that may carry weight; choose fewer to leave out")
    return replace(rig, skeleton=replace(skeleton, deform=chosen))


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
