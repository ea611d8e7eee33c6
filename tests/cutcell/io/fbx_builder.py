"""FBX files of the column, as text and binary, made from one tree of records."""

import base64
import struct
import zlib

import numpy as np

from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES, REST, SHARES, moved

TICKS = 46186158000
"""FBX' unit of time, in a second."""
MESH, ROOT, TIP, END = 200, 300, 301, 302


def record(name, *values, children=()):
    return (name, values, tuple(children))


def prop(name, *values, kind="double"):
    return record("P", name, kind, "", "A", *values)


def properties(*found):
    return record("Properties70", children=found)


def vector(name, values):
    return prop(name, *map(float, values), kind=name)


def column_scene(
    up=1, unit=1.0, joint=(), node=(), mesh=(), rest=REST, shares=SHARES, faces=None, curves=True
):
    """Return the records of the column: root, tip and an end marker without weights.

    Parameters
    ----------
    up, unit
        Axis 0, 1, 2 that points up; centimetres in a unit.
    joint, node, mesh
        More properties of the joint "tip", of the mesh' node, and records of its geometry.
    """
    corners = np.asarray(FACES if faces is None else faces).copy()
    corners[:, -1] = ~corners[:, -1]
    geometry = record(
        "Geometry", 100, "Geometry::column", "Mesh",
        children=[
            record("Vertices", COLUMN.astype(float).ravel()),
            record("PolygonVertexIndex", corners.ravel().astype(np.int32)),
            *mesh,
        ],
    )  # fmt: skip
    models = [
        model(MESH, "body", "Mesh", node),
        model(ROOT, "root", "LimbNode", [vector("Lcl Translation", rest[0])]),
        model(TIP, "tip", "LimbNode", [vector("Lcl Translation", rest[1] - rest[0]), *joint]),
        model(END, "tip_end", "LimbNode", [vector("Lcl Translation", (0, 0.5, 0))]),
    ]
    attributes = [
        record("NodeAttribute", 500 + k, "NodeAttribute::", "LimbNode", children=[
            record("TypeFlags", "Skeleton")]) for k in range(3)
    ]  # fmt: skip
    skin = [record("Deformer", 400, "Deformer::", "Skin")]
    for k in range(2):
        held = np.flatnonzero(shares[:, k] != 0)
        skin.append(
            record("Deformer", 401 + k, "SubDeformer::", "Cluster", children=[
                record("Indexes", held.astype(np.int32)),
                record("Weights", shares[held, k].astype(float)),
                record("Transform", moved(*-rest[k]).T.ravel()),
                record("TransformLink", moved(*rest[k]).T.ravel()),
            ])
        )  # fmt: skip
    links = [(MESH, 0), (ROOT, 0), (TIP, ROOT), (END, TIP), (100, MESH), (400, 100)]
    links += [(500, ROOT), (501, TIP), (502, END), (401, 400), (402, 400), (ROOT, 401), (TIP, 402)]
    objects = [geometry, *models, *attributes, *skin]
    connections = [record("C", "OO", a, b) for a, b in links]
    if curves:
        objects += turning()
        connections += [record("C", "OO", 601, 600), record("C", "OO", 602, 601)]
        connections += [record("C", "OP", 602, TIP, "Lcl Rotation")]
        connections += [record("C", "OP", 603 + k, 602, f"d|{a}") for k, a in enumerate("XYZ")]
    return [settings(up, unit), record("Objects", children=objects),
            record("Connections", children=connections)]  # fmt: skip


