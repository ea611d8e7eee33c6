"""What can be loaded besides files: bytes, open files, and pipes."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import BinaryIO

from ..errors import FileError
from .files import read_bytes

Input = str | os.PathLike[str] | bytes | bytearray | memoryview | BinaryIO
ADDRESS = re.compile(r"[A-Za-z][\w+.-]+:/")
OPENED = ("/dev/stdin", "/dev/fd/", "/proc/self/fd/")
BEGINNINGS = {
    ".glb": rb"glTF",
    ".fbx": rb"Kaydara FBX|;\s*FBX",
    ".usdc": rb"PXR-USDC",
    ".usda": rb"#usda",
    ".npz": rb"PK[\0-\xff]{28}\w+\.npy",
    ".usdz": rb"PK",
    ".ply": rb"ply\s",
    ".off": rb"\w{0,4}OFF\s",
    ".json": rb'\s*\{\s*"joints"',
    ".gltf": rb"\s*\{",
    ".txt": rb"(joints|root|hier|skin)\s",
    ".obj": rb"\s*(#|(mtllib|usemtl|v|vt|vn|o|g|s)\s)",
    ".stl": rb"solid\s|[\0-\xff]{84}",
}
"""Ending of a file by how its content begins."""


@contextmanager
def as_file(source: Input) -> Iterator[Path]:
    """Yield the path of a file that can be read again, and whose ending says what it holds."""
    name: object = "bytes"
    if isinstance(source, str | os.PathLike):
        path = Path(source)
        exists = os.path.exists(path)  # unlike `Path.exists`, of any name
        if ADDRESS.match(str(path)) and not exists:
            address = re.sub(":/+", "://", str(source), count=1)  # a `Path` has one slash less
            raise FileError(f"{address} is an address, not a file. Download the file first")
        if not (exists and path.is_fifo()) and not str(path).startswith(OPENED):
            yield path
            return
        name, data = path.name, read_bytes(path)
    elif isinstance(source, bytes | bytearray | memoryview):
        data = bytes(source)
    else:
        name, data = getattr(source, "name", name), source.read()
        if not isinstance(data, bytes):
            raise FileError(f'{name}: is open as text; open it as bytes: open(path, "rb")')
    start = data.removeprefix(b"\xef\xbb\xbf")
    endings = (end for end, pattern in BEGINNINGS.items() if re.match(pattern, start))
    stem = Path(str(name).strip("<>")).stem or "bytes"
    with TemporaryDirectory() as folder:
        path = Path(folder, stem + next(endings, ""))
        path.write_bytes(data)
        yield path
