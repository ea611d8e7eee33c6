"""A bare mesh (OBJ, PLY, STL, OFF), with a skeleton beside it or without."""

from __future__ import annotations

import io
import logging
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import FileError, MeshError
from ..rig import Rig, Skeleton, TriangleMesh
from .deforming import with_deform
from .files import one_line, read_bytes, read_text
from .objects import parse_obj
from .skeleton_json import read_skeleton_json, skeleton_file

logging.getLogger("trimesh").addHandler(logging.NullHandler())  # it writes tracebacks to terminals
MESHES = (".obj", ".ply", ".stl", ".off")


def read_soup(path: Path, skeleton: Path | None) -> Rig:
    """Load a mesh and its skeleton, if it has one; the mesh comes without weights.

    Parameters
    ----------
    path : Path
        The mesh.
    skeleton : Path, optional
        The skeleton; ``NAME.skeleton.json`` or ``NAME.json`` beside the mesh when left out.
    """
    mesh = read_mesh(path)
    found = skeleton or skeleton_file(path)
    if found is None:
        return Rig(mesh, Skeleton([], []), name=path.stem)  # type: ignore[arg-type]
    joints, says_deform = read_skeleton_json(found)
    told: list[str] = []
    if not says_deform:
        joints, told = with_deform(mesh, joints, None)
    return Rig(mesh, joints, name=path.stem, warnings=tuple(told))


def read_mesh(path: Path) -> TriangleMesh:
    """Read a mesh with every vertex in the file's order.

    A binary STL has no shared vertices: each triangle brings its own three.
    """
    if path.suffix.lower() == ".obj":
        return parse_obj(read_text(path))  # names the line that is wrong
    return _through_trimesh(read_bytes(path), path.suffix.lower()[1:])


def _through_trimesh(data: bytes, kind: str) -> TriangleMesh:
    import trimesh

    try:
        loaded: Any = trimesh.load(io.BytesIO(data), file_type=kind, process=False, force="mesh")
    except Exception as e:  # trimesh's readers raise whatever their parsing runs into
        raise FileError(f"is not a readable {kind.upper()} file ({one_line(e)})") from e
    faces = getattr(loaded, "faces", np.zeros((0, 3), int))
    if not len(faces):
        raise MeshError("has no triangles")
    return TriangleMesh(np.asarray(loaded.vertices), np.asarray(faces))
