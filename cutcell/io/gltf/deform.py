"""Which joints deform, as a saved glTF document has it in the extras of its skins."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..deforming import KEY
from .container import Document


def store_deform(
    document: dict[str, Any],
    skins: Iterable[tuple[int, Sequence[int]]],
    deform: NDArray[np.bool_],
) -> None:
    """Store which joints deform. Shapes: deform (j,)."""
    for skin, joints in skins:
        extras = document["skins"][skin].setdefault("extras", {})
        if isinstance(extras, dict):  # glTF allows any value; another one is not ours to replace
            extras[KEY] = deform[list(joints)].tolist()


def read_deform(
    document: Document, skins: Mapping[int, Sequence[int]], count: int
) -> NDArray[np.int8]:
    """Return which of `count` joints deform, as `with_deform` takes it.

    A list that does not fit its skin is ignored with a warning: another program has changed the
    joints, or the list.
    """
    stored = np.full(count, -1, np.int8)
    for skin, joints in skins.items():
        extras = document.json["skins"][skin].get("extras")
        if not isinstance(extras, dict) or KEY not in extras:
            continue
        flags = extras[KEY]
        if (
            isinstance(flags, list)
            and len(flags) == len(joints)
            and all(isinstance(flag, bool) for flag in flags)
        ):
            stored[joints] = np.maximum(stored[joints], flags)
        else:
            document.warnings.append(
                f"{document.label('skins', skin)}: {KEY} in its extras is ignored; it is no list "
                f"of true or false for each of the {len(joints)} joints"
            )
    return stored
