"""Meshes (OBJ, PLY, STL, OFF), with a skeleton beside them or without; an OBJ may be RigNet's."""

from __future__ import annotations

import io
import logging
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import FileError, MeshError
from ...rig import Rig, Skeleton, TriangleMesh
from ..files import one_line, read_bytes, read_text
from ..materials.obj_materials import ObjSource
from ..materials.surfaces import Surface, Surfaces
from ..obj import parse_obj
from ..weights import with_deform
from . import rignet
from .skeleton_json import read_skeleton

logging.getLogger("trimesh").addHandler(logging.NullHandler())  # it writes tracebacks to terminals

SUFFIXES = {
    ".obj": rb"\s*(#|(mtllib|usemtl|v|vt|vn|o|g|s)\s)",
    ".ply": rb"ply\s",
    ".stl": rb"solid\s",
    ".off": rb"\w{0,4}OFF\s",
}
NOTE = "a mesh, with a skeleton in a .json beside it"


def read(path: Path, accessories: bool = False, bare: bool = False) -> Rig:
    """Load a mesh, and the skeleton beside it unless `bare`; the mesh comes without weights."""
    if path.suffix.lower() == ".obj" and not bare and (rig_file := rignet.rig_file(path)):
        return rignet.read(rig_file)
    mesh, surfaces = read_mesh(path)
    beside = None if bare else skeleton_file(path)
    if beside is None:
        return Rig(mesh, Skeleton([], []), name=path.stem, source=surfaces)  # type: ignore[arg-type]
    joints, _, stored, _ = read_skeleton(beside)
    warnings: list[str] = []
    if stored is None:
        joints, _, warnings = with_deform(mesh, joints, None)
    return Rig(mesh, joints, name=path.stem, warnings=tuple(warnings), source=surfaces)


def read_mesh(path: Path) -> tuple[TriangleMesh, Surfaces | ObjSource | None]:
    """Read a mesh with every vertex in the file's order, and what colours it, if anything does."""
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


def skeleton_file(path: Path) -> Path | None:
    """Return the skeleton file next to a mesh, if there is one."""
    choices = (path.with_name(f"{path.stem}.skeleton.json"), path.with_suffix(".json"))
    return next((c for c in choices if c.is_file()), None)
