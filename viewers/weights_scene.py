"""The character coloured by its weights: of one joint, or of all at once."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from cutcell.rig import Rig

from .character import character
from .description import Description, Legend, Reading
from .joint_colors import colors_of
from .palette import SELECTION_COLORS, UNREACHED, colormap, to_bytes
from .short_names import short_names

MIXED = "Each bone's colour, mixed by weight"
WEIGHT_SCALES = ("linear", "log", "limit")
DECADES = 3
"""Powers of ten that the logarithmic scale shows."""
FAINTEST = 0.4
"""Place in the colour map of a weight at the limit, where all above it is to be seen."""
DOMINANT = "Dominant bone"


def weights_scene(
    rig: Rig,
    weights: ArrayLike,
    joint: int | None = None,
    *,
    skeleton: bool = True,
    chosen: int | None = None,
    **style: Any,
) -> Description:
    """Return the scene of a weight matrix.

    Parameters
    ----------
    rig : Rig
    weights : array_like, shape (n, j)
    joint : int, optional
        Show this joint's weights, from grey (none) to dark red (all). By default every joint
        has a colour, and each vertex their mixture, the strongest foremost.
    skeleton : bool
        Whether the bones are visible.
    chosen : int, optional
        The highlighted joint; `joint` by default.
    **style
        Other fields of the body's `Actor`.
    """
    colors, legend = weight_colors(rig, weights, joint)
    actors = character(
        rig,
        weights,
        joint if chosen is None else chosen,
        skeleton,
        colors_of(rig) if joint is None else None,
        **colors,
        **style,
    )
    return Description(actors, legend=legend)


def weight_colors(
    rig: Rig,
    weights: ArrayLike,
    joint: int | None = None,
    branch: bool = False,
    scale: str = "linear",
    limit: float = 0.05,
) -> tuple[dict[str, Any], Legend]:
    """Return the fields of the body's `Actor` that colour it, and how to read them.

    The weight of a branch is the sum over the joint and all joints below it. A joint's weight is
    shown as it is, by its logarithm, or where it is above a limit: `scale` is one of
    `WEIGHT_SCALES`.
    """
    if joint is not None:
        name = short_names(rig.skeleton.names)[joint] + " and below" * branch
        columns = rig.skeleton.subtree[joint] if branch else [joint]
        values = columns_of(weights, columns).sum(axis=1).astype(np.float32)
        title, low = f"Weight of {name}", "0"
        scalars: NDArray[Any] = values
        if scale == "log":
            low = f"\N{LESS-THAN OR EQUAL TO} {10.0**-DECADES:g}"
            shown = np.log10(np.maximum(values, 10.0**-DECADES), dtype=np.float32)
            scalars = 1 + shown / DECADES
        elif scale == "limit":
            title, low = f"{title} above {limit:.3g}", "0"
            scalars = np.where(values > limit, FAINTEST + (1 - FAINTEST) * values, 0)
        reading = Reading(f"{name} ", None if scalars is values else values)
        style = {"scalars": scalars, "colormap": "weight", "reading": reading}
        return style, Legend(title, "weight", low, "1")
    colors = to_bytes(np.clip(_mixed(rig, csr_array(weights)), 0, 1))
    return {"colors": colors, "reading": _dominant(rig, weights)}, Legend(MIXED)


def columns_of(weights: ArrayLike | csr_array, columns: ArrayLike) -> NDArray[np.float64]:
    """Return the weights of some joints as an array (n, c); weights (n, j) may be sparse."""
    if isinstance(weights, csr_array):
        return np.asarray(weights[:, np.asarray(columns)].toarray())
    return np.asarray(weights)[:, np.asarray(columns)]


def _mixed(rig: Rig, weights: csr_array) -> NDArray[np.float64]:
    """Mix the colours of joints by vertex; most weights are zero, and cost nothing."""
    count, joint = weights.shape[0], weights.indices
    vertex = np.repeat(np.arange(count), np.diff(weights.indptr))
    # Many small weights mix to grey; a power lets the strongest show its colour.
    strong = np.square(np.square(weights.data))
    total = np.bincount(vertex, strong, count)[:, None]
    channels = colors_of(rig).T
    mixed = [np.bincount(vertex, strong * channel[joint], count) for channel in channels]
    blended = np.stack(mixed, axis=1) / np.where(total > 0, total, 1)
    return np.where(total > 0, blended, UNREACHED)


def dominant_colors(rig: Rig, weights: ArrayLike) -> tuple[dict[str, Any], Legend]:
    """Colour each vertex by its dominant joint; see `weight_colors`."""
    reading = _dominant(rig, weights)
    colors = to_bytes(colors_of(rig))
    assert reading.values is not None
    style = {"colors": colors[reading.values.astype(int)], "reading": reading}
    return style, Legend(DOMINANT)


def count_colors(rig: Rig, weights: ArrayLike) -> tuple[dict[str, Any], Legend]:
    """Colour each vertex by its number of influences; see `weight_colors`."""
    count = np.asarray((csr_array(weights) > 0).sum(axis=1)).astype(np.float32)
    most = max(int(count.max(initial=1)), 2)
    legend = Legend("Influences", "count", "1", f"{most}")
    style = {"scalars": count, "colormap": "count", "limits": (1.0, float(most))}
    return {**style, "reading": Reading("joints: ")}, legend


def difference_colors(
    rig: Rig, weights: ArrayLike, other: ArrayLike
) -> tuple[dict[str, Any], Legend]:
    """Colour each vertex by the weight that differs from the file's; see `weight_colors`."""
    moved = np.abs(np.asarray(weights, np.float32) - np.asarray(other, np.float32)).sum(axis=1) / 2
    legend = Legend("Difference to the file's weights", "error", "0%", "100%")
    style = {"scalars": moved.astype(np.float32), "colormap": "error", "limits": (0.0, 1.0)}
    return {**style, "reading": Reading("Weights differ from the file's by ", percent=True)}, legend


