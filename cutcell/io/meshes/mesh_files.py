"""A bare mesh (OBJ, PLY, STL, OFF), with a skeleton beside it or without."""

from __future__ import annotations

import io
import logging
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import FileError, MeshError
from ...rig import Rig, Skeleton, TriangleMesh
from ..deforming import with_deform
from ..files import one_line, read_bytes, read_text
from ..materials.obj_materials import ObjSource
from ..materials.surfaces import Surface, Surfaces
from .obj import parse_obj
from .skeleton_json import read_skeleton_json, skeleton_file

logging.getLogger("trimesh").addHandler(logging.NullHandler())  # it writes tracebacks to terminals
MESHES = (".obj", ".ply", ".stl", ".off")


def read_soup(path: Path, bare: bool = False) -> Rig:
    """Load a mesh and the skeleton beside it, if there is one; the mesh comes without weights."""
    mesh, surfaces = read_mesh(path)
    skeleton_path = None if bare else skeleton_file(path)
    if skeleton_path is None:
        return Rig(mesh, Skeleton([], []), name=path.stem, source=surfaces)  # type: ignore[arg-type]
    joints, says_deform = read_skeleton_json(skeleton_path)
    warnings: list[str] = []
    if not says_deform:
        joints, _, warnings = with_deform(mesh, joints, None)
    return Rig(mesh, joints, name=path.stem, warnings=tuple(warnings), source=surfaces)


def read_mesh(path: Path) -> tuple[TriangleMesh, Surfaces | ObjSource | None]:
    """Read a mesh with every vertex in the file's order, and what colours it, if anything does.

    A binary STL has no shared vertices: each triangle brings its own three.
    """
    if path.suffix.lower() == ".obj":
        contents = parse_obj(read_text(path))  # names the line that is wrong
        return contents.mesh, ObjSource(path, contents)
    loaded = _through_trimesh(read_bytes(path), path.suffix.lower()[1:])
    mesh = TriangleMesh(np.asarray(loaded.vertices), np.asarray(loaded.faces))
    return mesh, _coloured(path, mesh, loaded.visual)


def _through_trimesh(data: bytes, kind: str) -> Any:
    import trimesh

    try:
        loaded: Any = trimesh.load(io.BytesIO(data), file_type=kind, process=False, force="mesh")
    except Exception as e:  # trimesh's readers raise whatever their parsing runs into
        raise FileError(f"is not a readable {kind.upper()} file ({one_line(e)})") from e
    if not len(getattr(loaded, "faces", ())):
        raise MeshError("has no triangles")
    return loaded


def _coloured(path: Path, mesh: TriangleMesh, visual: Any) -> Surfaces | None:
    """Return the colours that a file gives to vertices or faces."""
    try:
        kind = getattr(visual, "kind", None)
        if kind not in ("vertex", "face"):
            return None
        values = np.asarray(visual.vertex_colors if kind == "vertex" else visual.face_colors)
        faces = mesh.faces if kind == "vertex" else np.arange(len(mesh.faces))[:, None].repeat(3, 1)
        colors = np.ascontiguousarray(values[faces][..., :3], np.uint8)
    except Exception:  # trimesh looks at them only now
        return None
    none = np.full(len(mesh.faces), -1, np.int32)
    return Surfaces(path, {0: Surface(mesh.faces, none, colors=colors)})
