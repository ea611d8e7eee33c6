"""Reading a pickle as data: numbers, texts, lists, dictionaries and arrays, and nothing else.

A pickle is a program for a small machine, and two of its instructions call functions by name.
This machine calls none. It knows what a handful of numpy's functions stand for, and builds the
arrays itself; any other name becomes a `Refused`, which what holds it can be told by. The published
archives are one pickled list of all assets, tens of gigabytes: each is given away as soon as it is
complete, and forgotten.
"""

from __future__ import annotations

import io
import math
import pickletools
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from ...errors import FileError

MAX_BYTES = 2**30
"""Of one asset in the pickle."""
DEPTH = 20
"""Containers inside each other."""
BUFFER = 2**20
DTYPE = re.compile(r"[biufc]\d{1,2}|[SU]\d{1,6}|O8?")

ARRAY_MODULES = ("numpy", "numpy.core.multiarray", "numpy._core.multiarray",
                 "numpy.core.numeric", "numpy._core.numeric", "_codecs")  # fmt: skip
KNOWN = {
    (module, name)
    for module in ARRAY_MODULES
    for name in ("ndarray", "dtype", "_reconstruct", "scalar", "_frombuffer")
} - {("_codecs", name) for name in ("ndarray", "dtype", "_reconstruct", "scalar", "_frombuffer")}
KNOWN |= {("_codecs", "encode")}


@dataclass(frozen=True)
class Refused:
    """Stands where the pickle asked for something that is not data.

    Parameters
    ----------
    why : str
        In words.
    """

    why: str


@dataclass(frozen=True)
class _Name:
    """One of numpy's functions, by name; never called."""

    name: str


@dataclass
class _DType:
    """A numpy type while it is put together."""

    code: str
    order: str = "="

    def real(self) -> np.dtype:
        return np.dtype(self.code).newbyteorder(self.order)  # type: ignore[arg-type]


@dataclass
class _Array:
    """An array while it is put together."""

    value: Any = None


class _Mark:
    """Where a list of arguments begins; also what stands for things that were forgotten."""


_GONE = Refused("it shares an object with an earlier asset, which is forgotten by then")
_PLAIN = (str, int, float, bool, type(None), _Name, _DType, Refused)
SHORT = 8
"""Entries of a tuple that is remembered, such as the shape of an array."""


def plain_objects(stream: IO[bytes], what: str, most_bytes: int = MAX_BYTES) -> Iterator[Any]:
    """Yield the entries of a pickled list, or of a pickled array of objects, one at a time."""
    machine = _Machine(what, most_bytes)
    limited = _Limited(stream, machine)
    try:
        for operation, argument, _ in pickletools.genops(limited):  # type: ignore[arg-type]
            for entry in machine.step(operation.name, argument):
                yield machine.finished(entry)
            if operation.name == "STOP":
                yield from map(machine.finished, machine.rest())
                return
    except FileError:
        raise
    except Exception as error:  # whatever a damaged stream runs the parser and the machine into
        text = " ".join(str(error).split())[:200]
        raise FileError(
            f"{what} is damaged or no pickle ({text or type(error).__name__})"
        ) from None


class _Limited:
    """A stream that gives no more than an entry may take, checked before it is read."""

    def __init__(self, stream: IO[bytes], machine: _Machine) -> None:
        self._stream = io.BufferedReader(stream, BUFFER)  # type: ignore[type-var]
        self._machine = machine

    def read(self, size: int = -1) -> bytes:
        self._machine.take(size)
        return self._stream.read(size)

    def readline(self) -> bytes:
        line = self._stream.readline(self._machine.left())
        self._machine.take(len(line))
        return line


