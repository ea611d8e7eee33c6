"""The glTF document and its bytes: the GLB container, data URIs, files beside it.

The JSON is kept as it was parsed, so that whatever cutcell does not know (extensions,
extras, empty lists) is still there when the document is written again. Libraries that fill
dataclasses instead lose such fields, and take seconds over thousands of animation channels.
"""

from __future__ import annotations

import base64
import binascii
import json
import math
import re
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import unquote

from ...errors import CutcellError, FileError
from ..files import HALVES, Allowance, one_line, read_bytes, regular_file, whole_characters

MAGIC = b"glTF"
SURROGATE = re.compile(rb"\\u[dD][89a-fA-F]")
JSON_CHUNK = 0x4E4F534A
BINARY_CHUNK = 0x004E4942


@dataclass(eq=False)
class Document:
    """A glTF document: its JSON untouched, and its buffers; `replace` makes one without caches."""

    path: Path
    json: dict[str, Any]
    buffers: list[bytes]
    size: int = 0  # bytes of its JSON
    binary: bool = True  # whether it came as a GLB container
    chunks: list[tuple[int, bytes]] = field(default_factory=list)
    """GLB chunks that are neither JSON nor the binary buffer."""
    warnings: list[str] = field(default_factory=list)  # warnings of reading it, in sentences
    surfaces: Any = None
    """The `Surfaces` that colour the meshes of a document made from another format."""

    def __post_init__(self) -> None:
        self._checked: dict[str, list[dict[str, Any]]] = {}
        self.forget()
        self.allow()

    @property
    def is_gltf(self) -> bool:
        """Whether it was not made from another format."""
        return self.surfaces is None

    def allow(self) -> None:
        """Reset the memory budget of reading by the present size."""
        sizes = {id(buffer): len(buffer) for buffer in self.buffers}  # some may be the same
        self.allowance = Allowance(self.size + sum(sizes.values()))

    def forget(self) -> None:
        """Clear what was checked and decoded, by the number of its accessor or mesh."""
        self.accessors: dict[int, Any] = {}
        self.triangles: dict[int, Any] = {}  # vertices, faces and primitives of meshes

    def items(self, kind: str) -> list[dict[str, Any]]:
        """Return a top-level list of objects such as "nodes"; empty when absent."""
        objects = self.json.get(kind, [])
        if objects is not self._checked.get(kind, ()):  # long lists are asked for again and again
            if not isinstance(objects, list) or not all(isinstance(x, dict) for x in objects):
                raise FileError(f'"{kind}" of the glTF document must be a list of objects')
            self._checked[kind] = objects
        return objects

    def item(self, kind: str, index: Any, user: str) -> dict[str, Any]:
        """Return one object of a top-level list; `user` is who refers to it."""
        objects = self.items(kind)
        if type(index) is not int or not 0 <= index < len(objects):
            raise FileError(
                f"{user} refers to {kind}[{index}], but the file has {len(objects)} {kind}"
            )
        return objects[index]

    def view_range(self, view: dict[str, Any], user: str) -> tuple[bytes, int, int]:
        """Return the buffer of a buffer view, and the first byte and the number of those in it."""
        self.item("buffers", view.get("buffer"), user)
        buffer = self.buffers[view["buffer"]]
        start, length = whole(view, "byteOffset", user, 0), whole(view, "byteLength", user)
        if start + length > len(buffer):
            raise FileError(
                f"{user} ends at byte {start + length} of buffers[{view['buffer']}], "
                f"which has {len(buffer)}"
            )
        return buffer, start, length

    def label(self, kind: str, index: int) -> str:
        """Return how to name an object to people: by its name, else by its number."""
        name = self.item(kind, index, "the document").get("name")
        one = "mesh" if kind == "meshes" else kind.removesuffix("s")
        return f'{one} "{name}"' if isinstance(name, str) and name else f"{kind}[{index}]"


