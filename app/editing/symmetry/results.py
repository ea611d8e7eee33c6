"""The map of symmetry: the difference of weights between each vertex and its mirror image."""

from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from cutcell.errors import MeshError, SkeletonError
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress

from ...derive.derived import Derived
from ...document.state import State
from ...server.messages import visible_text
from .asymmetry import MirrorImage, asymmetry, mirror_image


@dataclass(frozen=True, eq=False)
class Asymmetry:
    """How far weights are from those of the mirror image.

    Parameters
    ----------
    weights : array, shape (n, j)
        The weights that it is of.
    values : array, shape (n,)
        See `asymmetry`.
    """

    weights: NDArray
    values: NDArray


def is_wanted(state: State) -> bool:
    """Return whether the map is what colours the character."""
    return state.weights_shown == "symmetry" and state.panel in ("weights", "pose")


def _image_inputs(state: State) -> tuple[Any, ...] | None:
    rig = state.rig
    return None if rig is None or state.bare else (rig.mesh, rig.skeleton, rig.partners)


def _image(
    mesh: Any, skeleton: Any, partners: Any, rig: Rig, progress: Progress
) -> MirrorImage | str:
    try:
        return mirror_image(rig, progress)
    except (MeshError, SkeletonError) as error:
        return visible_text(str(error))


def _inputs(state: State) -> tuple[Any, ...] | None:
    image = state.mirror_image
    source = state.rig if state.weights_of == "file" else state.binding
    is_there = source is not None and (source is state.binding or source.weights is not None)
    return (image, source) if isinstance(image, MirrorImage) and is_there else None


def _asymmetry(image: MirrorImage, source: Any, progress: Progress) -> Asymmetry:
    return Asymmetry(source.weights, asymmetry(source.weights, image, progress))


RESULTS = (
    Derived(
        "mirror_image", _image_inputs, _image, more=lambda state: (state.rig,), wanted=is_wanted
    ),
    Derived(
        "asymmetry",
        _inputs,
        _asymmetry,
        wanted=is_wanted,
        after=("mirror_image", "binding"),
        keeps=lambda old, new: old[0] is new[0],
    ),
)
