"""Training: each head learns one character, goes on where it stopped, and repeats itself."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from typer.testing import CliRunner

from cutcell.cli.app import app
from cutcell.errors import FileError, ParameterError
from cutcell_lab.networks import (
    HEADS,
    Recipe,
    Samples,
    collate,
    create_network,
    load_network,
    predict,
    train,
)
from cutcell_lab.networks.augmentation import drawn

ASSETS = Path(__file__).resolve().parent.parent / "assets"
STEPS = {"rignet": (200, 1e-2), "unirig": (800, 3e-3), "puppeteer": (250, 1e-2)}
"""How many a head needs to learn one character by heart, and the highest learning rate."""


@pytest.mark.parametrize("head", HEADS)
def test_it_learns_one_character_by_heart(head, biped):
    """To L1 below 0.05 of the artist's weights, of which RigNet sees the five that rank first."""
    sample = replace(biped, prior=(biped.prior + biped.target) / 2) if head == "rignet" else biped
    batch = collate([sample.part(np.arange(0, len(sample.points), 3))])
    network = create_network(head).train()
    steps, rate = STEPS[head]
    optimizer = torch.optim.AdamW(network.parameters(), rate)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, rate, steps)
    for _ in range(steps):
        loss = network.loss(batch)
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 1)
        optimizer.step()
        schedule.step()
    with torch.no_grad():
        error = (network(batch) - batch.target).abs().sum(dim=2).mean()
    print(f"{head}: L1 {error:.3f}")
    assert error < 0.05


def test_what_was_stopped_goes_on_as_if_it_had_not(two, tmp_path):
    recipe = Recipe("puppeteer", points=48, seed=2)
    whole = train(recipe, two, 4, tmp_path / "whole").state_dict()
    train(recipe, two, 2, tmp_path / "parts")
    parts = train(recipe, two, 4, tmp_path / "parts").state_dict()
    assert all(torch.equal(whole[key], parts[key]) for key in whole)
    with (tmp_path / "parts" / "log.csv").open() as log:
        rows = list(csv.DictReader(log))
    assert [row["epoch"] for row in rows] == ["1", "2", "3", "4"]
    assert all(float(row["loss"]) > 0 and float(row["seconds"]) > 0 for row in rows)


@pytest.mark.parametrize("augment", [False, True])
@pytest.mark.parametrize("head", HEADS)
def test_the_same_recipe_gives_the_same_network(head, augment, two):
    recipe = Recipe(head, points=32, augment=augment)
    one, other = (train(recipe, two, 2).state_dict() for _ in range(2))
    assert all(torch.equal(one[key], other[key]) for key in one)
    third = train(replace(recipe, seed=1), two, 2).state_dict()
    assert any(not torch.equal(one[key], third[key]) for key in one)


def test_a_kept_network_predicts_the_same(two, tmp_path):
    recipe = Recipe("unirig", points=32, prior="bind")
    network = train(recipe, two, 1, tmp_path)
    loaded, result = load_network(tmp_path)
    assert result == recipe
    np.testing.assert_array_equal(predict(network, two[:1])[0], predict(loaded, two[:1])[0])


def test_another_recipe_does_not_go_on(two, tmp_path):
    train(Recipe("puppeteer", points=16), two, 1, tmp_path)
    with pytest.raises(FileError, match="another recipe"):
        train(Recipe("puppeteer", points=16, seed=1), two, 1, tmp_path)


def test_augmentation_is_part_of_the_recipe(two, tmp_path):
    recipe = Recipe("puppeteer", points=16, augment=True)
    train(recipe, two, 1, tmp_path)
    assert load_network(tmp_path)[1] == recipe
    assert recipe.name == "puppeteer-cutcell-tiny-0-augmented"
    with pytest.raises(FileError, match="another recipe"):
        train(replace(recipe, augment=False), two, 2, tmp_path)


