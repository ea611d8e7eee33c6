"""Methods side by side: which there are, and names of settings of cutcell among them."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from cutcell.errors import CutcellError, ParameterError
from cutcell.method import Method, method_of
from cutcell.rig import Rig
from cutcell_lab.baselines import METHODS
from cutcell_lab.sweeps import parsed_values, value_text

from .method import options_of
from .state import State

PREFIX = "@"
"""Names of settings begin with it."""

TITLES = {
    "method": "{}",
    "connectivity": "{} axes",
    "winding_threshold": "τ = {}",
    "leaf": "bones: {}",
    "falloff": "{} falloff",
    "alpha": "α = {}",
    "max_influences": "{} influences",
    "threshold": "from {}",
    "orient": "flipped faces: {}",
}
"""Titles of options that differ from their defaults."""


def is_settings(name: str) -> bool:
    """Return whether a name of a method contains valid options."""
    try:
        settings(name)
    except ParameterError:
        return False
    return True


def settings(name: str) -> Method:
    """Return the method of a name; raise a `ParameterError` for options that are wrong."""
    options: dict[str, Any] = {"method": "animation"}
    try:
        if not name.startswith(PREFIX):
            raise ValueError(name)
        for part in filter(None, name[len(PREFIX) :].split(";")):
            key, _, text = part.partition("=")
            (options[key],) = parsed_values(text)
        return method_of(**options)
    except (CutcellError, ValueError, TypeError) as error:
        raise ParameterError(f"no settings of cutcell: {name}") from error


def name_of(method: Method) -> str:
    """Return the name of settings."""
    options = options_of(method)
    return PREFIX + ";".join(f"{name}={value_text(value)}" for name, value in options.items())


def title_of_settings(name: str) -> str:
    """Return R and the options that differ from the defaults, in a line."""
    method = settings(name)
    options = {n: v for n, v in options_of(method).items() if n != "resolution"}
    others = [_title(option, value) for option, value in options.items()]
    return ", ".join([f"R = {method.resolution}", *others])


def _title(option: str, value: Any) -> str:
    if (option, value) == ("connectivity", "any"):
        return "any angle"
    return TITLES.get(option, f"{option} = {{}}").format(value_text(value))


NOW = "now"
"""Stands among the methods for what the page computed, as it is set."""


FEWEST_VIEWS = 2
MAX_VIEWS = 4
SINGLE = ("minus", "first_method", "second_method")
"""Choices that are one of the methods side by side, or empty."""


def offered(rig: Any) -> list[str]:
    """Return all methods by name: what is on the page, the file's own, and the registered."""
    file_methods = ["artist"] if rig is not None and rig.weights is not None else []
    return [NOW, *file_methods, *(name for name in METHODS if name != "artist")]


def listed(rig: Any, chosen: Sequence[str]) -> list[str]:
    """Return the methods that are offered, and those of the chosen that are settings."""
    return [*offered(rig), *(name for name in chosen if is_settings(name))]


def standard(rig: Any, base: str = "computed") -> list[str]:
    """Return the methods that stand side by side before any is chosen.

    Over a file's weights, what is on the page would be the same twice.
    """
    first = NOW if base == "computed" else "cutcell_rig"
    return [name for name in offered(rig) if name in (first, "artist", "euclidean")]


def single_choices(chosen: Mapping[str, Any], names: list[str]) -> dict[str, str]:
    """Return the choices of one method each, empty where it is not among the names."""
    return {one: chosen[one] if chosen[one] in names else "" for one in SINGLE}


def carried(
    state: State, rig: Rig, base: str, fresh: bool, arrival: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the methods for a new character: those of an address, else those chosen before.

    `base` is what its edits begin from; with `fresh` no choice is carried over. `arrival` may have
    "methods", those of `SINGLE`, and "settled".
    """
    standards = [standard(state.rig, base) for base in ("computed", "file")]
    chosen = [] if fresh or state.methods in standards else state.methods
    wanted = arrival.get("methods", chosen)
    names = [name for name in wanted if name in listed(rig, wanted)]
    if len(names) < FEWEST_VIEWS:
        names = standard(rig, base)
    before = dict.fromkeys(SINGLE, "") if fresh else {one: getattr(state, one) for one in SINGLE}
    single = single_choices({**before, **arrival}, names)
    return {"methods": names, **single, "settled": arrival.get("settled", ())}


KEY = re.compile(r"[^/,]{1,300}/[^/,]{1,300}/[a-z-]*/\d{1,5}/\d{1,5}")
"""Keys of settled regions: two methods, and the `Region.key`."""


def settled_of(text: str) -> tuple[str, ...]:
    """Read keys of settled regions, separated by commas; raise a ValueError for other texts."""
    keys = tuple(text.split(","))
    if not all(map(KEY.fullmatch, keys)):
        raise ValueError(text)
    return keys
