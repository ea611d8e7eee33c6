"""Weights alone, to other programs and back."""

import json
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from cutcell import FileError, Part, Rig, Skeleton, TriangleMesh, WeightsError
from cutcell.io.exchange import save_weights, with_saved_weights
from cutcell.io.exchange.files import read_weights
from tests.bars import bar

KINDS = [".xml", ".json", ".csv"]
MAYA = """<?xml version="1.0"?>
<deformerWeight>
  <headerInfo fileName="C:/temp/plane.xml" worldMatrix="1.0 0.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0
    0.0 1.0 0.0 0.0 0.0 0.0 1.0 "/>
  <shape name="pPlaneShape1" group="7" stride="3" size="4" max="4">
    <point index="0" value=" -0.5  0.0  0.5 "/>
    <point index="1" value=" 0.5  0.0  0.5 "/>
    <point index="2" value=" -0.5  0.0  -0.5 "/>
    <point index="3" value=" 0.5  0.0  -0.5 "/>
  </shape>
  <weights deformer="skinCluster1" source="joint1" shape="pPlaneShape1" layer="0"
    defaultValue="0.000" size="3" max="4">
    <point index="0" value="1.000"/>
    <point index="1" value="0.250"/>
    <point index="3" value="1.000"/>
  </weights>
  <weights deformer="skinCluster1" source="joint2" shape="pPlaneShape1" layer="0"
    defaultValue="0.000" size="2" max="3">
    <point index="1" value="0.750"/>
    <point index="2" value="1.000"/>
  </weights>
</deformerWeight>
"""
"""In the form that Maya's documentation describes; no file of Maya itself was at hand."""


def crowd(seed=0):
    """Return three bars side by side whose meshes, vertices and joints have equal names."""
    one, rng = bar(4), np.random.default_rng(seed)
    count = len(one.mesh.vertices)
    vertices = np.concatenate([one.mesh.vertices + np.array([0, k, 0]) for k in range(3)])
    faces = np.concatenate([one.mesh.faces + k * count for k in range(3)])
    joints = np.concatenate([one.skeleton.joints + np.array([0, k, 0]) for k in range(3)])
    names = [f"{space}:joint{j}" for space in "abc" for j in range(3)]
    skeleton = Skeleton(joints, [-1, 0, 1, -1, 3, 4, -1, 6, 7], names=names)
    weights = np.kron(np.eye(3), np.ones((count, 3))) * rng.random((3 * count, 9))
    parts = tuple(
        Part(f"{space}:body", slice(k * count, (k + 1) * count)) for k, space in enumerate("abc")
    )
    return Rig(TriangleMesh(vertices, faces), skeleton, weights, parts=parts)


