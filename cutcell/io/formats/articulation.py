"""Articulation-XL 2.0: one rig as arrays in an ``npz`` file (Song et al. 2025).

``vertices`` (n, 3), ``faces`` (m, 3), ``joints`` (j, 3), ``bones`` (b, 2) as pairs of
parent and child, ``root_index``, ``joint_names`` (j,), and the weights as a sparse matrix:
``skinning_weights_value``, ``_row``, ``_col`` (or ``_rows``, ``_cols``) and ``_shape``. cutcell
adds which joints deform, ``cutcell_deform`` (j,).
"""

from __future__ import annotations

import io
import math
import zipfile
from pathlib import Path

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from ...errors import CutcellError, FileError, SkeletonError, WeightsError
from ...rig import Rig, Skeleton, TriangleMesh
from ..files import HALVES, Allowance, has_halves, one_line, read_bytes, whole_characters
from ..skeletons import SkeletonFile
from ..weights import DEFORM_KEY, NO_WEIGHTS, ReadWeights, loaded_rig, summed

SUFFIXES = {".npz": rb"PK[\0-\xff]{28}\w+\.npy"}
NOTE = "Articulation-XL"
HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
REQUIRED = ("vertices", "faces", "joints", "bones")


def read(path: Path, accessories: bool = False, bare: bool = False) -> Rig:
    """Load an Articulation-XL rig."""
    arrays = _arrays(read_bytes(path))
    missing = [name for name in REQUIRED if name not in arrays]
    if missing:
        raise FileError(
            f"is no Articulation-XL rig: it lacks {', '.join(missing)} "
            f"(it has {', '.join(sorted(arrays)) or 'nothing'})"
        )
    mesh = TriangleMesh(arrays["vertices"], arrays["faces"])
    joints = arrays["joints"]
    if joints.ndim != 2 or joints.shape[1] != 3:
        raise SkeletonError(f"joints has the shape {joints.shape}, expected (any, 3)")
    count = len(joints)
    if count == 0:
        raise SkeletonError("has no joints")
    weights = _weights(arrays, len(mesh.vertices), count, f'mesh "{path.stem}"')
    parents, names = _parents(arrays, count), _names(arrays, count)
    warnings = rounding_notes(arrays["vertices"], mesh)
    warnings += [HALVES] if any(map(has_halves, names)) else []
    skeleton = Skeleton(joints, parents, tuple(map(whole_characters, names)))
    stored = arrays.get(DEFORM_KEY)
    if stored is not None and (stored.dtype != np.bool_ or stored.shape != (count,)):
        warnings.append(f"{DEFORM_KEY} is ignored; it is no array of true or false for each joint")
        stored = None
    return loaded_rig(mesh, skeleton, weights, path.stem, stored, warnings)


def rounding_notes(positions: NDArray, mesh: TriangleMesh) -> list[str]:
    """Say how many triangles of a mesh have collapsed where its positions have 16 bits."""
    if positions.dtype != np.float16 or mesh.welded.is_whole.all():
        return []
    lost = int(np.count_nonzero(~mesh.welded.is_whole))
    return [
        f"{lost:,} of {len(mesh.faces):,} triangles have collapsed; positions are stored in 16 "
        "bits, which moves a coordinate by up to a 2,000th of its value. Read the "
        "original file for weights that follow its shape"
    ]


def read_skeleton(path: Path) -> SkeletonFile:
    """Read the skeleton of a rig."""
    return SkeletonFile(read(path).skeleton)


def _arrays(data: bytes) -> dict[str, NDArray]:
    allowance = Allowance(len(data))
    if data.startswith(npy.MAGIC_PREFIX):
        raise FileError("is a single array, not an npz archive of several")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            return {
                member.filename.removesuffix(".npy"): _array(archive, member, allowance)
                for member in archive.infolist()
            }
    except CutcellError:
        raise
    except Exception as e:  # zipfile and its decoders raise whatever their parsing runs into
        raise FileError(f"is not a readable npz archive: {one_line(e)}") from None


def _array(archive: zipfile.ZipFile, member: zipfile.ZipInfo, allowance: Allowance) -> NDArray:
    """Read an array, after a look at what its header says that it holds."""
    what = f'its array "{member.filename[:40]}"'
    allowance.take(2 * member.file_size, what)
    stored = io.BytesIO(archive.read(member))
    version = npy.read_magic(stored)
    if version not in HEADERS:
        raise FileError(f"{what} is of the npy version {version[0]}.{version[1]}")
    shape, _, dtype = HEADERS[version](stored)
    if dtype.hasobject:
        raise FileError(
            "holds pickled Python objects, which could run any code and are not opened; "
            "save its arrays as plain numbers and text"
        )
    size, available = math.prod(shape) * dtype.itemsize, member.file_size - stored.tell()
    if min(shape, default=0) < 0 or size != available:
        raise FileError(f"{what} announces {size:,} bytes and holds {available:,}")
    stored.seek(0)
    return npy.read_array(stored, allow_pickle=False)


