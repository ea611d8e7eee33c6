"""Weights of a file: scaled to a sum of one, with the joints that they make deform."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import LocatedWarning
from ..rig import Part, Rig, Skeleton, TriangleMesh
from ..rig.deform_joints import deform_joints
from ..rig.deform_joints.choice import guess_warnings
from ..rig.names import is_neutral
from ..rig.rig import LARGE, normalised
from ..runtime.display import listed
from ..runtime.memory import check_matrix

STORED_SUM_TOLERANCE = 0.01
"""Sums of weights that are stored in 8 bits differ from one by up to this: three miss by 0.006."""
MATRIX_COPIES = 2
"""Copies of the matrix at a time, before and after its rows are scaled."""


class ReadWeights(NamedTuple):
    """Weights as they were read."""

    weights: NDArray[np.float64] | None
    """(n, j): rows sum to one or to zero. None if there are no weights."""
    warnings: tuple[str, ...]  # A sentence if some were left out
    sums: NDArray[np.float64] | None
    """(n,): what each row summed to in the file; NaN where a weight was left out."""


NO_WEIGHTS = ReadWeights(None, (), None)


def summed(
    rows: NDArray, columns: NDArray, values: NDArray, shape: tuple[int, int], owner: str
) -> ReadWeights:
    """Return the weight matrix of influences (k,), with rows that sum to one or to zero.

    A weight that is negative or not a finite number counts as none.
    """
    with np.errstate(invalid="ignore"):  # a signalling NaN becomes a quiet one
        values = values.astype(np.float64)
    good = np.isfinite(values) & (values >= 0)
    warnings: tuple[str, ...] = ()
    sums = np.zeros(shape[0])
    if not good.all():
        sums[rows[~good]] = np.nan
        bad = len(np.unique(rows[~good]))
        text = (
            f"{owner}: {bad:,} of {shape[0]:,} vertices {'has' if bad == 1 else 'have'} weights "
            "that are negative or not a number; these weights count as none"
        )
        warnings = (LocatedWarning(text, "invalid-weights"),)
        rows, columns, values = rows[good], columns[good], values[good]
    if values.max(initial=0) > LARGE:
        top = np.zeros(shape[0])
        np.maximum.at(top, rows, values)
        values = values / np.where(top > 0, top, 1)[rows]
    check_matrix(*shape, copies=MATRIX_COPIES)
    weights = np.zeros(shape)
    np.add.at(weights, (rows, columns), values)
    return ReadWeights(normalised(weights), warnings, sums + weights.sum(axis=1))


def sum_warnings(sums: NDArray | None, faces: NDArray, parts: Iterable[Part]) -> list[str]:
    """Count the vertices of faces whose weights sum to zero, or not to one, by their meshes."""
    if sums is None:
        return []
    is_used = np.zeros(len(sums), bool)
    is_used[faces] = True
    empty = is_used & (sums == 0)
    off = is_used & (sums > 0) & (np.abs(sums - 1) > STORED_SUM_TOLERANCE)
    warnings: list[str] = []
    nothing = "no weight, so that no joint moves them. Binding gives them some"
    scaled = "weights that do not sum to one. They are scaled so that they do"
    cases = (empty, nothing, "unweighted-vertices"), (off, scaled, "unnormalised-weights")
    for rows, what, code in cases:
        counts = {part.name: int(rows[part.vertices].sum()) for part in parts}
        names = listed([f"{name}: {count:,}" for name, count in counts.items() if count])
        if rows.any():
            verb = "has" if rows.sum() == 1 else "have"
            text = f"{rows.sum():,} of {is_used.sum():,} vertices ({names}) {verb} {what}"
            warnings.append(LocatedWarning(text, code))
    return warnings


DEFORM_KEY = "cutcell_deform"
"""Under which a saved file stores for each joint whether it deforms: a joint that got no weight
still does."""
FOLLOWED = 0.25
"""Weight that some vertex of the file must give to a joint for it to deform."""


def with_deform(
    mesh: TriangleMesh, skeleton: Skeleton, weights: NDArray | None, stored: NDArray | None = None
) -> tuple[Skeleton, NDArray[np.float64] | None, list[str]]:
    """Return the skeleton with the joints that deform, the weights, and warnings.

    Weights of Blender's stand-in are removed; `stored` (j,) is 1, 0 or -1 where the file is silent.
    """
    if not len(skeleton.joints):
        return skeleton, weights, []
    neutral = neutral_joints(skeleton)
    warnings: list[str] = []
    if weights is not None and weights[:, neutral].any():
        count = int((weights[:, neutral] > 0).any(axis=1).sum())
        text = (
            f"{count:,} of {len(weights):,} vertices had no weights in Blender, which gives such "
            f"vertices to {skeleton.listed(neutral)}: they count as without weight, and binding "
            "gives them new weights"
        )
        warnings.append(LocatedWarning(text, "unweighted-vertices"))
        weights = normalised(np.where(neutral, 0.0, weights))
    if stored is not None and neutral.any():
        stored = np.where(neutral, 0, stored)
    if stored is None or not (stored == 1).any():
        stored = np.full(len(neutral), -1)
    deform = stored == 1
    if (stored < 0).any():  # such as a skin that another program added
        inferred, more = _inferred(mesh, skeleton, weights)
        deform, warnings = np.where(stored < 0, inferred, deform), warnings + more
    marked_off = stored == 0
    if weights is not None and (weighted := marked_off & (weights > 0).any(axis=0)).any():
        warnings.append(
            f"{skeleton.listed(weighted)} have weight in the file, but the file marks them as "
            "not deforming: new weights give them none"
        )
    return replace(skeleton, deform=deform), weights, warnings


def loaded_rig(
    mesh: TriangleMesh,
    skeleton: Skeleton,
    read: ReadWeights,
    name: str,
    stored: NDArray[np.int8] | None = None,
    warnings: Iterable[str] = (),
    source: Any = None,
) -> Rig:
    """Return a rig of one part, with the joints that deform; see `with_deform`."""
    skeleton, weights, more = with_deform(mesh, skeleton, read.weights, stored)
    more += sum_warnings(read.sums, mesh.faces, [Part(name, slice(None))])
    notices = (*read.warnings, *warnings, *more)
    return Rig(
        mesh, skeleton, weights, name=name, warnings=notices, weight_sums=read.sums, source=source
    )


def neutral_joints(skeleton: Skeleton) -> NDArray[np.bool_]:
    """Return which joints are Blender's stand-in for vertices without weights, shape (j,)."""
    neutral = np.array([is_neutral(name) for name in skeleton.names], bool)
    return neutral & (not neutral.all())


def _inferred(
    mesh: TriangleMesh, skeleton: Skeleton, weights: NDArray[np.float64] | None
) -> tuple[NDArray[np.bool_], list[str]]:
    """Return which joints (j,) deform by the weights, else by names and places, and warnings."""
    total = 0.0 if weights is None else float(weights.sum())
    if weights is None or total == 0:
        guess = deform_joints(mesh, skeleton)
        return guess.deform, guess_warnings(skeleton, guess.deform, guess.doubtful)
    strongest = weights.max(axis=0)
    deform = strongest >= FOLLOWED * min(1.0, strongest.max())
    weak = ~deform & (strongest > 0)
    if not weak.any():
        return deform, []
    return deform, [
        f"no vertex follows {skeleton.listed(weak)} by {FOLLOWED:.0%} in the file: taken for "
        "helpers or controls, which get no weight"
    ]
