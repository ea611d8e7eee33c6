"""Addresses of the page, as choices of a picture."""

from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlsplit

from cutcell.errors import ParameterError
from cutcell_viewers.camera import Camera

from ..state import State
from ..state.method import GRAPH, WEIGHTS, effective
from ..state.tour import TOUR
from ..state.url import CAMERA, from_query, simple

UNSEEN = ("corrections",)
"""Parts of an address that no picture follows."""
OPTIONS = {
    "shown": ("weights_shown",), "error": ("heat", "compare_field"), "turn": ("turns",),
    "skeleton": ("skeleton",), "bone": ("weights_shown", "compare_field"),
}  # fmt: skip
"""Choices of the page that correspond to options of the command."""


@dataclass(frozen=True)
class Address:
    """Content of an address.

    Parameters
    ----------
    panel, bone : str, optional
    methods : list of str
    settings : dict
        Choices of the page, all of them, as the address says or as they are at first.
    method : dict
        Options of the method that are not as at first.
    camera : Camera, optional
    """

    panel: str | None = None
    bone: str | None = None
    methods: list[str] = field(default_factory=list)
    settings: dict[str, Any] = field(default_factory=dict)
    method: dict[str, Any] = field(default_factory=dict)
    camera: Camera | None = None

    def without(self, options: list[str]) -> dict[str, Any]:
        """Return the settings that no option of the command takes the place of."""
        replaced = {name for option in options for name in OPTIONS.get(option, ())}
        return {name: value for name, value in self.settings.items() if name not in replaced}


def read_address(text: str) -> Address:
    """Return the content of a page's address, or of its part after the question mark.

    The character that it names is not opened.

    Raises
    ------
    ParameterError
        It says what the page does not know, or what cannot be drawn.
    """
    query = urlsplit(text).query if "?" in text else text
    state = State()
    choices, arrival, problems = from_query(query, state)
    problems += [name for name in UNSEEN if name in arrival]
    if problems:
        raise ParameterError(f"the address has entries that cannot be drawn: {', '.join(problems)}")
    if "tour" in arrival and "bone" not in arrival:  # a link to the step alone: its scene
        look = TOUR[arrival["tour"]].look
        arrival["bone"] = look.bone
        choices = {"panel": look.panel, **look.choices, **choices}
    options = {name: choices.pop(name) for name in (*GRAPH, *WEIGHTS) if name in choices}
    plain = {n: p.default for n, p in simple(state).items() if n not in (*GRAPH, *WEIGHTS, "panel")}
    panel = choices.pop("panel", None)
    settings = {**plain, **choices}
    settings |= {n: arrival[n] for n in ("vertex", "turns", "clip", "minus") if n in arrival}
    camera = _camera(arrival["camera"]) if "camera" in arrival else None
    falloff = options.get("falloff", state.falloff)
    method = effective({"falloff": falloff, **options})
    methods = arrival.get("methods", [])
    return Address(panel, arrival.get("bone"), methods, settings, method, camera)


def read_camera(text: str) -> Camera:
    """Return a camera as addresses write it: where the eye is, and what it looks at.

    Raises
    ------
    ParameterError
        It is not six numbers.
    """
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != CAMERA or not all(abs(x) < 1e6 for x in numbers):
        raise ParameterError(f'camera must be six numbers, such as 0,1,4,0,1,0, not "{text}"')
    return _camera(numbers)


def _camera(numbers: list[float]) -> Camera:
    x, y, z, *target = numbers
    return Camera((x, y, z), (target[0], target[1], target[2]))
