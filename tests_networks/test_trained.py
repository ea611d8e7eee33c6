"""Trained networks as methods beside the others: found, named, asked; what is broken says so."""

import json
import shutil
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
import torch
from typer.testing import CliRunner

import cutcell
from cutcell.cli.app import app
from cutcell.errors import Cancelled, FileError, TooLargeError, WeightsError
from cutcell.isolated.run import stoppable
from cutcell.runtime import memory
from cutcell_lab.baselines import METHODS, BaselineBinding
from cutcell_lab.networks import Recipe, load_network, predict, train, trained_networks
from cutcell_lab.networks.priors import PRIORS
from cutcell_lab.networks.samples import deal_rig
from tests.bars import bar

RECIPE = Recipe("unirig", prior="bind", points=32, resolution=16)


@pytest.fixture(scope="module")
def runs(two, tmp_path_factory) -> Path:
    """Train two networks for an epoch, into one folder."""
    folder = tmp_path_factory.mktemp("runs")
    train(RECIPE, two, 1, folder / "first")
    bare = [replace(sample, prior=None) for sample in two]
    train(Recipe("puppeteer", prior="none", points=32), bare, 1, folder / "second")
    return folder


@pytest.fixture(scope="module")
def methods(runs):
    return trained_networks([runs])


@pytest.fixture(scope="module")
def rig():
    return bar(24, 6)


def change(folder: Path, **changes) -> None:
    """Write what is kept in a folder with some of it changed."""
    kept = torch.load(folder / "network.pt", weights_only=True)
    torch.save({**kept, **changes}, folder / "network.pt")


def test_networks_are_found_and_named(runs, methods):
    assert list(methods) == ["unirig-bind-tiny-0", "puppeteer-none-tiny-0"]
    assert methods["unirig-bind-tiny-0"].recipe == RECIPE
    assert [one.title for one in methods.values()] == [
        "UniRig with bind, tiny, seed 0",
        "Puppeteer without prior, tiny, seed 0",
    ]
    assert list(trained_networks([runs / "second"])) == ["puppeteer-none-tiny-0"]


def test_networks_of_one_name_are_told_apart_by_their_folders(runs, tmp_path, two):
    train(replace(RECIPE, points=16), two, 1, tmp_path / "third")
    result = trained_networks([runs / "first", tmp_path])
    assert list(result) == ["unirig-bind-tiny-0-1", "unirig-bind-tiny-0-2"]
    assert [one.title[-8:] for one in result.values()] == [" (first)", " (third)"]


def test_the_weights_of_a_whole_rig_are_what_the_network_predicts(runs, methods, rig):
    method = methods["unirig-bind-tiny-0"]
    bound = method(rig)
    assert set(bound.seconds) == {"prior", "network", "weights"}
    np.testing.assert_allclose(bound.weights.sum(axis=1), 1, atol=1e-12)
    network, recipe = load_network(runs / "first")
    prior = cutcell.bind(rig, recipe.resolution).weights
    parts = list(deal_rig(rig, 4 * recipe.points))
    dealt = np.concatenate([part.vertices for part in parts])
    assert len(parts) > 1
    np.testing.assert_array_equal(np.sort(dealt), np.arange(len(rig.mesh.vertices)))
    for part in parts:
        (expected,) = predict(network, [part.with_prior(prior)], recipe.points)
        here = bound.weights[np.ix_(part.vertices, part.deform)]
        np.testing.assert_allclose(here, expected, atol=1e-5)


def test_what_no_face_uses_follows_what_is_nearest(methods, rig):
    mesh = rig.mesh
    vertices = np.vstack([mesh.vertices, mesh.vertices[:1] + 1e-3])
    loose = replace(rig, mesh=cutcell.TriangleMesh(vertices, mesh.faces), weights=None)
    result = methods["puppeteer-none-tiny-0"](loose)
    assert result.warnings == ()
    np.testing.assert_array_equal(result.weights[-1], result.weights[0])