def test_networks_from_before_augmentation_go_on_without_it(two, tmp_path):
    recipe = Recipe("puppeteer", points=16)
    train(recipe, two, 1, tmp_path)
    kept = torch.load(tmp_path / "network.pt", weights_only=True)
    before = json.loads(kept["recipe"])
    del before["augment"]
    torch.save({**kept, "recipe": json.dumps(before)}, tmp_path / "network.pt")
    assert load_network(tmp_path)[1] == recipe
    train(recipe, two, 2, tmp_path)


def test_a_folder_without_network_is_named(tmp_path):
    with pytest.raises(FileError, match="cannot be read"):
        load_network(tmp_path)
    (tmp_path / "network.pt").write_bytes(b"no network")
    with pytest.raises(FileError, match="no network"):
        load_network(tmp_path)


def test_nothing_to_learn_from_is_said(two):
    with pytest.raises(ParameterError, match="nothing to learn"):
        train(Recipe("puppeteer"), [], 1)
    with pytest.raises(ParameterError, match="nothing to learn"):
        train(Recipe("puppeteer"), [replace(two[0], target=None)], 1)


def test_augmentation_moves_points_and_joints_alike(biped, rng):
    moved = drawn(biped, 40, rng)
    assert len(moved.points) == 40
    where = np.flatnonzero(np.isin(biped.vertices, moved.vertices))
    place = {vertex: k for k, vertex in enumerate(moved.vertices)}
    order = [place[v] for v in biped.vertices[where]]
    before = np.linalg.norm(biped.points[where][:, None] - biped.joints, axis=2)
    after = np.linalg.norm(moved.points[order][:, None] - moved.joints, axis=2)
    ratio = after[before > 0.01] / before[before > 0.01]
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-3)
    assert 0.8 <= ratio[0] <= 1.25
    np.testing.assert_allclose(np.linalg.norm(moved.normals, axis=1), 1, atol=1e-5)


def test_parts_of_a_sample_keep_their_neighbours(biped):
    chosen = np.arange(0, len(biped.points), 2)
    part = biped.part(chosen)
    for k, point in enumerate(chosen[:20]):
        among = [n for n in biped.neighbours[point] if n % 2 == 0 and n != point]
        np.testing.assert_array_equal(chosen[part.neighbours[k, : len(among)]], among)
        assert (part.neighbours[k, len(among) :] == k).all()


def test_the_command_trains_and_goes_on(tmp_path):
    words = ["networks", "train", str(tmp_path / "out"), "--head", "puppeteer", "--prior", "bind"]
    words += ["--data", str(ASSETS / "biped.glb"), "--points", "32", "--resolution", "32"]
    words += ["--cache", str(tmp_path / "cache"), "--json"]
    first = CliRunner().invoke(app, [*words, "--epochs", "2"])
    assert first.exit_code == 0, first.output
    prepared = {path: path.stat().st_mtime_ns for path in (tmp_path / "cache").iterdir()}
    assert len(prepared) == 2
    then = CliRunner().invoke(app, [*words, "--epochs", "3"])
    assert json.loads(then.stdout)["rigs"] == 1
    assert len((tmp_path / "out" / "log.csv").read_text().splitlines()) == 4
    assert {p: p.stat().st_mtime_ns for p in (tmp_path / "cache").iterdir()} == prepared
    done = CliRunner().invoke(app, [*words, "--epochs", "3"])
    assert json.loads(done.stdout)["loss"] is None


def test_rigs_without_weights_are_left_out_and_said(tmp_path):
    (tmp_path / "rigs").mkdir()
    (tmp_path / "rigs" / "bare.glb").write_bytes((ASSETS / "biped.glb").read_bytes())
    (tmp_path / "rigs" / "cube.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    reports: list[str] = []
    result = Samples([tmp_path / "rigs"], prior="none", points=32, cache=tmp_path / "c").load(
        reports.append
    )
    assert len(result) == 1
    assert all("left out" in text for text in reports)
