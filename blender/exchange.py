# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators of exchange with the page: Open in cutcell, Take Weights from cutcell."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import bpy
import numpy as np
from bpy.props import StringProperty

from .character import deformed_meshes, gather
from .groups import write_weights
from .job import Problem
from .operator_base import WorkerOperator

TOLERANCE = 1e-4
"""Greatest distance of a vertex from the file's, as part of the character's size."""

_pages: list[subprocess.Popen] = []
"""Processes of open pages, which end with the terminal or by Ctrl-C there."""


def exchange_folder() -> Path:
    """Return the folder of characters for the page."""
    return Path(bpy.utils.extension_path_user(__package__, path="characters", create=True))


def program() -> str:
    """Return the path of the program cutcell: of the preferences, else on the PATH."""
    addon = bpy.context.preferences.addons.get(__package__)
    chosen = addon.preferences.program if addon is not None else ""
    path = shutil.which(bpy.path.abspath(chosen) if chosen else "cutcell")
    if path is None:
        raise Problem(
            "The program cutcell is missing. Install it with pip install 'cutcell[app]', or set "
            "its path in the preferences of the extension"
        )
    return path


class OBJECT_OT_cutcell_open(WorkerOperator, bpy.types.Operator):
    bl_description = "Open the character on the page of cutcell, in the browser"
    bl_idname = "object.cutcell_open"
    bl_label = "Open in cutcell"
    bl_options = {"REGISTER"}  # noqa: RUF012

    def request(self, context):
        self._program = program()
        meshes, armature = deformed_meshes(context)
        arrays = gather(meshes, armature, editable=False).arrays
        self._path = exchange_folder() / f"{bpy.path.clean_name(armature.name)}.npz"
        return "save", arrays, {"path": str(self._path)}

    def finish(self, context, arrays, result):
        command = [self._program, "app", str(self._path)]
        _pages.append(subprocess.Popen(command, stdin=subprocess.DEVNULL))
        return f"Opening {self._path.name}. Download the weights there, then take them from cutcell"


class OBJECT_OT_cutcell_take(WorkerOperator, bpy.types.Operator):
    bl_description = (
        "Take the weights of a file that the page of cutcell, or its command, has saved"
    )
    bl_idname = "object.cutcell_take"
    bl_label = "Take Weights from cutcell"

    filepath: StringProperty(subtype="FILE_PATH")
    filter_glob: StringProperty(default="*.npz;*.glb;*.gltf", options={"HIDDEN"})

    def invoke(self, context, event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def request(self, context):
        if not self.filepath:
            raise Problem("No file is chosen")
        meshes, armature = deformed_meshes(context)
        self._character = character = gather(meshes, armature)
        names = {"names": character.arrays["names"]}
        return "load", names, {"path": bpy.path.abspath(self.filepath)}

    def finish(self, context, arrays, result):
        points, stored = self._character.arrays["vertices"], arrays["vertices"]
        size = np.ptp(points, axis=0).max()
        if points.shape != stored.shape or np.abs(points - stored).max() > TOLERANCE * size:
            raise Problem(
                f"The file has {len(stored):,} vertices at other places than the selected meshes, "
                f"which have {len(points):,}. Select the meshes that were opened in cutcell"
            )
        if result["missing"]:
            raise Problem(f'The armature has no bone "{result["missing"][0]}" of the file')
        write_weights(self._character, arrays)
        return f"Took weights from {Path(self.filepath).name}"
