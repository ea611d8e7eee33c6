"""Documents whose meshes are compressed by Draco or meshopt."""

import copy

import DracoPy
import meshopt
import numpy as np

from tests.cutcell.io.gltf.gltf_builder import (
    CODES,
    COLUMN,
    FACES,
    JOINTS,
    KINDS,
    SHARES,
    Builder,
    column,
)

MESHOPT = "EXT_meshopt_compression"
DRACO = "KHR_draco_mesh_compression"


def draco_bytes(points=COLUMN, faces=FACES, joints=JOINTS, shares=SHARES):
    """Compress a skinned mesh, its vertices in their order, positions exact to 2^-20."""
    return DracoPy.encode(
        points,
        np.asarray(faces, "u4"),
        quantization_bits=20,
        preserve_order=True,
        generic_attributes={7: np.asarray(joints, "u2"), 9: np.asarray(shares, "f4")},
    )


def draco_column(data=None, **accessors):
    """Return the column with its mesh compressed by Draco."""
    builder = column()
    data = draco_bytes() if data is None else data
    view = builder.view(data)
    counts = {"POSITION": 12, "JOINTS_0": 12, "WEIGHTS_0": 12} | accessors
    result = {}
    for name, kind, width in (("POSITION", "f4", 3), ("JOINTS_0", "u1", 4), ("WEIGHTS_0", "f4", 4)):
        item = {"componentType": CODES[kind], "count": counts[name], "type": KINDS[width]}
        if name == "POSITION":
            item |= {"min": [0, 0, 0], "max": [1, 2, 1]}
        result[name] = builder.add("accessors", item)
    indices = {"componentType": CODES["u2"], "count": FACES.size, "type": "SCALAR"}
    ids = {"POSITION": 10, "JOINTS_0": 7, "WEIGHTS_0": 9}
    builder.json["meshes"][0]["primitives"] = [
        {
            "attributes": result,
            "indices": builder.add("accessors", indices),
            "extensions": {DRACO: {"bufferView": view, "attributes": ids}},
        }
    ]
    used(builder, DRACO)
    return builder


def used(builder, name):
    for key in ("extensionsUsed", "extensionsRequired"):
        builder.json[key] = [*builder.json.get(key, []), name]


def meshopt_of(builder: Builder, name=MESHOPT, version=0, filters=()):
    """Return a document with all buffer views compressed, as glTF-Transform writes it.

    `filters` maps a view's number to (filter, stride, bytes that the filter made).
    """
    packed = copy.deepcopy(builder)
    packed.data = bytearray()
    corners = {p["indices"] for m in builder.json["meshes"] for p in m["primitives"]}
    corners = {builder.json["accessors"][i]["bufferView"] for i in corners}
    place = 0
    for i, view in enumerate(packed.json["bufferViews"]):
        raw = bytes(builder.data[view["byteOffset"] : view["byteOffset"] + view["byteLength"]])
        how, stride, mode = "NONE", view.get("byteStride", 4), "ATTRIBUTES"
        if i in corners:
            mode, stride = "TRIANGLES", 2
            data = meshopt.encode_index_buffer(np.frombuffer(raw, "<u2"))
        else:
            if i in dict(filters):
                how, stride, raw = dict(filters)[i]
            rows = np.frombuffer(raw, "u1").reshape(-1, stride)
            data = meshopt.encode_vertex_buffer_level(rows, 2, version)
        compressed = {
            "buffer": 0,
            "byteOffset": len(packed.data),
            "byteLength": len(data),
            "byteStride": stride,
            "count": len(raw) // stride,
            "mode": mode,
            "filter": how,
        }
        packed.data += data + bytes(-len(data) % 4)
        view.update(buffer=1, byteOffset=place, extensions={name: compressed})
        place += len(raw)
    packed.json["buffers"] = [{}, {"byteLength": place, "extensions": {name: {"fallback": True}}}]
    used(packed, name)
    return packed
