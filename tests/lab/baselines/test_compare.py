"""The comparison of methods, and its forms: tables, JSON, a figure."""

import io
import json
import sys

import numpy as np
import pytest
from PIL import Image
from rich.console import Console

from cutcell import (
    Cancelled,
    FileError,
    MeshError,
    MissingLibraryError,
    ParameterError,
    Rig,
    Skeleton,
    TriangleMesh,
    WeightsError,
)
from cutcell.pose import swing
from cutcell_lab.baselines import METHODS, BaselineBinding
from cutcell_lab.baselines.compare import Comparison, compare, comparison_markdown
from cutcell_lab.baselines.compare.plot import plot_comparison
from cutcell_lab.baselines.compare.terminal import comparison_table
from cutcell_lab.metrics import METRICS
from tests import meshes


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


def broken(rig):
    return 1 / 0


def test_each_method_is_measured_on_each_rig():
    rigs = [character("a"), character("b", clips=False)]
    names = ["artist", "euclidean", "cutcell"]
    result = compare(iter(rigs), names, resolution=16)
    assert result.methods == tuple(names)
    assert [rig.name for rig in result.rigs] == ["a", "b"]
    for rig in result.rigs:
        assert [score.method for score in rig.scores] == names
        artist, euclidean, computed = rig.scores
        errors = [artist.values[name] for name in ("l1", "precision", "recall", "deformation")]
        assert errors == [0, 1, 1, 0]
        assert 0 < computed.values["l1"] < 2
        assert euclidean.values["deformation"] > 0
        assert euclidean.worst[0].mean >= euclidean.worst[-1].mean
        assert euclidean.values["unweighted"] == 0
        assert euclidean.values["crosstalk"] is None  # a ball has no gap
    assert result.rigs[0].scores[1].values["clips"] > 0
    assert result.rigs[1].scores[1].values["clips"] is None
    assert result.statistic("euclidean", "clips").count == 1


def test_failures_are_told_and_stop_nothing():
    known = {"dead": dead, "lame": lame, "broken": broken}
    result = compare([character()], {**known, "euclidean": METHODS["euclidean"]})
    first, second, crash, third = result.rigs[0].scores
    assert crash.failed == "ZeroDivisionError: division by zero"
    assert (first.failed, first.values["l1"], first.values["seconds"]) == ("no power", None, 1.5)
    assert second.failed == "not this one"
    assert third.failed == ""
    assert result.statistic("dead", "l1").median is None
    text = comparison_markdown(result)
    assert "- dead on ball: no power" in text
    assert "- lame on ball: not this one" in text
    assert "| ball | failed | failed | failed | 0." in text
    json.dumps(result.to_dict(), allow_nan=False)


def test_statistics_by_hand():
    result = compare([character("a"), character("b")], ["euclidean"])
    statistic = result.statistic("euclidean", "l1")
    values = [rig.scores[0].values["l1"] for rig in result.rigs]
    assert statistic.count == 2
    assert statistic.median == pytest.approx(np.median(values))
    assert statistic.mean == pytest.approx(np.mean(values))
    assert statistic.worst == max(values)
    document = result.to_dict()
    assert document["summary"]["euclidean"]["l1"]["mean"] == statistic.mean
    assert set(document["summary"]["euclidean"]) == set(METRICS)


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


def test_cancelling_stops_everything():
    def stop(rig):
        raise Cancelled

    with pytest.raises(Cancelled):
        compare([character()], {"stop": stop})


# Kept and put together


def test_ctrl_c_in_a_dispatcher_stops_everything():
    def interrupted(rig):
        raise SystemError from KeyboardInterrupt()

    with pytest.raises(SystemError):
        compare([character()], {"a": interrupted})


def test_a_comparison_comes_back_from_json():
    result = compare([character("a"), character("b")], ["artist", "euclidean"])
    again = Comparison.from_dict(json.loads(json.dumps(result.to_dict())))
    assert again == result


def test_comparisons_are_merged():
    first = compare([character("a"), character("b")], {"euclidean": dead, "artist": dead})
    second = compare([character("b"), character("c")], ["euclidean"])
    both = first.merged(second)
    assert both.methods == ("euclidean", "artist")
    assert [rig.name for rig in both.rigs] == ["a", "b", "c"]
    failed = [[score.failed for score in rig.scores] for rig in both.rigs]
    assert failed == [["no power"] * 2, ["", "no power"], ["", "not measured"]]
    assert first.merged(first) == first


# Shown


def shown(comparison, width):
    console = Console(width=width, record=True, file=io.StringIO())
    console.print(comparison_table(comparison, width))
    return console.export_text()


@pytest.mark.parametrize("width", [80, 120])
def test_a_terminal_of_any_width_shows_all_numbers(width):
    methods = {"quasi_harmonic": METHODS["euclidean"], "dead": dead, "artist": METHODS["artist"]}
    rigs = [character("a_rig_with_a_long_name_of_two_lines"), character("b")]
    result = compare(rigs, methods)
    text = shown(result, width)
    lines = text.splitlines()
    assert max(map(len, lines)) <= width
    row = next(line for line in lines if line.startswith("quasi_harmonic"))
    statistic = result.statistic("quasi_harmonic", "l1")
    assert f"{statistic.median:.3f}  {statistic.mean:.3f}" in row
    assert row.rstrip().endswith("2/2")
    assert ("crosstalk" in text) == (width >= 100)
    assert "dead failed on all rigs: no power" in text
    assert "Best on each rig" in text
    assert "nan" not in text


@pytest.mark.parametrize("width", [80, 120])
def test_one_rig_is_shown_in_full(width):
    methods = {"euclidean": METHODS["euclidean"], "dead": dead}
    result = compare([character("ball")], methods)
    text = shown(result, width)
    assert max(map(len, text.splitlines())) <= width
    assert "ball: 162 vertices, 3 joints with weight" in text
    turn = result.rigs[0].scores[0].worst[0]
    assert f"{turn.name}, {turn.axis}" in text
    assert "dead failed: no power" in text


def test_a_figure_is_drawn(tmp_path):
    result = compare([character("a"), character("b")], {"cutcell": dead, **some_methods()})
    path = tmp_path / "plot.png"
    plot_comparison(result, path)
    with Image.open(path) as image:
        assert image.width > 1300
        pixels = np.asarray(image.convert("RGB"))
    assert tuple(pixels[0, 0]) == (255, 255, 255)
    assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 20
    svg = tmp_path / "plot.svg"
    plot_comparison(result, svg)
    assert "<svg" in svg.read_text()


def some_methods():
    return {"euclidean": METHODS["euclidean"], "artist": METHODS["artist"], "dead": dead}


def test_figures_that_cannot_be_drawn_say_why(tmp_path, monkeypatch):
    result = compare([character()], {"dead": dead})
    with pytest.raises(FileError, match=r'cannot be "\.gif"'):
        plot_comparison(result, tmp_path / "plot.gif")
    with pytest.raises(FileError, match="no folder"):
        plot_comparison(result, tmp_path / "nowhere" / "plot.png")
    with pytest.raises(ParameterError, match="nothing to plot"):
        plot_comparison(result, tmp_path / "plot.png")
    (tmp_path / "taken.png").mkdir()
    result = compare([character()], ["euclidean"])
    with pytest.raises(FileError, match="is a folder"):
        plot_comparison(result, tmp_path / "taken.png")
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(MissingLibraryError, match=r"cutcell\[plot\]"):
        plot_comparison(result, tmp_path / "plot.png")
