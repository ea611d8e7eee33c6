"""`cutcell transfer` and `cutcell weights`."""

import json

import numpy as np

import cutcell
from tests.bars import bar
from tests.cutcell.cli.files import refused


def body(path):
    rig = bar(8)
    cutcell.save(path, rig.with_weights(cutcell.bind(rig, 16).weights))
    return path


def test_targets_get_weights_and_are_saved(run, tmp_path):
    source = body(tmp_path / "body.npz")
    rig = cutcell.load(source)
    for name in "ab":
        cutcell.save(
            tmp_path / f"{name}.npz", rig.with_weights(np.eye(3)[np.zeros(len(rig.weights), int)])
        )
    files = [tmp_path / name for name in ("a.npz", "new_a.npz", "b.npz", "new_b.npz")]
    document = json.loads(run("transfer", source, *files, "--json").stdout)
    assert [one["matched"] for one in document["targets"]] == 2 * [len(rig.mesh.vertices)]
    for file in files[1::2]:
        np.testing.assert_allclose(cutcell.load(file).weights, rig.weights, atol=1e-6)
    assert "matched" in run("transfer", source, *files[:2]).stdout
    run("transfer", source, *files[:2], "--mix", 0.5, "--lock", rig.skeleton.names[0])


def test_wrong_targets_are_a_sentence(run, tmp_path):
    source = body(tmp_path / "body.npz")
    assert "no output file" in refused(run("transfer", source, source))
    out = tmp_path / "out.npz"
    assert "JOINT=NAME" in refused(run("transfer", source, source, out, "--names", "a"))
    assert not out.exists()


def test_weights_go_to_another_program_and_back(run, tmp_path):
    source, rig = body(tmp_path / "body.npz"), cutcell.load(tmp_path / "body.npz")
    bare = tmp_path / "bare.npz"
    cutcell.save(bare, rig.with_weights(np.eye(3)[np.zeros(len(rig.weights), int)]))
    for kind in ("xml", "json", "csv"):
        alone, out = tmp_path / f"weights.{kind}", tmp_path / f"{kind}.npz"
        assert json.loads(run("weights", source, alone, "--json").stdout)["files"] == [str(alone)]
        run("weights", bare, out, "--weights", alone)
        np.testing.assert_allclose(cutcell.load(out).weights, rig.weights, atol=1e-6)
    assert "weights" in refused(run("weights", source, tmp_path / "a.npz", "--weights", source))
