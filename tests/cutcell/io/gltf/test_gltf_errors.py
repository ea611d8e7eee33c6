"""Every way in which a glTF file can be wrong gives one sentence that names the file."""

import json
import struct

import numpy as np
import pytest

import cutcell
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES, SHARES, column, moved, pack
from tests.cutcell.io.gltf.test_gltf_clips import LINEAR, animate

F, M, S, W = cutcell.FileError, cutcell.MeshError, cutcell.SkeletonError, cutcell.WeightsError


def primitive(b):
    return b.json["meshes"][0]["primitives"][0]


def attributes(b):
    return primitive(b)["attributes"]


def put(path, value):
    """Return a change that sets one field of the document."""

    def change(b):
        owner = b.json
        for key in path[:-1]:
            owner = owner[key]
        owner[path[-1]] = value

    return change


def drop(*path):
    def change(b):
        owner = b.json
        for key in path[:-1]:
            owner = owner[key]
        del owner[path[-1]]

    return change


def attribute(name, values, **fields):
    def change(b):
        attributes(b)[name] = b.accessor(values, **fields)

    return change


def in_accessor(name, **fields):
    def change(b):
        b.json["accessors"][attributes(b)[name]].update(fields)

    return change


def in_view(name, **fields):
    def change(b):
        view = b.json["accessors"][attributes(b)[name]]["bufferView"]
        b.json["bufferViews"][view].update(fields)

    return change


def indices(values):
    def change(b):
        primitive(b)["indices"] = b.accessor(np.array(values))

    return change


def sparse(**parts):
    def change(b):
        view = b.view(bytes(64))
        whole = {
            "count": 1,
            "indices": {"bufferView": view, "componentType": 5121},
            "values": {"bufferView": view},
        }
        b.json["accessors"][attributes(b)["POSITION"]]["sparse"] = {**whole, **parts}

    return change


def animated(**sampler):
    def change(b):
        animate(b, *LINEAR)
        b.json["animations"][0]["samplers"][0] |= {
            k: v(b) if callable(v) else v for k, v in sampler.items()
        }

    return change


def binds(matrices):
    def change(b):
        b.json["skins"][0]["inverseBindMatrices"] = b.accessor(np.array(matrices))

    return change


def nan(array, at=(3, 0)):
    array = np.array(array)
    array[at] = np.nan
    return array


def attach(b):
    mesh = b.mesh({"POSITION": b.positions(np.zeros((3, 3)))}, faces=[0, 1, 2])
    b.node(1, name="sword", mesh=mesh)


def flat_strip(b):
    primitive(b).update(mode=5, indices=b.accessor(np.zeros(3, "u1")))


def large_together(builder):
    for node in builder.json["nodes"][:2]:
        node["scale"] = [1e59] * 3


