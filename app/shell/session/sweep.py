"""Sweeps: the scenes of a film in which the wavefront or the cut runs from 0 to 1."""

from cutcell.runtime.progress import Progress, silent
from cutcell_viewers.description import Description

from ...document.state import State
from ...features.scenes import resolve
from ...looks.character import cut_of, has_field

SWEEPS = {"wave": "front", "cut": "cut_position"}
"""Choices of the page that the sweeps move."""
SECONDS = 6.0
REST = 1.0
"""Seconds without motion at the end of a film."""


def sweep_of(state: State) -> str | None:
    """Return the sweep that a state offers: the wavefront if it is shown, else the cut."""
    if state.panel == "distance" and state.wave and has_field(state):
        return "wave"
    return "cut" if has_cut(state) else None


def has_cut(state: State) -> bool:
    """Return whether a state's panel shows a cut that can be moved."""
    is_slice = state.panel == "graph" and state.slicing
    return state.open_panel.cuts and not is_slice and cut_of(state) is not None


def sweep_scenes(
    state: State, name: str, rate: int, progress: Progress = silent
) -> tuple[Description, ...]:
    """Return the scenes of a sweep of `SWEEPS`, one for each frame; the rate is per second."""
    count, moving = round(SECONDS * rate), round((SECONDS - REST) * rate)
    scenes = []
    for k in range(moving + 1):
        progress("describing the frames", k / moving)
        scenes.append(resolve(state.changed(**{SWEEPS[name]: k / moving})))
    return tuple(scenes + scenes[-1:] * (count - len(scenes)))
