"""Representations of large objects: a line, and a short table in notebooks."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

import cutcell
from cutcell_viewers.pose_scene import pose_scene
from tests.viewers.arm import arm_rig

MAX_LETTERS = 200
MAX_ROWS = 10


@pytest.fixture(scope="module")
def objects():
    rig = arm_rig()
    binding = cutcell.bind(rig, 16)
    scene = pose_scene(rig, binding.weights, np.tile(np.eye(4), (3, 1, 1)))
    objects = rig, rig.mesh, rig.skeleton, binding.graph, binding.distances, binding, scene
    return {type(one).__name__: one for one in objects}


NAMES = [
    "Rig", "TriangleMesh", "Skeleton", "CutCellGraph", "BoneDistances", "Binding", "Description",
]  # fmt: skip


def rows(one):
    """Return the texts of a table's rows."""
    table = ElementTree.fromstring(one._repr_html_())
    assert (table.tag, table.find("caption").text) == ("table", type(one).__name__)
    return {row.find("th").text: row.find("td").text for row in table.iter("tr")}


@pytest.mark.parametrize("name", NAMES)
def test_an_object_is_a_line_and_a_short_table(objects, name):
    line = repr(objects[name])
    assert line.startswith(f"{name}(")
    assert "\n" not in line
    assert "np." not in line
    assert len(line) < MAX_LETTERS
    assert 1 < len(rows(objects[name])) <= MAX_ROWS


def test_counts_and_methods_are_named(objects):
    rig, binding = objects["Rig"], objects["Binding"]
    assert f"vertices={len(rig.mesh.vertices)}, " in repr(rig)
    table = rows(rig)
    assert table["triangles"] == f"{len(rig.mesh.faces):,}"
    assert (table["joints"], table["clips"], table["weights"]) == ("3", "1", "yes")
    table = rows(binding)
    assert (table["method"], table["resolution"]) == ("animation", "16")
    assert table["edges"] == f"{len(binding.graph.edges):,}"
    assert rows(cutcell.bind(rig, 16, method="paper", alpha=0.3))["method"] == "custom"


def test_names_of_files_are_escaped_and_cut_short():
    rig = replace(arm_rig(), name="<script>\n\u202e" + "x" * 1000)
    assert len(repr(rig)) < MAX_LETTERS
    assert "\n" not in repr(rig)
    assert "\u202e" not in repr(rig)
    assert rows(rig)["name"].startswith(r"<script>\n\u202exx")
