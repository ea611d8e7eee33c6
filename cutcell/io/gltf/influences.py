"""Weights as attributes of glTF, and which joints deform as extras of its skins."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...rig.rig import normalised
from ..weights import DEFORM_KEY
from .container import Document


def pack_influences(weights: NDArray) -> tuple[NDArray, NDArray]:
    """Sort influences of weights (n, j) into slots of four: joints and shares (s, n, 4)."""
    rounded = normalised(weights).astype(np.float32)
    # The heaviest takes the rounding error, where it matters least, before the influences are
    # sorted: so they are sorted the same way when they are loaded and saved again.
    rows, heaviest = np.arange(len(weights)), rounded.argmax(axis=1)
    largest = rounded[rows, heaviest].astype(np.float64)
    rest = 1 - rounded.sum(axis=1, dtype=np.float64)
    rounded[rows, heaviest] = np.where(largest > 0, largest + rest, 0)
    rows, columns = np.nonzero(rounded)
    return sorted_influences(rows, columns, rounded[rows, columns], len(weights))


def sorted_influences(
    rows: NDArray, columns: NDArray, values: NDArray, count: int, limit: int | None = None
) -> tuple[NDArray, NDArray]:
    """Sort influences (k,) into joints and shares in slots of four (s, count, 4), descending."""
    order = np.lexsort((-values, rows))
    rows, columns, values = rows[order], columns[order], values[order]
    slot = np.arange(len(rows)) - np.searchsorted(rows, rows)
    slots = min(int(slot.max(initial=0)) + 1, limit or len(rows) + 1)
    sets = -(-slots // 4)
    joints, shares = np.zeros((count, 4 * sets), int), np.zeros((count, 4 * sets), values.dtype)
    fits = slot < slots
    joints[rows[fits], slot[fits]] = columns[fits]
    shares[rows[fits], slot[fits]] = values[fits]
    in_slots = [one.reshape(-1, sets, 4).transpose(1, 0, 2) for one in (joints, shares)]
    return in_slots[0], in_slots[1]


def influence_attributes(
    influences: tuple[NDArray, NDArray], joints: int, is_wide: bool = False
) -> dict[str, NDArray]:
    """Return slots of four as attributes; joints have 16 bits if they must, or if `is_wide`."""
    number = "<u2" if is_wide or joints > 256 else "<u1"
    attributes = {}
    for n, (numbers, shares) in enumerate(zip(*influences, strict=True)):
        attributes[f"JOINTS_{n}"] = numbers.astype(number)
        attributes[f"WEIGHTS_{n}"] = shares.astype("<f4")
    return attributes


def is_influence(name: str) -> bool:
    """Return whether an attribute is of weights."""
    return name.startswith(("JOINTS_", "WEIGHTS_"))


def take_influences(attributes: dict[str, int]) -> dict[str, int]:
    """Remove JOINTS_n and WEIGHTS_n from attributes and return what they were."""
    return {name: attributes.pop(name) for name in list(attributes) if is_influence(name)}


def store_deform(
    document: dict[str, Any], skins: Iterable[tuple[int, Sequence[int]]], deform: NDArray[np.bool_]
) -> None:
    """Store which joints deform. Shapes: deform (j,)."""
    for skin, joints in skins:
        extras = document["skins"][skin].setdefault("extras", {})
        if isinstance(extras, dict):  # glTF allows any value; another one is not ours to replace
            extras[DEFORM_KEY] = deform[list(joints)].tolist()


def read_deform(
    document: Document, skins: Mapping[int, Sequence[int]], count: int
) -> NDArray[np.int8]:
    """Return which of `count` joints deform, as `with_deform` takes it, and warn of misfits."""
    stored = np.full(count, -1, np.int8)
    for skin, joints in skins.items():
        extras = document.json["skins"][skin].get("extras")
        if not isinstance(extras, dict) or DEFORM_KEY not in extras:
            continue
        flags = extras[DEFORM_KEY]
        if isinstance(flags, list) and [type(flag) for flag in flags] == [bool] * len(joints):
            stored[joints] = np.maximum(stored[joints], flags)
        else:
            document.warnings.append(
                f"{document.label('skins', skin)}: {DEFORM_KEY} in its extras is ignored; it is no "
                f"list of true or false for each of the {len(joints)} joints"
            )
    return stored
