"""`cutcell graph`: counts, for people and for scripts."""

import json

import cutcell
from tests.cutcell.cli.files import bar_faces, refused, write_obj
from tests.cutcell.io.gltf.gltf_builder import column


def test_counts_what_the_library_builds(run, bar):
    document = json.loads(run("graph", bar, "-r", 16, "--json").stdout)
    graph = cutcell.build_graph(cutcell.load(bar).mesh, 16)
    assert document["graph"]["nodes"]["total"] == len(graph.nodes)
    assert document["graph"]["edges"]["total"] == len(graph.edges)
    kinds = document["graph"]["edges"]
    assert kinds["mesh"] + kinds["interior"] + kinds["surface"] == kinds["total"]
    assert document["graph"]["components"] == 1
    assert document["graph"]["largest_component"] == 1.0
    assert document["mesh"] == {
        "vertices": 12,
        "welded_vertices": 12,
        "triangles": 20,
        "components": 1,
        "open_edges": 0,
        "non_manifold_edges": 0,
        "closed": True,
    }
    assert document["skeleton"] == {"joints": 2, "deform": 2, "roots": 1}
    assert document["fallback"]["vertices"] == 0


def test_says_it_in_words(run, bar):
    words = run("graph", bar, "-r", 16).stdout
    for expected in ("bar.obj", "closed", "2 joints", "1 root", "not reached", "seconds"):
        assert expected in words


def test_needs_no_skeleton(run, tmp_path):
    path = write_obj(tmp_path / "open.obj", faces=bar_faces()[2:])
    document = json.loads(run("graph", path, "-r", 8, "--json").stdout)
    assert document["skeleton"] is None
    assert document["fallback"] is None
    assert document["mesh"]["open_edges"] == 4
    assert not document["mesh"]["closed"]
    assert "open: 4 edges with one triangle" in run("graph", path, "-r", 8).stdout


def test_names_the_meshes_of_the_file(run, tmp_path):
    builder = column()
    builder.node(name="hat", mesh=builder.mesh(), skin=0)
    builder.node(1, name="sword", mesh=builder.mesh())
    builder.node(name="floor", mesh=builder.mesh())
    path = builder.save(tmp_path / "rig.glb")
    document = json.loads(run("graph", path, "-r", 8, "--json").stdout)
    assert document["meshes"] == {
        "parts": [
            {"name": "body", "first": 0, "vertices": 12, "hidden": False},
            {"name": "hat", "first": 12, "vertices": 12, "hidden": False},
        ],
        "attachments": [{"name": "sword", "joint": "tip", "hidden": False}],
        "left_out": [{"name": "floor", "why": "has no skin and hangs on no joint"}],
    }
    words = run("graph", path, "-r", 8).stdout
    for expected in ("2: body, hat", "1: sword (on tip)", "1: floor (has no skin and hangs"):
        assert expected in words


def test_a_bare_mesh_that_is_wrong_is_named(run, tmp_path):
    path = write_obj(tmp_path / "flat.obj", [[0, 0, 0]] * 3, [[0, 1, 2]])
    assert "flat.obj" in refused(run("graph", path))
