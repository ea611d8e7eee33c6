"""Result of the flat scene: its data."""

import json
from typing import Any

from cutcell.geodesics import BoneDistances
from cutcell.method import ANIMATION
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell_viewers.flat import flat_section
from cutcell_viewers.short_names import short_names

from ...derive.derived import Derived
from ...derive.jobs import DESCRIBING
from ...document.method import READABLE
from ...document.state import State
from ...looks.character import has_field

METHOD = ("connectivity", "winding_threshold", "orient")


def _inputs(state: State) -> tuple[Any, ...] | None:
    if state.rig is None:
        return None
    # A section that is replaced loses what a person has chosen in it.
    if state.lesson_task == "open" and state.binding is None and state.rig.skeleton.deform.any():
        return None
    return (
        state.rig,
        state.step,
        state.binding.distances if has_field(state) else None,
        state.joint,
        state.slice_axis,
        state.slice_position,
        state.graph_resolution or READABLE,
        *(getattr(state, name) for name in METHOD),
    )


def flat_data(
    rig: Rig,
    step: int,
    distances: BoneDistances | None,
    joint: int,
    axis: str,
    position: float,
    resolution: int,
    *options: Any,
    progress: Progress,
) -> str:
    """Return the data of the flat scene as JSON."""
    chosen = dict(zip(METHOD, options, strict=True))
    method = ANIMATION.with_options(resolution=resolution, **chosen)
    bones, bone = None, ""
    if distances is not None:
        bones = distances.bones.subset(distances.bones.joint == joint)
        bone = short_names(rig.skeleton.names)[joint]
    section = flat_section(rig, method, axis=axis, position=position, bones=bones)
    return json.dumps({"bone": bone, **section.data()})


RESULTS = (
    Derived(
        "flat_data",
        _inputs,
        flat_data,
        wanted=lambda state: bool(state.flat),
        # No step of the lesson shows the section of another one.
        keeps=lambda old, new: old[0] is new[0] and old[1] == new[1],
        slots=lambda state: DESCRIBING,
        failed=lambda session: session.state.param.update(flat=""),
    ),
)