class _Machine:
    """The stack of the pickle's instructions."""

    def __init__(self, what: str, most_bytes: int) -> None:
        self._what, self._most = what, most_bytes
        self._taken = 0
        self._stack: list[Any] = []
        self._below: list[list[Any]] = []
        self._memo: list[Any] = []
        self._from = 0
        self._entries: list[Any] | None = None
        self._level = -1
        self._texts: dict[str, str] = {}
        self._tuples: dict[tuple, tuple] = {}

    def left(self) -> int:
        return self._most - self._taken + 1

    def take(self, size: int) -> None:
        """Count the bytes of an entry."""
        self._taken += max(size, 0)
        if size < 0 or self._taken > self._most:
            raise FileError(
                f"{self._what} holds an entry of more than {self._most / 1e9:.2g} GB; it is damaged"
            )

    def finished(self, entry: Any) -> Any:
        """Return an entry without what only this machine knows."""
        return _unwrapped(entry, 0)

    def rest(self) -> list[Any]:
        """Return the entries that are left at the end: a batch of one has no mark."""
        if self._entries is not None:
            return self._entries
        whole = self._stack[-1]
        whole = whole.value if isinstance(whole, _Array) else whole
        if not isinstance(whole, list):
            why = whole.why if isinstance(whole, Refused) else "it holds something else"
            raise FileError(f"{self._what} is no pickled list: {why}")
        return whole

    def step(self, name: str, argument: Any) -> list[Any]:
        """Do one instruction; return the entries that are complete by it."""
        complete: list[Any] = []
        at_entries = self._entries is not None and len(self._below) == self._level
        if (
            at_entries
            and name == "EMPTY_DICT"
            and self._stack
            and isinstance(self._stack[-1], dict)
        ):
            complete = self._give_away()
        if at_entries and name in ("APPENDS", "APPEND"):
            complete = self._give_away()
            if name == "APPENDS":
                self._pop_mark()
            return complete
        if name in PUSHED:
            self._stack.append(argument)
        elif name in CONSTANTS:
            self._stack.append(CONSTANTS[name])
        elif name in TEXTS:
            self._stack.append(self._texts.setdefault(argument, argument))
        elif name in IGNORED:
            pass
        else:
            try:
                action = ACTIONS[name]
            except KeyError:
                raise FileError(
                    f"{self._what} uses the pickle instruction {name}, which data does not need"
                ) from None
            action(self, argument)
        return complete

    def _give_away(self) -> list[Any]:
        """Return all complete entries, and forget what was made for them."""
        complete, self._stack[:] = list(self._stack), []
        for k in range(self._from, len(self._memo)):
            self._memo[k] = self._kept(self._memo[k])
        self._from = len(self._memo)
        self._taken = 0
        return complete

    def _kept(self, thing: Any) -> Any:
        """Return what is remembered of a thing: later assets may refer to texts and shapes."""
        if isinstance(thing, tuple) and len(thing) <= SHORT:
            if all(isinstance(item, int | str | None) for item in thing):
                return self._tuples.setdefault(thing, thing)
        elif isinstance(thing, _PLAIN):
            return thing
        return _GONE

    def _pop_mark(self) -> list[Any]:
        items, self._stack = self._stack, self._below.pop()
        return items

    def mark(self, _: Any) -> None:
        if len(self._below) > DEPTH:
            raise FileError(f"{self._what} nests deeper than {DEPTH} containers; it is damaged")
        entries = self._stack[-1] if self._stack else None
        self._below.append(self._stack)
        self._stack = []
        # The list of assets is the first list: nothing but the array that holds it comes before.
        if self._entries is None and isinstance(entries, list) and self._is_outermost():
            self._entries, self._level = entries, len(self._below)

    def _is_outermost(self) -> bool:
        """Tell whether no other list or dictionary is under way."""
        return not any(
            isinstance(item, dict | list) for items in self._below for item in items[:-1]
        ) and not any(isinstance(items[-1], dict | list) for items in self._below[:-1] if items)

    def memoize(self, _: Any) -> None:
        self._put(len(self._memo))

    def put(self, argument: Any) -> None:
        self._put(int(argument))

    def _put(self, index: int) -> None:
        if index > len(self._memo) + 1_000_000:
            raise FileError(f"{self._what} numbers its objects in no order; it is damaged")
        while len(self._memo) <= index:
            self._memo.append(_GONE)
        self._memo[index] = self._stack[-1]

    def get(self, argument: Any) -> None:
        self._stack.append(self._memo[int(argument)])

    def pop(self, _: Any) -> None:
        self._stack.pop()

    def pop_mark(self, _: Any) -> None:
        self._pop_mark()

    def new_list(self, _: Any) -> None:
        self._stack.append([])

    def new_dict(self, _: Any) -> None:
        self._stack.append({})

    def marked_tuple(self, _: Any) -> None:
        items = self._pop_mark()
        self._stack.append(tuple(items))

    def marked_list(self, _: Any) -> None:
        items = self._pop_mark()
        self._stack.append(items)

    def marked_dict(self, _: Any) -> None:
        items = self._pop_mark()
        self._stack.append({})
        self._set_all(items)

    def short_tuple(self, count: int) -> None:
        items = self._stack[len(self._stack) - count :]
        del self._stack[len(self._stack) - count :]
        self._stack.append(tuple(items))

    def append(self, _: Any) -> None:
        item = self._stack.pop()
        self._extend([item])

    def appends(self, _: Any) -> None:
        items = self._pop_mark()
        self._extend(items)

    def _extend(self, items: list[Any]) -> None:
        if isinstance(self._stack[-1], list):
            self._stack[-1].extend(items)

    def set_item(self, _: Any) -> None:
        value, key = self._stack.pop(), self._stack.pop()
        self._set_all([key, value])

    def set_items(self, _: Any) -> None:
        items = self._pop_mark()
        self._set_all(items)

    def _set_all(self, items: list[Any]) -> None:
        goal = self._stack[-1]
        if isinstance(goal, dict):
            for key, value in zip(items[::2], items[1::2], strict=True):
                if not isinstance(key, str | int):
                    value, key = Refused("a key that is no text"), "?"
                goal[key] = value

    def name_argument(self, argument: str) -> None:
        module, _, name = argument.partition(" ")
        self._push_name(module, name)

    def name_on_stack(self, _: Any) -> None:
        name, module = self._stack.pop(), self._stack.pop()
        self._push_name(module, name)

    def _push_name(self, module: Any, name: Any) -> None:
        if (module, name) in KNOWN:
            self._stack.append(_Name(name))
        else:
            shown = f"{module}.{name}"[:80]
            self._stack.append(Refused(f"it asks for {shown}, which is no data and was not opened"))

    def reduce(self, _: Any) -> None:
        arguments, function = self._stack.pop(), self._stack.pop()
        self._stack.append(_called(function, arguments))

    def refuse_object(self, _: Any) -> None:
        """NEWOBJ and the like: a class and its arguments."""
        arguments, kind = self._stack.pop(), self._stack.pop()
        del arguments
        self._stack.append(kind if isinstance(kind, Refused) else Refused("it makes an object"))

    def refuse_marked(self, _: Any) -> None:
        self._pop_mark()
        self._stack.append(Refused("it makes an object of a class by name"))

    def refuse_call(self, _: Any) -> None:
        """NEWOBJ_EX: a class, its arguments, and some by name."""
        del self._stack[-2:]
        self._stack[-1] = Refused("it makes an object")

    def refuse_outside(self, argument: Any) -> None:
        """PERSID, EXT and the like: something that is not in the pickle."""
        self._stack.append(Refused(f"it refers to something outside of itself, {argument!r:.40}"))

    def refuse_outside_on_stack(self, _: Any) -> None:
        self.refuse_outside(self._stack.pop())

    def new_set(self, _: Any) -> None:
        self._stack.append(Refused("it holds a set"))

    def duplicate(self, _: Any) -> None:
        self._stack.append(self._stack[-1])

    def build(self, _: Any) -> None:
        state, target = self._stack.pop(), self._stack[-1]
        if isinstance(target, _DType):
            _set_order(target, state)
        elif isinstance(target, _Array):
            target.value = _built(state)
        elif not isinstance(target, Refused):
            self._stack[-1] = Refused("it sets the state of an object")


