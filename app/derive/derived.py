"""Results that follow from choices, declared by what they depend on."""

from __future__ import annotations

import operator
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass
from typing import Any

from cutcell.runtime.progress import Progress, silent

from .jobs import COMPUTING, Slots
from .reading import ReadOnlyState

Inputs = tuple[Any, ...]


@dataclass(frozen=True, eq=False)
class Derived:
    """A result that follows from choices: an attribute of the state.

    With `parts`, it is an attribute that holds a dict of results, and `inputs`, `more`, `wanted`,
    `immediate` and `failed` get the part's key as their last argument.

    Parameters
    ----------
    name : str
        The attribute of the state; None there while there is no value that holds.
    inputs : callable
        Takes the state; returns a tuple of all that the result depends on, or None where there can
        be no result.
    compute : callable
        Takes the inputs, then `more`, and `progress` by name.
    wanted : callable
        Takes the state; returns whether the result is to be computed.
    more : callable
        Takes the state; returns a tuple of arguments that do not change the result.
    parts : callable, optional
        Takes the state; returns the keys of the results that may be wanted.
    after : tuple of str
        Names of results that must be up to date before this one is computed.
    slots : callable
        Takes the state; returns the `Slots` that limit the computation.
    lane : str
        Of several results with the same lane, one is computed at a time.
    pause : callable
        Takes the inputs of the older value, None without one, and the present inputs; returns
        whether to wait until choices rest.
    patient : bool
        Whether a computation is completed, and shown, though its inputs have changed meanwhile.
    immediate : callable
        Takes the state; returns whether it is computed at once, on the page's own thread.
    reported : bool
        Whether the page shows its progress.
    current : callable
        Takes older and present inputs; returns whether the older value holds.
    keeps : callable
        Takes older and present inputs; returns whether the older value is shown until the new one
        is there.
    cached : int
        How many values are remembered while they may be shown.
    failed : callable, optional
        Takes the engine's owner; called after an error was reported.
    """

    name: str
    inputs: Callable[..., Inputs | None]
    compute: Callable[..., Any]
    wanted: Callable[..., bool] = lambda state, *part: True
    more: Callable[..., Inputs] = lambda state, *part: ()
    parts: Callable[[Any], Iterable[Hashable]] | None = None
    after: tuple[str, ...] = ()
    slots: Callable[[Any], Slots] = lambda state: COMPUTING
    lane: str = ""
    pause: Callable[[Inputs | None, Inputs], bool] = lambda old, new: False
    patient: bool = False
    immediate: Callable[..., bool] = lambda state, *part: False
    reported: bool = False
    current: Callable[[Inputs, Inputs], bool] = operator.eq
    keeps: Callable[[Inputs, Inputs], bool] = lambda old, new: False
    cached: int = 1
    failed: Callable[..., None] | None = None

    def work(self, state: Any, inputs: Inputs, *part: Hashable) -> Callable[[Progress], Any]:
        """Return a function that computes the result for some inputs, in any thread."""
        arguments = (*inputs, *self.more(state, *part))
        return lambda progress: self.compute(*arguments, progress=progress)

    def put(self, state: Any, value: Any, *part: Hashable) -> None:
        """Set the value in the state."""
        if part:
            before = getattr(state, self.name)
            rest = {key: one for key, one in before.items() if key != part[0]}
            value = rest if value is None else {**rest, part[0]: value}
        setattr(state, self.name, value)


class ComputedWhenRead(ReadOnlyState):
    """A state without an engine: each result that is wanted is computed when it is first read.

    Results that the state has already stay.

    Parameters
    ----------
    state : param.Parameterized
    results : iterable of Derived
    progress : callable
        See `cutcell.runtime.progress`.
    """

    def __init__(self, state: Any, results: Iterable[Derived], progress: Progress = silent) -> None:
        super().__init__(type(state), state)
        unread = {one.name: one for one in results if one.parts or getattr(state, one.name) is None}
        self.__dict__.update(_unread=unread, _progress=progress)

    def __getattr__(self, name: str) -> Any:
        one = None if name.startswith("_") else self._unread.pop(name, None)
        if one is not None:
            self._compute(one)
        return super().__getattr__(name)

    def _compute(self, one: Derived) -> None:
        for name in one.after:
            getattr(self, name)
        before = getattr(self._source, one.name) or ()
        keys = one.parts(self) if one.parts else ()
        for part in [(key,) for key in keys if key not in before] if one.parts else [()]:
            inputs = one.inputs(self, *part)
            if inputs is not None and one.wanted(self, *part):
                value = one.work(self, inputs, *part)(self._progress)
                one.put(self._source, value, *part)
