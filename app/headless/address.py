"""Addresses of the page, as choices of a picture."""

from collections.abc import Collection, Mapping
from typing import Any
from urllib.parse import urlsplit

from cutcell.cli.options import chosen_method
from cutcell.errors import ParameterError
from cutcell_viewers.camera import Camera

from ..document.address import camera_of, from_query, numbers_of, simple, with_scene
from ..document.method import GRAPH, WEIGHTS, effective
from ..features.state import PageState
from .choices import Choices

METHOD = (*GRAPH, *WEIGHTS)
ENTRIES = ("bone", "methods", "vertex", "turns", "clip", "minus")
"""Entries of the address that are no plain choices of the page."""
REPLACED = {
    "shown": ("weights_shown",), "error": ("heat", "compare_field"), "turn": ("turns",),
    "skeleton": ("skeleton",), "bone": ("weights_shown", "compare_field"),
}  # fmt: skip
"""Choices of the page that options of the command replace."""


def read_address(text: str) -> tuple[dict[str, Any], Camera | None]:
    """Return the choices of a page's address, or of its part after the question mark.

    They are all choices of the page by name, as the address says or as they are at first, options
    of the method that are not as at first, and "bone" and "methods" where it has them. The
    character that it names is not opened.

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
    options = {name: page.pop(name) for name in METHOD if name in page}
    first = {n: p.default for n, p in simple(state).items() if n not in (*METHOD, "panel")}
    method = effective({"falloff": state.falloff, **options})
    moment = {name: arrival[name] for name in ENTRIES if name in arrival}
    camera = camera_of(arrival["camera"]) if "camera" in arrival else None
    return {**first, **page, **moment, **method}, camera


def choices_at(
    address: Mapping[str, Any], explicit: Collection[str], fields: Mapping[str, Any],
    settings: Mapping[str, Any], options: Mapping[str, Any],
) -> Choices:  # fmt: skip
    """Return the choices of an address and of the command's options, of which explicit ones win.

    Parameters
    ----------
    address : mapping
        As `read_address` returns it.
    explicit : collection of str
        Options that a person has given.
    fields, settings : mapping
        Fields of `Choices`, and choices of the page, by these options or their defaults.
    options : mapping
        Options of the method.
    """
    replaced = {*explicit, *(name for one in explicit for name in REPLACED.get(one, ()))}
    rest = {name: value for name, value in address.items() if name not in replaced}
    named = dict(fields)
    named |= {name: rest.pop(name) for name in ("panel", "bone", "methods") if name in rest}
    method = chosen_method({**options, **{n: rest.pop(n) for n in METHOD if n in rest}})
    return Choices(**named, settings={**rest, **settings}, method=method)


def read_camera(text: str) -> Camera:
    """Return a camera as addresses write it: the position of the eye, and its target."""
    try:
        return camera_of(numbers_of(text))
    except ValueError:
        raise ParameterError(
            f'camera must be six numbers, such as 0,1,4,0,1,0, not "{text}"'
        ) from None
