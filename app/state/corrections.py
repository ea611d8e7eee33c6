"""What a person corrects of the binding, and its form in an address."""

from __future__ import annotations

import base64
import binascii
import zlib
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import param

from cutcell.corrections import Corrections, JointCorrection
from cutcell.errors import CutcellError
from cutcell.rig import Rig, Skeleton
from cutcell.skinning import Binding

MOST_IN_ADDRESS = 1500
"""Letters: longer addresses are cut by some programs that pass them on."""
MOST_VERTICES = 300
"""Overruled ones: more are not even tried to be written so short, which takes a while."""
MOST_BYTES = 4 * 2**20
"""Of corrections as JSON: some characters are overruled vertex by vertex."""


class CorrectionsChoices(param.Parameterized):
    """What is corrected of the character that stands there."""

    corrections: Any = param.Parameter(Corrections(), doc="A cutcell.Corrections.")
    own_skeleton: Any = param.Parameter(
        None, doc="Where the joints are, and which may carry weight, where nothing is corrected."
    )
    joint_handle: Any = param.Boolean(False, label="Move it in the scene")
    mirrored: Any = param.Boolean(True, label="The other side moves along")
    dragged: Any = param.Parameter(
        None, doc="A `Dragged` while joints are on their way, which the corrections do not tell."
    )
    part: Any = param.Integer(
        None, allow_None=True, doc="A vertex of the connected component that is looked at."
    )


@dataclass(frozen=True, eq=False)
class Dragged:
    """What is seen while joints are dragged.

    Parameters
    ----------
    rig : Rig
        With the joints where the pointer has them.
    binding : Binding
        The newest that there is; of joints where they were a moment ago.
    """

    rig: Rig
    binding: Binding


def applied(rig: Rig, own: Skeleton | None, corrections: Corrections) -> Rig:
    """Return a rig with joints where the corrections put them, and those that may carry weight.

    Parameters
    ----------
    rig : Rig
        Corrected or not.
    own : Skeleton or None
        As it is where nothing is corrected; the rig's when left out.
    corrections : Corrections

    Raises
    ------
    SkeletonError
        None would be left, or one stands too far from the mesh.
    """
    own = rig.skeleton if own is None else own
    deform, joints = own.deform.copy(), own.joints.copy()
    for joint, name in enumerate(rig.skeleton.names):
        one = corrections.joints.get(name)
        if one is not None and one.deform is not None:
            deform[joint] = one.deform
        if one is not None and one.position is not None:
            joints[joint] = one.position
    if not np.array_equal(deform, rig.skeleton.deform):
        rig = replace(rig, skeleton=replace(rig.skeleton, deform=deform))
    return rig.with_joints(joints)


def measured(corrections: Corrections) -> Corrections:
    """Return the part of corrections that distances, or weights of many joints, depend on.

    Locks, glue and overruled vertices are applied to the weights that come of it.
    """
    joints = {name: replace(one, locked=False) for name, one in corrections.joints.items()}
    parts = {v: part for v, part in corrections.parts.items() if part.how == "itself"}
    return tidy(Corrections(joints, parts))


def tidy(corrections: Corrections) -> Corrections:
    """Return corrections without those of joints that correct nothing."""
    nothing = JointCorrection()
    joints = {name: one for name, one in corrections.joints.items() if one != nothing}
    return replace(corrections, joints=joints)


def news(state: Any, choices: dict[str, Any]) -> dict[str, Any]:
    """Return what of some choices the state does not hold; param takes the same for new."""
    large = {name: getattr(state, name) for name in ("rig", "corrections")}
    return {
        name: value
        for name, value in choices.items()
        if name not in large or not (value is large[name] or value == large[name])
    }


def to_text(corrections: Corrections) -> str:
    """Return corrections in letters that an address may hold."""
    packed = zlib.compress(corrections.to_json(indent=None).encode(), 9)
    return base64.urlsafe_b64encode(packed).decode().rstrip("=")


def from_text(text: str) -> Corrections:
    """Read what `to_text` returns.

    Raises
    ------
    ValueError
        It is something else.
    """
    try:
        packed = base64.urlsafe_b64decode(text + "=" * (-len(text) % 4))
        plain = zlib.decompressobj().decompress(packed, MOST_BYTES)
        return Corrections.from_json(plain.decode())
    except (binascii.Error, zlib.error, UnicodeDecodeError, CutcellError) as error:
        raise ValueError(str(error)) from None
