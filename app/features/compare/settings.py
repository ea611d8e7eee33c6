"""Settings of cutcell among the methods: names that contain the options of the method."""

from typing import Any

from cutcell.errors import CutcellError, ParameterError
from cutcell.method import Method, method_of
from cutcell_lab.sweeps import parsed_values, value_text

from ...document.method import options_of

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
