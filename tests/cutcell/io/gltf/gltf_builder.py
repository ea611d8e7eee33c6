"""Small glTF documents made by hand, one feature at a time."""

import base64
import copy
import json
import struct
from pathlib import Path

import numpy as np
from numpy.testing import assert_allclose

CODES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}

# A column: three rings of four vertices, with lids.
COLUMN = np.array([[x, y, z] for y in (0, 1, 2) for x, z in ((0, 0), (1, 0), (1, 1), (0, 1))], "f4")
SIDES = [[r + k, r + 4 + k, r + (k + 1) % 4] for r in (0, 4) for k in range(4)]
SIDES += [[r + 4 + k, r + 4 + (k + 1) % 4, r + (k + 1) % 4] for r in (0, 4) for k in range(4)]
FACES = np.array([*SIDES, [0, 1, 2], [0, 2, 3], [8, 10, 9], [8, 11, 10]])
JOINTS = np.zeros((12, 4), "u1")
JOINTS[:, 1] = 1
SHARES = np.zeros((12, 4), "f4")
SHARES[:, 1] = np.repeat([0, 0.5, 1], 4)
SHARES[:, 0] = 1 - SHARES[:, 1]
REST = np.array([[0.5, 0, 0.5], [0.5, 1, 0.5]])


def moved(*offset):
    """Return the matrix of a translation."""
    matrix = np.eye(4)
    matrix[:3, 3] = offset
    return matrix