CASES = {
    "no asset": (drop("asset"), F, 'no "asset"'),
    "version 1": (put(["asset", "version"], "1.0"), F, "is glTF 1.0; only glTF 2.0"),
    "no mesh": (drop("nodes", 2, "mesh"), F, "has no mesh"),
    "nodes no list": (put(["nodes"], {}), F, '"nodes" of the glTF document must be a list'),
    "node no object": (put(["nodes", 0], 7), F, '"nodes" of the glTF document must be a list'),
    "children no list": (put(["nodes", 0, "children"], 1), F, '"children" must be a list'),
    "child missing": (put(["nodes", 0, "children"], [9]), F, "nodes.0. refers to nodes.9."),
    "two parents": (put(["nodes", 2, "children"], [1]), S, 'node "tip" hangs on two nodes'),
    "cycle": (put(["nodes", 1, "children"], [0]), S, 'node tree has a cycle at node "root"'),
    "node hangs on itself": (put(["nodes", 2, "children"], [2]), S, 'cycle at node "body"'),
    "scene missing": (put(["scene"], 4), F, r"scene refers to scenes\[4\]"),
    "mesh missing": (put(["nodes", 2, "mesh"], 3), F, r'node "body" refers to meshes\[3\]'),
    "skin missing": (put(["nodes", 2, "skin"], 3), F, r"refers to skins\[3\], but .* 1 skins"),
    "skin no number": (put(["nodes", 2, "skin"], "a"), F, r"refers to skins\['?a'?\]"),
    "translation": (
        put(["nodes", 1, "translation"], [1, 2]),
        F,
        'node "tip": "translation" must be 3 finite numbers',
    ),
    **{
        f"large {key}": (
            put(["nodes", 1, key], [1e200] * count),
            F,
            f'node "tip": "{key}" must be {count} finite numbers',
        )
        for key, count in (("translation", 3), ("rotation", 4), ("scale", 3), ("matrix", 16))
    },
    "large together": (large_together, F, 'node "tip": its place in the scene has numbers above'),
    "no joints": (put(["skins", 0, "joints"], []), S, r"skins\[0\] has no joints"),
    "joint missing": (put(["skins", 0, "joints"], [0, 8]), F, r"skins\[0\] refers to nodes\[8\]"),
    "joint twice": (put(["skins", 0, "joints"], [0, 0]), S, 'names node "root" twice'),
    "flat bind": (
        binds([np.eye(4), np.diag([1.0, 0, 1, 1])]),
        S,
        'inverse bind matrix of the joint node "tip" cannot be inverted',
    ),
    "nan bind": (binds([np.eye(4), nan(np.eye(4))]), S, 'joint node "tip" cannot be inverted'),
    "joint far away": (binds([np.eye(4), moved(0, -9e4, 0)]), S, 'joint "tip" at .* same units'),
    "primitives": (put(["meshes", 0, "primitives"], 0), F, 'mesh "column": "primitives" must be'),
    "no attributes": (lambda b: primitive(b).pop("attributes"), F, 'has no "attributes"'),
    "no POSITION": (lambda b: attributes(b).pop("POSITION"), M, "primitive 0 has no POSITION"),
    "only points": (lambda b: primitive(b).update(mode=0), M, "no triangles"),
    "no faces": (flat_strip, M, "no triangles"),
    "nan vertex": (
        attribute("POSITION", nan(COLUMN)),
        M,
        'mesh "column", primitive 0: vertex 3 has a coordinate that is not a finite number',
    ),
    "one point": (attribute("POSITION", COLUMN * 0), M, "lie in one point"),
    "index out of range": (
        indices([0, 1, 12]),
        M,
        "index 12 is out of range: it has 12 vertices",
    ),
    "float indices": (indices([0.0, 1, 2]), F, "not unsigned integers"),
    "half a face": (indices([0, 1, 2, 3]), M, "4 corners do not make whole triangles"),
    "accessor missing": (lambda b: attributes(b).update(POSITION=99), F, r"accessors\[99\]"),
    "accessor type": (in_accessor("POSITION", type="VEC2"), F, "is VEC2, expected VEC3"),
    "component type": (in_accessor("POSITION", componentType=5124), F, "5124 is none of glTF's"),
    "no count": (in_accessor("POSITION", count=None), F, '"count" must be a whole number'),
    "count 0": (in_accessor("POSITION", count=0), F, "is empty: its count is 0"),
    "negative offset": (in_accessor("POSITION", byteOffset=-4), F, '"byteOffset" must be a whole'),
    "count too large": (in_accessor("POSITION", count=13), F, r"runs past bufferViews\[1\]"),
    "huge count": (in_accessor("POSITION", count=10**15), F, r"runs past bufferViews\[1\]"),
    "huge nothing": (
        lambda b: attributes(b).update(
            POSITION=b.add("accessors", {"componentType": 5126, "count": 10**12, "type": "VEC3"})
        ),
        F,
        r"accessors\[\d+\] would take 24,000 GB of memory, and a file of \d\.\d kB may take 269 MB",
    ),
    "view missing": (in_accessor("POSITION", bufferView=77), F, r"bufferViews\[77\]"),
    "view past buffer": (in_view("POSITION", byteLength=10**6), F, "ends at byte 1000128 of"),
    "view without buffer": (in_view("POSITION", buffer=2), F, r"refers to buffers\[2\]"),
    "short stride": (in_view("POSITION", byteStride=4), F, "stride of 4 bytes is too short"),
    "sparse no object": (in_accessor("POSITION", sparse=3), F, "sparse: must be an object"),
    "sparse no values": (sparse(values=None), F, '"indices" and "values" need'),
    "sparse no view": (sparse(values={}), F, 'need a "bufferView"'),
    "sparse range": (sparse(indices={"bufferView": 0, "componentType": 5126}), F, "out of range"),
    "float joints": (attribute("JOINTS_0", SHARES), F, "JOINTS_0 are float"),
    "integer weights": (attribute("WEIGHTS_0", SHARES.astype("u1")), F, "neither floats nor"),
    "no weights": (lambda b: attributes(b).pop("WEIGHTS_0"), W, "has JOINTS_0 but no WEIGHTS_0"),
    "too few weights": (attribute("WEIGHTS_0", SHARES[:5]), W, "12 JOINTS_0 and 5 WEIGHTS_0"),
    "joint out of skin": (
        attribute("JOINTS_0", np.full((12, 4), 2, "u1")),
        W,
        "vertex 0 is weighted to joint 2 in JOINTS_0, but its skin has 2 joints",
    ),
    "interpolation": (animated(interpolation="MAGIC"), F, 'animation "wave": the interpolation'),
    "too few values": (
        animated(output=lambda b: b.accessor(np.ones((2, 4)))),
        F,
        "4 keys need 4 values, 2 are there",
    ),
    "keys go back": (
        animated(input=lambda b: b.accessor(np.array([0, 2, 1, 3.0]))),
        F,
        "key times must be ascending",
    ),
    "nan pose": (
        animated(output=lambda b: b.accessor(nan(np.ones((4, 4))))),
        F,
        'animation "wave" holds values that are not finite',
    ),
    "sampler missing": (
        lambda b: (animate(b, *LINEAR), b.json["animations"][0]["channels"][0].update(sampler=4)),
        F,
        "a channel uses sampler 4 of 1",
    ),
    "no target": (
        lambda b: (animate(b, *LINEAR), b.json["animations"][0]["channels"][0].pop("target")),
        F,
        'a channel has no "target"',
    ),
    "no channels": (put(["animations"], [{"name": "x"}]), F, 'animation "x": needs "channels"'),
    "attachment in one point": (attach, M, 'node "sword": all faces of the mesh lie in one'),
    "a field of another kind": (put(["nodes", 2, "skin"], [0]), F, r"refers to skins\[\[0\]\]"),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("end", [".glb", ".gltf"])
def test_what_is_wrong_is_said(tmp_path, case, end):
    change, kind, message = CASES[case]
    builder = column()
    change(builder)
    path = builder.save(tmp_path / f"bad{end}")
    with pytest.raises(kind, match=message) as caught:
        cutcell.load(path)
    assert str(caught.value).startswith(f"bad{end}: ")
    assert "\n" not in str(caught.value)


def glb_with(**header):
    content = bytearray(column().glb())
    for at, value in header.values():
        struct.pack_into("<I", content, at, value)
    return bytes(content)


WHOLE = column().glb()
CONTENTS = {
    "text": (b"Hello, this is a letter.\n", "is not a glTF file: it starts with neither"),
    "empty": (b"", "the file is empty"),
    "another binary": (b"\x00\xff" * 99, "is not a glTF file"),
    "only the magic": (b"glTF", "is cut short: 4 bytes are no complete GLB"),
    "version 1": (glb_with(version=(4, 1)), "GLB container of version 1"),
    "half": (WHOLE[: len(WHOLE) // 2], "is cut short: .* bytes are announced"),
    "chunk too long": (glb_with(chunk=(12, 10**6)), "chunk at byte 12 runs past the end"),
    "no JSON chunk": (glb_with(chunk=(16, 7)), "has no JSON chunk at the start"),
    "broken JSON": (pack(b'{"asset": ', b""), "JSON cannot be read: Expecting value"),
    "NaN in JSON": (pack(b'{"a": NaN}', b""), "NaN is not a JSON number"),
    "not UTF-8": (pack(b'{"a": "\xff"}', b""), "JSON cannot be read"),
    "too deep": (pack(b'{"a":' * 100000, b""), "JSON cannot be read"),
    "a list": (pack(b"[1, 2]", b""), "its JSON is not an object"),
    "other JSON": (b'{"joints": []}', 'is JSON, but not glTF: it has no "asset"'),
    "no buffer": (pack(json.dumps(column().finished()).encode(), b""), "has no data"),
    "short buffer": (
        pack(json.dumps(column().finished()).encode(), bytes(40)),
        r"buffers\[0\] is cut short: \d+ bytes announced, 40 there",
    ),
}


@pytest.mark.parametrize("case", CONTENTS)
def test_what_is_no_gltf_at_all(tmp_path, case):
    content, message = CONTENTS[case]
    path = tmp_path / "bad.glb"
    path.write_bytes(content)
    with pytest.raises(cutcell.FileError, match=rf"^bad\.glb: .*{message}"):
        cutcell.load(path)


@pytest.mark.parametrize(
    ("uri", "message"),
    [
        ("gone.bin", "gone.bin: there is no such file"),
        ("../secret.bin", r"is not a file in the folder of rig\.gltf or below it"),
        ("%2e%2e/secret.bin", "is not a file in the folder"),
        ("/etc/passwd", "is not a file in the folder"),
        ("https://example.org/a.bin", "is not a file in the folder"),
        ("data:application/octet-stream,abc", "only base64 data URIs"),
        ("data:;base64,####", "not valid base64"),
        (5, '"uri" must be text'),
    ],
)
def test_buffers_that_cannot_be_had(tmp_path, uri, message):
    builder = column()
    builder.json["buffers"] = [{"uri": uri}]
    (tmp_path / "secret.bin").write_bytes(builder.data)
    (tmp_path / "in").mkdir()
    path = tmp_path / "in" / "rig.gltf"
    path.write_text(json.dumps(builder.finished()))
    with pytest.raises(cutcell.FileError, match=message) as caught:
        cutcell.load(path)
    assert "rig.gltf" in str(caught.value)


def test_a_gltf_document_under_another_name_is_still_one(tmp_path):
    for name, source in (("a.glb", "b.gltf"), ("a.gltf", "b.glb"), ("a.vrm", "b.glb")):
        content = column().save(tmp_path / source).read_bytes()
        (tmp_path / name).write_bytes(content)
        assert len(cutcell.load(tmp_path / name).mesh.faces) == len(FACES)
