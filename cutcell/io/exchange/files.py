"""Files of weights alone: Maya's deformerWeights, ngSkinTools' JSON, and CSV."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from io import StringIO
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from ...errors import CutcellError, FileError
from ..files import one_line, read_text

HEADER = ("mesh", "vertex", "x", "y", "z", "joint", "weight")
"""Columns of a CSV: a row for each weight above 0."""
MAX_VERTICES = 2**31
"""Vertices of a mesh in a CSV, which does not tell their number."""


class MeshWeights(NamedTuple):
    """Weights of one mesh."""

    mesh: str
    joints: tuple[str, ...]
    weights: NDArray[np.float64]  # (n, j)
    points: NDArray[np.float64] | None  # (n, 3); None where the file has none


def read_weights(path: Path) -> list[MeshWeights]:
    """Read the weights in a file; see `with_saved_weights` for errors."""
    kind = path.suffix.lower()
    if kind not in WEIGHT_FILES:
        raise FileError(f'weights are read from {", ".join(WEIGHT_FILES)}, not from "{kind}"')
    text = read_text(path)
    try:
        meshes = WEIGHT_FILES[kind][1](text)
    except CutcellError:
        raise
    except (ElementTree.ParseError, ValueError, LookupError, TypeError, RecursionError) as e:
        raise FileError(f"its weights cannot be read: {one_line(e)}") from None
    if not meshes:
        raise FileError("it holds no weights")
    arrays = [one.weights for one in meshes] + [
        one.points for one in meshes if one.points is not None
    ]
    if not all(np.isfinite(array).all() for array in arrays):
        raise FileError("it holds a number that is not finite")
    return meshes


def _maya(one: MeshWeights, path: Path) -> str:
    assert one.points is not None
    count, mesh = len(one.points), quoteattr(one.mesh)
    matrix = " ".join(f"{value:.6f}" for value in np.eye(4).ravel())
    lines = [
        '<?xml version="1.0"?>', "<deformerWeight>",
        f'  <headerInfo fileName={quoteattr(path.as_posix())} worldMatrix="{matrix}"/>',
        f'  <shape name={mesh} group="0" stride="3" size="{count}" max="{count}">',
        *(f'    <point index="{v}" value="{x:.9g} {y:.9g} {z:.9g}"/>'
          for v, (x, y, z) in enumerate(one.points.tolist())),
        "  </shape>",
    ]  # fmt: skip
    for joint, column in zip(one.joints, one.weights.T, strict=True):
        rows = np.flatnonzero(column)
        last = rows[-1] + 1 if len(rows) else 0
        lines += [
            f'  <weights deformer="skinCluster1" source={quoteattr(joint)} shape={mesh} layer="0" '
            f'defaultValue="0.000" size="{len(rows)}" max="{last}">',
            *(f'    <point index="{v}" value="{column[v]:.9g}"/>' for v in rows.tolist()),
            "  </weights>",
        ]
    return "\n".join([*lines, "</deformerWeight>", ""])


def _read_maya(text: str) -> list[MeshWeights]:
    root = ElementTree.fromstring(text)
    meshes = []
    for shape in root.iter("shape"):
        points = np.array([point.attrib["value"].split() for point in shape], float).reshape(-1, 3)
        layers = [w for w in root.iter("weights") if w.attrib["shape"] == shape.attrib["name"]]
        weights = np.zeros((len(points), len(layers)))
        for column, layer in zip(weights.T, layers, strict=True):
            column[:] = float(layer.get("defaultValue", "0"))
            for point in layer:
                column[_index(point.attrib["index"], len(points))] = float(point.attrib["value"])
        joints = tuple(layer.attrib["source"] for layer in layers)
        meshes.append(MeshWeights(shape.attrib["name"], joints, weights, points))
    return meshes


def _ngskintools(one: MeshWeights, path: Path) -> str:
    assert one.points is not None
    influences = [
        {"name": joint, "index": j, "weights": column.tolist()}
        for j, (joint, column) in enumerate(zip(one.joints, one.weights.T, strict=True))
    ]
    layer = {"name": "cutcell", "opacity": 1.0, "enabled": True, "mask": []}
    mesh = {"name": one.mesh, "vertPositions": one.points.ravel().tolist()}
    return json.dumps({"mesh": mesh, "layers": [{**layer, "influences": influences}]})


def _read_ngskintools(text: str) -> list[MeshWeights]:
    data = json.loads(text)
    layers = [layer for layer in data["layers"] if layer["enabled"]]
    names = list(dict.fromkeys(i["name"] for layer in layers for i in layer["influences"]))
    count = max((len(i["weights"]) for layer in layers for i in layer["influences"]), default=0)
    total = np.zeros((count, len(names)))
    for layer in reversed(layers):  # the last one is the lowest
        rows = np.zeros_like(total)
        for influence in layer["influences"]:
            rows[:, names.index(influence["name"])] = influence["weights"]
        mask = np.array(layer.get("mask") or np.ones(count), float)[:, None]
        opacity = np.where(rows.any(axis=1, keepdims=True), float(layer["opacity"]) * mask, 0.0)
        total = (1 - opacity) * total + opacity * rows
    mesh = data.get("mesh") or {}
    points = mesh.get("vertPositions")
    places = None if points is None else np.array(points, float).reshape(count, 3)
    return [MeshWeights(str(mesh.get("name", "")), tuple(names), total, places)] if count else []


def _csv(one: MeshWeights, path: Path) -> str:
    assert one.points is not None
    text = StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADER)
    places = [[f"{value:.9g}" for value in point] for point in one.points.tolist()]
    for v, j in np.argwhere(one.weights).tolist():
        writer.writerow([one.mesh, v, *places[v], one.joints[j], f"{one.weights[v, j]:.9g}"])
    return text.getvalue()


def _read_csv(text: str) -> list[MeshWeights]:
    rows = list(csv.reader(StringIO(text)))
    if not rows or tuple(rows[0]) != HEADER:
        raise FileError(f"its first line must be {','.join(HEADER)}")
    by_mesh: dict[str, list[list[str]]] = {}
    for row in rows[1:]:
        by_mesh.setdefault(row[0], []).append(row)
    meshes = []
    for mesh, of_mesh in by_mesh.items():
        joints = tuple(dict.fromkeys(row[5] for row in of_mesh))
        number = {joint: j for j, joint in enumerate(joints)}
        # A vertex without weights has no row; the numbers of the others only tell them apart.
        vertices = sorted({_index(row[1], MAX_VERTICES) for row in of_mesh})
        place = {vertex: v for v, vertex in enumerate(vertices)}
        weights, points = np.zeros((len(vertices), len(joints))), np.zeros((len(vertices), 3))
        for _, vertex, x, y, z, joint, weight in of_mesh:
            v = place[int(vertex)]
            weights[v, number[joint]], points[v] = float(weight), (float(x), float(y), float(z))
        meshes.append(MeshWeights(mesh, joints, weights, points))
    return meshes


def _index(text: str, count: int) -> int:
    if not 0 <= int(text) < count:
        raise FileError(f"vertex {text} is not one of its {count:,}")
    return int(text)


WEIGHT_FILES: dict[
    str, tuple[Callable[[MeshWeights, Path], str], Callable[[str], list[MeshWeights]]]
] = {
    ".xml": (_maya, _read_maya),
    ".json": (_ngskintools, _read_ngskintools),
    ".csv": (_csv, _read_csv),
}
"""How each kind of file is written and read."""