def symmetry_colors(values: NDArray[np.float64]) -> tuple[dict[str, Any], Legend]:
    """Colour each vertex by the difference to its mirror image, (n,); nan where it has none."""
    legend = Legend("Difference to the mirror image", "error", "0%", "100%")
    has_image, table = np.isfinite(values), colormap("error")
    shown = np.where(has_image, values, 0.0).astype(np.float32)
    colors = table[np.round(shown * (len(table) - 1)).astype(int)]
    if not has_image.all():
        colors[~has_image] = to_bytes(UNREACHED)
        legend = replace(legend, swatches=((UNREACHED, "no mirror image"),))
    reading = Reading("Differs from its mirror image by ", shown, percent=True)
    return {"colors": colors, "reading": reading}, legend


def mask_colors(strengths: NDArray[np.float64], name: str) -> tuple[dict[str, Any], Legend]:
    """Colour each vertex by the strength of a layer's mask, (n,)."""
    style = {"scalars": strengths.astype(np.float32), "colormap": "weight", "limits": (0.0, 1.0)}
    return {**style, "reading": Reading("Mask ")}, Legend(f"Mask of {name}", "weight", "0", "1")


def selections_colors(
    selections: Mapping[str, NDArray[np.intp] | None], count: int
) -> tuple[dict[str, Any], Legend]:
    """Colour each of `count` vertices by the last selection that it is in; None is all of them."""
    number = np.full(count, -1)
    for k, vertices in enumerate(selections.values()):
        number[slice(None) if vertices is None else vertices] = k
    table = [SELECTION_COLORS[k % len(SELECTION_COLORS)] for k in range(len(selections))]
    sizes = [count if vertices is None else len(vertices) for vertices in selections.values()]
    swatches = [
        (color, f"{name}: {size:,}")
        for color, name, size in zip(table, selections, sizes, strict=True)
    ]
    reading = Reading("", number + 1, ("in none", *selections))
    style = {"colors": to_bytes(np.array([*table, UNREACHED]))[number], "reading": reading}
    return style, Legend("Saved selections", swatches=tuple(swatches))


def bone_difference_colors(
    rig: Rig, weights: ArrayLike, truth: ArrayLike, joint: int, names: tuple[str, str]
) -> tuple[dict[str, Any], Legend]:
    """Colour each vertex by a joint's weight in one matrix minus that in another.

    `names` are those of the two matrices; see `weight_colors`.
    """
    name = short_names(rig.skeleton.names)[joint]
    change = (np.asarray(weights)[:, joint] - np.asarray(truth)[:, joint]).astype(np.float32)
    title = f"Weight of {name}: {names[0]} minus {names[1]}"
    legend = Legend(title, "difference", "\N{MINUS SIGN}1", "+1")
    style = {"scalars": change, "colormap": "difference", "limits": (-1.0, 1.0)}
    return {**style, "reading": Reading(f"{name} ")}, legend


def _dominant(rig: Rig, weights: ArrayLike) -> Reading:
    rows = csr_array(weights)
    count, joints = rows.shape
    vertex = np.repeat(np.arange(count), np.diff(rows.indptr))
    largest, dominant = np.zeros(count), np.full(count, joints)
    np.maximum.at(largest, vertex, rows.data)
    best = rows.data == largest[vertex]
    np.minimum.at(dominant, vertex[best], rows.indices[best])  # of equal ones the first
    return Reading("", np.where(largest > 0, dominant, 0), rig.skeleton.names)
