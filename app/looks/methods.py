"""Titles and weights of methods side by side."""

from typing import Any

from cutcell_lab.baselines import METHODS

from ..document.side_by_side import NOW, is_settings, title_of_settings
from ..document.state import State

TITLES = {
    NOW: "Current weights",
    "artist": "From file",
    "bbw": "Bounded biharmonic",
    "cutcell": "cutcell (paper)",
    "cutcell_any": "Cut-cell, any angle",
    "cutcell_rig": "cutcell (animation)",
    "visibility": "RigNet's distance",
    "voxel": "Voxel binding",
    "voxel_unirig": "Voxel binding, UniRig's",
}
"""Titles of methods; trained networks have their own, and others use their names."""


def title_of(name: str) -> str:
    """Return the title of a method."""
    if is_settings(name):
        return title_of_settings(name)
    title = getattr(METHODS.get(name), "title", None)
    return TITLES.get(name) or title or name.replace("_", " ").capitalize()


def shown_title(state: State, name: str) -> str:
    """Return the title of a method, or the caption that the step of a lesson gives it."""
    step = state.lesson_step
    return (step and step.captions.get(name)) or title_of(name)


def weights_of(state: State, name: str) -> Any:
    """Return the weights of a method, shape (n, j); None if they are not computed."""
    if name == NOW:
        return None if state.binding is None else state.binding.weights
    if name == "artist":
        return state.rig.weights
    result = state.compared.get(name)
    return None if result is None else result.weights
