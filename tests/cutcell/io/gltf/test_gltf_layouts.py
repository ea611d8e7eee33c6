"""Wherever a file keeps its data, saving changes the weights and nothing else."""

import base64
import json

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.io.gltf.container import read_document
from cutcell.io.gltf.read.accessors import read_accessor
from tests.cutcell.io.gltf.gltf_builder import (
    CODES,
    COLUMN,
    FACES,
    JOINTS,
    KINDS,
    REST,
    SHARES,
    moved,
)
from tests.cutcell.io.gltf.test_gltf_save import random_weights
from tests.gltf_validator.validator import errors, reports

SMALL = COLUMN[:8]
CORNERS = FACES[(FACES < 8).all(axis=1)].reshape(-1).astype("u2")
TIMES = np.array([0, 0.5, 1], "f4")
TURNS = np.tile(np.array([0, 0, 0, 1], "f4"), (3, 1))


class Layout:
    """A document whose arrays lie as a test wants them.

    Each array is stored by the function that `place` names for it; those that share a view
    are collected and written by `finished`.
    """

    def __init__(self, place=lambda name: "own", buffer=lambda name: 0):
        self.place, self.buffer = place, buffer
        self.data = [bytearray()]
        self.views, self.accessors = [], []
        self.together = {}
        self.json = {
            "asset": {"version": "2.0"},
            "scene": 0,
            "nodes": [
                {"name": "root", "translation": REST[0].tolist(), "children": [1]},
                {"name": "tip", "translation": (REST[1] - REST[0]).tolist()},
            ],
            "scenes": [{"nodes": [0]}],
            "meshes": [],
            "skins": [{"joints": [0, 1]}],
        }

    def view(self, content, buffer=0, **fields):
        while len(self.data) <= buffer:
            self.data.append(bytearray())
        data = self.data[buffer]
        data += bytes(-len(data) % 4)
        self.views.append(
            {"buffer": buffer, "byteOffset": len(data), "byteLength": len(content), **fields}
        )
        data += content
        return len(self.views) - 1

    def array(self, name, values, **fields):
        """Store an array as `place` says and return its accessor."""
        values = np.ascontiguousarray(values)
        values = values.reshape(len(values), -1)
        width = {"componentType": CODES[values.dtype.str[1:]], "type": KINDS[values.shape[1]]}
        self.accessors.append({**width, "count": len(values), **fields})
        index, place, buffer = len(self.accessors) - 1, self.place(name), self.buffer(name)
        rows = values.view("u1").reshape(len(values), -1)
        if place == "sparse":
            self._sparse(index, values, buffer)
        elif place == "strided" and rows.shape[1] % 4 == 0:
            padded = np.pad(rows, ((0, 0), (0, 8)), constant_values=0xEE)
            view = self.view(padded.tobytes(), buffer, byteStride=padded.shape[1])
            self.accessors[index]["bufferView"] = view
        elif place == "shared":
            self.together.setdefault((buffer, *width.values()), []).append((index, rows))
        elif place == "interleaved" and rows.shape[1] % 4 == 0:
            self.together.setdefault((buffer, len(values)), []).append((index, rows))
        else:
            self.accessors[index]["bufferView"] = self.view(rows.tobytes(), buffer)
        return index

    def _sparse(self, index, values, buffer):
        where = np.arange(0, len(values), 2).astype("u1")
        base = values.copy()
        base[where] = 0
        self.accessors[index] |= {
            "bufferView": self.view(base.tobytes(), buffer),
            "sparse": {
                "count": len(where),
                "indices": {
                    "bufferView": self.view(where.tobytes(), buffer),
                    "componentType": 5121,
                },
                "values": {"bufferView": self.view(values[where].tobytes(), buffer)},
            },
        }

    def overlap(self, index):
        """Give an accessor a view of its own over the bytes that it has."""
        accessor = self.accessors[index]
        offset = accessor.pop("byteOffset", 0)
        old = self.views[accessor["bufferView"]]
        place = {"byteOffset": old["byteOffset"] + offset, "byteLength": old["byteLength"] - offset}
        self.views.append({**old, **place})
        accessor["bufferView"] = len(self.views) - 1

    def finished(self):
        """Write what is stored together, and return the document as .gltf text."""
        for (buffer, *kind), members in self.together.items():
            if len(kind) == 2:  # one after the other, as COLLADA's exporters do
                content = b"".join(rows.tobytes() for _, rows in members)
                stride = members[0][1].shape[1]
                fields = {"byteStride": stride} if stride % 4 == 0 else {}
                offsets = np.cumsum([0, *(rows.size for _, rows in members)])
            else:
                packed = np.concatenate([rows for _, rows in members], axis=1)
                content, fields = packed.tobytes(), {"byteStride": packed.shape[1]}
                offsets = np.cumsum([0, *(rows.shape[1] for _, rows in members)])
            view = self.view(content, buffer, **fields)
            for (index, _), offset in zip(members, offsets, strict=False):
                self.accessors[index] |= {"bufferView": view, "byteOffset": int(offset)}
        self.together = {}
        head = "data:application/octet-stream;base64,"
        buffers = [
            {"byteLength": len(data), "uri": head + base64.b64encode(data).decode()}
            for data in self.data
        ]
        stored = {"accessors": self.accessors, "bufferViews": self.views, "buffers": buffers}
        return self.json | stored

    def mesh(self, k, attributes=None):
        """Add a skinned mesh of eight vertices, and return its primitive."""
        offset = np.float32([2 * k, 0, 0])
        position = SMALL + offset
        low, high = position.min(axis=0).tolist(), position.max(axis=0).tolist()
        primitive = {
            "attributes": {
                "POSITION": self.array("POSITION", position, min=low, max=high),
                "NORMAL": self.array("NORMAL", np.tile(np.float32([0, 1, 0]), (8, 1))),
                "JOINTS_0": self.array("JOINTS_0", JOINTS[:8]),
                "WEIGHTS_0": self.array("WEIGHTS_0", SHARES[:8]),
                **(attributes or {}),
            },
            "indices": self.array("indices", CORNERS),
        }
        self.json["meshes"].append({"primitives": [primitive]})
        self.json["nodes"].append({"mesh": len(self.json["meshes"]) - 1, "skin": 0})
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]) - 1)
        return primitive

    def extras(self):
        """Add what is neither mesh nor weights."""
        binds = np.array([moved(*-p).T.reshape(16) for p in REST], "f4")
        self.json["skins"][0]["inverseBindMatrices"] = self.array("binds", binds)
        times = self.array("times", TIMES, min=[0], max=[1])
        turns = self.array("turns", TURNS)
        target = {"node": 1, "path": "rotation"}
        self.json["animations"] = [
            {
                "channels": [{"sampler": 0, "target": target}],
                "samplers": [{"input": times, "output": turns}],
            }
        ]
        primitive = self.json["meshes"][0]["primitives"][0]
        shape = SMALL * np.float32(0.1)
        low, high = shape.min(axis=0).tolist(), shape.max(axis=0).tolist()
        primitive["targets"] = [{"POSITION": self.array("target", shape, min=low, max=high)}]
        self.json["images"] = [
            {"bufferView": self.view(b"\x89PNG picture"), "mimeType": "image/png"}
        ]
        self.json["extensionsUsed"] = ["ACME_thing"]
        own = self.view(b"of an extension")
        self.json["extensions"] = {"ACME_thing": {"deep": [{"bufferView": own}]}}

    def save(self, path):
        path.write_text(json.dumps(self.finished()))
        return path


