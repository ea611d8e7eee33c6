"""A flat section is a part of the graph, and lies where the graph does."""

import json

import numpy as np
import pytest

from cutcell import build_graph
from cutcell.geodesics import bone_segments
from cutcell.graph import MESH
from cutcell.method import ANIMATION
from cutcell_viewers.character import to_scene
from cutcell_viewers.flat import LOOKS, MAX_NODES, flat_section
from tests.viewers.arm import arm_rig


@pytest.fixture(scope="module")
def rig():
    return arm_rig()


@pytest.mark.parametrize("axis", LOOKS)
@pytest.mark.parametrize("connectivity", [6, 26])
def test_nodes_and_edges_are_those_of_the_graph(rig, axis, connectivity):
    method = ANIMATION.with_options(resolution=20, connectivity=connectivity)
    whole, flat = build_graph(rig.mesh, method=method), flat_section(rig, method, axis=axis).graph
    assert len(flat.nodes) > 20
    assert edges_of(flat) <= edges_of(whole)


def edges_of(graph):
    """Return kinds and positions of the ends, kind and length of each edge."""
    ends = [(kind, *node) for kind, node in zip(graph.node_kind, graph.nodes, strict=True)]
    rest = zip(graph.edge_kind, graph.lengths, strict=True)
    return {
        (frozenset((ends[a], ends[b])), *kind_and_length)
        for (a, b), kind_and_length in zip(graph.edges, rest, strict=True)
    }


@pytest.mark.parametrize("axis", LOOKS)
def test_the_picture_lies_in_the_plane_and_looks_as_the_scene_does(rig, axis):
    section = flat_section(rig, ANIMATION.with_options(resolution=20), axis=axis, position=0.4)
    data = json.loads(json.dumps(section.data()))
    frame = {name: np.array(at) for name, at in data["frame"].items()}
    inside = section.graph.node_kind != MESH
    x, y = np.array(data["nodes"])[inside].T
    at = frame["origin"] + np.outer(x, frame["right"]) + np.outer(y, frame["up"])
    placed = to_scene(rig, section.graph.lattice.to_file(section.graph.nodes[inside]))
    assert np.allclose(at, placed, atol=1e-8)
    across = np.cross(frame["right"], frame["up"])
    assert np.allclose(across / np.linalg.norm(across), np.eye(3)["xyz".index(axis)])
    assert abs(np.linalg.norm(frame["right"]) - data["size"]) < 1e-9
    low, high = np.reshape(data["box"], (2, 2))
    assert (low < high).all()
    for ray in data["rays"]:
        ends = np.array(ray["pieces"])[:, :2]
        assert (ends[:, 0] < ends[:, 1]).all()
        assert (np.diff(ends[:, 0]) > 0).all()


def test_the_resolution_falls_until_few_nodes_are_left(rig):
    section = flat_section(rig, ANIMATION.with_options(resolution=256))
    assert MAX_NODES / 2 < len(section.graph.nodes) <= MAX_NODES
    assert section.graph.lattice.resolution < 256


@pytest.mark.parametrize("position", [0.0, 1.0])
def test_a_plane_beside_the_body_is_empty(rig, position):
    # The outermost lattice plane may lie half a cell outside of the body.
    method = ANIMATION.with_options(resolution=9)
    bones = bone_segments(rig.skeleton)
    for axis in LOOKS:
        section = flat_section(rig, method, axis=axis, position=position, bones=bones)
        data = section.data()
        assert np.isfinite(np.array(data["box"])).all()
        assert (len(data["nodes"]) == 0) == (len(data["outline"]) == 0)
        assert len(section.distances()) == len(data["nodes"])


def test_without_bones_no_distance_is_finite(rig):
    section = flat_section(rig, ANIMATION.with_options(resolution=12, connectivity="any"))
    assert section.data()["sources"] == section.data()["bones"] == []
    assert np.isinf(section.distances()).all()
