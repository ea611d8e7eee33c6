"""The parameters of the method, with the defaults of `cutcell.bind`."""

from collections.abc import Iterable, Mapping
from dataclasses import fields
from typing import Any

import param

import cutcell
from cutcell.method import METHODS, OPTIONS, STAGE_OPTIONS, Method
from cutcell.options import Flag, Whole


def _shown(*stages: str) -> tuple[str, ...]:
    return tuple(name for one in stages for name in STAGE_OPTIONS[one] if OPTIONS[name].label)


GRAPH = _shown("graph", "distances")
"""Parameters whose change needs new distances."""

WEIGHTS = _shown("weights")
"""Parameters whose change needs new weights, but no new distances."""


def default(name: str) -> Any:
    """Return the default of an option of `cutcell.bind`."""
    value = getattr(cutcell.ANIMATION, name)
    return cutcell.PAPER.alpha if name == "alpha" else value


def choices_of(names: Iterable[str], **most: int) -> Any:
    """Return a class with a parameter for each option; some whole numbers end lower."""
    parameters = {name: _parameter(name, most.get(name)) for name in names}
    return type("Choices", (param.Parameterized,), parameters)


def _parameter(name: str, most: int | None) -> param.Parameter:
    option, value = OPTIONS[name], default(name)
    values, label = option.values, option.label
    if isinstance(values, Mapping):
        return param.Selector(default=value, objects=dict(values), label=label)
    if isinstance(values, Flag):
        return param.Boolean(value, label=label)
    if isinstance(values, Whole):
        bounds = (values.low, most) if most else None
        return param.Integer(
            value, bounds=bounds, softbounds=(values.low, values.high), label=label
        )
    low, high, step = option.slider or (0, 1, 0.01)
    closed = (not values.strictly,) * 2
    return param.Number(
        value,
        bounds=(0, 1),
        inclusive_bounds=closed,
        softbounds=(low, high),
        step=step,
        label=label,
    )


def effective(options: dict[str, Any]) -> dict[str, Any]:
    """Drop options that the falloff does not use, which the core refuses."""
    is_paper = options["falloff"] == "paper"
    return {name: value for name, value in options.items() if is_paper or name != "alpha"}


def stored_method(state: Any) -> dict[str, Any]:
    """Return the options of a state that edits are stored with: R, and what differs otherwise."""
    options = effective(method_of(state))
    changed = {name: value for name, value in options.items() if value != default(name)}
    return {"resolution": options["resolution"], **changed}


def chosen_by(stored: Mapping[str, Any]) -> dict[str, Any]:
    """Return the choices of a state by options that edits are stored with; none without any."""
    if not stored:
        return {}
    method = cutcell.ANIMATION.with_options(**{k: v for k, v in stored.items() if k != "method"})
    values = {name: getattr(method, name) for name in (*GRAPH, *WEIGHTS)}
    return {name: value for name, value in values.items() if value is not None}


def method_of(state: Any, names: tuple[str, ...] = (*GRAPH, *WEIGHTS)) -> dict[str, Any]:
    """Return the parameters that a state holds, by their names."""
    return {name: getattr(state, name) for name in names}


def options_of(method: Method) -> dict[str, Any]:
    """Return the fewest options that make a method from a named one, with its name as "method"."""

    def differences(name: Any) -> dict[str, Any]:
        base = METHODS[name]
        options = {} if name == "animation" else {"method": name}
        if method.falloff != base.falloff:
            base = base.with_options(falloff=method.falloff)
            options["falloff"] = method.falloff
        values = {one.name: getattr(method, one.name) for one in fields(Method)}
        return options | {n: value for n, value in values.items() if value != getattr(base, n)}

    return min(map(differences, METHODS), key=len)


READABLE = 40
"""Lattice cells along the longest side of a graph that is easy to read on a screen."""
