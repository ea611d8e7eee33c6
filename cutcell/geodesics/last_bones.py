"""How long the last bone of a chain is, which no file tells."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from .bones import Bones
from .chains import SAME_PLACE, Chains
from .probe import BodyProbe

PART_OF_WAY = 0.5
"""A bone along a rest axis ends half way to where the body does: skin beyond is near its end."""
LEAST_CELLS = 2.0
"""Lattice cells: such a bone is at least this long if the body is still near there. Shorter ones
hardly point anywhere."""
UNDER_SKIN = 0.35
"""A joint lies close under the skin if that is nearer than this part of the room around it."""
LEAST_ROOM = 1.5
"""Lattice cells: with less room than this nothing can be said."""


def last_bone_lengths(
    bones: Bones, tip: NDArray[np.bool_], chains: Chains, way: NDArray[np.float64], probe: BodyProbe
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Measure how long the last bones are.

    Each goes on until it leaves the body, or until it comes nearer, through the body, to the
    bone of another joint than to its own joint: a jaw does not run on through the skull.

    Parameters
    ----------
    bones : Bones
        All of them, those of tips up to where they leave the body.
    tip : array, shape (b,), bool
        Which are the t last bones.
    chains : Chains
    way : array, shape (t,)
        How far each last bone can go until it leaves the body.
    probe : BodyProbe

    Returns
    -------
    length : array, shape (t,)
    told : array, shape (t,), bool
        Those that point along the joints' rest axis.
    """
    joint = bones.joint[tip]
    place, onward = chains.joints[joint], chains.onward[joint]
    length = probe.way_to_others(place, onward, way, _others(bones, tip, joint, place))
    if chains.rest is None:
        return length, np.zeros(len(joint), np.bool_)
    length *= PART_OF_WAY
    least = LEAST_CELLS / probe.resolution
    told = probe.near(place + onward * least) | (length > least)
    return np.where(told, np.maximum(length, least), length), told


def _others(
    bones: Bones, tip: NDArray[np.bool_], joints: NDArray[np.int32], places: NDArray[np.float64]
) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Give for each joint the bones of others that do not lead to it; of tips, their start."""
    end = np.where(tip[:, None], bones.start, bones.end)
    for joint, place in zip(joints, places, strict=True):
        leads_here = np.abs(bones.end - place).max(axis=1) < SAME_PLACE
        other = (bones.joint != joint) & ~leads_here
        yield bones.start[other], end[other]


def moves_what_is_near(places: NDArray[np.float64], probe: BodyProbe) -> NDArray[np.bool_]:
    """Tell which last joints (t, 3) lie close under the skin of something large, among others.

    So do the joints of a face. Each moves the skin about it, not half a head: it has no bone.
    """
    room = probe.room(places)
    apart = cdist(places, places)
    nearby = ((apart > SAME_PLACE) & (apart < room[:, None])).any(axis=1)
    close = probe.to_skin(places) < UNDER_SKIN * room
    return nearby & close & (room > LEAST_ROOM / probe.resolution)
