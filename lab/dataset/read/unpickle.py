"""Unpickling of numbers, texts, lists, dictionaries and arrays, and nothing else.

A pickle can call any function by its name. The names of numpy's constructors are looked up in a
table of stand-ins, and all other names become a `Refused`. numpy's own constructors are never
called, because damaged arguments crash them. The published archives are one pickled list of all
assets, tens of gigabytes: each entry is yielded as soon as it is complete, and forgotten.
"""

from __future__ import annotations

import math
import pickle
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import IO, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from cutcell.errors import FileError

from .limited_stream import LimitedStream

MAX_BYTES = 2**30
"""Largest size of one entry in the pickle."""
MAX_ITEMS = 10_000_000
"""Largest number of values of one entry, which a few bytes could make billions."""
MAX_DEPTH = 20
"""Containers inside each other."""
MAX_REMEMBERED = 200
"""Length of a text or tuple that later entries may share, such as the shape of an array."""
DTYPE = re.compile(r"[biufc]\d{1,2}|[SU]\d{1,6}|O8?")


# typeshed lists neither: the standard library's unpickler as it is written in Python.
_Unpickler: Any = vars(pickle)["_Unpickler"]
_Unframer: Any = vars(pickle)["_Unframer"]


@dataclass(frozen=True)
class Refused:
    """Placeholder of an object that is not data; calls and changes of it do nothing.

    Parameters
    ----------
    why : str
        The reason.
    """

    why: str

    def __call__(self, *_: Any) -> Refused:
        return self

    append = extend = add = __setitem__ = build = __call__


DATA = (str, int, float, bytes, bytearray, set, frozenset, type(None), np.ndarray, Refused)


def plain_objects(stream: IO[bytes], what: str, max_bytes: int = MAX_BYTES) -> Iterator[Any]:
    """Yield the entries of a pickled list, or of a pickled array of objects, one at a time."""
    try:
        yield from _DataUnpickler(stream, what, max_bytes).entries()
    except FileError:
        raise
    except Exception as error:  # a damaged stream can raise anything in the unpickler
        text = " ".join(str(error).split())[:200]
        raise FileError(
            f"{what} is damaged or no pickle ({text or type(error).__name__})"
        ) from None


class _DataUnpickler(_Unpickler):
    """The standard library's unpickler, which builds stand-ins and forgets complete entries."""

    dispatch: ClassVar[dict[int, Callable]] = dict(_Unpickler.dispatch)

    def __init__(self, stream: IO[bytes], what: str, max_bytes: int) -> None:
        self._limited = LimitedStream(stream, what, max_bytes)
        super().__init__(self._limited, encoding="latin-1")
        self.memo = _Memo()
        self._what = what
        self._list: list[Any] | None = None  # of the entries
        self._complete: list[Any] = []
        self._items = 0

    def entries(self) -> Iterator[Any]:
        """Yield the entries: `load` of the standard library as a generator."""
        self._unframer = _Unframer(self._file_read, self._file_readline)
        self.read, self.readinto = self._unframer.read, self._unframer.readinto
        self.readline = self._unframer.readline
        self.metastack: list[list[Any]] = []
        self.stack: list[Any] = []
        self.append = self.stack.append
        while (code := self.read(1)) != pickle.STOP:
            if not code:
                raise EOFError("it ends too early")
            self.dispatch[code[0]](self)
            complete, self._complete = self._complete, []
            yield from (self._plain(entry, 0) for entry in complete)
        top = self.stack.pop()
        entries = top.value if isinstance(top, _Array) else top
        if not isinstance(entries, list):
            why = entries.why if isinstance(entries, Refused) else "it holds something else"
            raise FileError(f"{self._what} is no pickled list: {why}")
        yield from (self._plain(entry, 0) for entry in entries)

    def _plain(self, value: Any, depth: int) -> Any:
        """Return a value with arrays in place of their placeholders."""
        self._items += 1
        if self._items > MAX_ITEMS or depth > MAX_DEPTH:
            raise FileError(f"{self._what} holds an entry of too many nested lists; it is damaged")
        if isinstance(value, _Array):
            return self._plain(value.value, depth + 1)
        if isinstance(value, list | tuple):
            return type(value)(self._plain(item, depth + 1) for item in value)
        if isinstance(value, dict):
            if not all(isinstance(key, str | int) for key in value):
                return Refused("it has a key that is no text")
            return {key: self._plain(item, depth + 1) for key, item in value.items()}
        return value if isinstance(value, DATA) else Refused("it holds a function or a type")

    def find_class(self, module: str, name: str) -> Any:
        if module.partition(".")[0] in ("numpy", "_codecs") and name in STAND_INS:
            return STAND_INS[name]
        label = f"{module}.{name}"[:80]
        return Refused(f"it asks for {label}, which is no data and was not opened")

    def persistent_load(self, pid: Any) -> Refused:
        return Refused(f"it refers to something outside of itself, {pid!r:.40}")

    def get_extension(self, code: int) -> None:
        self.append(self.persistent_load(code))

    def load_mark(self) -> None:
        if len(self.metastack) > MAX_DEPTH:
            raise FileError(f"{self._what} nests deeper than {MAX_DEPTH} containers; it is damaged")
        super().load_mark()

    def load_empty_list(self) -> None:
        super().load_empty_list()
        if self._list is None:  # only the array that holds the list of entries comes before it
            self._list = self.stack[-1]

    def load_empty_dictionary(self) -> None:
        if self._list is None:
            raise FileError(f"{self._what} is no pickled list: it begins with a dictionary")
        if self.stack and isinstance(self.stack[-1], dict):
            self._release()
        super().load_empty_dictionary()

    def load_appends(self) -> None:
        self._release()
        super().load_appends()

    def _release(self) -> None:
        """Hand over the complete entries, and forget the objects that were made for them."""
        if self.metastack and self.metastack[-1] and self.metastack[-1][-1] is self._list:
            self._complete = self.stack[:]
            self.stack.clear()
            self.memo.forget()
            self._limited.bytes_read = self._items = 0

    def load_build(self) -> None:
        state = self.stack.pop()
        if isinstance(self.stack[-1], _Array | _DType | Refused):
            self.stack[-1].build(state)
        else:
            self.stack[-1] = Refused("it sets the state of an object")

    def load_newobj(self, arguments: int = 1) -> None:
        del self.stack[-arguments:]
        if not isinstance(self.stack[-1], Refused):
            self.stack[-1] = Refused("it makes an object")

    for _code, _load in (
        (pickle.MARK, load_mark),
        (pickle.EMPTY_LIST, load_empty_list),
        (pickle.EMPTY_DICT, load_empty_dictionary),
        (pickle.APPENDS, load_appends),
        (pickle.BUILD, load_build),
        (pickle.NEWOBJ, load_newobj),
        (pickle.NEWOBJ_EX, lambda self: self.load_newobj(2)),
    ):
        dispatch[_code[0]] = _load