def test_influences_are_limited(methods, rig):
    result = methods["puppeteer-none-tiny-0"](rig, max_influences=1)
    assert ((result.weights > 0).sum(axis=1) == 1).all()


class Harm:
    """What pickle would do as it reads."""

    def __reduce__(self):
        return (Path.touch, (Path("harm"),))


SPOILED = [
    ({"recipe": json.dumps({**asdict(RECIPE), "warmth": 3})}, "another version"),
    ({"recipe": json.dumps({**asdict(RECIPE), "head": "transformer"})}, "another version"),
    ({"recipe": json.dumps({**asdict(RECIPE), "prior": "moon"})}, "another version"),
    ({"recipe": "[]"}, "another version"),
    ({"recipe": "{"}, "another version"),
    ({"recipe": None}, "no network"),
    ({"network": Harm()}, "no network"),
]


def test_what_cannot_be_used_is_told_and_left_out(runs, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for k, (changes, _) in enumerate(SPOILED):
        shutil.copytree(runs / "first", tmp_path / f"spoiled {k}")
        change(tmp_path / f"spoiled {k}", **changes)
    reports: list[str] = []
    assert len(trained_networks([runs, tmp_path], reports.append)) == 2
    for k, (sentence, (_, problem)) in enumerate(zip(reports, SPOILED, strict=True)):
        assert f"spoiled {k}" in sentence
        assert problem in sentence
    assert not (tmp_path / "harm").exists()


def test_where_none_can_be_used_it_is_an_error(tmp_path):
    (tmp_path / "network.pt").write_bytes(b"no network")
    with pytest.raises(FileError, match=r"none of the networks can be used: .*no network"):
        trained_networks([tmp_path])


def test_folders_without_networks_are_named(tmp_path):
    with pytest.raises(FileError, match="no trained network"):
        trained_networks([tmp_path])
    with pytest.raises(FileError, match="no such folder"):
        trained_networks([tmp_path / "nowhere"])


def test_parameters_of_another_version_are_told_when_it_is_asked(rig, runs, tmp_path):
    shutil.copy(runs / "first" / "network.pt", tmp_path)
    method = trained_networks([tmp_path])["unirig-bind-tiny-0"]
    change(tmp_path, network={"weigh": torch.zeros(3)})
    assert "another version" in method(rig).failed
    (tmp_path / "network.pt").unlink()
    result = method(rig)
    assert result.weights is None
    assert "cannot be read" in result.failed


def test_a_prior_that_cannot_be_computed_is_told(methods, rig, monkeypatch):
    method = methods["unirig-bind-tiny-0"]
    monkeypatch.setitem(PRIORS, "bind", lambda rig: BaselineBinding(None, failed="it is flat"))
    with pytest.raises(WeightsError, match="prior bind cannot be computed: it is flat"):
        method(rig)


def test_what_does_not_fit_in_memory_is_refused(methods, rig, monkeypatch):
    method = methods["unirig-bind-tiny-0"]
    monkeypatch.setattr(memory, "available_memory", lambda: 10**6)
    with pytest.raises(TooLargeError, match="a network that looks at"):
        method(rig)


def test_it_stops_when_nobody_wants_it(methods, rig):
    def unwanted():
        raise Cancelled

    method = methods["puppeteer-none-tiny-0"]
    with pytest.raises(Cancelled), stoppable(unwanted):
        method(rig)


def test_commands_compare_them(runs, monkeypatch):
    monkeypatch.setattr("cutcell_lab.baselines.METHODS", dict(METHODS))
    biped = Path(__file__).resolve().parent.parent / "assets" / "rabbit.glb"
    words = ["compare", str(biped), "--networks", str(runs), "--json", "--quiet"]
    done = CliRunner().invoke(app, [*words, "--methods", "euclidean,unirig-bind-tiny-0"])
    assert done.exit_code == 0, done.output
    (rig,) = json.loads(done.stdout)["rigs"]
    assert [score["failed"] for score in rig["scores"]] == ["", ""]