def _called(function: Any, arguments: Any) -> Any:
    """Return what one of numpy's functions stands for."""
    if isinstance(function, Refused):
        return function
    if not isinstance(function, _Name) or not isinstance(arguments, tuple):
        return Refused("it calls what is no function")
    name = function.name
    if name == "_reconstruct":
        return _Array()
    if name == "dtype" and arguments and isinstance(arguments[0], str):
        code = arguments[0]
        return _DType(code) if DTYPE.fullmatch(code) else Refused(f"it has the type {code[:40]}")
    if name == "scalar" and len(arguments) == 2 and isinstance(arguments[0], _DType):
        kind, data = arguments[0].real(), arguments[1]
        if isinstance(data, bytes) and not kind.hasobject and len(data) == kind.itemsize:
            return np.frombuffer(data, kind)[0].item()
    if name == "encode" and arguments and isinstance(arguments[0], str):
        return arguments[0].encode("latin-1")  # how protocol 2 writes bytes
    if name == "_frombuffer" and len(arguments) == 4 and isinstance(arguments[1], _DType):
        data, kind, shape, order = arguments
        return _Array(_array(data, kind.real(), shape, order == "F"))
    return Refused(f"it calls numpy's {name} in a way that is not known")


def _set_order(kind: _DType, state: Any) -> None:
    if isinstance(state, tuple) and len(state) >= 5 and state[1] in ("<", ">", "|", "="):
        kind.order = state[1]
        if state[2:5] == (None, None, None):
            return
    kind.code, kind.order = "O", "="


