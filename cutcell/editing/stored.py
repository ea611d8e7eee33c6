"""Edits in files: in JSON, and in GLB and VRM together with the weights that they begin from."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .. import __version__
from ..errors import FileError, ParameterError
from ..io import save
from ..io.files import naming
from ..io.formats import GLTF
from ..io.gltf.container import json_bytes, pack_glb, read_document
from ..method import ANIMATION, Method
from ..rig import Rig
from ..runtime.writing import write_all
from .edits import Edits
from .layers.contents import FromFile, Locked
from .layers.layer import Layer
from .layers.packing import ascending, packed, packed_rows, unpacked_rows, with_keys
from .layers.packing import naming as naming_part

EDITS_KEY = "cutcell"
"""Entry of a document's asset extras."""
ABOUT = {"program": f"cutcell {__version__}", "lengths": "in the file's units"}
"""Source of the numbers of a file, and their unit."""


def load_edits(path: str | Path) -> Edits:
    """Return the edits in a JSON file, or in a GLB, glTF or VRM that holds layers.

    Raises
    ------
    FileError, ParameterError
        It cannot be read, or holds none.
    """
    path = Path(path)
    if path.suffix.lower() not in GLTF:
        return Edits.load(path)
    with naming(path):
        entry = _entry(read_document(path).json)
        if entry is None:
            raise FileError("it holds no layers; give a JSON file with layers, or an export")
        return _edits(entry)


def stored_edits(rig: Rig) -> Edits | None:
    """Return the edits that a rig's own file holds, or None.

    Raises
    ------
    ParameterError
        They are damaged.
    """
    entry = _entry_of(rig)
    return None if entry is None else _edits(entry)


def with_base(rig: Rig) -> Rig:
    """Return a rig with the weights below the layers that its file holds; itself without any.

    Raises
    ------
    ParameterError
        They are damaged.
    """
    entry = _entry_of(rig)
    stored = None if entry is None else entry.get("file")
    if stored is None or rig.weights is None:
        return rig
    data = with_keys("the file's weights", stored, ("vertices", "rows"))
    vertices = ascending("vertices", data.get("vertices", ()))
    rows = unpacked_rows(data.get("rows"), len(rig.skeleton.joints))
    if rows.shape[0] != len(vertices) or (len(vertices) and vertices[-1] >= len(rig.weights)):
        raise ParameterError("the weights below its layers are of another mesh")
    weights = rig.weights.copy()
    weights[vertices] = rows.toarray()
    return rig.with_weights(weights)


def entry_of(rig: Rig, edits: Edits, merged: NDArray[np.float64]) -> dict[str, Any]:
    """Return what a file holds of edits besides the weights that they lead to, as JSON.

    Changes of the skeleton are in the file itself. Of the weights in `rig`, shape (n, j), which
    the base or a layer begins from, it holds the rows that differ from the merged ones.
    """
    entry: dict[str, Any] = {"layers": json.loads(replace(edits, joints={}, removed=()).to_json())}
    contents = [layer.content for layer in edits.layers]
    if edits.base == "file" or any(isinstance(one, FromFile | Locked) for one in contents):
        assert rig.weights is not None
        changed = np.flatnonzero((rig.weights != merged).any(axis=1))
        rows = packed_rows(csr_array(rig.weights[changed]))
        entry["file"] = {"vertices": packed(changed), "rows": rows}
    return entry


def settings_with_layers(
    rig: Rig,
    method: Method,
    weights: NDArray[np.float64],
    edits: Edits,
    lowest: Sequence[Layer] = (),
) -> dict[str, Any]:
    """Return what a file holds of weights (n, j) by edits; the lowest layers go below others."""
    options = asdict(method)
    changed = {name: value for name, value in options.items() if value != getattr(ANIMATION, name)}
    changed["resolution"] = method.resolution
    settings = {**ABOUT, **options}
    if edits.layers or lowest or edits.base == "file":
        edits = replace(edits, method=changed, layers=edits.layers_over(lowest))
        settings |= entry_of(rig, edits, weights)
    return settings


def save_bound(path: Path, rig: Rig, settings: Mapping[str, Any]) -> tuple[Path, ...]:
    """Save a rig as GLB, glTF or VRM with settings in the asset's extras; return the files."""
    files = save(path, rig)
    saved = read_document(path)
    extras = saved.json["asset"].setdefault("extras", {})
    if not isinstance(extras, dict):
        return files  # glTF allows any value; another program wrote this one
    extras[EDITS_KEY] = dict(settings)
    text = json_bytes(saved.json)
    write_all({path: pack_glb(text, saved.buffers[0], saved.chunks) if saved.binary else text})
    return files


def _entry_of(rig: Rig) -> dict[str, Any] | None:
    document = getattr(rig.source, "document", None)
    return None if document is None else _entry(document.json)


def _entry(document: dict[str, Any]) -> dict[str, Any] | None:
    """Return the entry of a glTF document that holds layers."""
    asset = document.get("asset")
    extras = asset.get("extras") if isinstance(asset, dict) else None
    entry = extras.get(EDITS_KEY) if isinstance(extras, dict) else None
    return entry if isinstance(entry, dict) and "layers" in entry else None


def _edits(entry: dict[str, Any]) -> Edits:
    with naming_part("its layers cannot be read"):
        return Edits.from_json(json.dumps(entry["layers"]))
