"""Without torch all else works, and networks say what to install."""

import sys

import numpy as np
import pytest
from typer.testing import CliRunner

import cutcell
import cutcell_lab.networks
from cutcell.cli.app import app
from cutcell.errors import MissingLibraryError
from cutcell_lab.networks.recipe import PRIOR_NAMES
from tests.bars import bar
from tests.test_layers import ROOT

BIPED = ROOT / "assets" / "biped.glb"


@pytest.fixture
def without_torch(monkeypatch):
    monkeypatch.setitem(sys.modules, "torch", None)


@pytest.mark.parametrize("name", sorted(cutcell_lab.networks.WITH_TORCH))
def test_what_needs_torch_says_what_to_install(name, without_torch):
    with pytest.raises(MissingLibraryError, match=r"pip install 'cutcell\[networks\]'"):
        getattr(cutcell_lab.networks, name)


def test_the_command_says_what_to_install(tmp_path, without_torch):
    words = ["networks", "train", str(tmp_path / "out"), "--head", "rignet", "--data", str(BIPED)]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 2
    assert "cutcell[networks]" in done.stderr
    assert not (tmp_path / "out").exists()


def test_names_that_need_no_torch_are_there(without_torch):
    assert cutcell_lab.networks.HEADS == ("rignet", "unirig", "puppeteer")
    assert tuple(cutcell_lab.networks.PRIORS) == PRIOR_NAMES
    assert set(cutcell_lab.networks.__all__) == set(dir(cutcell_lab.networks))
    with pytest.raises(AttributeError, match="no attribute"):
        cutcell_lab.networks.transformer  # noqa: B018


@pytest.fixture(scope="module")
def rig() -> cutcell.Rig:
    return cutcell.load(BIPED)


def test_a_sample_has_the_joints_that_carry_weight(rig):
    sample = cutcell_lab.networks.sample_rig(rig, 50)
    skeleton = rig.skeleton
    np.testing.assert_array_equal(sample.deform, np.flatnonzero(skeleton.deform))
    np.testing.assert_allclose(sample.target, rig.weights[sample.vertices][:, sample.deform])
    for joint, parent in zip(sample.deform, sample.parents, strict=True):
        above = skeleton.parents[joint]
        while above >= 0 and not skeleton.deform[above]:
            above = skeleton.parents[above]
        assert above == (sample.deform[parent] if parent >= 0 else -1)


def test_a_sample_is_in_longest_sides_around_the_origin():
    small = bar(8)
    weights = np.eye(3)[np.minimum(small.mesh.vertices[:, 0] * 2, 1).astype(int)]
    sample = cutcell_lab.networks.sample_rig(small.with_weights(weights))
    low, high = sample.points.min(axis=0), sample.points.max(axis=0)
    np.testing.assert_allclose((high - low).max(), 1, rtol=1e-6)
    np.testing.assert_allclose(low + high, 0, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(sample.normals, axis=1), 1, atol=1e-5)


def test_neighbours_are_the_nearest_along_the_surface(rig):
    """Against Dijkstra on all vertices of a slow graph."""
    import networkx

    from cutcell.geometry.weld import weld

    sample = cutcell_lab.networks.sample_rig(rig, 40, seed=3)
    _, group = weld(rig.mesh.vertices)
    graph = networkx.Graph()
    for face in rig.mesh.faces:
        for one, other in zip(face, np.roll(face, 1), strict=True):
            length = np.linalg.norm(rig.mesh.vertices[one] - rig.mesh.vertices[other])
            graph.add_edge(group[one], group[other], length=length)
    place = {group[vertex]: k for k, vertex in enumerate(sample.vertices)}
    for vertex in sample.vertices[:8]:
        away = networkx.single_source_dijkstra_path_length(graph, group[vertex], weight="length")
        order = [place[v] for v in sorted(away, key=away.get) if v in place and v != group[vertex]]
        result = sample.ring[place[group[vertex]]]
        known = result[result != place[group[vertex]]]
        np.testing.assert_array_equal(known, order[: len(known)])


@pytest.mark.parametrize(
    "words",
    [
        ["app", "--no-show", "--port", "0"],
        ["compare", str(BIPED)],
        ["render", str(BIPED), "out.png", "--panel", "compare"],
    ],
    ids=lambda words: words[0],
)
def test_the_option_for_networks_says_what_to_install(words, without_torch, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, [*words, "--networks", str(tmp_path)])
    assert done.exit_code == 2
    assert "cutcell[networks]" in done.stderr
    assert not list(tmp_path.iterdir())


def test_samples_are_kept_for_as_long_as_the_code_is_the_same(tmp_path, monkeypatch):
    options = {"prior": "none", "points": 20, "cache": tmp_path}
    for _ in range(2):
        cutcell_lab.networks.Samples([BIPED], **options).load()
        assert len(list(tmp_path.iterdir())) == 1
    monkeypatch.setattr("cutcell_lab.networks.priors.code_digest", lambda: "changed since")
    cutcell_lab.networks.Samples([BIPED], **options).load()
    assert len(list(tmp_path.iterdir())) == 2