def _built(state: Any) -> Any:
    if not isinstance(state, tuple) or len(state) != 5:
        return Refused("it sets the state of an array in a way that is not known")
    _, shape, kind, by_columns, data = state
    if not isinstance(kind, _DType):
        return kind if isinstance(kind, Refused) else Refused("it has an array of no type")
    if kind.code.startswith("O"):
        return data if isinstance(data, list) else Refused("it has a damaged array of objects")
    return _array(data, kind.real(), shape, bool(by_columns))


def _array(data: Any, kind: np.dtype, shape: Any, by_columns: bool) -> NDArray | Refused:
    whole = isinstance(shape, tuple) and all(isinstance(n, int) and n >= 0 for n in shape)
    if not whole or not isinstance(data, bytes | bytearray) or kind.hasobject:
        return Refused("it has a damaged array")
    if math.prod(shape) * kind.itemsize != len(data):
        return Refused(f"its array of the shape {shape} holds {len(data):,} bytes")
    return np.frombuffer(data, kind).reshape(shape, order="F" if by_columns else "C")


def _unwrapped(value: Any, depth: int) -> Any:
    if depth > DEPTH:
        return Refused(f"it nests deeper than {DEPTH} containers")
    if isinstance(value, _Array):
        return _unwrapped(value.value, depth + 1)
    if isinstance(value, _Name | _DType):
        return Refused("it holds a function or a type")
    if isinstance(value, list):
        return [_unwrapped(item, depth + 1) for item in value]
    if isinstance(value, tuple):
        return tuple(_unwrapped(item, depth + 1) for item in value)
    if isinstance(value, dict):
        return {key: _unwrapped(item, depth + 1) for key, item in value.items()}
    return value


PUSHED = {
    "BININT", "BININT1", "BININT2", "INT", "LONG", "LONG1", "LONG4", "FLOAT", "BINFLOAT",
    "BINBYTES", "SHORT_BINBYTES", "BINBYTES8", "BYTEARRAY8", "BINSTRING", "SHORT_BINSTRING",
}  # fmt: skip
TEXTS = {"SHORT_BINUNICODE", "BINUNICODE", "BINUNICODE8", "UNICODE", "STRING"}
CONSTANTS: dict[str, Any] = {"NONE": None, "NEWTRUE": True, "NEWFALSE": False, "EMPTY_TUPLE": ()}
IGNORED = {"PROTO", "FRAME", "STOP"}
ACTIONS: dict[str, Callable[[_Machine, Any], None]] = {
    "MARK": _Machine.mark,
    "MEMOIZE": _Machine.memoize,
    "PUT": _Machine.put,
    "BINPUT": _Machine.put,
    "LONG_BINPUT": _Machine.put,
    "GET": _Machine.get,
    "BINGET": _Machine.get,
    "LONG_BINGET": _Machine.get,
    "POP": _Machine.pop,
    "POP_MARK": _Machine.pop_mark,
    "EMPTY_LIST": _Machine.new_list,
    "EMPTY_DICT": _Machine.new_dict,
    "TUPLE": _Machine.marked_tuple,
    "LIST": _Machine.marked_list,
    "DICT": _Machine.marked_dict,
    "TUPLE1": lambda machine, _: machine.short_tuple(1),
    "TUPLE2": lambda machine, _: machine.short_tuple(2),
    "TUPLE3": lambda machine, _: machine.short_tuple(3),
    "APPEND": _Machine.append,
    "APPENDS": _Machine.appends,
    "SETITEM": _Machine.set_item,
    "SETITEMS": _Machine.set_items,
    "GLOBAL": _Machine.name_argument,
    "STACK_GLOBAL": _Machine.name_on_stack,
    "REDUCE": _Machine.reduce,
    "NEWOBJ": _Machine.refuse_object,
    "OBJ": _Machine.refuse_marked,
    "INST": _Machine.refuse_marked,
    "BUILD": _Machine.build,
    "NEWOBJ_EX": _Machine.refuse_call,
    "PERSID": _Machine.refuse_outside,
    "BINPERSID": _Machine.refuse_outside_on_stack,
    "EXT1": _Machine.refuse_outside,
    "EXT2": _Machine.refuse_outside,
    "EXT4": _Machine.refuse_outside,
    "EMPTY_SET": _Machine.new_set,
    "ADDITEMS": _Machine.pop_mark,
    "FROZENSET": _Machine.refuse_marked,
    "DUP": _Machine.duplicate,
}
