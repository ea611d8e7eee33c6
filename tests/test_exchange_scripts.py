"""The scripts for other programs in docs/exchange, with stand-ins for these programs."""

import runpy
import sys
from collections import defaultdict
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from cutcell.io.exchange import save_weights
from tests.bars import bar

SCRIPTS = Path(__file__).resolve().parent.parent / "docs/exchange"


@pytest.fixture
def exported(tmp_path):
    rig = bar(4)
    x = rig.mesh.vertices[:, 0]
    rig = rig.with_weights(np.stack([1 - x, x, 0 * x], axis=1))
    (file,) = save_weights(tmp_path / "bar.csv", rig)
    return rig, str(file)


def loaded(monkeypatch, name, **modules):
    for module, content in modules.items():
        stand_in = ModuleType(module.replace("__", "."))
        vars(stand_in).update(content)
        monkeypatch.setitem(sys.modules, module.replace("__", "."), stand_in)
    return runpy.run_path(str(SCRIPTS / f"{name}.py"))


class Maya:
    """The commands of Maya that the script calls."""

    def __init__(self, joints):
        self.joints, self.weights = joints, {}

    def listHistory(self, mesh, pruneDagObjects):
        return ["tweak1", "skinCluster1"]

    def ls(self, nodes, type):
        return [node for node in nodes if node.startswith(type)]

    def skinCluster(self, cluster, query, influence):
        return self.joints

    def skinPercent(self, cluster, point, transformValue, normalize):
        self.weights[point] = dict(transformValue)


def test_maya(monkeypatch, exported):
    rig, file = exported
    cmds = Maya(["|root|joint 0", "|root|joint 0|joint 1", "extra"])
    script = loaded(monkeypatch, "maya", maya={"cmds": cmds})
    assert script["apply"](file, "body") == len(rig.weights)
    for v, row in enumerate(rig.weights):
        written = cmds.weights[f"body.vtx[{v}]"]
        assert written["|root|joint 0"] == pytest.approx(row[0], abs=1e-6)
        assert written["|root|joint 0|joint 1"] == pytest.approx(row[1], abs=1e-6)
        assert written["extra"] == 0
    cmds.joints = ["joint 0"]
    with pytest.raises(RuntimeError, match="joint 1"):
        script["apply"](file, "body")


class Modifier:
    """Unreal's SkinWeightModifier."""

    def __init__(self, count, bones):
        self.count, self.bones, self.weights, self.committed = count, bones, {}, False

    def set_skeletal_mesh(self, mesh):
        return True

    def get_num_vertices(self):
        return self.count

    def get_all_bone_names(self):
        return self.bones

    def set_vertex_weights(self, vertex, weights, replace_all):
        self.weights[vertex] = weights

    def commit_weights_to_skeletal_mesh(self):
        self.committed = True
        return True


def test_unreal(monkeypatch, exported):
    rig, file = exported
    modifier = Modifier(len(rig.weights), ["joint 0", "joint 1"])
    content = {"load_asset": lambda path: path, "SkinWeightModifier": lambda: modifier}
    script = loaded(monkeypatch, "unreal", unreal=content)
    assert script["apply"](file, "/Game/Body") == len(rig.weights)
    assert modifier.committed
    for v, row in enumerate(rig.weights):
        assert modifier.weights[v].get("joint 1", 0) == pytest.approx(row[1], abs=1e-6)
    modifier.count = 3
    with pytest.raises(RuntimeError, match="only 3"):
        script["apply"](file, "/Game/Body")


class Tree:
    """Blender's KDTree."""

    def __init__(self, size):
        self.places, self.numbers = [], []

    def insert(self, place, number):
        self.places.append(place)
        self.numbers.append(number)

    def balance(self):
        self.tree = cKDTree(self.places)

    def find(self, place):
        distance, k = self.tree.query(place)
        return self.places[k], self.numbers[k], distance


class Groups(dict):
    """The vertex groups of an object."""

    def new(self, name):
        rows = defaultdict(float)
        self[name] = SimpleNamespace(
            rows=rows,
            add=lambda which, weight, mode: rows.update(dict.fromkeys(which, weight)),
            remove=lambda which: [rows.pop(one, None) for one in which],
        )
        return self[name]


def test_blender(monkeypatch, exported):
    rig, file = exported
    order = np.random.default_rng(0).permutation(len(rig.weights))
    with_z_up = rig.mesh.vertices[:, [0, 2, 1]] * [1, -1, 1]
    points = [SimpleNamespace(index=k, co=with_z_up[v]) for k, v in enumerate(order)]
    thing = SimpleNamespace(
        vertex_groups=Groups(), data=SimpleNamespace(vertices=points), matrix_world=np.eye(3)
    )
    context = SimpleNamespace(view_layer=SimpleNamespace(update=lambda: None))
    script = loaded(
        monkeypatch,
        "blender",
        bpy={"context": context},
        mathutils={},
        mathutils__kdtree={"KDTree": Tree},
    )
    assert script["apply"](file, thing) < 1e-6
    rows = thing.vertex_groups["joint 1"].rows
    for k, v in enumerate(order):
        assert rows[k] == pytest.approx(rig.weights[v, 1], abs=1e-6)