@pytest.mark.parametrize("kind", KINDS)
def test_meshes_with_equal_names_come_back_right(kind, tmp_path):
    rig = crowd()
    files = save_weights(tmp_path / f"crowd{kind}", rig)
    assert len(files) == 3
    back = with_saved_weights(rig.with_weights(None), files[::-1])
    np.testing.assert_allclose(back.weights, rig.weights, atol=1e-6)
    alike = replace(rig, parts=tuple(replace(part, name="body") for part in rig.parts))
    files = save_weights(tmp_path / f"alike{kind}", alike)
    assert [file.name for file in files] == [f"alike.body{n}{kind}" for n in ("", "-2", "-3")]
    back = with_saved_weights(alike.with_weights(None), files[::-1])
    np.testing.assert_allclose(back.weights, rig.weights, atol=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_other_vertices_take_the_weights_of_the_nearest(kind, tmp_path):
    coarse, fine = bar(4), bar(8)
    weights = np.stack(
        [
            1 - coarse.mesh.vertices[:, 0],
            coarse.mesh.vertices[:, 0],
            0 * coarse.mesh.vertices[:, 0],
        ],
        1,
    )
    (file,) = save_weights(tmp_path / f"bar{kind}", coarse.with_weights(weights))
    back = with_saved_weights(fine, [file])
    assert np.abs(back.weights[:, 1] - fine.mesh.vertices[:, 0]).max() <= 1 / 8 + 1e-6
    order = np.random.default_rng(0).permutation(len(coarse.mesh.vertices))
    shuffled = replace(
        coarse, mesh=TriangleMesh(coarse.mesh.vertices[order], np.argsort(order)[coarse.mesh.faces])
    )
    np.testing.assert_allclose(
        with_saved_weights(shuffled, [file]).weights, weights[order], atol=1e-6
    )


def test_the_xml_has_the_form_that_maya_writes(tmp_path):
    (file,) = save_weights(tmp_path / "bar.xml", bar(4).with_weights(np.eye(3)[np.arange(42) % 3]))

    def form(root):
        return {(node.tag, tuple(sorted(node.attrib))) for node in root.iter()}

    written = ElementTree.parse(file).getroot()
    assert form(written) == form(ElementTree.fromstring(MAYA))
    for one in [*written.iter("shape"), *written.iter("weights")]:
        assert int(one.attrib["size"]) == len(one)
        assert int(one.attrib["max"]) == max(int(p.attrib["index"]) for p in one) + 1


def test_what_maya_writes_is_read(tmp_path):
    (tmp_path / "plane.xml").write_text(MAYA)
    (one,) = read_weights(tmp_path / "plane.xml")
    assert one.mesh == "pPlaneShape1"
    assert one.joints == ("joint1", "joint2")
    np.testing.assert_allclose(one.weights, [[1, 0], [0.25, 0.75], [0, 1], [1, 0]])
    skeleton = Skeleton([[0, 0, 0], [1, 0, 0]], [-1, 0], names=["joint1", "joint2"])
    rig = Rig(TriangleMesh(one.points, [[0, 1, 2], [1, 3, 2]]), skeleton, name="pPlane1")
    np.testing.assert_allclose(
        with_saved_weights(rig, [tmp_path / "plane.xml"]).weights, one.weights
    )


def test_layers_of_ngskintools_are_blended_from_the_last_one_up(tmp_path):
    def layer(opacity, mask, *weights, enabled=True):
        influences = [
            {"name": f"|a|{n}", "index": k, "weights": w} for k, (n, w) in enumerate(weights)
        ]
        return {
            "name": "l",
            "opacity": opacity,
            "enabled": enabled,
            "mask": mask,
            "influences": influences,
        }

    layers = [
        layer(1.0, [], ("x", [0, 1, 0]), ("y", [1, 0, 1]), enabled=False),
        layer(0.5, [1, 1, 0], ("y", [1, 0, 1])),
        layer(1.0, [], ("x", [1, 1, 1])),
    ]
    (tmp_path / "l.json").write_text(json.dumps({"layers": layers}))
    (one,) = read_weights(tmp_path / "l.json")
    expected = {"|a|x": [0.5, 1, 1], "|a|y": [0.5, 0, 0]}
    for name, column in zip(one.joints, one.weights.T, strict=True):
        np.testing.assert_allclose(column, expected[name])


WRONG = {
    "a.xml": "<deformerWeight>",
    "b.xml": "<deformerWeight/>",
    "c.xml": MAYA.replace('index="3"', 'index="9"'),
    "d.json": "{}",
    "e.json": '{"layers": []}',
    "f.csv": "a,b\n",
    "g.csv": "mesh,vertex,x,y,z,joint,weight\nbody,-1,0,0,0,hip,1\n",
    "h.csv": "mesh,vertex,x,y,z,joint,weight\nbody,0,0\n",
    "i.csv": "mesh,vertex,x,y,z,joint,weight\nbody,0,nan,0,0,hip,1\n",
    "j.txt": "",
}


@pytest.mark.parametrize("name", WRONG)
def test_a_damaged_file_is_a_sentence(name, tmp_path):
    (tmp_path / name).write_text(WRONG[name])
    with pytest.raises(FileError):
        with_saved_weights(bar(4), [tmp_path / name])


def test_what_does_not_fit_is_a_sentence(tmp_path):
    rig = crowd()
    with pytest.raises(WeightsError, match="no weights"):
        save_weights(tmp_path / "a.csv", bar(4))
    with pytest.raises(FileError, match=r"\.obj"):
        save_weights(Path(tmp_path / "a.obj"), rig)
    first, *_ = save_weights(tmp_path / "a.csv", rig)
    with pytest.raises(WeightsError, match="no weights for b:body, c:body"):
        with_saved_weights(rig.with_weights(None), [first])
    with pytest.raises(WeightsError, match="the rig lacks"):
        with_saved_weights(replace(bar(4), skeleton=Skeleton([[0, 0, 0]], [-1])), [first])
    away = replace(
        rig,
        mesh=TriangleMesh(rig.mesh.vertices * 100, rig.mesh.faces),
        skeleton=replace(rig.skeleton, joints=rig.skeleton.joints * 100),
    )
    with pytest.raises(WeightsError, match="units"):
        with_saved_weights(away, [first])
