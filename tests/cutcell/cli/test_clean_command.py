"""`cutcell clean`: weights without what cannot be true, for people and for scripts."""

import json

import numpy as np

import cutcell
from tests.cutcell.cli.files import refused
from tests.cutcell.diagnosis.worm import worm


def damaged(path):
    rig = worm()
    weights = rig.weights.copy()
    weights[rig.mesh.vertices[:, 0] > 0.93] = np.eye(7)[1]
    cutcell.save(path, rig.with_weights(weights))
    return path


def test_it_saves_cleaned_weights_and_says_what_was_taken_away(run, tmp_path):
    given, out = damaged(tmp_path / "worm.npz"), tmp_path / "clean.npz"
    words = run("clean", given, out, "-r", 24).stdout
    for text in ("worm.npz", "removed", "bound again", "tail"):
        assert text in words
    cleaned = cutcell.clean(cutcell.load(given), 24)
    np.testing.assert_allclose(cutcell.load(out).weights, cleaned.weights, atol=1e-6)
    document = json.loads(run("clean", given, out, "-r", 24, "--json").stdout)
    (joint,) = document["joints"]
    assert joint["name"] == "tail"
    assert joint["vertices"] == cleaned.losses[0].vertices.tolist()
    assert document["share"] == cleaned.share
    assert run("clean", given, out, "-r", 24, "--quiet").stdout == ""


def test_sound_weights_lose_nothing(run, tmp_path):
    cutcell.save(tmp_path / "worm.npz", worm())
    words = run("clean", tmp_path / "worm.npz", tmp_path / "clean.npz", "-r", 24).stdout
    assert "nothing" in words


def test_a_file_without_weights_is_a_sentence(run, bar, tmp_path):
    out = tmp_path / "clean.npz"
    assert "no weights" in refused(run("clean", bar, out))
    assert not out.exists()
