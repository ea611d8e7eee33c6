"""Fingerprints of what graphs and distances were computed from, so that others are refused."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError
from ..method import DistanceOptions, GraphOptions, Method
from ..rig import Skeleton, TriangleMesh

Fingerprint = Mapping[str, Any]
"""Hashes of arrays, as bytes, and values of options, by name."""
APPROXIMATE: Fingerprint = {"approximate": True}
"""Of distances while joints are moved: they equal no others."""
NEAREST = 3
"""Default number of bones that a vertex without a path follows."""

AT_LEAST = ("nearest joints", "within")
"""Entries of which more is as good: what is measured from more joints, or farther."""


def mesh_fingerprint(mesh: TriangleMesh) -> dict[str, Any]:
    """Return the fingerprint of a mesh."""
    return _digests("mesh", mesh)


def graph_fingerprint(
    mesh: TriangleMesh, method: Method, rays: str = "raster", winding: str = "exact"
) -> dict[str, Any]:
    """Return the fingerprint of the graph of a mesh by a method."""
    options = {
        name: getattr(method, name) for name in ("resolution", *GraphOptions.__annotations__)
    }
    return mesh_fingerprint(mesh) | options | {"rays": rays, "winding": winding}


def skeleton_fingerprint(skeleton: Skeleton) -> dict[str, Any]:
    """Return the fingerprint of a skeleton. Names count: they decide about bones."""
    return _digests("skeleton", skeleton)


def distance_fingerprint(
    skeleton: Skeleton, method: Method, allowed: NDArray[np.bool_] | None, nearest: int = NEAREST
) -> dict[str, Any]:
    """Return what distances depend on besides their graph and how far they are measured."""
    options = {name: getattr(method, name) for name in DistanceOptions.__annotations__}
    allowed = None if allowed is None or allowed.all() else allowed
    permitted = {"permitted joints": _digest(allowed)}
    return skeleton_fingerprint(skeleton) | options | permitted | {"nearest": nearest}


def measured_fingerprint(nearest_joints: int | None, within: float) -> dict[str, float]:
    """Return from how many joints, None for all, and how far distances are measured."""
    if nearest_joints is None:
        return dict.fromkeys(AT_LEAST, np.inf)
    return dict(zip(AT_LEAST, (nearest_joints, within), strict=True))


def require_same(what: str, actual: Fingerprint, expected: Fingerprint) -> None:
    """Raise a `ParameterError` that names what differs from the expected entries."""
    if not actual:
        raise ParameterError(f"{what} changed after it was computed; leave it out")
    if actual == APPROXIMATE:
        raise ParameterError(f"{what} are approximate, of joints that were moved; leave them out")
    differences = [
        f"other {name}"
        if isinstance(value, bytes | None)
        else f"{name}={actual.get(name)!r}, expected {value!r}"
        for name, value in expected.items()
        if actual.get(name) != value and not (name in AT_LEAST and actual.get(name, 0) > value)
    ]
    if differences:
        raise ParameterError(
            f"{what} does not fit: {'; '.join(differences)}. Leave it out, and it is computed"
        )


def _digests(what: str, data: Any) -> dict[str, bytes | None]:
    """Hash each field of a mesh or a skeleton."""
    return {f"{what} {field.name}": _digest(getattr(data, field.name)) for field in fields(data)}


def _digest(array: Any) -> bytes | None:
    """Hash an array, or names; -0 counts as 0."""
    if array is None:
        return None
    if isinstance(array, tuple):
        return hashlib.blake2b(repr(array).encode()).digest()
    data = np.ascontiguousarray(array + 0 if array.dtype.kind == "f" else array)
    return hashlib.blake2b(repr((data.dtype.str, data.shape)).encode() + data.tobytes()).digest()
