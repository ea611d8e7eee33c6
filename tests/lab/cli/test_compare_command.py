"""`cutcell compare`: tables, figures, refusals."""

import json

import numpy as np

import cutcell
from cutcell import Rig, Skeleton, TriangleMesh
from tests.bars import grid_box
from tests.cutcell.cli.files import refused


def test_measures_each_method_on_each_rig(run, bar, tmp_path):
    rigged = tmp_path / "rigged.glb"
    assert run("bind", bar, rigged, "-r", 8).exit_code == 0
    options = ("--methods", "cutcell_rig, euclidean", "-r", 8)
    result = run("compare", rigged, *options, "--json")
    assert result.exit_code == 0
    document = json.loads(result.stdout)
    assert document["methods"] == ["cutcell_rig", "euclidean"]
    assert document["summary"]["cutcell_rig"]["l1"]["median"] < 1e-6
    table = run("compare", rigged, *options).stdout
    assert table.startswith("rigged: 12 vertices, 2 joints with weight")
    assert "cutcell_rig  0.000" in table


def test_all_joints_turn_when_asked(run, tmp_path):
    """The middle joint of a bar carries no weight; about it the far half moves otherwise."""
    rig = tmp_path / "bar.npz"
    vertices, faces = grid_box(8)
    joints = [[0.1, 0.1, 0.1], [0.5, 0.1, 0.1], [0.9, 0.1, 0.1]]
    far = vertices[:, 0] > 0.5
    weights = np.stack([~far, 0 * far, far], axis=1).astype(float)
    skeleton = Skeleton(joints, [-1, 0, 1], deform=[True, False, True])
    cutcell.save(rig, Rig(TriangleMesh(vertices, faces), skeleton, weights=weights))

    def measured(*more):
        result = run("compare", rig, "--methods", "euclidean", "-r", 8, "--json", *more)
        return json.loads(result.stdout)["summary"]["euclidean"]["deformation"]["median"]

    assert measured("--turned", "all") > measured("--turned", "deform") == measured()
    assert "turned must be one of" in refused(run("compare", rig, "--turned", "some"))


def test_writes_markdown_and_a_figure(run, demo_paths, tmp_path):
    plot = tmp_path / "errors.svg"
    rig = next(path for path in demo_paths if path.stem == "rabbit")
    options = ("--methods", "artist,euclidean", "--markdown", "--plot", plot)
    table = run("compare", rig, rig, *options).stdout
    assert "| euclidean |" in table
    assert "| rabbit |" in table
    assert "<svg" in plot.read_text()
    assert "cannot be" in refused(run("compare", rig, "--plot", tmp_path / "errors.txt"))


def test_unknown_methods_and_rigs_without_weights_are_told(run, bar, tmp_path):
    assert "'bone_heat'" in refused(run("compare", bar, "--methods", "magic"))
    assert "weights" in refused(run("compare", bar, "--methods", "euclidean"))