def with_materials(scene, uv, polygons=None, materials=(), colors=None):
    """Give the column materials, texture coordinates and colours.

    Parameters
    ----------
    scene
        See `column_scene`.
    uv : array, shape (f, 3, 2)
        Of each corner.
    polygons : array, shape (f,), optional
        The material of each face; the first when left out.
    materials : sequence of (properties, texture or None)
        A texture has a `file`, and perhaps `content` and more properties (`look`).
    colors : array, shape (f, 3, 4), optional
    """
    layers = [("UV", uv, "UV", "UVIndex"), ("Color", colors, "Colors", "ColorIndex")]
    result, named = [], []
    for kind, values, name, index in layers:
        if values is None:
            continue
        flat = np.asarray(values, float).reshape(-1, np.shape(values)[-1])
        direct, which = np.unique(flat, axis=0, return_inverse=True)
        result.append(layer(kind, "ByPolygonVertex", [
            record(name, direct.ravel()), record(index, which.ravel().astype(np.int32))
        ]))  # fmt: skip
        named.append(kind)
    which = np.zeros(1) if polygons is None else np.asarray(polygons)
    how = "AllSame" if polygons is None else "ByPolygon"
    result.append(layer("Material", how, [record("Materials", which.astype(np.int32))]))
    named.append("Material")
    elements = [
        record("LayerElement", children=[record("Type", f"LayerElement{kind}"),
                                         record("TypedIndex", 0)]) for kind in named
    ]  # fmt: skip
    result.append(record("Layer", 0, children=[record("Version", 100), *elements]))
    head, objects, connections = scene
    geometry, *others = objects[2]
    geometry = record(*geometry[:1], *geometry[1], children=[*geometry[2], *result])
    links = []
    for k, (look, texture) in enumerate(materials):
        others.append(record("Material", 900 + k, f"Material::paint {k}", "", children=[
            record("ShadingModel", "lambert"), properties(*look)]))  # fmt: skip
        links.append(record("C", "OO", 900 + k, MESH))
        if texture is not None:
            others += _texture(920 + k, 940 + k, **texture)
            links += [record("C", "OP", 920 + k, 900 + k, "DiffuseColor")]
            links += [record("C", "OO", 940 + k, 920 + k)]
    return [head, record("Objects", children=[geometry, *others]),
            record("Connections", children=[*connections[2], *links])]  # fmt: skip


def layer(kind, mapping, children):
    return record(f"LayerElement{kind}", 0, children=[
        record("Version", 101), record("Name", "map"), record("MappingInformationType", mapping),
        record("ReferenceInformationType", "IndexToDirect"), *children
    ])  # fmt: skip


def _texture(unique, video, file, content=None, look=()):
    names = [record("FileName", "C:\\work\\" + file), record("RelativeFilename", file)]
    inside = [] if content is None else [record("Content", content)]
    return [
        record("Texture", unique, "Texture::image", "", children=[
            record("Type", "TextureVideoClip"), properties(*look), *names]),
        record("Video", video, "Video::image", "Clip", children=[
            record("Type", "Clip"), *names, *inside]),
    ]  # fmt: skip


def model(unique, name, kind, found):
    return record("Model", unique, f"Model::{name}", kind, children=[properties(*found)])


def settings(up, unit):
    front, side = {0: (1, 2), 1: (2, 0), 2: (1, 0)}[up]
    signs = {0: (1, 1), 1: (1, 1), 2: (-1, 1)}[up]
    axes = [("UpAxis", up), ("UpAxisSign", 1), ("FrontAxis", front), ("FrontAxisSign", signs[0])]
    axes += [("CoordAxis", side), ("CoordAxisSign", signs[1])]
    result = [record("P", name, "int", "Integer", "", value) for name, value in axes]
    result.append(record("P", "UnitScaleFactor", "double", "Number", "", float(unit)))
    return record("GlobalSettings", children=[record("Version", 1000), properties(*result)])


def turning():
    """Turn a joint about x by 90 degrees within a second."""
    times = np.array([0, TICKS], np.int64)
    curves = [
        record("AnimationCurve", 603 + k, "AnimCurve::", "", children=[
            record("KeyTime", times),
            record("KeyValueFloat", np.array([0, end], np.float32)),
            record("KeyAttrFlags", np.array([4], np.int32)),
            record("KeyAttrDataFloat", np.zeros(4, np.float32)),
            record("KeyAttrRefCount", np.array([2], np.int32)),
        ]) for k, end in enumerate((90, 0, 0))
    ]  # fmt: skip
    stop = record("P", "LocalStop", "KTime", "Time", "", TICKS)
    return [
        record("AnimationStack", 600, "AnimStack::bow", "", children=[properties(stop)]),
        record("AnimationLayer", 601, "AnimLayer::base", ""),
        record("AnimationCurveNode", 602, "AnimCurveNode::R", ""),
        *curves,
    ]


