"""Reads of the state that are recorded, so that a change is followed by what has read it."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Set
from functools import cache
from typing import Any, Generic, TypeVar

from param import Parameterized

T = TypeVar("T")


class ReadOnlyState:
    """A state that can only be read, and that records the names of the parameters that are read.

    Properties of the state are evaluated here, so that what they read is recorded as well.

    Parameters
    ----------
    kind : type
        Class of the state, a `param.Parameterized`.
    source : object
        What has the values: the state, a copy of them, or another such view.
    changes : mapping, optional
        Values of parameters that are others here.

    Attributes
    ----------
    read_names : set of str
    """

    read_names: set[str]

    def __init__(
        self, kind: type[Parameterized], source: Any, changes: Mapping[str, Any] | None = None
    ) -> None:
        self.__dict__.update(_kind=kind, _source=source, _changes=changes or {}, read_names=set())

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self._changes:
            return self._changes[name]
        names, properties = _attributes_of(self._kind)
        if name in names:
            self.read_names.add(name)
        elif name in properties:
            return properties[name](self)
        return getattr(self._source, name)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"{name} cannot be set: this state can only be read")

    def changed(self, **changes: Any) -> ReadOnlyState:
        """Return this state with other values of some parameters."""
        return ReadOnlyState(self._kind, self, changes)


def view_of(state: Any) -> Any:
    """Return a `ReadOnlyState` of a state, or of another such view."""
    return ReadOnlyState(getattr(state, "_kind", type(state)), state)


@cache
def _attributes_of(kind: type[Parameterized]) -> tuple[Set[str], dict[str, Callable[[Any], Any]]]:
    """Return the names of a state's parameters, and the functions of its properties."""
    names = frozenset(kind.param) - {"name"}
    others = {name: getattr(kind, name) for name in dir(kind) if name not in names}
    properties = {n: one.fget for n, one in others.items() if isinstance(one, property)}
    return names, {name: get for name, get in properties.items() if get is not None}


class Recorded(Generic[T]):
    """Value of a function of the state, which is called again after a change of what it read.

    Parameters
    ----------
    function : callable
        Takes a `ReadOnlyState`, then `part`.
    """

    def __init__(self, function: Callable[..., T], *part: Hashable) -> None:
        self._function, self._part = function, part
        self.names: Set[str] | None = None  # None: it is to be called
        self._value: Any = None
        self._error: Exception | None = None

    @property
    def is_stale(self) -> bool:
        """Whether the function is called when the value is needed next."""
        return self.names is None

    def renewed(self) -> Recorded[T]:
        """Return another one of the same function, without a value."""
        return Recorded(self._function, *self._part)

    def forget(self, names: Set[str]) -> bool:
        """Drop the value if any of these parameters was read; return whether it was dropped."""
        if self.names is None or self.names.isdisjoint(names):
            return False
        self.names = None
        return True

    def read(self, state: Any) -> T:
        """Return the value for a state; what it reads of a `ReadOnlyState` is recorded there, too.

        An error is raised again until what was read before it changes.
        """
        if self.names is None:
            view = view_of(state)
            self._error = None
            try:
                self._value = self._function(view, *self._part)
            except Exception as error:
                self._error = error
            self.names = view.read_names
        if self._error is not None:
            raise self._error
        value: T = self._value
        return value
