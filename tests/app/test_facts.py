"""What the inspector tells of a vertex, without a browser."""

import json
import zipfile
from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell.graph.winding import winding_number as cutcell_winding
from cutcell.rig import TriangleMesh
from cutcell_app.features.compare.results import Compared
from cutcell_app.features.inspector.facts import NO_WEIGHT, components, node_facts, vertex_facts
from cutcell_app.features.state import PageState
from cutcell_app.files.table_export import save_graph
from cutcell_app.looks.methods import title_of


def facts(rig, binding, vertex):
    return vertex_facts(PageState(rig=rig, binding=binding, vertex=vertex))


def test_without_a_vertex_there_is_nothing_to_tell(rig, binding):
    assert facts(rig, binding, None) is None
    assert facts(None, None, 3) is None


def test_before_anything_is_computed_only_the_vertex_is_known(rig):
    assert facts(rig, None, 3) == {"vertex": 3, "computed": False}


def test_weights_and_distances_are_those_of_the_vertex(rig, binding):
    result = facts(rig, binding, 7)
    computed = {bone["joint"]: bone["ours"] for bone in result["weights"]}
    held = dict(enumerate(binding.weights[7]))
    assert computed == {j: w for j, w in held.items() if max(w, rig.weights[7, j]) > NO_WEIGHT}
    shown = [max(bone["ours"], bone["artist"]) for bone in result["weights"]]
    assert shown == sorted(shown, reverse=True)
    assert sum(bone["artist"] for bone in result["weights"]) == pytest.approx(1)
    distances = [bone["distance"] for bone in result["distances"]]
    size = np.ptp(rig.mesh.bounds, axis=0).max()
    assert size != pytest.approx(1)
    np.testing.assert_allclose(distances, np.sort(binding.distances.joint[:, 7]) * size)
    assert result["unit"] == "units"
    assert result["distances"][0]["name"] in rig.skeleton.names
    assert result["reached"]
    assert result["component"] == {"number": 1, "of": 1, "vertices": len(rig.mesh.vertices)}


def test_the_card_lists_the_distance_of_the_chosen_bone(monkeypatch, rig, binding):
    monkeypatch.setattr("cutcell_app.features.inspector.facts.MAX_DISTANCES", 1)
    for joint in range(3):
        state = PageState(rig=rig, binding=binding, vertex=7, joint=joint)
        listed = [one["joint"] for one in vertex_facts(state)["distances"]]
        assert joint in listed
        assert len(listed) <= 2


def test_a_file_without_weights_has_none_to_compare(rig, binding):
    result = facts(replace(rig, weights=None), binding, 7)
    assert not result["artist"]
    assert all(bone["artist"] == 0 for bone in result["weights"])


def test_a_vertex_apart_from_the_rest_says_why_it_fell_back(rig):
    vertices, faces = rig.mesh.vertices, rig.mesh.faces
    apart = vertices[:4] * 0.05 + np.array([0, 2.0, 0])
    faces = np.concatenate(
        [faces, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]) + len(vertices)]
    )
    mesh = TriangleMesh(np.concatenate([vertices, apart]), faces)
    both = replace(rig, mesh=mesh, weights=None, clips=(), attachments=())
    binding = cutcell.bind(both, 16)
    result = facts(both, binding, len(vertices))
    assert result["component"] == {"number": 2, "of": 2, "vertices": 4}
    assert not result["reached"]
    assert "no path through the body" in result["reason"]
    which, sizes = components(binding.graph)
    assert sizes.tolist() == [len(vertices), 4]
    assert (which == np.repeat([0, 1], sizes)).all()


def test_a_node_tells_where_it_is_and_what_it_leads_to(rig, binding):
    graph = binding.graph
    state = PageState(rig=rig, binding=binding, panel="graph", graph_resolution=0)
    assert node_facts(state) is None
    for kind, name in enumerate(("mesh", "interior", "surface")):
        state.node = node = int(np.flatnonzero((graph.node_kind == kind) & graph.connected)[0])
        result = node_facts(state)
        assert (result["node"], result["kind"]) == (node, name)
        place = graph.lattice.to_file(graph.nodes[[node]])
        np.testing.assert_allclose([result["position"]], place)
        assert result["winding"] == pytest.approx(cutcell_winding(rig.mesh, place)[0])
        row = graph.csr()[[node]].tocoo()
        reports = {other["node"]: other["length"] for other in result["neighbours"]}
        assert result["degree"] == len(row.col)
        assert set(reports) <= set(row.col.tolist())
        if kind == 2:
            face = graph.triangle[node]
            assert result["triangle"] == [face, *rig.mesh.faces[face]]
        else:
            assert result["triangle"] is None
    state.panel = "weights"
    assert node_facts(state) is None


def test_a_graph_leaves_as_numbers(binding, tmp_path):
    graph = binding.graph
    for ending in ("npz", "zip"):
        save_graph(tmp_path / f"graph.{ending}", graph)
    with np.load(tmp_path / "graph.npz") as held:
        np.testing.assert_array_equal(held["edges"], graph.edges)
        ends = held["nodes"][graph.edges]
        length = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
        np.testing.assert_allclose(held["lengths"], length, atol=1e-6)
        settings = json.loads(str(held["settings"]))
    with zipfile.ZipFile(tmp_path / "graph.zip") as archive:
        nodes = archive.read("nodes.csv").decode().splitlines()
        edges = archive.read("edges.csv").decode().splitlines()
        assert json.loads(archive.read("settings.json")) == settings
    assert settings["resolution"] == 16
    assert settings["program"] == f"cutcell {cutcell.__version__}"
    assert nodes[0] == "node,kind,x,y,z,triangle"
    assert (len(nodes), len(edges)) == (len(graph.nodes) + 1, len(graph.edges) + 1)
    a, b = graph.edges[-1]
    assert edges[-1].startswith(f"{a},{b},surface,")


def test_beside_other_methods_the_card_shows_the_clicked_ones_weights(rig, binding):
    other = np.zeros_like(binding.weights)
    other[:, 2] = 1
    state = PageState(
        rig=rig, binding=binding, vertex=7, panel="compare", methods=["now", "artist", "euclidean"]
    )
    state.compared = {"euclidean": Compared(other)}
    state.clicked_method = "euclidean"
    result = vertex_facts(state)
    assert result["method"] == title_of("euclidean")
    assert {bone["joint"]: bone["ours"] for bone in result["weights"]}[2] == 1
    assert not {"distances", "why", "reached"} & set(result), "these are of the page's own binding"
    state.clicked_method = "artist"
    result = vertex_facts(state)
    assert result["method"] == "From file"
    shown = {bone["joint"]: bone["ours"] for bone in result["weights"]}
    assert shown == {j: rig.weights[7, j] for j in shown}
    state.clicked_method = "now"
    result = vertex_facts(state)
    assert result["method"] == title_of("now")
    assert result["distances"]
    state.methods = ["now", "voxel"]
    state.clicked_method = "voxel"
    assert vertex_facts(state) == {
        "vertex": 7,
        "computed": False,
        "method": title_of("voxel"),
    }
    state.panel = "weights"
    assert "method" not in vertex_facts(state)