@contextmanager
def malformed() -> Iterator[None]:
    """Turn what a malformed document raises into a `FileError`."""
    try:
        yield
    except CutcellError:
        raise
    except (TypeError, ValueError, KeyError, IndexError, AttributeError, OverflowError) as e:
        # Fields that no check above looked at, in a document that is not what it says.
        raise FileError(f"its glTF document is malformed ({type(e).__name__}: {e})") from e


def whole(owner: dict[str, Any], key: str, user: str, default: int | None = None) -> int:
    """Return a field that must be a whole number, 0 or more."""
    value = owner.get(key, default)
    if type(value) is not int or value < 0:
        raise FileError(f'{user}: "{key}" must be a whole number, 0 or more, not {value!r}')
    return value


def extensions(owner: dict[str, Any]) -> dict[str, Any]:
    """Return the extensions of an object by name; empty when absent."""
    value = owner.get("extensions")
    return value if isinstance(value, dict) else {}


def indices(owner: dict[str, Any], key: str, user: str) -> list[int]:
    """Return a field that must be a list of whole numbers; empty when absent."""
    value = owner.get(key, [])
    if not isinstance(value, list) or any(type(x) is not int for x in value):
        raise FileError(f'{user}: "{key}" must be a list of whole numbers')
    return value


def read_document(path: Path) -> Document:
    """Read a GLB or glTF file with all its buffers."""
    data = read_bytes(path)
    binary: bytes | None = None
    others: list[tuple[int, bytes]] = []
    if data[:4] == MAGIC:
        text, binary, others = _split_chunks(data)
    elif data.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"{":
        text = data
    else:
        raise FileError(
            "is not a glTF file: it starts with neither the letters glTF (binary) nor a "
            "brace (JSON text)"
        )
    parsed, warnings = _parse(text)
    document = Document(path, parsed, [], len(text), data[:4] == MAGIC, others, warnings=warnings)
    asset = parsed.get("asset")
    if not isinstance(asset, dict) or "version" not in asset:
        raise FileError('is JSON, but not glTF: it has no "asset" with a "version"')
    if not str(asset["version"]).startswith("2."):
        raise FileError(f"is glTF {asset['version']}; only glTF 2.0 can be read")
    files: dict[str, bytes] = {}
    buffers = document.items("buffers")
    lengths = [whole(one, "byteLength", f"buffers[{i}]") for i, one in enumerate(buffers)]
    document.buffers = [b""] * len(buffers)
    for i in sorted(range(len(buffers)), key=lambda i: -lengths[i]):
        document.buffers[i] = _buffer_bytes(path, buffers[i], i, binary, files)
    for image in document.items("images"):  # saving copies them
        beside(path, str(image.get("uri", "data:")))
    document.allow()
    return document


def _split_chunks(data: bytes) -> tuple[bytes, bytes | None, list[tuple[int, bytes]]]:
    if len(data) < 20:
        raise FileError(f"is cut short: {len(data)} bytes are no complete GLB file")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise FileError(f"is a GLB container of version {version}; only version 2 can be read")
    if length > len(data):
        raise FileError(f"is cut short: {length} bytes are announced, {len(data)} are there")
    chunks: list[tuple[int, bytes]] = []
    at = 12
    while at + 8 <= length:
        size, kind = struct.unpack_from("<II", data, at)
        if at + 8 + size > length:
            raise FileError(f"is cut short: the GLB chunk at byte {at} runs past the end")
        chunks.append((kind, data[at + 8 : at + 8 + size]))
        at += 8 + size
    if not chunks or chunks[0][0] != JSON_CHUNK:
        raise FileError("has no JSON chunk at the start of its GLB container")
    if len(chunks) > 1 and chunks[1][0] == BINARY_CHUNK:
        return chunks[0][1], chunks[1][1], chunks[2:]
    return chunks[0][1], None, chunks[1:]


