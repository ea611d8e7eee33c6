"""Conversion of meshes and rigs: from plain arrays, or objects of trimesh and PyVista."""

from __future__ import annotations

from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import shown
from ..errors import CutcellError, MeshError, SkeletonError
from .mesh import TriangleMesh
from .rig import Rig
from .skeleton import Skeleton


@runtime_checkable
class TrimeshLike(Protocol):
    """Attributes read from a `trimesh.Trimesh`."""

    vertices: Any  # (n, 3)
    faces: Any  # (m, 3)


@runtime_checkable
class PolyDataLike(Protocol):
    """Attributes read from a `pyvista.PolyData`."""

    points: Any  # (n, 3)
    faces: Any  # for each face how many corners it has, then these; all in one row


MeshLike: TypeAlias = TriangleMesh | TrimeshLike | PolyDataLike | tuple[ArrayLike, ArrayLike]
"""A mesh; (vertices, faces); a `trimesh.Trimesh`; a `pyvista.PolyData` of triangles."""
SkeletonLike: TypeAlias = Skeleton | tuple[ArrayLike, ArrayLike]
"""A skeleton; or (joints, parents)."""
RigLike: TypeAlias = (
    Rig | tuple[MeshLike, SkeletonLike] | tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike]
)
"""A rig; (mesh, skeleton); or (vertices, faces, joints, parents)."""


def as_mesh(mesh: MeshLike) -> TriangleMesh:
    """Return a mesh for one of several kinds; positions in C-contiguous float64 are not copied."""
    if isinstance(mesh, TriangleMesh):
        return mesh
    if isinstance(mesh, tuple | list) and len(mesh) == 2:
        return TriangleMesh(_read_only(mesh[0]), _read_only(mesh[1]))
    if isinstance(mesh, PolyDataLike):
        return TriangleMesh(_read_only(mesh.points), _triangles(mesh.faces))
    if isinstance(mesh, TrimeshLike):
        return TriangleMesh(_read_only(mesh.vertices), _read_only(mesh.faces))
    raise MeshError(
        "a mesh must be a cutcell.TriangleMesh, a pair of arrays (vertices, faces), a "
        f"trimesh.Trimesh or a pyvista.PolyData, not {_kind(mesh)}"
    )


def as_rig(rig: RigLike) -> Rig:
    """Return a rig for one of several kinds."""
    if isinstance(rig, Rig):
        return rig
    if isinstance(rig, tuple | list) and len(rig) == 4:
        vertices, faces, joints, parents = rig
        return Rig(as_mesh((vertices, faces)), as_skeleton((joints, parents)))
    if isinstance(rig, tuple | list) and len(rig) == 2:
        return Rig(as_mesh(rig[0]), as_skeleton(rig[1]))
    raise CutcellError(
        "a rig must be a cutcell.Rig, a pair (mesh, skeleton), or four arrays (vertices, faces, "
        f"joints, parents), not {_kind(rig)}"
    )


def as_skeleton(skeleton: SkeletonLike) -> Skeleton:
    """Return a skeleton for one of several kinds."""
    if isinstance(skeleton, Skeleton):
        return skeleton
    if isinstance(skeleton, tuple | list) and len(skeleton) == 2:
        return Skeleton(np.asarray(skeleton[0]), np.asarray(skeleton[1]))
    raise SkeletonError(
        "a skeleton must be a cutcell.Skeleton or a pair of arrays (joints, parents), "
        f"not {_kind(skeleton)}"
    )


def _read_only(array: ArrayLike) -> NDArray[Any]:
    """Return an array that may be kept without a copy: nobody writes to it through this one."""
    try:
        view = np.asarray(array).view()
    except ValueError:  # rows of several lengths, for which `as_array` has a sentence
        return array  # type: ignore[return-value]
    view.flags.writeable = False
    return view


def _triangles(faces: Any) -> NDArray[Any]:
    """Return the corners of faces as VTK lists them, shape (m, 3)."""
    listed = np.asarray(faces)
    rows = listed.reshape(-1, 4) if listed.ndim == 1 and len(listed) % 4 == 0 else None
    if rows is None or (rows[:, 0] != 3).any():
        raise MeshError(
            "the PyVista mesh has faces that are no triangles; call its triangulate() first"
        )
    return rows[:, 1:]


def _kind(value: Any) -> str:
    if isinstance(value, tuple | list):
        return f"a {type(value).__name__} of {len(value)}"
    return shown(value) if isinstance(value, str) or value is None else f"a {type(value).__name__}"
