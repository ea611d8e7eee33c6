"""Export of a store: the formats of RigNet, UniRig and Puppeteer, and a table in Parquet."""

from __future__ import annotations

import io
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import shortest_path

from cutcell.checks import check_choice
from cutcell.errors import FileError, MissingLibraryError
from cutcell.geometry.edges import find_edges
from cutcell.geometry.segments import distance_to_segment
from cutcell.io.formats.rignet import word_names
from cutcell.io.obj import write_obj
from cutcell.rig import TriangleMesh
from cutcell.runtime.writing import replacing, write_all

from .audit.points import mesh_normals, sample_surface
from .read.entry import Entry
from .read.store import Store, import_arrow
from .torch_data import at_points

FORMATS = ("rignet", "unirig", "puppeteer", "parquet")
UNREACHED = 8.0
"""RigNet's offset to the straight distance for vertices that no path reaches."""
POINTS = 8192
"""Puppeteer's points a surface."""
APART = 999.0
"""Puppeteer's graph distance between joints of two trees, which is also its padding."""


def export(
    store: Path, out: Path, kind: str, report: Callable[[str], None] = lambda name: None
) -> int:
    """Write a store in the format of a project's training code, or as one table.

    Parameters
    ----------
    store : Path
        Made by `bind_all`.
    out : Path
        A folder; for Puppeteer an HDF5 file, for Parquet its file.
    kind : {"rignet", "unirig", "puppeteer", "parquet"}
        See `docs/dataset.md` for the files and arrays of each.
    report : callable
        Receives the name of each asset.

    Returns
    -------
    int
        Number of written assets.

    Raises
    ------
    ParameterError
        There is no such format.
    FileError
        The folder is no store or lacks data for the format, or a file cannot be written.
    MissingLibraryError
        h5py is not installed, for Puppeteer; or pyarrow.
    """
    check_choice("kind", kind, FORMATS)
    entries = _named(Store(store), report)
    if kind == "puppeteer":
        return _puppeteer(entries, out)
    if kind == "parquet":
        return _parquet(entries, out)
    count = 0
    for name, entry in entries:
        write_all(_rignet(out, name, entry) if kind == "rignet" else _unirig(out, name, entry))
        count += 1
    return count


def _named(store: Store, report: Callable[[str], None]) -> Iterator[tuple[str, Entry]]:
    """Yield entries under unique names without slashes."""
    counts: Counter[str] = Counter()
    for name, entry in store.entries():
        flat = name.replace("/", "_")
        counts[flat] += 1
        report(name)
        yield flat if counts[flat] == 1 else f"{flat}~{counts[flat]}", entry


def rignet_distances(entry: Entry) -> NDArray[np.float32]:
    """Return the distances of all bones to all vertices in RigNet's form, shape (n, b).

    They are finite, in the units of the mesh, with bones in RigNet's order.
    """
    if not len(entry.bone_joints):
        raise FileError("the store has no distances of single bones; bind again with --bones")
    distances = entry.bone_distances * np.float32(entry.scale)
    lost = ~np.isfinite(distances)
    if lost.any():
        ends = entry.joints[entry.bone_joints]
        for bone in np.flatnonzero(lost.any(axis=0)):
            at = lost[:, bone]
            straight = distance_to_segment(entry.vertices[at], *ends[bone])
            distances[at, bone] = (UNREACHED * entry.scale + straight).astype(np.float32)
    return distances


def _rignet(out: Path, name: str, entry: Entry) -> dict[Path, bytes]:
    """Return RigNet's three files of an asset."""
    packed = io.BytesIO()
    np.save(packed, rignet_distances(entry))
    identifiers = word_names(entry.names)
    lines = [
        f"joints {word} {x:.8g} {y:.8g} {z:.8g}"
        for word, (x, y, z) in zip(identifiers, entry.joints.tolist(), strict=True)
    ]
    lines += [f"root {identifiers[j]}" for j in np.flatnonzero(entry.parents < 0)[:1]]
    lines += [
        f"hier {identifiers[p]} {identifiers[j]}"
        for j, p in enumerate(entry.parents.tolist())
        if p >= 0
    ]
    weights = entry.weights if entry.artist is None else entry.artist
    for vertex, row in enumerate(weights):
        carrying = np.flatnonzero(row)
        if len(carrying):
            lines.append(
                f"skin {vertex} " + " ".join(f"{identifiers[j]} {row[j]:.6g}" for j in carrying)
            )
    mesh = TriangleMesh(entry.vertices, entry.faces)
    return {
        out / "obj" / f"{name}.obj": write_obj(mesh).encode(),
        out / "rig_info" / f"{name}.txt": ("\n".join(lines) + "\n").encode(),
        out / "volumetric_geodesic" / f"{name}_volumetric_geo.npy": packed.getvalue(),
    }


