"""Which rigs are in the folders and files that somebody names, and what bytes each is made of."""

from __future__ import annotations

import hashlib
import json
import zipfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...errors import CutcellError, FileError
from ...io import load
from ...io.files import naming, read_bytes
from ...io.rignet import rig_file
from ...rig.rig import Rig, Skeleton, TriangleMesh
from .archive import MEMBER
from .formats import read_samples, read_unirig, samples_of
from .store import STORE, Store, read_entry

RAW = "raw_data.npz"
"""UniRig's name for one rig; the folder it is in names the rig."""
HDF5 = (".h5", ".hdf5")
FILES = (".glb", ".gltf", ".vrm", ".fbx", ".usd", ".usda", ".usdc", ".usdz", ".npz")
RIGNET = (("obj", "rig_info"), ("obj_remesh", "rig_info_remesh"))
"""Folders of RigNet's that belong together: meshes, and the rigs of the same names."""


@dataclass(frozen=True, eq=False)
class Content:
    """The bytes of one rig, which can go to another machine.

    Parameters
    ----------
    kind : {"file", "unirig", "stored"}
        How they are read.
    files : dict of str to bytes
        By name; the first is the one to load.
    """

    kind: str
    files: dict[str, bytes]

    def digest(self) -> str:
        """Return a hash of the bytes, whatever the files are called: 32 hexadecimal digits."""
        state = hashlib.blake2b(self.kind.encode(), digest_size=16)
        for index, (name, data) in enumerate(self.files.items()):
            called = Path(name).suffix.lower() if index == 0 or len(self.files) == 2 else name
            state.update(f"\0{called}\0{len(data)}\0".encode())
            state.update(data)
        return state.hexdigest()


@dataclass(frozen=True)
class Source:
    """One rig to be read.

    Parameters
    ----------
    name : str
        Unlike all others: its path below the folder that was named, without ending.
    path : Path
    kind : {"file", "unirig", "rignet", "puppeteer", "stored"}
    beside : Path or None
        RigNet's other file.
    sample : str
        Puppeteer's group.
    """

    name: str
    path: Path
    kind: str = "file"
    beside: Path | None = None
    sample: str = ""

    def content(self) -> Content:
        """Read all bytes that the rig is made of.

        Raises
        ------
        FileError
            They cannot be read.
        """
        if self.kind == "stored":
            return Content("stored", {"stored.npz": read_bytes(self.path)})
        if self.kind == "unirig":
            return Content("unirig", {RAW: read_bytes(self.path)})
        if self.kind == "puppeteer":
            _, data = next(read_samples(self.path, [self.sample]))
            return Content("file", {"sample.npz": data})
        if self.kind == "rignet" and self.beside is not None:
            files = {"rig.obj": self.path, "rig.txt": self.beside}
            return Content("file", {name: read_bytes(path) for name, path in files.items()})
        files = {self.path.name: self.path, **_beside(self.path)}
        return Content("file", {name: read_bytes(path) for name, path in files.items()})


def read_content(content: Content, folder: Path) -> Rig:
    """Return the rig of some bytes."""
    first = next(iter(content.files))
    if content.kind == "stored":
        return _stored(content.files[first], folder)
    if content.kind == "unirig":
        return read_unirig(content.files[first], first)
    for name, data in content.files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    with naming(Path(first)):
        return load(folder / first)


def find_sources(paths: Iterable[Path]) -> list[Source]:
    """List the rigs in files and folders, in order, each under a name of its own.

    Raises
    ------
    FileError
        There is no such file or folder; it holds no rig; or it is an archive, to be split first.
    """
    found: list[Source] = []
    for path in paths:
        if path.is_dir():
            inside = list(_in_folder(path))
            if not inside:
                raise FileError(
                    f"{path}: holds no rigs; what is read is GLB, glTF, VRM, FBX, USD, npz of "
                    f"Articulation-XL, folders of RigNet's (obj, rig_info), {RAW} and HDF5"
                )
            found += inside
        elif path.is_file():
            found += _in_file(path, path.stem)
        else:
            raise FileError(f"{path}: there is no such file or folder")
    return _named(found)