def _parse(text: bytes) -> tuple[dict[str, Any], list[str]]:
    """Return the JSON object in a text, and warnings about it."""
    warnings = []
    try:
        decoded = text.decode("utf-8-sig").rstrip("\0")
        document = json.loads(decoded, parse_float=_number, parse_constant=_number)
        if SURROGATE.search(text):
            whole = with_whole_names(document)
            warnings += [HALVES] if whole != document else []
            document = whole
    except (ValueError, RecursionError) as e:
        raise FileError(f"its JSON cannot be read: {one_line(e)}") from None
    if not isinstance(document, dict):
        raise FileError("its JSON is not an object")
    return document, warnings


def _number(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text[:40]} is not a JSON number")
    return value


def _buffer_bytes(
    path: Path, buffer: dict[str, Any], i: int, binary: bytes | None, files: dict[str, bytes]
) -> bytes:
    """Return the bytes of a buffer; `files` keeps what was read, for those that want less of it."""
    user = f"buffers[{i}]"
    if any(isinstance(x, dict) and x.get("fallback") is True for x in extensions(buffer).values()):
        return b""  # it is empty: its buffer views are compressed, in another buffer
    uri, length = buffer.get("uri"), buffer["byteLength"]
    if uri is None:
        if i != 0 or binary is None:
            raise FileError(f"{user} has no data: neither a uri nor a binary chunk")
        data = binary[:length]
    else:
        key = str(uri) if str(uri).startswith("data:") else str(beside(path, str(uri)))
        if key not in files:
            files[key] = read_uri(path, uri, user, max(length, 1))
        data = files[key]
    if len(data) < length:
        raise FileError(f"{user} is cut short: {length} bytes announced, {len(data)} there")
    return data


def read_uri(path: Path, uri: Any, user: str, most: int | None = None) -> bytes:
    """Return the bytes behind a data URI, or the first `most` behind a relative file name."""
    if not isinstance(uri, str):
        raise FileError(f'{user}: "uri" must be text')
    if uri.startswith("data:"):
        head, _, body = uri.partition(",")
        if not head.endswith(";base64"):
            raise FileError(f"{user}: only base64 data URIs can be read")
        try:
            return base64.b64decode(body, validate=True)
        except (binascii.Error, ValueError):
            raise FileError(f"{user}: its data URI is not valid base64") from None
    file = beside(path, uri)
    if file is None:
        raise FileError(
            f'{user}: "{uri[:80]}" is not a file in the folder of {path.name} or below it'
        )
    return read_bytes(file, most)


def beside(path: Path, uri: str) -> Path | None:
    """Return the file that a URI names, regular or not there; None outside of the folder."""
    name = PurePosixPath(unquote(uri))
    outside = name.is_absolute() or ".." in name.parts or ":" in str(name) or "\\" in str(name)
    if outside or "\0" in str(name) or not name.parts:
        return None
    file = path.parent.joinpath(*name.parts)
    regular_file(file, path.parent)
    return file


def with_whole_names(document: dict[str, Any]) -> dict[str, Any]:
    """Return a document in which no text holds half of a character."""
    return json.loads(whole_characters(json.dumps(document, ensure_ascii=False)))


def json_bytes(document: dict[str, Any]) -> bytes:
    """Return a document as JSON text."""
    try:
        return json.dumps(document, separators=(",", ":"), allow_nan=False).encode()
    except ValueError as e:
        raise FileError(f"its document cannot be written as JSON: {e}") from None


def pack_glb(text: bytes, binary: bytes, chunks: list[tuple[int, bytes]]) -> bytes:
    """Assemble a GLB container; every chunk starts and ends on a multiple of 4 bytes."""
    parts = [(JSON_CHUNK, text + b" " * (-len(text) % 4))]
    if binary:
        parts.append((BINARY_CHUNK, binary + b"\0" * (-len(binary) % 4)))
    parts += [(kind, body + b"\0" * (-len(body) % 4)) for kind, body in chunks]
    packed = b"".join(struct.pack("<II", len(body), kind) + body for kind, body in parts)
    if 12 + len(packed) >= 2**32:
        raise FileError("is too large for a GLB file, which ends at 4 GiB; save it as .gltf")
    return MAGIC + struct.pack("<II", 2, 12 + len(packed)) + packed
