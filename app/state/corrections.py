"""What a person corrects of the binding, and its form in an address."""

from __future__ import annotations

import base64
import binascii
import zlib
from dataclasses import replace
from typing import Any

import numpy as np
import param

from cutcell.corrections import Corrections, JointCorrection
from cutcell.errors import CutcellError
from cutcell.rig import Rig

MOST_IN_ADDRESS = 1500
"""Letters: longer addresses are cut by some programs that pass them on."""
MOST_BYTES = 4 * 2**20
"""Of corrections as JSON: some characters are overruled vertex by vertex."""


class CorrectionsChoices(param.Parameterized):
    """What is corrected of the character that stands there."""

    corrections: Any = param.Parameter(Corrections(), doc="A cutcell.Corrections.")
    own_deform: Any = param.Parameter(
        None, doc="Which joints may carry weight where nothing is corrected: an array, or None."
    )
    part: Any = param.Integer(
        None, allow_None=True, doc="A vertex of the connected component that is looked at."
    )


def applied(rig: Rig, own_deform: Any, corrections: Corrections) -> Rig:
    """Return a rig with the joints that may carry weight by the corrections.

    Raises
    ------
    SkeletonError
        None would be left.
    """
    deform = np.array(rig.skeleton.deform if own_deform is None else own_deform)
    for joint, name in enumerate(rig.skeleton.names):
        one = corrections.joints.get(name)
        if one is not None and one.deform is not None:
            deform[joint] = one.deform
    if np.array_equal(deform, rig.skeleton.deform):
        return rig
    return replace(rig, skeleton=replace(rig.skeleton, deform=deform))


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
    packed = zlib.compress(corrections.to_json().encode(), 9)
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
