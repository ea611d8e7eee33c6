"""The bound character as a binary glTF file that names the settings of its weights."""

import json
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import cutcell
from cutcell.io.gltf.container import json_bytes
from cutcell.rig import Rig

KEY = "cutcell"
HEAD = 20
"""Bytes of a GLB before its JSON: those of the container, and of its first chunk."""


def save_bound(path: Path, rig: Rig, settings: Mapping[str, Any]) -> None:
    """Save a rig as `cutcell.save` does, with settings as "cutcell" in the asset's extras.

    Parameters
    ----------
    path : Path
        Ends in ".glb" or ".vrm".
    rig : Rig
    settings : mapping
        See `settings_of`.
    """
    cutcell.save(path, rig)
    data = path.read_bytes()
    (size,) = struct.unpack_from("<I", data, 12)
    document = json.loads(data[HEAD : HEAD + size])
    extras = document["asset"].setdefault("extras", {})
    if not isinstance(extras, dict):
        return  # glTF allows any value, and another program wrote this one
    extras[KEY] = dict(settings)
    text = json_bytes(document)
    text += b" " * (-len(text) % 4)
    rest = data[HEAD + size :]
    head = data[:8] + struct.pack("<II", HEAD + len(text) + len(rest), len(text)) + data[16:HEAD]
    path.write_bytes(head + text + rest)