def content(document, view):
    """Return the bytes of a buffer view, or of anything else that names bytes."""
    start = view.get("byteOffset", 0)
    return document.buffers[view["buffer"]][start : start + view["byteLength"]]


def check_saving(path, out, dropped=("JOINTS_0", "WEIGHTS_0"), most=2):
    """Save with new weights, and see that all but the weights reads as it did."""
    rig = cutcell.load(path)
    weights = random_weights(rig, most)
    cutcell.save(out, rig.with_weights(weights))
    again = cutcell.load(out)
    assert_allclose(again.weights, weights, atol=2e-7)
    assert_array_equal(again.mesh.vertices, rig.mesh.vertices)
    before, after = read_document(path), read_document(out)
    attributes = [p["attributes"] for m in before.items("meshes") for p in m["primitives"]]
    gone = {result[name] for result in attributes for name in dropped if name in result}
    kept = {v for result in attributes for k, v in result.items() if k not in dropped}
    for i, accessor in enumerate(before.items("accessors")):
        if i in gone - kept:
            continue
        same = after.items("accessors")[i]
        assert {**same, "byteOffset": 0} == {**accessor, "byteOffset": 0}, i
        stored = [read_accessor(d, i, accessor["type"], f"{i}") for d in (before, after)]
        assert_array_equal(*stored)
    for image, same in zip(before.items("images"), after.items("images"), strict=True):
        views = [
            d.json["bufferViews"][k["bufferView"]] for d, k in ((before, image), (after, same))
        ]
        assert content(before, views[0]) == content(after, views[1])
    cutcell.save(out.with_stem("twice"), again)
    assert out.with_stem("twice").read_bytes() == out.read_bytes()
    return before, after


PLACES = ("own", "shared", "interleaved", "strided")


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("meshes", [1, 3])
@pytest.mark.parametrize("end", [".glb", ".gltf"])
def test_the_layouts_that_exporters_write(tmp_path, place, meshes, end):
    layout = Layout(lambda name: place)
    for k in range(meshes):
        layout.mesh(k)
    layout.extras()
    path, out = layout.save(tmp_path / "in.gltf"), tmp_path / f"out{end}"
    check_saving(path, out)
    before, after = map(errors, reports(path, out))
    assert after - before == {}