def text(records, version=7400):
    """Write records as FBX text."""
    major, minor = divmod(version // 100, 10)
    lines = [f"; FBX {major}.{minor}.0 project file"]
    lines += _lines([record("FBXHeaderExtension", children=[record("FBXVersion", version)])], "")
    return "\n".join(lines + _lines(records, "")).encode()


def _lines(records, indent):
    lines = []
    for name, values, children in records:
        inner = indent + "\t"
        arrays = [v for v in values if isinstance(v, np.ndarray)]
        if arrays:
            numbers = ",".join(repr(x) for x in arrays[0].tolist())
            lines += [
                f"{indent}{name}: *{len(arrays[0])} {{",
                f"{inner}a: {numbers}",
                f"{indent}}}",
            ]
            continue
        values = [base64.b64encode(v).decode() if isinstance(v, bytes) else v for v in values]
        shown = ", ".join(f'"{v}"' if isinstance(v, str) else repr(v) for v in values)
        lines.append(f"{indent}{name}: {shown}" + (" {" if children else ""))
        if children:
            lines += [*_lines(children, inner), f"{indent}}}"]
    return lines


def binary(records, version=7400):
    """Write records as binary FBX, arrays compressed."""
    head = b"Kaydara FBX Binary  \0\x1a\0" + struct.pack("<I", version)
    wide = version >= 7500
    data = bytearray(head)
    for one in records:
        data += _packed(one, len(data), wide)
    return bytes(data + bytes(25 if wide else 13))


def _packed(one, at, wide):
    name, values, children = one
    packed = b"".join(_value(v) for v in values)
    form = "<QQQB" if wide else "<IIIB"
    head = struct.calcsize(form) + len(name)
    body = bytearray(packed)
    for child in children:
        body += _packed(child, at + head + len(body), wide)
    if children:
        body += bytes(25 if wide else 13)
    end = at + head + len(body)
    return struct.pack(form, end, len(values), len(packed), len(name)) + name.encode() + body


def _value(value):
    if isinstance(value, np.ndarray):
        kind = {"f8": b"d", "f4": b"f", "i4": b"i", "i8": b"l"}[value.dtype.str[1:]]
        content = zlib.compress(value.tobytes())
        return kind + struct.pack("<III", len(value), 1, len(content)) + content
    if isinstance(value, str):
        kind, _, name = value.partition("::")
        content = f"{name}\0\x01{kind}".encode() if "::" in value else value.encode()
        return b"S" + struct.pack("<I", len(content)) + content
    if isinstance(value, bytes):
        return b"R" + struct.pack("<I", len(value)) + value
    if isinstance(value, float):
        return b"D" + struct.pack("<d", value)
    return b"L" + struct.pack("<q", value)


OLD = """; FBX 6.1.0 project file
FBXHeaderExtension:  {
    FBXHeaderVersion: 1003
    FBXVersion: 6100
}
Objects:  {
    Model: "Model::body", "Mesh" {
        Version: 232
        Vertices: %(vertices)s
        PolygonVertexIndex: %(corners)s
    }
    Model: "Model::root", "Limb" {
        Version: 232
        Properties60:  {
            Property: "Lcl Translation", "Lcl Translation", "A+",0.5,0,0.5
        }
    }
    Model: "Model::tip", "Limb" {
        Version: 232
        Properties60:  {
            Property: "Lcl Translation", "Lcl Translation", "A+",0,1,0
        }
    }
    Deformer: "Deformer::Skin body", "Skin" {
        Version: 100
        MultiLayer: 0
        Type: "Skin"
    }
    %(clusters)s
    GlobalSettings:  {
        Version: 1000
        Properties60:  {
            Property: "UpAxis", "int", "",1
            Property: "UnitScaleFactor", "double", "",1
        }
    }
}
Connections:  {
    Connect: "OO", "Model::body", "Model::Scene"
    Connect: "OO", "Model::root", "Model::Scene"
    Connect: "OO", "Model::tip", "Model::root"
    Connect: "OO", "Deformer::Skin body", "Model::body"
    Connect: "OO", "SubDeformer::Cluster 0", "Deformer::Skin body"
    Connect: "OO", "SubDeformer::Cluster 1", "Deformer::Skin body"
    Connect: "OO", "Model::root", "SubDeformer::Cluster 0"
    Connect: "OO", "Model::tip", "SubDeformer::Cluster 1"
}
"""


def old_text():
    """Return the column as FBX 6.1, without its end marker."""
    corners = FACES.copy()
    corners[:, -1] = ~corners[:, -1]
    clusters = []
    for k in range(2):
        held = np.flatnonzero(SHARES[:, k])
        clusters.append(
            f'Deformer: "SubDeformer::Cluster {k}", "Cluster" {{\nVersion: 100\nType: "Cluster"\n'
            f"Indexes: {_list(held)}\nWeights: {_list(SHARES[held, k])}\n"
            f"Transform: {_list(moved(*-REST[k]).T)}\nTransformLink: {_list(moved(*REST[k]).T)}\n}}"
        )
    result = {"vertices": _list(COLUMN), "corners": _list(corners), "clusters": "\n".join(clusters)}
    return (OLD % result).encode()


def _list(values):
    return ",".join(map(str, np.asarray(values).ravel().tolist()))
