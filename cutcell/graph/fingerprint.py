"""Fingerprints of what graphs and distances were computed from, so that others are refused."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError
from ..method import Method
from ..rig import Skeleton, TriangleMesh

Fingerprint = Mapping[str, Any]
"""Hashes of arrays, as bytes, and values of options, by name."""


def mesh_fingerprint(mesh: TriangleMesh) -> dict[str, Any]:
    """Return the fingerprint of a mesh."""
    return {"vertices": _digest(mesh.vertices), "faces": _digest(mesh.faces)}


def graph_fingerprint(mesh: TriangleMesh, method: Method) -> dict[str, Any]:
    """Return the fingerprint of the graph of a mesh by a method."""
    options = ("resolution", "connectivity", "winding_threshold", "orient")
    return mesh_fingerprint(mesh) | {name: getattr(method, name) for name in options}


def skeleton_fingerprint(skeleton: Skeleton) -> dict[str, Any]:
    """Return the fingerprint of the bones of a skeleton."""
    return {
        "joints": _digest(skeleton.joints),
        "parents": _digest(skeleton.parents),
        "deforming joints": _digest(skeleton.deform),
        "joint orientations": _digest(skeleton.orientations),
    }


def distance_fingerprint(
    skeleton: Skeleton, method: Method, allowed: NDArray[np.bool_] | None
) -> dict[str, Any]:
    """Return what distances depend on besides their graph."""
    options = {"samples": method.samples, "leaf": method.leaf}
    allowed = None if allowed is None or allowed.all() else allowed
    return skeleton_fingerprint(skeleton) | options | {"permitted joints": _digest(allowed)}


def require_same(what: str, actual: Fingerprint, expected: Fingerprint) -> None:
    """Raise a `ParameterError` that names what differs from the expected entries."""
    if not actual:
        raise ParameterError(f"{what} changed after it was computed; leave it out")
    differences = [
        f"other {name}"
        if isinstance(value, bytes | None)
        else f"{name}={actual.get(name)!r}, expected {value!r}"
        for name, value in expected.items()
        if actual.get(name) != value
    ]
    if differences:
        raise ParameterError(
            f"{what} does not fit: {'; '.join(differences)}. Leave it out, and it is computed"
        )


def _digest(array: NDArray[Any] | None) -> bytes | None:
    """Hash an array; -0 counts as 0."""
    if array is None:
        return None
    data = np.ascontiguousarray(array + 0 if array.dtype.kind == "f" else array)
    return hashlib.blake2b(repr((data.dtype.str, data.shape)).encode() + data.tobytes()).digest()
