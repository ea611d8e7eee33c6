"""Addresses of the page, as choices of a picture."""

from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlsplit

from cutcell.errors import ParameterError
from cutcell_viewers.camera import Camera

from ..document.address import camera_of, from_query, numbers_of, simple, with_scene
from ..document.method import GRAPH, WEIGHTS, effective
from ..features.state import PageState

REPLACED = {
    "shown": ("weights_shown",), "error": ("heat", "compare_field"), "turn": ("turns",),
    "skeleton": ("skeleton",), "bone": ("weights_shown", "compare_field"),
}  # fmt: skip
"""Choices of the page that options of the command replace."""


@dataclass(frozen=True)
class Address:
    """Content of an address.

    Parameters
    ----------
    choices : dict
        Fields of `Choices`: "panel", "bone" and "methods", where it has them.
    settings : dict
        Choices of the page, all of them, as the address says or as they are at first.
    method : dict
        Options of the method that are not as at first.
    camera : Camera, optional
    """

    choices: dict[str, Any] = field(default_factory=dict)
    settings: dict[str, Any] = field(default_factory=dict)
    method: dict[str, Any] = field(default_factory=dict)
    camera: Camera | None = None

    def without(self, options: list[str]) -> "Address":
        """Return an address without the entries that options of the command replace."""
        replaced = {*options, *(name for one in options for name in REPLACED.get(one, ()))}

        def rest(part: dict[str, Any]) -> dict[str, Any]:
            return {name: value for name, value in part.items() if name not in replaced}

        return Address(rest(self.choices), rest(self.settings), rest(self.method), self.camera)


def read_address(text: str) -> Address:
    """Return the content of a page's address, or of its part after the question mark.

    The character that it names is not opened.

    Raises
    ------
    ParameterError
        It has unknown entries, or entries that cannot be drawn.
    """
    state = PageState()
    query = with_scene(urlsplit(text).query if "?" in text else text, state)
    page, arrival, problems = from_query(query, state)
    problems += [name for name in ("edits", "repairs") if name in arrival]
    if problems:
        raise ParameterError(f"the address has entries that cannot be drawn: {', '.join(problems)}")
    options = {name: page.pop(name) for name in (*GRAPH, *WEIGHTS) if name in page}
    plain = {n: p.default for n, p in simple(state).items() if n not in (*GRAPH, *WEIGHTS, "panel")}
    choices = {"panel": page.pop("panel")} if "panel" in page else {}
    choices |= {name: arrival[name] for name in ("bone", "methods") if name in arrival}
    moment: dict[str, Any] = {
        n: arrival[n] for n in ("vertex", "turns", "clip", "minus") if n in arrival
    }
    camera = camera_of(arrival["camera"]) if "camera" in arrival else None
    method = effective({"falloff": state.falloff, **options})
    return Address(choices, {**plain, **page, **moment}, method, camera)


def read_camera(text: str) -> Camera:
    """Return a camera as addresses write it: the position of the eye, and its target."""
    try:
        return camera_of(numbers_of(text))
    except ValueError:
        raise ParameterError(
            f'camera must be six numbers, such as 0,1,4,0,1,0, not "{text}"'
        ) from None
