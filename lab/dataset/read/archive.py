"""Articulation-XL 2.0 as published: an npz whose `arr_0` is a pickled list of dictionaries.

Each dictionary is one asset, its arrays named as in `cutcell.io.formats.articulation`, some of them
in two ways (`skinning_weights_row` and `_rows`, `_col` and `_cols`).
"""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from cutcell.checks import one_line
from cutcell.errors import FileError
from cutcell.io.formats.articulation import HEADERS
from cutcell.runtime.writing import reason, write_all

from .unpickle import Refused, plain_objects

MEMBER = "arr_0.npy"
UNSAFE = re.compile(r"[^A-Za-z0-9._-]+")
LONGEST_NAME = 120


@dataclass(frozen=True, eq=False)
class ArchivedAsset:
    """One asset of an archive.

    Parameters
    ----------
    index : int
        Its place in the archive, from 0.
    name : str
        Its `uuid`, fit for a file's name; its place where it has none.
    arrays : dict of str to array
        As they are stored; empty where it cannot be read.
    error : str
        Reason why it cannot be read; empty if it can.
    """

    index: int
    name: str
    arrays: Mapping[str, NDArray]
    error: str = ""


def read_archive(path: Path) -> Iterator[ArchivedAsset]:
    """Yield the assets of an archive, one at a time, without running anything that is in it.

    The memory taken is that of one asset, and eight bytes for each object before it.

    Parameters
    ----------
    path : Path
        An npz file with `arr_0`, as published: a pickled list of dictionaries.

    Raises
    ------
    FileError
        No such archive; or it is damaged, and what came before has been yielded.
    """
    try:
        with zipfile.ZipFile(path) as archive, archive.open(MEMBER) as member:
            _read_header(member, path)
            entries = plain_objects(member, path.name)
            for index, entry in enumerate(entries):
                yield _asset(index, entry)
    except FileNotFoundError:
        raise FileError(f"{path}: there is no such file") from None
    except KeyError:
        raise FileError(
            f"{path.name}: has no {MEMBER.removesuffix('.npy')}; an archive of Articulation-XL 2.0 "
            "holds all assets in one list of that name"
        ) from None
    except (OSError, zipfile.BadZipFile, zipfile.LargeZipFile, EOFError, NotImplementedError) as e:
        raise FileError(f"{path.name}: is no readable npz archive ({reason(e)})") from None


def _read_header(member: Any, path: Path) -> None:
    """Go past the npy header, up to the pickle."""
    try:
        version = npy.read_magic(member)
        _, _, dtype = HEADERS[version](member)
    except (ValueError, KeyError) as error:
        raise FileError(f"{path.name}: {MEMBER} is no array ({one_line(error)[:200]})") from None
    if not dtype.hasobject:
        raise FileError(
            f"{path.name}: {MEMBER} holds plain numbers, not a list of assets; a single asset is "
            "read as it is"
        )


def _asset(index: int, entry: Any) -> ArchivedAsset:
    if not isinstance(entry, dict):
        why = entry.why if isinstance(entry, Refused) else "it is no dictionary of arrays"
        return ArchivedAsset(index, f"asset_{index:06d}", {}, f"asset {index}: {why}")
    uuid = entry.get("uuid")
    name = UNSAFE.sub("_", uuid).strip("._")[:LONGEST_NAME] if isinstance(uuid, str) else ""
    arrays, faults = {}, []
    for key, value in entry.items():
        array = _as_plain_array(value)
        if array is None:
            faults.append(f'"{str(key)[:40]}": {_fault(value)}')
        else:
            arrays[str(key)] = array
    error = f"asset {index} ({name}): {'; '.join(faults[:3])}" if faults else ""
    return ArchivedAsset(index, name or f"asset_{index:06d}", {} if error else arrays, error)


def _as_plain_array(value: Any) -> NDArray | None:
    """Return a value as an array without objects, None if it is none."""
    if isinstance(value, np.ndarray):
        return value
    try:
        array = np.array(value)
    except (ValueError, TypeError, OverflowError, MemoryError):
        return None
    return array if array.dtype.kind in "biufSU" else None


def _fault(value: Any) -> str:
    if isinstance(value, Refused):
        return value.why
    if isinstance(value, list | tuple):
        refused = next((item for item in value if isinstance(item, Refused)), None)
        if refused:
            return refused.why
    return f"is a {type(value).__name__} that is no array"


def asset_bytes(asset: ArchivedAsset) -> bytes:
    """Return an asset as a separate npz file for `cutcell.load`."""
    packed = io.BytesIO()
    np.savez_compressed(packed, **asset.arrays)  # type: ignore[arg-type]
    return packed.getvalue()


@dataclass(frozen=True)
class Split:
    """Result of `split`.

    Parameters
    ----------
    written, kept : int
        Number of assets that were written, and that existed before.
    refused : dict of str to str
        Reasons why assets were not written, by name.
    """

    written: int
    kept: int
    refused: Mapping[str, str]


def split(archive: Path, folder: Path, report: Any = lambda asset: None) -> Split:
    """Write each asset of an archive to a separate file.

    No code of the archive is run. An asset with anything but arrays, texts and numbers is left
    out. Files with equal contents are not written again, so a split can be resumed.

    Parameters
    ----------
    archive : Path
        As `read_archive` takes it.
    folder : Path
        Gets `NAME.npz` for each asset; made if it is not there.
    report : callable
        Receives each `ArchivedAsset`.

    Returns
    -------
    Split

    Raises
    ------
    FileError
        The archive is none, or damaged; or a file cannot be written.
    """
    written = kept = 0
    refused: dict[str, str] = {}
    names: set[str] = set()
    for asset in read_archive(archive):
        name = asset.name
        if name.lower() in names:
            name = f"{name}_{asset.index:06d}"
        names.add(name.lower())
        report(asset)
        if asset.error:
            refused[name] = asset.error
            continue
        path, data = folder / f"{name}.npz", asset_bytes(asset)
        if path.is_file() and path.stat().st_size == len(data) and path.read_bytes() == data:
            kept += 1
        else:
            write_all({path: data})
            written += 1
    return Split(written, kept, refused)