class Builder:
    """A glTF document under construction, with one buffer."""

    def __init__(self):
        self.json = {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": []}],
            "nodes": [],
            "accessors": [],
            "bufferViews": [],
        }
        self.data = bytearray()

    def add(self, kind, item, **fields):
        """Append to a top-level list; return the number."""
        self.json.setdefault(kind, []).append({**item, **fields})
        return len(self.json[kind]) - 1

    def view(self, content, **fields):
        self.data += bytes(-len(self.data) % 4)
        start = len(self.data)
        self.data += content
        place = {"buffer": 0, "byteOffset": start, "byteLength": len(content)}
        return self.add("bufferViews", place, **fields)

    def accessor(self, values, view=None, **fields):
        """Append an array (a vector becomes scalars, a stack of matrices is transposed)."""
        values = np.asarray(values)
        if values.ndim == 3:
            values = values.transpose(0, 2, 1).reshape(-1, 16)
        values = values.reshape(len(values), -1)
        if values.dtype.kind == "f":
            values = values.astype("f4")
        elif values.dtype.itemsize == 8:
            values = values.astype("u2")
        item = {
            "bufferView": self.view(values.tobytes()) if view is None else view,
            "componentType": CODES[values.dtype.str[1:]],
            "count": len(values),
            "type": KINDS[values.shape[1]],
        }
        return self.add("accessors", item, **fields)

    def positions(self, values, **fields):
        values = np.asarray(values)
        low, high = values.min(axis=0).tolist(), values.max(axis=0).tolist()
        return self.accessor(values, min=low, max=high, **fields)

    def interleaved(self, *arrays):
        """Append arrays of four-byte multiples into one strided view; return the accessors."""
        rows = [np.ascontiguousarray(a).view("u1").reshape(len(a), -1) for a in arrays]
        packed = np.concatenate(rows, axis=1)
        view = self.view(packed.tobytes(), byteStride=packed.shape[1], target=34962)
        result, offset = [], 0
        for array, row in zip(arrays, rows, strict=True):
            result.append(self.accessor(array, view=view, byteOffset=offset))
            self._cut_copy(result[-1])
            offset += row.shape[1]
        return result

    def _cut_copy(self, accessor):
        if self.json["accessors"][accessor]["type"] == "VEC3":
            values = self.json["accessors"][accessor]
            values.setdefault("min", [0, 0, 0])
            values.setdefault("max", [1, 2, 1])

    def node(self, parent=None, **fields):
        index = self.add("nodes", {}, **fields)
        if parent is None:
            self.json["scenes"][0]["nodes"].append(index)
        else:
            self.json["nodes"][parent].setdefault("children", []).append(index)
        return index

    def skin(self, joints, inverse=None, **fields):
        if inverse is not None:
            fields["inverseBindMatrices"] = self.accessor(np.array(inverse))
        return self.add("skins", {"joints": joints}, **fields)

    def attributes(self, vertices=COLUMN, joints=JOINTS, shares=SHARES):
        return {
            "POSITION": self.positions(vertices),
            "JOINTS_0": self.accessor(joints),
            "WEIGHTS_0": self.accessor(shares),
        }

    def mesh(self, attributes=None, faces=FACES, **fields):
        primitive = {"attributes": attributes or self.attributes(), "mode": 4}
        if faces is not None:
            primitive["indices"] = self.accessor(np.asarray(faces).reshape(-1))
        return self.add("meshes", {"primitives": [primitive]}, **fields)

    def finished(self):
        document = copy.deepcopy(self.json)
        if self.data:
            document.setdefault("buffers", [{}])[0]["byteLength"] = len(self.data)
        return document

    def glb(self):
        text = json.dumps(self.finished()).encode()
        return pack(text, bytes(self.data))

    def save(self, path: Path):
        """Write a .glb, or a .gltf with its buffer in a data URI."""
        if path.suffix == ".glb":
            path.write_bytes(self.glb())
            return path
        document = self.finished()
        body = base64.b64encode(self.data).decode()
        document["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{body}"
        path.write_text(json.dumps(document))
        return path


def pack(text: bytes, data: bytes) -> bytes:
    """Return a GLB container."""
    text += b" " * (-len(text) % 4)
    data += bytes(-len(data) % 4)
    total = 12 + 8 + len(text) + (8 + len(data) if data else 0)
    head = struct.pack("<4sII", b"glTF", 2, total)
    tail = struct.pack("<II", len(data), 0x004E4942) + data if data else b""
    return head + struct.pack("<II", len(text), 0x4E4F534A) + text + tail


def column(**mesh_fields):
    """Return a builder with the column, bound to two joints; nodes 0, 1 joints, 2 mesh."""
    builder = Builder()
    root = builder.node(name="root", translation=REST[0].tolist())
    builder.node(root, name="tip", translation=(REST[1] - REST[0]).tolist())
    skin = builder.skin([0, 1], [moved(*-p) for p in REST])
    mesh = builder.mesh(name="column", **mesh_fields)
    builder.node(name="body", mesh=mesh, skin=skin)
    return builder


def check_column(rig, tolerance=1e-6):
    """See that a rig is the column."""
    assert_allclose(rig.mesh.vertices, COLUMN, atol=tolerance)
    assert_allclose(rig.weights, SHARES[:, :2], atol=tolerance)
    assert_allclose(rig.skeleton.joints, REST, atol=tolerance)
    assert rig.skeleton.parents.tolist() == [-1, 0]
    assert rig.skeleton.names == ("root", "tip")


def turned(primitive):
    """Put a primitive's corners in canonical order, each face starting at its least one."""
    return sorted(tuple(np.roll(f, -np.argmin(f)).tolist()) for f in primitive)


def two_skins(second_offset, shared=True):
    """Return a builder with the column twice, the second time stored off by an offset."""
    builder = column()
    inverse = [moved(*-p) @ moved(*-np.array(second_offset)) for p in REST]
    if shared:
        extra = builder.node(1, name="extra", translation=[0, 1, 0])
        joints, inverse = [1, extra], [inverse[1], moved(0, -1, 0) @ inverse[1]]
    else:
        joints = [builder.node(name="r2", translation=REST[0].tolist())]
        joints.append(builder.node(joints[0], name="t2", translation=[0, 1, 0]))
    skin = builder.skin(joints, inverse)
    mesh = builder.mesh(builder.attributes(COLUMN + np.float32(second_offset)), name="second")
    builder.node(name="second", mesh=mesh, skin=skin)
    return builder
