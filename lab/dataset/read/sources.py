"""Rigs in files and folders, and their bytes."""

from __future__ import annotations

import hashlib
import json
import zipfile
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from cutcell.errors import CutcellError, FileError
from cutcell.io import load
from cutcell.io.files import naming, read_bytes, regular_file
from cutcell.io.formats import suffixes
from cutcell.io.formats.rignet import rig_file
from cutcell.io.gltf.container import beside
from cutcell.rig import Rig, Skeleton, TriangleMesh

from .archive import MEMBER
from .entry import read_entry
from .formats import read_samples, read_unirig, samples_of
from .store import STORE, Store

RAW = "raw_data.npz"
"""UniRig's name for one rig; the folder it is in names the rig."""
HDF5 = (".h5", ".hdf5")
FACES_OF_ANYMATE = b"mesh_face"
"""Key of the faces in Anymate's test split; its training split has none."""
MAX_PICKLE = 2**28
"""Bytes of a pickle that are searched for it; the numbers are in other members."""
FILES = set(suffixes("read")) & set(suffixes("read_skeleton")) - {".txt"}
"""RigNet's files are found by their meshes."""
RIGNET = (("obj", "rig_info"), ("obj_remesh", "rig_info_remesh"))
"""Matching folders of RigNet: meshes, and rigs of the same names."""


@dataclass(frozen=True, eq=False)
class Content:
    """The bytes of one rig, which can be sent to another machine."""

    kind: str  # "file", "unirig" or "stored"
    files: dict[str, bytes]
    """By name; the first is the one to load."""

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
        Unique: the path in the input folder, without suffix.
    path : Path
    kind : {"file", "unirig", "rignet", "puppeteer", "stored"}
    rig_info : Path or None
        RigNet's other file.
    sample : str
        Puppeteer's group.
    """

    name: str
    path: Path
    kind: str = "file"
    rig_info: Path | None = None
    sample: str = ""

    def content(self) -> Content:
        """Read all bytes of the rig.

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
        if self.kind == "rignet" and self.rig_info is not None:
            files = {"rig.obj": self.path, "rig.txt": self.rig_info}
            return Content("file", {name: read_bytes(path) for name, path in files.items()})
        files = {self.path.name: self.path, **_referenced(self.path)}
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
    """List the rigs in files and folders, in order, under unique names.

    Raises
    ------
    FileError
        A path does not exist, contains no rig, or is an archive that must be split first.
    """
    sources: list[Source] = []
    for path in paths:
        if path.is_dir():
            inside = list(_in_folder(path))
            if not inside:
                for tensors in sorted(path.rglob("*.pt")):
                    _refuse_tensors(tensors)
                raise FileError(
                    f"{path}: holds no rigs; what is read is {', '.join(sorted(FILES))}, folders "
                    f"of RigNet's (obj, rig_info), {RAW} and HDF5"
                )
            sources += inside
        elif path.is_file():
            sources += _in_file(path, path.stem)
        else:
            raise FileError(f"{path}: there is no such file or folder")
    return _named(sources)


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
    """Return the rig of one of RigNet's meshes, in the same folder or in the matching one."""
    for meshes, rigs in RIGNET:
        if path.parent.name == meshes:
            candidate = path.parent.parent / rigs / f"{path.stem}.txt"
            if candidate.is_file():
                return candidate
    return rig_file(path)


def _in_file(path: Path, name: str) -> Iterator[Source]:
    kind = path.suffix.lower()
    if kind == ".pt":
        _refuse_tensors(path)
    elif kind in HDF5:
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


def _refuse_tensors(path: Path) -> None:
    """Say why a file of `torch.save`, such as Anymate's, is not read."""
    try:
        with zipfile.ZipFile(path) as archive:
            pickles = [name for name in archive.namelist() if name.endswith("data.pkl")]
            has_faces = any(
                FACES_OF_ANYMATE in archive.open(name).read(MAX_PICKLE) for name in pickles
            )
    except (OSError, zipfile.BadZipFile):
        raise FileError(f"{path.name}: is no readable file of torch.save") from None
    if not has_faces:
        raise FileError(
            f"{path.name}: has points and no faces, as Anymate's training split; weights through "
            "the body need a mesh. Take a data set with faces"
        )
    raise FileError(
        f"{path.name}: is a file of torch.save, which only PyTorch reads; save each of its meshes "
        "(mesh_pc, mesh_face) with its joints as OBJ, GLB or npz"
    )


def _is_archive(path: Path) -> bool:
    try:
        with zipfile.ZipFile(path) as archive:
            return MEMBER in archive.namelist()
    except (OSError, zipfile.BadZipFile):
        return False  # the reader of npz files reports the fault


def _referenced(path: Path) -> dict[str, Path]:
    """List the existing files that a glTF document refers to."""
    if path.suffix.lower() != ".gltf":
        return {}
    try:
        document: Any = json.loads(path.read_text(encoding="utf-8"))
        entries = [*document.get("buffers", []), *document.get("images", [])]
        names = [e["uri"] for e in entries if not e.get("uri", "data:").startswith("data:")]
    except (OSError, ValueError, AttributeError, TypeError):
        return {}  # the reader of glTF files reports the fault
    beside_it = sorted(file for file in {beside(path, name) for name in names} if file is not None)
    files = {file: regular_file(file, path.parent) for file in beside_it}
    return {file.relative_to(path.parent).as_posix(): real for file, real in files.items() if real}


def _named(sources: list[Source]) -> list[Source]:
    """Make names differ where folders have rigs of the same name, or files differ in ending."""
    counts: Counter[str] = Counter()
    named = []
    for source in sources:
        counts[source.name] += 1
        count = counts[source.name]
        named.append(source if count == 1 else replace(source, name=f"{source.name}~{count}"))
    return named


def read_source(source: Source, folder: Path) -> Rig:
    """Return the rig of a source; see `read_content`."""
    try:
        return read_content(source.content(), folder)
    except CutcellError as error:
        raise type(error)(f"{source.name}: {error}") from None