def _stored(data: bytes, folder: Path) -> Rig:
    path = folder / "stored.npz"
    path.write_bytes(data)
    entry = read_entry(path)
    skeleton = Skeleton(entry.joints, entry.parents, entry.names)
    return Rig(TriangleMesh(entry.vertices, entry.faces), skeleton, entry.artist)


def _in_store(root: Path) -> Iterator[Source]:
    for row in Store(root).manifest():
        if not row["error"]:
            yield Source(row["name"], root / row["path"], "stored")


def _in_folder(root: Path) -> Iterator[Source]:
    if (root / STORE).is_file():
        yield from _in_store(root)
        return
    for path in sorted(p for p in root.rglob("*") if p.is_file()):
        kind, name = path.suffix.lower(), path.relative_to(root).with_suffix("").as_posix()
        if path.name == RAW:
            yield Source(path.parent.relative_to(root).as_posix(), path, "unirig")
        elif kind == ".obj":
            rig = _rignet_rig(path)
            if rig is not None:
                yield Source(name, path, "rignet", rig)
        elif kind in HDF5 or (kind in FILES and not path.name.startswith(".")):
            yield from _in_file(path, name)


def _rignet_rig(path: Path) -> Path | None:
    """Return the rig of one of RigNet's meshes: beside it, or in the folder that goes with it."""
    for meshes, rigs in RIGNET:
        if path.parent.name == meshes:
            there = path.parent.parent / rigs / f"{path.stem}.txt"
            if there.is_file():
                return there
    return rig_file(path)


def _in_file(path: Path, name: str) -> Iterator[Source]:
    kind = path.suffix.lower()
    if kind in HDF5:
        for sample in samples_of(path):
            yield Source(f"{name}/{sample}", path, "puppeteer", sample=sample)
    elif path.name == RAW:
        yield Source(path.parent.name, path, "unirig")
    elif kind == ".obj" and (rig := _rignet_rig(path)) is not None:
        yield Source(name, path, "rignet", rig)
    elif kind == ".npz" and _is_archive(path):
        raise FileError(
            f"{path.name}: is an archive of many rigs; split it first: cutcell dataset split "
            f"{path.name} FOLDER"
        )
    else:
        yield Source(name, path)


def _is_archive(path: Path) -> bool:
    try:
        with zipfile.ZipFile(path) as archive:
            return MEMBER in archive.namelist()
    except (OSError, zipfile.BadZipFile):
        return False  # its own reader says what is wrong with it


def _beside(path: Path) -> dict[str, Path]:
    """List the files that a glTF document refers to, where they are there."""
    if path.suffix.lower() != ".gltf":
        return {}
    try:
        document: Any = json.loads(path.read_text(encoding="utf-8"))
        entries = [*document.get("buffers", []), *document.get("images", [])]
        names = [e["uri"] for e in entries if not e.get("uri", "data:").startswith("data:")]
    except (OSError, ValueError, AttributeError, TypeError):
        return {}  # its own reader says what is wrong with it
    from urllib.parse import unquote

    inside = {unquote(name) for name in names if ".." not in Path(unquote(name)).parts}
    return {name: path.parent / name for name in sorted(inside) if (path.parent / name).is_file()}


def _named(sources: list[Source]) -> list[Source]:
    """Make names differ where folders have rigs of the same name, or files differ in ending."""
    counts: dict[str, int] = {}
    named = []
    for source in sources:
        count = counts[source.name] = counts.get(source.name, 0) + 1
        name = source.name if count == 1 else f"{source.name}~{count}"
        named.append(Source(name, source.path, source.kind, source.beside, source.sample))
    return named


def read_source(source: Source, folder: Path) -> Rig:
    """Return the rig of a source; see `read_content`."""
    try:
        return read_content(source.content(), folder)
    except CutcellError as error:
        raise type(error)(f"{source.name}: {error}") from None
