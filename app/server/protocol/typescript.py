"""Types of messages for the scripts: `python -m cutcell_app.server.protocol.typescript`."""

from __future__ import annotations

import types
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, Literal, get_args, get_origin, get_type_hints, is_typeddict

import numpy as np
from numpy.typing import NDArray

from . import received, sent

DECLARATIONS = Path(__file__).parents[2] / "frontend/common/messages.d.ts"
PLAIN: dict[Any, str] = {
    Any: "any", bool: "boolean", bytes: "ArrayBuffer", float: "number", int: "number",
    str: "string", type(None): "null", sent.Numbers: "Iterable<number>", sent.Vector: "Vector",
    received.Vector: "Vector", NDArray[np.float64]: "Float64Array",
    NDArray[np.float32]: "Float32Array", NDArray[np.uint8]: "Uint8Array",
    NDArray[np.uint16]: "Uint16Array", NDArray[np.uint32]: "Uint32Array",
}  # fmt: skip


def typescript() -> str:
    """Return declarations of all messages."""
    return "\n".join(_lines()) + "\n"


def _lines() -> Iterator[str]:
    yield "// Written by app/server/protocol/typescript.py."
    yield "type Vector = number[]"
    shapes = [one for module in (received, sent) for one in vars(module).values()]
    for shape in filter(is_typeddict, shapes):
        yield f"type {shape.__name__} = {{{_parts(shape)}}}  // {_summary(shape)}"
    yield "type FromBrowser ="
    for message in received.RECEIVED.values():
        parts = "; ".join(filter(None, (f"type: '{message.type}'", _parts(message))))
        yield f"  | {{{parts}}}  // {_summary(message)}"


def _parts(shape: Any) -> str:
    hints = get_type_hints(shape)
    if is_dataclass(shape):
        parts = [(one.name, one.default is not one.default_factory) for one in fields(shape)]
    else:
        parts = [(name, name in shape.__optional_keys__) for name in hints]
    return "; ".join(f"{name}{'?' * optional}: {_type(hints[name])}" for name, optional in parts)


def _type(hint: Any) -> str:
    """Return a type in TypeScript."""
    origin, parts = get_origin(hint), get_args(hint)
    if hint in PLAIN:
        return PLAIN[hint]
    if is_typeddict(hint):
        return str(hint.__name__)
    if origin is Literal:
        return " | ".join(f"'{one}'" for one in parts)
    if hint in (sent.Numbers | None,):
        return "Iterable<number> | null"
    if origin is types.UnionType or (len(parts) > 1 and type(None) in parts):
        return " | ".join(dict.fromkeys(map(_type, parts)))
    if origin is list:
        inner = _type(parts[0])
        return f"({inner})[]" if " | " in inner else f"{inner}[]"
    if origin is tuple:
        return f"[{', '.join(map(_type, parts))}]"
    if origin is dict:
        return f"Record<{', '.join(map(_type, parts))}>"
    raise TypeError(f"messages cannot have parts of the type {hint}")


def _summary(shape: Any) -> str:
    return str(shape.__doc__).partition("\n")[0]


if __name__ == "__main__":
    DECLARATIONS.write_text(typescript(), encoding="utf-8")
