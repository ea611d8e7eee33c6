# SPDX-License-Identifier: GPL-3.0-or-later
"""From computed weights to vertex groups, parents and modifiers."""

from __future__ import annotations

import bpy
import numpy as np

from .character import Character
from .job import Problem


def write_weights(character: Character, arrays, changed: np.ndarray | None = None) -> None:
    """Replace the weights of deforming bones; locked groups and masked vertices stay.

    `arrays` are those of `worker.sparse`; `changed` (n,) says which vertices change, None for all.
    """
    for part in character.parts:
        if len(part.object.data.vertices) != part.vertices.stop - part.vertices.start:
            raise Problem(f'"{part.object.name}" was edited meanwhile. Run the operator again')
    for part in character.parts:
        size = part.vertices.stop - part.vertices.start
        writable = np.ones(size, bool) if part.mask is None else part.mask
        if changed is not None:
            writable = writable & changed[part.vertices]
        _write_part(character, part, arrays, writable)


def _write_part(character: Character, part, arrays, writable: np.ndarray) -> None:
    groups, cleared = part.object.vertex_groups, np.flatnonzero(writable).tolist()
    for bone, name in enumerate(character.bones):
        if part.locked[bone] or not character.arrays["deform"][bone]:
            continue
        group = groups.get(name) or groups.new(name=name)
        if cleared:
            group.remove(cleared)
        entries = slice(*arrays["indptr"][bone : bone + 2])
        local, weights = arrays["indices"][entries] - part.vertices.start, arrays["data"][entries]
        inside = (local >= 0) & (local < len(writable)) & (weights > 0)
        local, weights = local[inside], weights[inside]
        keep = writable[local]
        for vertex, weight in zip(local[keep].tolist(), weights[keep].tolist(), strict=True):
            group.add((vertex,), weight, "REPLACE")


def parent(character: Character) -> None:
    """Parent the meshes to the armature as Blender does, each with an Armature modifier."""
    objects = [part.object for part in character.parts if part.object.mode == "OBJECT"]
    if not objects:  # a painted mesh is deformed by its armature already
        return
    selection = [*objects, character.armature]
    names = ("selected_objects", "selected_editable_objects")
    override = dict.fromkeys(names, selection)
    override |= dict.fromkeys(("object", "active_object"), character.armature)
    with bpy.context.temp_override(**override):
        bpy.ops.object.parent_set(type="ARMATURE", keep_transform=True)
