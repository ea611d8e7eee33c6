# SPDX-License-Identifier: GPL-3.0-or-later
"""From Blender's objects to the arrays of a character, in the coordinates of glTF."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .job import Problem

Y_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
"""Blender's z is up. With glTF's axes the lattice, and the weights, are those of exported files."""


@dataclass(frozen=True, eq=False)
class Part:
    """A mesh object: its vertices in the character, and which of them may change."""

    object: Any
    vertices: slice
    locked: np.ndarray  # (j,): bones whose vertex groups are locked
    mask: np.ndarray | None  # (n,): vertices selected for painting; None for all


@dataclass(frozen=True, eq=False)
class Character:
    """Mesh objects and an armature as arrays."""

    armature: Any
    parts: tuple[Part, ...]
    arrays: dict[str, np.ndarray]

    @property
    def bones(self) -> list[str]:
        """Names of all bones."""
        return self.arrays["names"].tolist()


def gather(objects, armature, needs_weights: bool = False, editable: bool = True) -> Character:
    """Return mesh objects and their armature as a character.

    `needs_weights`: they must have weights. `editable`: their weights are to be changed. Raises a
    `Problem` if they cannot be bound.
    """
    if not objects:
        raise Problem("No mesh is selected. Select meshes and their armature")
    skeleton = skeleton_arrays(armature)
    names, deform = skeleton["names"].tolist(), skeleton["deform"]
    if editable:
        check_editable(objects, armature)
    parts, vertices, faces, stored, start = [], [], [], [], 0
    for obj in objects:
        points, triangles = surface(obj)
        rows, locked = stored_weights(obj, names)
        if editable and locked[deform].all():
            raise Problem(f'Every vertex group of "{obj.name}" is locked. Unlock some of them')
        end = start + len(points)
        parts.append(Part(obj, slice(start, end), locked, paint_mask(obj)))
        vertices.append(points)
        faces.append(triangles + start)
        stored.append(rows)
        start = end
    arrays = skeleton | {"vertices": np.concatenate(vertices), "faces": np.concatenate(faces)}
    every = np.concatenate(stored)
    locked = np.repeat([part.locked & deform for part in parts], list(map(len, stored)), axis=0)
    if editable and locked.any():
        arrays |= {"stored": every, "locked": locked}
    if (deforming := np.where(deform, every, 0.0)).any():
        arrays["weights"] = deforming
    elif needs_weights:
        raise Problem("The meshes have no weights of the armature's bones")
    return Character(armature, tuple(parts), arrays)


def skeleton_arrays(armature) -> dict[str, np.ndarray]:
    """Return the bones of an armature at rest, in world space."""
    if armature is None or armature.type != "ARMATURE":
        raise Problem("No armature. Make the armature the active object")
    bones = armature.data.bones
    if not len(bones):
        raise Problem(f'Armature "{armature.name}" has no bones')
    heads = np.zeros(3 * len(bones))
    bones.foreach_get("head_local", heads)
    index = {bone.name: i for i, bone in enumerate(bones)}
    deform = np.array([bone.use_deform for bone in bones])
    if not deform.any():
        raise Problem(f'No bone of "{armature.name}" deforms. Enable Deform for some of them')
    return {
        "joints": in_world(armature, heads.reshape(-1, 3)),
        "parents": np.array([index[b.parent.name] if b.parent else -1 for b in bones], np.int32),
        "names": np.array([bone.name for bone in bones], np.str_),
        "deform": deform,
    }


def surface(obj) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices (n, 3) and triangles (m, 3) of an object without shape keys and modifiers.

    An odd number of negative scales turns each triangle.
    """
    if obj.mode == "EDIT":
        obj.update_from_editmode()
    mesh = obj.data
    if not len(mesh.polygons):
        raise Problem(f'Mesh "{obj.name}" has no faces')
    points = np.zeros(3 * len(mesh.vertices))
    keys = mesh.shape_keys
    (keys.reference_key.data if keys else mesh.vertices).foreach_get("co", points)
    mesh.calc_loop_triangles()
    triangles = np.zeros(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    triangles = triangles.reshape(-1, 3)
    if np.linalg.det(np.array(obj.matrix_world)[:3, :3]) < 0:
        triangles = triangles[:, ::-1]
    return in_world(obj, points.reshape(-1, 3)), triangles


def in_world(obj, points: np.ndarray) -> np.ndarray:
    """Bring points (n, 3) of an object into world space, with glTF's axes."""
    matrix = np.array(obj.matrix_world, np.float64)
    return (points @ matrix[:3, :3].T + matrix[:3, 3]) @ Y_UP.T


def stored_weights(obj, names: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Return the weights (n, j) of an object's vertex groups, and which bones' are locked (j,)."""
    bones = {name: j for j, name in enumerate(names)}
    column = {group.index: bones.get(group.name, -1) for group in obj.vertex_groups}
    weights = np.zeros((len(obj.data.vertices), len(names)))
    for vertex in obj.data.vertices:
        for element in vertex.groups:
            if (j := column.get(element.group, -1)) >= 0:
                weights[vertex.index, j] = element.weight
    locked = np.zeros(len(names), bool)
    locked[[bones[g.name] for g in obj.vertex_groups if g.lock_weight and g.name in bones]] = True
    return weights, locked


def paint_mask(obj) -> np.ndarray | None:
    """Return which vertices are selected where painting is masked, as Blender's own tools do."""
    mesh = obj.data
    if obj.mode != "WEIGHT_PAINT" or not (mesh.use_paint_mask or mesh.use_paint_mask_vertex):
        return None
    selected = np.zeros(len(mesh.vertices), bool)
    mesh.vertices.foreach_get("select", selected)
    return selected


def check_editable(objects, armature) -> None:
    """Raise an error for linked data, two objects with one mesh, and an armature below a mesh."""
    users: dict[str, str] = {}
    for obj in objects:
        for data in (obj, obj.data):
            if not data.is_editable:
                library = getattr(data.library, "filepath", "another file")
                raise Problem(f'"{data.name}" is linked from {library}. Make it local first')
        if (first := users.setdefault(obj.data.name, obj.name)) != obj.name:
            raise Problem(
                f'"{first}" and "{obj.name}" share one mesh. Make it single-user, or select one'
            )
    above = armature.parent
    while above is not None:
        if above in objects:
            raise Problem(f'Loop in parents: "{armature.name}" is below "{above.name}"')
        above = above.parent


def armature_of(obj):
    """Return the armature that deforms an object; None without."""
    for modifier in obj.modifiers:
        if modifier.type == "ARMATURE" and modifier.object is not None:
            return modifier.object
    parent = obj.parent
    return parent if parent is not None and parent.type == "ARMATURE" else None


def deformed_meshes(context):
    """Return the selected meshes with the active object's armature, and this armature."""
    active = context.active_object
    if active is not None and active.type == "ARMATURE":
        armature = active
    else:
        armature = None if active is None else armature_of(active)
    if armature is None:
        raise Problem("The active object has no armature. Parent it to one first")
    selected = {obj.name: obj for obj in context.selected_objects}
    selected.setdefault(active.name, active)
    meshes = [obj for obj in selected.values() if obj.type == "MESH"]
    return [obj for obj in meshes if armature_of(obj) == armature], armature
