# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender as a module, with the extension in a temporary home; see `make test-blender`."""

import os
from pathlib import Path

import bpy
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
EXTENSION = "bl_ext.user_default.cutcell"


@pytest.fixture(scope="session", autouse=True)
def extension():
    """Install the archive as a user does."""
    bpy.ops.extensions.package_install_files(
        repo="user_default", filepath=os.environ["CUTCELL_ARCHIVE"], enable_on_install=True
    )
    assert EXTENSION in {addon.module for addon in bpy.context.preferences.addons}
    return EXTENSION


@pytest.fixture(autouse=True)
def empty_scene():
    bpy.ops.wm.read_homefile(use_empty=True)


def select(*objects):
    """Select objects, the last one active."""
    bpy.ops.object.select_all(action="DESELECT")
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[-1]


def load(path):
    """Import a glTF file; return its skinned meshes and their armature."""
    bpy.ops.import_scene.gltf(filepath=str(path))
    meshes = [obj for obj in bpy.data.objects if obj.type == "MESH" and obj.vertex_groups]
    armature = next(m.object for m in meshes[0].modifiers if m.type == "ARMATURE")
    return [mesh for mesh in meshes if mesh.modifiers[0].object == armature], armature


def weights(obj, names=None):
    """Return the weights (n, j) of an object's vertex groups, by names or as they come."""
    names = [group.name for group in obj.vertex_groups] if names is None else names
    column = {g.index: names.index(g.name) for g in obj.vertex_groups if g.name in names}
    array = np.zeros((len(obj.data.vertices), len(names)), np.float32)
    for vertex in obj.data.vertices:
        for element in vertex.groups:
            if element.group in column:
                array[vertex.index, column[element.group]] = element.weight
    return array


def grid(name, length, segments=24, radius=0.3, sides=12):
    """Make a closed tube along x."""
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    ring = np.stack([np.zeros(sides), np.cos(angle), np.sin(angle)], axis=1) * radius
    points = np.concatenate([np.add(ring, (x, 0, 0)) for x in np.linspace(0, length, segments)])
    faces = [
        (s * sides + i, s * sides + (i + 1) % sides, (s + 1) * sides + (i + 1) % sides,
         (s + 1) * sides + i)
        for s in range(segments - 1) for i in range(sides)
    ]  # fmt: skip
    faces += [tuple(range(sides))[::-1], tuple(range((segments - 1) * sides, segments * sides))]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.tolist(), [], faces)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(obj)
    return obj


def arm(length=3.0, bones=3):
    """Make an armature of bones along x."""
    armature = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.collection.objects.link(armature)
    select(armature)
    bpy.ops.object.mode_set(mode="EDIT")
    parent = None
    for i in range(bones):
        bone = armature.data.edit_bones.new(f"bone{i}")
        bone.head, bone.tail = (length * i / bones, 0, 0), (length * (i + 1) / bones, 0, 0)
        bone.parent = parent
        parent = bone
    bpy.ops.object.mode_set(mode="OBJECT")
    return armature


@pytest.fixture
def tube():
    """Return a tube and its armature, both selected."""
    mesh, armature = grid("Tube", 3.0), arm()
    select(mesh, armature)
    return mesh, armature