def test_one_view_for_each_type_is_used_again_by_all_its_arrays(tmp_path):
    """The first array took the view, the next was written past its end."""
    layout = Layout(lambda name: "shared" if name in ("JOINTS_0", "WEIGHTS_0") else "own")
    for k in range(5):
        layout.mesh(k)
    before, after = check_saving(layout.save(tmp_path / "in.gltf"), tmp_path / "out.gltf")
    assert len(after.json["bufferViews"]) == len(before.json["bufferViews"])
    assert len(after.buffers[0]) <= len(before.buffers[0]) + 8


def test_several_buffers_and_one_view_in_each(tmp_path):
    layout = Layout(lambda name: "shared", lambda name: len(name) % 3)
    for k in range(2):
        layout.mesh(k)
    layout.extras()
    _, after = check_saving(layout.save(tmp_path / "in.gltf"), tmp_path / "out.glb")
    assert len(after.buffers) == 1


def test_an_accessor_that_two_primitives_and_two_meshes_use(tmp_path):
    layout = Layout()
    first = layout.mesh(0)
    same = {k: first["attributes"][k] for k in ("JOINTS_0", "WEIGHTS_0")}
    layout.mesh(1, same)
    other = {**first, "indices": layout.array("indices", CORNERS[:6])}
    layout.json["meshes"][0]["primitives"].append(other)
    check_saving(layout.save(tmp_path / "in.gltf"), tmp_path / "out.glb")


def test_weights_whose_bytes_something_else_reads_too(tmp_path):
    layout = Layout(lambda name: "interleaved")
    primitive = layout.mesh(0)
    layout.finished()
    shares = layout.accessors[primitive["attributes"]["WEIGHTS_0"]]
    layout.accessors.append(dict(shares))
    primitive["attributes"]["_COPY"] = len(layout.accessors) - 1
    layout.json["nodes"].append({"mesh": 1})  # a mesh without a skin that has weights all the same
    layout.json["scenes"][0]["nodes"].append(3)
    layout.json["meshes"].append({"primitives": [dict(primitive)]})
    check_saving(layout.save(tmp_path / "in.gltf"), tmp_path / "out.glb", dropped=())


def test_an_extension_that_names_bytes_itself(tmp_path):
    layout = Layout(buffer=lambda name: 1)
    layout.mesh(0)
    hidden = layout.views[layout.view(b"named by an extension", 1)]
    layout.views.pop()
    extension = {"ACME_thing": {"buffer": 1, "byteLength": 21, "byteOffset": hidden["byteOffset"]}}
    layout.views[0]["extensions"] = extension
    layout.views[2] |= {"name": "joints", "extensions": extension}  # goes with the old bytes
    layout.json["extensionsUsed"] = ["ACME_thing"]
    layout.json["extras"] = {"buffer": 1, "byteLength": 4}
    _, after = check_saving(layout.save(tmp_path / "in.gltf"), tmp_path / "out.glb")
    assert after.json["bufferViews"][2]["name"] == "joints"
    assert "extensions" not in after.json["bufferViews"][2]
    result = after.json["bufferViews"][0]["extensions"]["ACME_thing"]
    assert content(after, result) == b"named by an extension"
    assert after.json["extras"] == {"buffer": 1, "byteLength": 4}


@pytest.mark.parametrize("buffer", [0, 1, -1])
def test_a_document_that_refers_to_bytes_that_are_not_there_is_refused(tmp_path, buffer):
    layout = Layout()
    layout.mesh(0)
    layout.views.append({"buffer": buffer, "byteOffset": 8, "byteLength": 10_000})
    sentence = r"in\.gltf: a buffer view (ends at byte 10008|refers to buffers\[-?1\])"
    with pytest.raises(cutcell.FileError, match=sentence):
        cutcell.load(layout.save(tmp_path / "in.gltf"))


@settings(
    max_examples=60,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(data=st.data())
def test_any_layout(tmp_path, data):
    places, buffers = st.sampled_from(PLACES), st.integers(0, 2)
    influence_places = st.sampled_from((*PLACES, "sparse"))

    def place(name):
        return data.draw(influence_places if name.endswith("_0") else places, label=name)

    layout = Layout(place, lambda name: data.draw(buffers))
    primitives = [layout.mesh(k) for k in range(data.draw(st.integers(1, 3)))]
    layout.extras()
    layout.finished()
    for index in data.draw(st.sets(st.integers(0, len(layout.accessors) - 1), max_size=4)):
        layout.overlap(index)
    if data.draw(st.booleans()):  # bytes of weights that are something else's, too
        shares = layout.accessors[primitives[0]["attributes"]["WEIGHTS_0"]]
        layout.accessors.append(dict(shares))
        primitives[-1]["attributes"]["_COPY"] = len(layout.accessors) - 1
    if data.draw(st.booleans()):  # weights that several primitives use
        primitives[-1]["attributes"] |= {
            k: primitives[0]["attributes"][k] for k in ("JOINTS_0", "WEIGHTS_0")
        }
    path = layout.save(tmp_path / "in.gltf")
    most = data.draw(st.integers(1, 2))
    check_saving(path, tmp_path / data.draw(st.sampled_from(["out.glb", "out.gltf"])), most=most)
