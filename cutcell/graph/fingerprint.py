"""Fingerprints of what graphs and distances were computed from, so that others are refused."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError
from ..method import STAGE_OPTIONS, Method
from ..rig import Skeleton, TriangleMesh

Fingerprint = Mapping[str, Any]
"""Hashes of arrays, as bytes, and values of options, by name."""
APPROXIMATE: Fingerprint = {"approximate": True}
"""Of distances while joints are moved: they equal no others."""
AT_LEAST = ("nearest joints", "within")
"""Entries of which more is as good: what is measured from more joints, or farther."""


def data_fingerprint(*data: TriangleMesh | Skeleton) -> dict[str, Any]:
    """Return the fingerprint of all fields. Names count: they decide about bones."""
    return {
        f"{type(one).__name__} {field.name}": _digest(getattr(one, field.name))
        for one in data
        for field in fields(one)
    }


def option_fingerprint(method: Method, stage: str) -> dict[str, Any]:
    """Return the values of the options that a stage follows."""
    return {name: getattr(method, name) for name in STAGE_OPTIONS[stage]}


def graph_fingerprint(
    mesh: TriangleMesh, method: Method, rays: str = "raster", winding: str = "exact"
) -> dict[str, Any]:
    """Return the fingerprint of the graph of a mesh by a method."""
    options = option_fingerprint(method, "graph")
    return data_fingerprint(mesh) | options | {"rays": rays, "winding": winding}


def distance_fingerprint(
    skeleton: Skeleton,
    method: Method,
    allowed: NDArray[np.bool_] | None,
    nearest_joints: int | None = 1,
    within: float = 1.0,
    nearest: int = 3,
) -> dict[str, Any]:
    """Return what distances depend on besides their graph, see `bone_distances`."""
    options = option_fingerprint(method, "distances")
    allowed = None if allowed is None or allowed.all() else allowed
    measured = dict(zip(AT_LEAST, (nearest_joints or np.inf, within), strict=True))
    own = options | measured | {"nearest": nearest, "permitted joints": _digest(allowed)}
    return data_fingerprint(skeleton) | own


def require_same(what: str, actual: Fingerprint, expected: Fingerprint) -> None:
    """Raise a `ParameterError` that names what differs from the expected entries."""
    if not actual:
        raise ParameterError(f"{what} changed after it was computed; leave it out")
    if actual == APPROXIMATE:
        raise ParameterError(f"{what} are approximate, of joints that were moved; leave them out")
    if different := differences(actual, expected):
        raise ParameterError(
            f"{what} does not fit: {'; '.join(different)}. Leave it out, and it is computed"
        )


def differences(actual: Fingerprint, expected: Fingerprint) -> list[str]:
    """Name what differs from the expected entries."""
    return [
        f"other {name}"
        if isinstance(value, bytes | None)
        else f"{name}={actual.get(name)!r}, expected {value!r}"
        for name, value in expected.items()
        if actual.get(name) != value and not (name in AT_LEAST and actual.get(name, 0) > value)
    ]


def _digest(array: Any) -> bytes | None:
    """Hash an array, or names; -0 counts as 0."""
    if array is None:
        return None
    if isinstance(array, tuple):
        return hashlib.blake2b(repr(array).encode()).digest()
    data = np.ascontiguousarray(array + 0 if array.dtype.kind == "f" else array)
    return hashlib.blake2b(repr((data.dtype.str, data.shape)).encode() + data.tobytes()).digest()
