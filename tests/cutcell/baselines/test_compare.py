"""The comparison of methods, and the script that prints it."""

import json

import numpy as np
import pytest

import cutcell
from benchmarks import quality
from cutcell import MeshError, ParameterError, Rig, Skeleton, TriangleMesh, WeightsError
from cutcell.baselines import METHODS, BaselineBinding
from cutcell.compare import MEASURES, compare, comparison_markdown
from cutcell.pose import swing
from tests import meshes
from tests.conftest import SHARED_RIGS


def character(name="ball", clips=True):
    vertices, faces = meshes.ball(2)
    skeleton = Skeleton([[0.2, 0.5, 0.5], [0.5, 0.5, 0.5], [0.8, 0.5, 0.5]], [-1, 0, 1])
    right = np.clip((vertices[:, 0] - 0.3) / 0.4, 0, 1)
    weights = np.stack([1 - right, right / 2, right / 2], axis=1)
    motion = (swing(skeleton, 1, "z", 30, fps=4),) if clips else ()
    return Rig(TriangleMesh(vertices, faces), skeleton, weights, motion, name=name)


def dead(rig):
    return BaselineBinding(None, {"weights": 1.5}, failed="no power")


def lame(rig):
    raise MeshError("not this one")


def test_each_method_is_measured_on_each_rig():
    rigs = [character("a"), character("b", clips=False)]
    names = ["artist", "euclidean", "cutcell"]
    found = compare(iter(rigs), names, resolution=16)
    assert found.methods == tuple(names)
    assert [rig.name for rig in found.rigs] == ["a", "b"]
    for rig in found.rigs:
        assert [score.method for score in rig.scores] == names
        artist, euclidean, ours = rig.scores
        assert (artist.l1, artist.precision, artist.recall, artist.deformation) == (0, 1, 1, 0)
        assert 0 < ours.l1 < 2
        assert euclidean.deformation > 0
        assert euclidean.worst[0].mean >= euclidean.worst[-1].mean
        assert euclidean.unweighted == 0
        assert euclidean.crosstalk is None  # a ball has no gap
    assert found.rigs[0].scores[1].clips > 0
    assert found.rigs[1].scores[1].clips is None
    assert found.statistic("euclidean", "clips").count == 1


def test_failures_are_told_and_stop_nothing():
    methods = {"dead": dead, "lame": lame, "euclidean": METHODS["euclidean"]}
    found = compare([character()], methods)
    first, second, third = found.rigs[0].scores
    assert (first.failed, first.l1, first.seconds) == ("no power", None, 1.5)
    assert second.failed == "not this one"
    assert third.failed == ""
    assert found.statistic("dead", "l1").median is None
    text = comparison_markdown(found)
    assert "- dead on ball: no power" in text
    assert "- lame on ball: not this one" in text
    json.dumps(found.to_dict(), allow_nan=False)


def test_statistics_by_hand():
    found = compare([character("a"), character("b")], ["euclidean"])
    statistic = found.statistic("euclidean", "l1")
    values = [rig.scores[0].l1 for rig in found.rigs]
    assert statistic.count == 2
    assert statistic.median == pytest.approx(np.median(values))
    assert statistic.mean == pytest.approx(np.mean(values))
    assert statistic.worst == max(values)
    document = found.to_dict()
    assert document["summary"]["euclidean"]["l1"]["mean"] == statistic.mean
    assert set(document["summary"]["euclidean"]) == set(MEASURES)


def test_tables_are_whole():
    text = comparison_markdown(compare([character()], ["artist", "euclidean"]))
    tables = [line for line in text.splitlines() if line.startswith("|")]
    assert {line.count("|") for line in tables[:4]} == {11}
    assert "nan" not in text
    assert "Failed" not in text


def test_progress_names_the_rigs_and_options_reach_the_methods():
    seen, options = [], []

    def curious(rig, resolution=1, max_influences=None):
        options.append((resolution, max_influences))
        return METHODS["euclidean"](rig, max_influences=max_influences)

    compare(
        [character("a")],
        {"curious": curious},
        resolution=20,
        max_influences=1,
        progress=lambda stage, fraction: seen.append((stage, fraction)),
    )
    assert seen[0] == ("a", 0)
    assert seen[-1] == ("a", 1)
    assert options == [(20, 1)]


def test_what_cannot_be_compared_is_refused():
    with pytest.raises(ParameterError, match="method must be one of"):
        compare([character()], ["wishes"])
    with pytest.raises(ParameterError, match="no methods"):
        compare([character()], {})
    with pytest.raises(ParameterError, match="no rigs"):
        compare([], ["artist"])
    with pytest.raises(ParameterError, match="resolution"):
        compare([character()], ["voxel"], resolution=1)
    rig = character()
    with pytest.raises(WeightsError, match='"ball" has no weights'):
        compare([Rig(rig.mesh, rig.skeleton, name="ball")], ["artist"])


def test_the_script_prints_and_writes(demo_paths, tmp_path, capsys):
    path = next(p for p in demo_paths if p.stem == "biped_soup")
    out = {name: tmp_path / f"out.{name}" for name in ("json", "markdown")}
    given = [str(path), "--methods", "artist,euclidean,blender"]
    quality.main([*given, "--json", str(out["json"]), "--markdown", str(out["markdown"])])
    text = out["markdown"].read_text()
    assert text.strip() in capsys.readouterr().out
    assert "- blender on biped_soup: there is no" in text
    document = json.loads(out["json"].read_text())
    assert document["rigs"][0]["scores"][0]["l1"] == 0
    with pytest.raises(SystemExit, match="unknown: wishes"):
        quality.main([str(path), "--methods", "wishes"])


@pytest.mark.parametrize(
    ("name", "l1"), [("khronos_RiggedFigure", 0.75), ("khronos_CesiumMan", 0.3)]
)
def test_blenders_weights_are_read_by_name_or_by_order(name, l1):
    path = SHARED_RIGS / f"{name}.glb"
    folder = SHARED_RIGS.parent / "bone_heat"
    if not path.exists() or not folder.exists():
        pytest.skip(f"there is no {path}; it is not part of the project")
    rig = cutcell.load(path)
    found = compare([rig], {"blender": lambda rig: quality.blender(rig, folder)})
    assert found.rigs[0].scores[0].l1 < l1
    assert found.rigs[0].scores[0].unweighted == 0


def test_touching_parts_share_little_weight_through_heat(demo_paths):
    """Fingers, arms beside hips, ears on a back: paths through the body tell them apart."""
    for name in ("biped", "rabbit"):
        path = next(p for p in demo_paths if p.stem == name)
        found = compare([cutcell.load(path)], ["artist", "bone_heat", "cutcell", "euclidean"])
        artist, heat, ours, straight = (score.crosstalk for score in found.rigs[0].scores)
        assert artist < 0.02
        assert heat < 0.1
        assert ours < straight