def _parents(arrays: dict[str, NDArray], count: int) -> NDArray:
    bones = arrays["bones"] if arrays["bones"].size else np.zeros((0, 2), int)
    whole = bones.dtype.kind in "iu" and bones.ndim == 2 and bones.shape[1] == 2
    if not whole or ((bones < 0) | (bones >= count)).any():
        raise SkeletonError(f"bones must be pairs of joint numbers, 0 to {count - 1}")
    parents = np.full(count, -1)
    for parent, child in bones.tolist():
        if parents[child] not in (-1, parent):
            raise SkeletonError(f"joint {child} hangs on two joints, {parents[child]} and {parent}")
        parents[child] = parent
    if "root_index" in arrays:
        root = arrays["root_index"]
        k = int(root.flat[0]) if root.size == 1 and root.dtype.kind in "iu" else -1
        if not 0 <= k < count:
            raise SkeletonError(f"root_index must be one joint number, 0 to {count - 1}")
        if parents[k] >= 0:
            raise SkeletonError(f"joint {k} is the root but hangs on joint {parents[k]}")
    return parents


def _names(arrays: dict[str, NDArray], count: int) -> tuple[str, ...]:
    if "joint_names" not in arrays:
        return ()
    names = arrays["joint_names"].reshape(-1)
    if len(names) != count or names.dtype.kind not in "US":
        raise SkeletonError(f"joint_names must be {count} texts, as many as there are joints")
    return tuple(n.decode("utf-8", "replace") if isinstance(n, bytes) else str(n) for n in names)


def _weights(arrays: dict[str, NDArray], vertices: int, joints: int, owner: str) -> ReadWeights:
    if "skinning_weights_value" not in arrays:
        return NO_WEIGHTS
    parts = []
    for names in (("row", "rows"), ("col", "cols")):
        keys = [f"skinning_weights_{n}" for n in names]
        key = next((k for k in keys if k in arrays), None)
        if key is None:
            raise FileError(f"has skinning_weights_value but no {keys[0]}")
        parts.append(arrays[key].reshape(-1))
    (rows, columns), values = parts, arrays["skinning_weights_value"].reshape(-1)
    if any(p.dtype.kind not in "iu" for p in parts) or values.dtype.kind not in "fiu":
        raise WeightsError("skinning weights must be numbers, their rows and columns whole ones")
    if not len(rows) == len(columns) == len(values):
        raise WeightsError(
            f"there are {len(values)} skinning weights, {len(rows)} rows and {len(columns)} columns"
        )
    if ((rows < 0) | (rows >= vertices) | (columns < 0) | (columns >= joints)).any():
        raise WeightsError(
            f"a skinning weight lies outside of {vertices} vertices and {joints} joints"
        )
    shape = arrays.get("skinning_weights_shape")
    if shape is not None and shape.reshape(-1).tolist() != [vertices, joints]:
        raise WeightsError(
            f"the skinning weights are {shape.reshape(-1).tolist()}, but the mesh has {vertices} "
            f"vertices and the skeleton {joints} joints"
        )
    return summed(rows, columns, values, (vertices, joints), owner)


def write(path: Path, rig: Rig) -> dict[Path, bytes]:
    """Return a rig as an Articulation-XL archive; `root_index` is the first of its roots."""
    skeleton = rig.skeleton
    children = np.flatnonzero(skeleton.parents >= 0)
    arrays = {
        "vertices": rig.mesh.vertices,
        "faces": rig.mesh.faces,
        "joints": skeleton.joints,
        "bones": np.stack([skeleton.parents[children], children], axis=1).astype(np.int32),
        "root_index": np.array(int(np.flatnonzero(skeleton.parents < 0)[0])),
        DEFORM_KEY: skeleton.deform,
        "joint_names": np.array([whole_characters(name) for name in skeleton.names], np.str_),
    }
    if rig.weights is not None:
        rows, columns = np.nonzero(rig.weights)
        arrays |= {
            "skinning_weights_value": rig.weights[rows, columns],
            "skinning_weights_row": rows.astype(np.int32),
            "skinning_weights_col": columns.astype(np.int32),
            "skinning_weights_shape": np.array(rig.weights.shape, np.int64),
        }
    packed = io.BytesIO()
    np.savez_compressed(packed, **arrays)  # type: ignore[arg-type]
    return {path: packed.getvalue()}