def _unirig(out: Path, name: str, entry: Entry) -> dict[Path, bytes]:
    """Return UniRig's `raw_data.npz`, and the prior in the order of its joints."""
    order, parents = _parents_first(entry.parents)
    joints = entry.joints[order]
    tails = joints.copy()
    for joint in range(len(joints)):
        below = [k for k, parent in enumerate(parents) if parent == joint]
        above = parents[joint]
        if below:
            tails[joint] = joints[below].mean(axis=0)
        elif above is not None:
            tails[joint] = joints[joint] + (joints[joint] - joints[above]) / 2
    local = np.tile(np.eye(4, dtype=np.float32), (len(joints), 1, 1))
    local[:, :3, 3] = joints
    face_normals, vertex_normals = mesh_normals(entry.vertices, entry.faces)
    raw = {
        "vertices": entry.vertices,
        "vertex_normals": vertex_normals,
        "faces": entry.faces.astype(np.int64),
        "face_normals": face_normals,
        "joints": joints,
        "tails": tails,
        "skin": (entry.weights if entry.artist is None else entry.artist)[:, order],
        "parents": np.array(parents, object),
        "names": np.array(entry.names, np.str_)[order],
        "matrix_local": local,
    }
    packed, prior = io.BytesIO(), io.BytesIO()
    np.savez_compressed(packed, **raw)  # type: ignore[arg-type]
    np.save(prior, entry.weights[:, order])
    folder = out / name
    return {folder / "raw_data.npz": packed.getvalue(), folder / "voxel_skin.npy": prior.getvalue()}


def _parents_first(parents: NDArray) -> tuple[NDArray[np.intp], list[int | None]]:
    """Order joints so that parents come first; further roots become children of the first."""
    order: list[int] = []
    level = np.flatnonzero(parents < 0).tolist()
    while level:
        order += level
        level = [j for p in level for j in np.flatnonzero(parents == p).tolist()]
    place = {joint: k for k, joint in enumerate(order)}
    above = [place.get(int(parents[joint])) for joint in order]
    return np.array(order), [None, *(0 if p is None else p for p in above[1:])]


def _puppeteer(entries: Iterator[tuple[str, Entry]], out: Path) -> int:
    try:
        import h5py
    except ImportError:
        raise MissingLibraryError(
            "HDF5 is written by h5py, which is not installed; try: pip install 'cutcell[dataset]'"
        ) from None
    out.parent.mkdir(parents=True, exist_ok=True)
    count = 0
    with replacing(out) as (unready,), h5py.File(unready, "w", locking=False) as file:
        for name, entry in entries:
            group = file.create_group(f"sample_{count}")
            for key, value in _puppeteer_sample(name, entry, count).items():
                group.create_dataset(key, data=value)
            count += 1
    return count


def _puppeteer_sample(name: str, entry: Entry, seed: int) -> dict[str, Any]:
    points = sample_surface(entry.vertices, entry.faces, POINTS, seed)
    face_normals, _ = mesh_normals(entry.vertices, entry.faces)
    children = np.flatnonzero(entry.parents >= 0)
    bones = np.stack([entry.parents[children], children], axis=1)
    count = len(entry.joints)
    links = coo_array((np.ones(len(children)), (bones[:, 0], bones[:, 1])), shape=(count, count))
    hops = shortest_path(links.tocsr(), directed=False, unweighted=True)
    cloud = np.concatenate([points.places, face_normals[points.face]], axis=1)
    return {
        "pc_w_norm": cloud.astype(np.float32),
        "joints": entry.joints,
        "bones": bones.astype(np.int32),
        "root_index": np.int64(np.flatnonzero(entry.parents < 0)[0]),
        "graph_dist": np.where(np.isfinite(hops), hops, APART).astype(np.float32),
        "file_name": np.bytes_(name.encode()),
        "vertices": entry.vertices,
        "faces": entry.faces,
        "edges": find_edges(entry.faces).edges.astype(np.int64),
        "skin": entry.weights if entry.artist is None else entry.artist,
        "prior": entry.weights,
        "prior_points": at_points(entry.weights, entry.faces, points).astype(np.float32),
    }


def _parquet(entries: Iterator[tuple[str, Entry]], out: Path) -> int:
    """Write a row an asset, each in a row group of its own: memory is that of one asset."""
    arrow, parquet = import_arrow()
    numbers, whole = arrow.float32(), arrow.int32()
    points, table = arrow.list_(arrow.list_(numbers, 3)), arrow.list_(arrow.list_(numbers))
    schema = arrow.schema(
        {
            "name": arrow.string(),
            "vertices": points,
            "faces": arrow.list_(arrow.list_(whole, 3)),
            "joints": points,
            "parents": arrow.list_(whole),
            "joint_names": arrow.list_(arrow.string()),
            "scale": arrow.float64(),
            "distances": table,
            "prior": table,
            "skin": table,
        }
    )
    out.parent.mkdir(parents=True, exist_ok=True)
    count = 0
    with (
        replacing(out) as (unready,),
        parquet.ParquetWriter(unready, schema, compression="zstd") as writer,
    ):
        for name, entry in entries:
            row = {
                "name": name,
                "vertices": list(entry.vertices),
                "faces": list(entry.faces),
                "joints": list(entry.joints),
                "parents": entry.parents,
                "joint_names": list(entry.names),
                "scale": entry.scale,
                "distances": list(entry.distances.astype(np.float32)),
                "prior": list(entry.weights.astype(np.float32)),
                "skin": None if entry.artist is None else list(entry.artist.astype(np.float32)),
            }
            writer.write_table(arrow.Table.from_pylist([row], schema))
            count += 1
    return count
