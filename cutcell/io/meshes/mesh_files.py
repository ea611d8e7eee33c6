"""A bare mesh (OBJ, PLY, STL, OFF), with a skeleton beside it or without."""

from __future__ import annotations

import io
import json
import logging
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import FileError, MeshError, SkeletonError
from ...rig import Rig, Skeleton, TriangleMesh
from ..files import has_halves, naming, one_line, read_bytes, read_text
from ..materials.obj_materials import ObjSource
from ..materials.surfaces import Surface, Surfaces
from ..weights import with_deform
from .obj import parse_obj

logging.getLogger("trimesh").addHandler(logging.NullHandler())  # it writes tracebacks to terminals


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


FIELDS = ("name", "position", "parent", "deform")


def skeleton_file(path: Path) -> Path | None:
    """Return the skeleton file next to a mesh, if there is one."""
    choices = (path.with_name(f"{path.stem}.skeleton.json"), path.with_suffix(".json"))
    return next((c for c in choices if c.is_file()), None)


def read_skeleton_json(path: Path) -> tuple[Skeleton, bool]:
    """Read a skeleton, and whether the file says which joints may carry weight."""
    with naming(path):
        text = read_text(path)
        try:
            data = json.loads(text)
        except (ValueError, RecursionError) as e:  # also numbers of thousands of digits
            raise FileError(f"its JSON cannot be read: {one_line(e)}") from None
        joints = data.get("joints") if isinstance(data, dict) else None
        if not isinstance(joints, list):
            raise FileError('is not a skeleton: it must be {"joints": [...]}')
        if not joints:
            raise SkeletonError("the skeleton has no joints; it needs at least one")
        names = [_name(joint, k) for k, joint in enumerate(joints)]
        twice = next((name for name, times in Counter(names).items() if times > 1), None)
        if twice is not None:
            raise SkeletonError(f'the joint "{twice}" is there twice; names must differ')
        place = {name: k for k, name in enumerate(names)} | {None: -1}
        for name, joint in zip(names, joints, strict=True):
            unknown = next((k for k in joint if k not in FIELDS), None)
            if unknown is not None:
                raise FileError(f'joint "{name}": "{unknown}" is none of {", ".join(FIELDS)}')
            parent = joint.setdefault("parent", None)
            if not isinstance(parent, str | None) or parent not in place:
                wrong = repr(parent)[:40]
                raise SkeletonError(
                    f'joint "{name}": its parent {wrong} is not a joint of the file'
                )
            if not isinstance(joint.get("deform", True), bool):
                raise SkeletonError(f'joint "{name}": "deform" must be true or false')
        skeleton = Skeleton(
            [_position(joint, name) for name, joint in zip(names, joints, strict=True)],
            [place[joint["parent"]] for joint in joints],
            names,
            [joint.get("deform", True) for joint in joints],
        )
        return skeleton, any("deform" in joint for joint in joints)


def _name(joint: Any, k: int) -> str:
    if not isinstance(joint, dict):
        raise FileError(f"joint {k} must be an object with a name and a position")
    name = joint.get("name")
    if not isinstance(name, str) or not name:
        raise SkeletonError(f'joint {k} needs a "name"')
    if has_halves(name):
        raise SkeletonError(f"the name of joint {k} holds half of a character (a lone surrogate)")
    return name


def _position(joint: dict[str, Any], name: str) -> list[float]:
    value = joint.get("position")
    try:
        right = isinstance(value, list) and [type(x) in (int, float) for x in value] == [True] * 3
        if right and np.isfinite(np.array(value, np.float64)).all():
            return value  # type: ignore[return-value]
    except OverflowError:  # a whole number with hundreds of digits
        pass
    raise SkeletonError(f'joint "{name}": "position" must be three finite numbers')