class _Memo(list):
    """The objects that later instructions may refer to by number."""

    def __init__(self) -> None:
        super().__init__()
        self._first = 0  # of the current entry
        self._shared: dict[str, Any] = {}

    def __setitem__(self, index: Any, value: Any) -> None:
        if index > len(self) + 1:  # some picklers count from 1
            raise ValueError("it numbers its objects in no order")
        self.extend([_GONE] * (index + 1 - len(self)))
        super().__setitem__(index, value)

    def forget(self) -> None:
        """Forget the objects of an entry, but for texts, shapes, types and names."""
        for index in range(self._first, len(self)):
            self[index] = self._remembered(self[index])
        self._first = len(self)

    def _remembered(self, value: Any) -> Any:
        if isinstance(value, _DType) or callable(value):
            return value
        is_short = isinstance(value, str | tuple) and len(value) <= MAX_REMEMBERED
        if is_short and all(isinstance(part, str | int | None) for part in value):
            return self._shared.setdefault(repr(value), value)
        return _GONE


@dataclass
class _DType:
    """A numpy type while it is built."""

    code: str
    order: str = "="

    def real(self) -> np.dtype:
        return np.dtype(self.code).newbyteorder(self.order)  # type: ignore[arg-type]

    def build(self, state: Any) -> None:
        if isinstance(state, tuple) and state[1] in ("<", ">", "|", "="):
            self.order = state[1]
            if state[2:5] == (None, None, None):
                return
        self.code, self.order = "O", "="  # a type with fields, which is refused


@dataclass
class _Array:
    """An array while it is built: of numbers or texts, or the list of an array of objects."""

    value: Any = None

    def build(self, state: Any) -> None:
        _, shape, kind, by_columns, data = state
        if isinstance(kind, _DType) and kind.code.startswith("O") and isinstance(data, list):
            self.value = data
        else:
            self.value = _array(data, kind, shape, bool(by_columns))


def _array(data: Any, kind: Any, shape: Any, by_columns: bool) -> NDArray | Refused:
    if isinstance(kind, Refused):
        return kind
    is_shape = isinstance(shape, tuple) and all(isinstance(n, int) and n >= 0 for n in shape)
    is_complete = isinstance(kind, _DType) and isinstance(data, bytes | bytearray)
    if not is_shape or not is_complete or kind.real().hasobject:
        return Refused("it has a damaged array")
    if math.prod(shape) * kind.real().itemsize != len(data):
        return Refused(f"its array of the shape {shape!r:.99} holds {len(data):,} bytes")
    return np.frombuffer(data, kind.real()).reshape(shape, order="F" if by_columns else "C")


def _dtype(code: str, *_: Any) -> _DType | Refused:
    return _DType(code) if DTYPE.fullmatch(code) else Refused(f"it has the type {code[:40]}")


def _scalar(kind: Any, data: Any) -> Any:
    value = _array(data, kind, (), False)
    return value.item() if isinstance(value, np.ndarray) else value


_GONE = Refused("it shares an object with an earlier asset, which is forgotten by then")
STAND_INS = {
    "ndarray": Refused("it holds a function or a type"),
    "dtype": _dtype,
    "scalar": _scalar,
    "_frombuffer": lambda data, kind, shape, order: _Array(_array(data, kind, shape, order == "F")),
    "_reconstruct": lambda *_: _Array(),
    "encode": lambda text, *_: text.encode("latin-1"),  # bytes in protocol 2
}
