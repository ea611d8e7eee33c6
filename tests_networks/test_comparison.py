"""The comparison measures what the metrics of whole rigs measure, and says who made what."""

from pathlib import Path

import numpy as np
from PIL import Image

import cutcell
from cutcell_assets.generate import generate
from cutcell_lab.benchmarks import network_data
from cutcell_lab.benchmarks.network_scores import dropped, groups, means, scores
from cutcell_lab.benchmarks.networks import Run, main
from cutcell_lab.metrics import deformation_error, precision_recall, vertex_shares, weight_l1
from cutcell_lab.networks import sample_rig

ASSETS = Path(__file__).resolve().parent.parent / "assets"


def test_all_points_of_a_rig_measure_as_the_rig_does():
    rig = cutcell.load(ASSETS / "robot.glb")
    sample = sample_rig(rig)
    weights = cutcell.bind(rig, 32).weights
    shares = vertex_shares(rig.mesh)
    wanted = [
        weight_l1(weights, rig.weights, shares),
        *precision_recall(weights, rig.weights, shares=shares),
        deformation_error(rig, weights, rig.weights).mean,
    ]
    result = scores(sample, sample.of_rig(weights).astype(float))[:4]
    np.testing.assert_allclose(result, wanted, rtol=2e-3)


def test_small_weights_are_dropped_unless_they_are_next_to_nothing():
    weights = np.array([[0.9, 0.1, 0.0], [0.995, 0.005, 0.0], [0.5, 0.3, 0.2]])
    wanted = [[1.0, 0.0, 0.0], [0.995, 0.005, 0.0], [0.5, 0.3, 0.2]]
    np.testing.assert_allclose(dropped(weights), wanted)


def test_characters_are_parted_by_maker():
    parted = groups(["quaternius_wolf", "khronos_Fox", "quat_wasp"])
    assert parted == {
        "other makers": ["khronos_Fox"],
        "same maker": ["quaternius_wolf", "quat_wasp"],
    }
    result = {"khronos_Fox": [1.0, np.nan, 3.0, 4.0], "other": [3.0, 0.5, 3.0, 4.0]}
    np.testing.assert_allclose(means(result, ["khronos_Fox", "other"]), [2, 0.5, 3, 4])


def test_it_goes_on_where_it_stopped(tmp_path, monkeypatch, capsys):
    for name, files in {"train": ["biped"], "rigs": ["robot"], "wild": ["octopus"]}.items():
        (tmp_path / name).mkdir()
        for file in files:
            copied = tmp_path / name / ("quat_robot.glb" if file == "robot" else f"{file}.glb")
            copied.write_bytes((ASSETS / f"{file}.glb").read_bytes())
    monkeypatch.setattr("cutcell_lab.benchmarks.networks.SHARED", tmp_path)
    monkeypatch.setattr("cutcell_lab.benchmarks.networks.LOADED", {})
    out = tmp_path / "networks.md"
    out.write_text("<!-- networks -->\n<!-- /networks -->\n")
    words = ["--priors", "none,cutcell", "--heads", "puppeteer", "--seeds", "2", "--points", "16"]
    words += ["--folder", str(tmp_path / "kept"), "--cache", str(tmp_path / "cache")]
    main([*words, "--epochs", "1", "--out", str(out)])
    lines = capsys.readouterr().out.splitlines()
    assert sum(line.startswith("tiny 16") for line in lines) == 4
    text = out.read_text()
    assert "4 trainings" in text
    assert "of each of 2 characters" in text
    assert "±" in text
    figure = tmp_path / "networks.png"
    main([*words, "--epochs", "1", "--figure", str(figure)])
    with Image.open(figure) as drawn:
        assert len(drawn.convert("RGB").getcolors(2**24)) > 20
    assert "tiny 16" not in capsys.readouterr().out
    log = tmp_path / "kept" / "tiny" / Run("puppeteer", "cutcell", 1).name / "log.csv"
    assert len(log.read_text().splitlines()) == 2


def test_makehuman_s_characters_are_measured_apart():
    parted = network_data.unseen(["makehuman_default", "khronos_Fox", "quat_wasp"])
    assert parted == (["khronos_Fox"], ["makehuman_default"])


def test_ways_to_learn_are_compared(tmp_path, monkeypatch, capsys):
    for name, file in {"train": "biped", "rigs": "robot", "wild": "octopus"}.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / f"{file}.glb").write_bytes((ASSETS / f"{file}.glb").read_bytes())
    monkeypatch.setattr(network_data, "SHARED", tmp_path)
    monkeypatch.setattr(network_data, "GENERATED", 1)
    monkeypatch.setattr(network_data, "PEOPLE", 1)
    # People take a package that need not be there.
    monkeypatch.setattr(network_data, "generate", lambda kind, seed: generate("robot", seed))
    out = tmp_path / "networks.md"
    out.write_text("<!-- network-data -->\n<!-- /network-data -->\n")
    words = ["--prior", "none", "--heads", "puppeteer", "--points", "16", "--epochs", "2"]
    words += ["--folder", str(tmp_path / "kept"), "--cache", str(tmp_path / "cache")]
    network_data.main([*words, "--seeds", "2", "--out", str(out)])
    assert sum(line.startswith("{") for line in capsys.readouterr().out.splitlines()) == 8
    rows = [line.split("|") for line in out.read_text().splitlines() if "puppeteer" in line]
    cells = [[cell.strip() for cell in row[1:-1]] for row in rows]
    assert [row[3] for row in cells] == ["no", "yes", "no", "yes"]
    assert [row[4:6] for row in cells] == [["1", "2"]] * 2 + [["3", "1"]] * 2
    assert [row[8] == "-" for row in cells] == [True, False, False, False]
    network_data.main([*words, "--seeds", "2"])
    assert "{" not in capsys.readouterr().out
