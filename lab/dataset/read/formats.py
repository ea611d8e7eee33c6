"""Rigs of UniRig (`raw_data.npz`) and of Puppeteer (HDF5)."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from cutcell.checks import one_line
from cutcell.errors import CutcellError, FileError, MissingLibraryError, SkeletonError, WeightsError
from cutcell.geometry.edges import find_edges
from cutcell.io.formats.articulation import HEADERS, rounding_notes, write
from cutcell.io.weights import normalised, with_deform
from cutcell.rig import Rig, Skeleton, TriangleMesh

from .unpickle import plain_objects

SAMPLE = "sample_"
"""How the groups of Puppeteer's HDF5 begin; a number follows."""
RECOVERED = 0.9
"""Share of the edges that must lie in a triangle, where triangles are found from edges."""


def read_unirig(data: bytes, name: str) -> Rig:
    """Return the rig of one `raw_data.npz`.

    `vertices` (N, 3), `faces` (F, 3), `joints` (J, 3), `parents` (J,) with None for the root,
    `names` (J,), `skin` (N, J). `parents` is pickled, and read as data alone.
    """
    arrays = _members(data, name)
    missing = [k for k in ("vertices", "faces", "joints", "parents") if arrays.get(k) is None]
    if missing:
        raise FileError(f"{name}: is no rig of UniRig: it lacks {', '.join(missing)}")
    mesh = TriangleMesh(
        _numbers(arrays["vertices"], "vertices"), _numbers(arrays["faces"], "faces")
    )
    joints = _numbers(arrays["joints"], "joints")
    parents = [-1 if p is None else p for p in np.asarray(arrays["parents"], object).reshape(-1)]
    if not all(isinstance(p, int | np.integer) for p in parents):
        raise SkeletonError("parents must be joint numbers, or None for the root")
    names = arrays.get("names")
    skeleton = Skeleton(joints, parents, () if names is None else [str(n) for n in names])
    weights = None
    if arrays.get("skin") is not None:
        skin = _numbers(arrays["skin"], "skin").astype(np.float64)
        if skin.shape != (len(mesh.vertices), len(joints)):
            raise WeightsError(
                f"skin has the shape {skin.shape}, but there are {len(mesh.vertices)} vertices "
                f"and {len(joints)} joints"
            )
        weights = normalised(np.where(np.isfinite(skin) & (skin > 0), skin, 0.0))
    skeleton, weights, warnings = with_deform(mesh, skeleton, weights)
    notes = rounding_notes(np.asarray(arrays["vertices"]), mesh)
    return Rig(mesh, skeleton, weights, name=name, warnings=(*notes, *warnings))


def _members(data: bytes, name: str) -> dict[str, Any]:
    arrays: dict[str, Any] = {}
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            for member in archive.infolist():
                with archive.open(member) as stream:
                    version = npy.read_magic(stream)
                    shape, _, dtype = HEADERS[version](stream)
                    key = member.filename.removesuffix(".npy")
                    if not dtype.hasobject:
                        arrays[key] = npy.read_array(io.BytesIO(archive.read(member)))
                    elif shape != ():  # a single object is None, or a path
                        arrays[key] = list(
                            plain_objects(stream, f"{name}: {key}", len(data) + 4096)
                        )
    except CutcellError:
        raise
    except Exception as error:  # zipfile and numpy raise whatever their parsing runs into
        raise FileError(f"{name}: is no readable npz archive ({one_line(error)[:200]})") from None
    return arrays


def _numbers(value: Any, what: str) -> NDArray:
    array = np.asarray(value)
    if array.dtype.kind not in "fiu" or array.ndim != 2:
        raise FileError(f"{what} are no table of numbers")
    return array


def samples_of(path: Path) -> list[str]:
    """List the groups of a file of Puppeteer's, in order."""
    with _opened(path) as file:
        names = [name for name in file if name.startswith(SAMPLE)]
    if not names:
        raise FileError(f'{path.name}: has no group "{SAMPLE}0"; it is no data set of Puppeteer\'s')
    return sorted(names, key=lambda name: (len(name), name))


def read_samples(path: Path, names: list[str]) -> Iterator[tuple[str, bytes]]:
    """Yield the samples of a file of Puppeteer's, each as the bytes of an Articulation-XL npz.

    Such a file has edges and no faces where it was made to evaluate: then the triangles are the
    circles of three edges, turned to agree with their neighbours.
    """
    with _opened(path) as file:
        for name in names:
            yield name, write(path, _sample(file[name], f"{path.name}/{name}"))[path]


def _opened(path: Path) -> Any:
    try:
        import h5py
    except ImportError:
        raise MissingLibraryError(
            "HDF5 is read by h5py, which is not installed; try: pip install 'cutcell[dataset]'"
        ) from None
    try:
        return h5py.File(path, "r")
    except OSError as error:
        raise FileError(
            f"{path.name}: is no readable HDF5 file ({one_line(error)[:200]})"
        ) from None


def _sample(group: Any, name: str) -> Rig:
    missing = [key for key in ("vertices", "joints", "bones") if key not in group]
    if missing:
        raise FileError(f"{name}: lacks {', '.join(missing)}")
    vertices, joints = group["vertices"][:], group["joints"][:]
    if "faces" in group:
        faces = group["faces"][:]
    elif "edges" in group:
        faces = faces_of_edges(vertices, group["edges"][:])
    else:
        raise FileError(f"{name}: has neither faces nor edges")
    parents = np.full(len(joints), -1)
    for parent, child in np.asarray(group["bones"][:], int).reshape(-1, 2):
        if not (0 <= parent < len(joints) and 0 <= child < len(joints)):
            raise SkeletonError(f"{name}: bones must be pairs of joint numbers")
        parents[child] = parent
    weights = None
    if "skin" in group:
        skin = np.asarray(group["skin"][:], np.float64)
        if skin.shape[0] != len(vertices) or skin.ndim != 2 or skin.shape[1] < len(joints):
            raise WeightsError(f"{name}: skin has the shape {skin.shape}, which does not fit")
        weights = normalised(np.maximum(skin[:, : len(joints)], 0))
    return Rig(TriangleMesh(vertices, faces), Skeleton(joints, parents), weights, name=name)


def faces_of_edges(vertices: NDArray, edges: NDArray) -> NDArray[np.int64]:
    """Find the triangles of a mesh from its edges.

    Shapes: vertices (n, 3), edges (e, 2); returns (m, 3).
    """
    import trimesh

    pairs = np.unique(np.sort(np.asarray(edges, np.int64).reshape(-1, 2), axis=1), axis=0)
    pairs = pairs[pairs[:, 0] < pairs[:, 1]]
    if len(pairs) and not (pairs.min() >= 0 and pairs.max() < len(vertices)):
        raise FileError("an edge uses a vertex that is not there")
    above: dict[int, set[int]] = {}
    for a, b in pairs.tolist():
        above.setdefault(a, set()).add(b)
    faces = [
        (a, b, c)
        for a, b in pairs.tolist()
        for c in sorted(above[a] & above.get(b, set()))
    ]  # fmt: skip
    if not faces:
        raise FileError("its edges make no triangles; save its faces as well")
    triangles = np.array(faces, np.int32)
    used = find_edges(triangles).edges
    if len(used) < RECOVERED * len(pairs):
        raise FileError(
            f"only {len(used):,} of its {len(pairs):,} edges lie in a triangle; its faces had more "
            "corners than three, save them as triangles"
        )
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    trimesh.repair.fix_normals(mesh, multibody=True)
    return np.asarray(mesh.faces, np.int64)
