# SPDX-License-Identifier: GPL-3.0-or-later
"""Cut-cell weights in Blender: operators, menus and preferences.

The computation is the package cutcell (MIT), a copy of which lies in the folder `core`.
"""

import bpy
from bpy.props import StringProperty

from .bind import OBJECT_OT_cutcell_parent
from .edit import (
    OBJECT_OT_cutcell_clean,
    OBJECT_OT_cutcell_diagnose,
    OBJECT_OT_cutcell_transfer,
)
from .exchange import OBJECT_OT_cutcell_open, OBJECT_OT_cutcell_take
from .operator_base import stop_worker

OPERATORS = (
    OBJECT_OT_cutcell_parent,
    OBJECT_OT_cutcell_transfer,
    OBJECT_OT_cutcell_clean,
    OBJECT_OT_cutcell_diagnose,
    OBJECT_OT_cutcell_open,
    OBJECT_OT_cutcell_take,
)


class Preferences(bpy.types.AddonPreferences):
    """Where the program cutcell is."""

    bl_idname = __package__

    program: StringProperty(
        name="Program cutcell",
        description="Needed for Open in cutcell only. Empty: the one on the PATH",
        subtype="FILE_PATH",
    )

    def draw(self, context):
        self.layout.prop(self, "program")


class VIEW3D_MT_cutcell(bpy.types.Menu):
    """Operators of cut-cell weights."""

    bl_label = "Cut-Cell Weights"

    def draw(self, context):
        for operator in OPERATORS:
            self.layout.operator(operator.bl_idname)


def draw_parent(menu, context):
    """Add the entry to Object > Parent."""
    menu.layout.separator()
    menu.layout.operator(OBJECT_OT_cutcell_parent.bl_idname)


def draw_menu(menu, context):
    """Add the submenu to Object, and to Weights in Weight Paint Mode."""
    menu.layout.separator()
    menu.layout.menu("VIEW3D_MT_cutcell")


CLASSES = (*OPERATORS, Preferences, VIEW3D_MT_cutcell)
MENUS = (
    ("VIEW3D_MT_object_parent", draw_parent),
    ("VIEW3D_MT_object", draw_menu),
    ("VIEW3D_MT_paint_weight", draw_menu),
)


def register():
    """Add everything to Blender."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    for menu, draw in MENUS:
        getattr(bpy.types, menu).append(draw)


def unregister():
    """Remove everything, and end the worker process."""
    for menu, draw in MENUS:
        getattr(bpy.types, menu).remove(draw)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
    stop_worker()
