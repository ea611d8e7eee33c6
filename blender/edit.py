# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators on weights: Transfer Weights, Clean Weights and Diagnose."""

from __future__ import annotations

import bmesh
import bpy
import numpy as np
from bpy.props import BoolProperty, FloatProperty, IntProperty

from .character import armature_of, deformed_meshes, gather
from .groups import parent, write_weights
from .job import Problem
from .operator_base import WorkerOperator

RESOLUTION = {"name": "Resolution", "default": 64, "min": 2, "max": 1024, "soft_max": 256}
SHOWN_FINDINGS = 12


class OBJECT_OT_cutcell_transfer(WorkerOperator, bpy.types.Operator):
    bl_description = (
        "Transfer the weights of the active mesh to the other selected meshes, such as clothes"
    )
    bl_idname = "object.cutcell_transfer"
    bl_label = "Transfer Weights"

    distance: FloatProperty(
        name="Max Distance", description="Part of the size of the active mesh", default=0.05,
        min=0, max=1, precision=3,
    )  # fmt: skip
    flipped: BoolProperty(name="Match Flipped Normals", description="For the inside of layers")
    influences: IntProperty(name="Max Influences", default=4, min=0, max=1024, soft_max=16)

    @classmethod
    def poll(cls, context):
        active = context.active_object
        return active is not None and active.type == "MESH" and active.mode == "OBJECT"

    def request(self, context):
        active = context.active_object
        armature = armature_of(active)
        if armature is None:
            raise Problem(f'"{active.name}" has no armature. Make the bound mesh the active object')
        meshes = [obj for obj in context.selected_objects if obj.type == "MESH" and obj != active]
        if not meshes:
            raise Problem("Select the meshes to transfer to, and last the bound mesh")
        source = gather([active], armature, needs_weights=True, editable=False).arrays
        self._character = character = gather(meshes, armature)
        arrays = {f"source_{name}": array for name, array in source.items()} | character.arrays
        options = {"distance": self.distance, "flipped": self.flipped}
        options["max_influences"] = self.influences or None
        return "transfer", arrays, options

    def finish(self, context, arrays, result):
        write_weights(self._character, arrays)
        parent(self._character)
        return f"Transferred weights to {len(self._character.parts)} meshes"


class OBJECT_OT_cutcell_clean(WorkerOperator, bpy.types.Operator):
    bl_description = (
        "Remove weights that are implausible through the body, such as a hand's on the hip"
    )
    bl_idname = "object.cutcell_clean"
    bl_label = "Clean Weights"

    resolution: IntProperty(**RESOLUTION)

    @classmethod
    def poll(cls, context):
        active = context.active_object
        return active is not None and active.mode in ("OBJECT", "WEIGHT_PAINT")

    def request(self, context):
        meshes, armature = deformed_meshes(context)
        self._character = character = gather(meshes, armature, needs_weights=True)
        return "clean", character.arrays, {"resolution": self.resolution}

    def finish(self, context, arrays, result):
        changed = np.zeros(len(self._character.arrays["vertices"]), bool)
        changed[arrays["changed"]] = True
        write_weights(self._character, arrays, changed)
        joints = f": {', '.join(result['joints'][:5])}" if result["joints"] else ""
        return f"Removed {result['share']:.2%} of the weight at {changed.sum()} vertices{joints}"


class OBJECT_OT_cutcell_diagnose(WorkerOperator, bpy.types.Operator):
    bl_description = "Find faults of the character, and explain the weights of the active vertex"
    bl_idname = "object.cutcell_diagnose"
    bl_label = "Diagnose"
    bl_options = {"REGISTER"}  # noqa: RUF012

    resolution: IntProperty(**RESOLUTION)
    vertex: IntProperty(
        name="Vertex", description="Vertex to explain. -1: the active one, or a selected one",
        default=-1, min=-1,
    )  # fmt: skip

    @classmethod
    def poll(cls, context):
        active = context.active_object
        return active is not None and active.mode in ("OBJECT", "WEIGHT_PAINT", "EDIT")

    def request(self, context):
        active = context.active_object
        meshes, armature = deformed_meshes(context)
        character = gather(meshes, armature, editable=False)
        vertex = -1
        for part in character.parts:
            if part.object == active:
                local = self.vertex if self.vertex >= 0 else active_vertex(active)
                if local >= part.vertices.stop - part.vertices.start:
                    raise Problem(f'"{active.name}" has no vertex {local}')
                vertex = local + part.vertices.start if local >= 0 else -1
        return "diagnose", character.arrays, {"resolution": self.resolution, "vertex": vertex}

    def finish(self, context, arrays, result):
        findings, lines = result["findings"], result["vertex"]
        for finding in findings:
            kind = "INFO" if finding["severity"] == "note" else "WARNING"
            self.report({kind}, finding["text"])
        for line in lines:
            self.report({"INFO"}, line)

        def draw(menu, context):
            for finding in findings[:SHOWN_FINDINGS]:
                menu.layout.label(text=finding["text"], icon="ERROR")
            menu.layout.separator()
            for line in lines:
                menu.layout.label(text=line, icon="VERTEXSEL")

        if not bpy.app.background:
            context.window_manager.popup_menu(draw, title="Cut-Cell Diagnosis")
        return f"{len(findings)} findings. The Info editor lists them"


def active_vertex(obj) -> int:
    """Return the active vertex, else the first that is selected, else -1."""
    if obj.mode == "EDIT":
        mesh = bmesh.from_edit_mesh(obj.data)
        if isinstance(mesh.select_history.active, bmesh.types.BMVert):
            return mesh.select_history.active.index
    selected = np.zeros(len(obj.data.vertices), bool)
    obj.data.vertices.foreach_get("select", selected)
    return int(selected.argmax()) if selected.any() and not selected.all() else -1
