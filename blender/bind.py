# SPDX-License-Identifier: GPL-3.0-or-later
"""Object > Parent > With Cut-Cell Weights."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty, IntProperty

from .character import armature_of, gather
from .groups import parent, write_weights
from .job import Problem
from .operator_base import WorkerOperator

NO_LIMIT = 0
METHODS = (
    ("animation", "Animation", "Smooth weights to animate with"),
    ("paper", "Paper", "The method of the paper, a soft feature of the distance"),
)
FALLOFFS = (
    ("method", "Of the Method", "The falloff that belongs to the method"),
    ("rig", "Animation", "Decrease of weight with distance for animation"),
    ("paper", "Paper", "Decrease of weight with distance by the paper's kernel"),
)


class OBJECT_OT_cutcell_parent(WorkerOperator, bpy.types.Operator):
    bl_description = (
        "Parent the selected meshes to the armature, and compute weights of its deforming bones "
        "from shortest paths through the body. Locked vertex groups stay as they are"
    )
    bl_idname = "object.cutcell_parent"
    bl_label = "With Cut-Cell Weights"

    method: EnumProperty(
        name="Method", description="What the weights are for", items=METHODS, default="animation"
    )
    resolution: IntProperty(
        name="Resolution",
        description="Lattice cells along the longest side. More cells separate close parts better, "
        "but take more time and memory",
        default=64, min=2, max=1024, soft_min=16, soft_max=256,
    )  # fmt: skip
    influences: IntProperty(
        name="Max Influences",
        description="Maximum number of bones per vertex. 0: no limit",
        default=4, min=NO_LIMIT, max=1024, soft_max=16,
    )  # fmt: skip
    falloff: EnumProperty(
        name="Falloff", description="Decrease of weight with distance", items=FALLOFFS,
        default="method",
    )  # fmt: skip

    @classmethod
    def poll(cls, context):
        active = context.active_object
        if active is None or active.mode not in ("OBJECT", "WEIGHT_PAINT"):
            cls.poll_message_set("Select meshes and an armature in Object Mode")
            return False
        return True

    def request(self, context):
        meshes, armature = meshes_and_armature(context)
        self._character = character = gather(meshes, armature)
        options = {
            "resolution": self.resolution,
            "max_influences": None if self.influences == NO_LIMIT else self.influences,
        }
        if self.falloff != "method":
            options["falloff"] = self.falloff
        return "bind", character.arrays, {"method": self.method, "options": options}

    def finish(self, context, arrays, result):
        character = self._character
        write_weights(character, arrays)
        parent(character)
        for part in character.parts:
            if any(modifier.type == "MIRROR" for modifier in part.object.modifiers):
                text = f'"{part.object.name}" has a Mirror modifier: only its own half was bound'
                self.report({"WARNING"}, text)
            if part.object.data.users > 1:
                text = f'Other objects share the mesh of "{part.object.name}" and its weights'
                self.report({"WARNING"}, text)
        for warning in result["warnings"]:
            self.report({"WARNING"}, warning)
        names = ", ".join(part.object.name for part in character.parts)
        return f"Bound {names} to {int(character.arrays['deform'].sum())} bones"


def meshes_and_armature(context):
    """Return the selected meshes and armature; in Weight Paint Mode the painted mesh and its."""
    active = context.active_object
    if active.mode == "WEIGHT_PAINT":
        return [active], armature_of(active)
    selected = list(context.selected_objects)
    armatures = [obj for obj in selected if obj.type == "ARMATURE"]
    if active.type == "ARMATURE":
        armatures = [active]
    if len(armatures) != 1:
        raise Problem("Select meshes and one armature, the armature last")
    return [obj for obj in selected if obj.type == "MESH"], armatures[0]
