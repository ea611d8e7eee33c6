"""The network that corrects `bind` begins with no change, learns, and each maker is left out."""

import numpy as np
import pytest

import cutcell
from cutcell_lab.benchmarks.refinement import corrected, fit, main, maker, pairs_of
from tests.bars import bar
from tests.benchmarks.markdown import read_tables


def painted(nx: int, edge: float) -> cutcell.Rig:
    """Make a bar of two bones whose artist parted it at `edge`."""
    rig = bar(nx)
    far = rig.mesh.vertices[:, :1] > edge
    return rig.with_weights(np.hstack([~far, far, 0 * far]).astype(float))


def test_without_learning_the_weights_are_those_of_bind():
    rig = painted(20, 0.5)
    pairs = pairs_of("bar", rig, 16)
    network = fit([pairs], epochs=0)
    wanted = cutcell.bind(rig, 16).weights
    np.testing.assert_allclose(corrected(network, pairs, 1.0), wanted, atol=1e-4)


def test_it_learns_where_an_artist_parts_two_bones():
    pairs = [pairs_of(f"bar{nx}", painted(nx, 0.6), 16) for nx in (18, 20, 22)]
    network = fit(pairs, epochs=60)
    new = painted(26, 0.6)
    unseen = pairs_of("bar26", new, 16)
    before, after = (
        np.abs(corrected(network, unseen, part) - new.weights).sum(axis=1).mean()
        for part in (0.0, 1.0)
    )
    assert after < 0.6 * before


@pytest.mark.parametrize(
    ("name", "by"),
    [("fish_pack__Shark", "quaternius"), ("quat_leela", "quaternius"), ("godot_hand", "godot")],
)
def test_the_maker_is_told_by_the_name(name, by):
    assert maker(name) == by


def test_each_character_is_listed(tmp_path, monkeypatch, capsys):
    given = {"rigs": {"one_bar": painted(20, 0.5)}, "wild": {"two_bar": painted(24, 0.6)}}
    monkeypatch.setattr(
        "cutcell_lab.benchmarks.refinement.characters", lambda group: given.get(group, {}).items()
    )
    out = tmp_path / "networks.md"
    out.write_text("<!-- refinement -->\n<!-- /refinement -->\n")
    main(["--epochs", "40", "--resolution", "8", "--parts", "1", "--out", str(out)])
    printed = capsys.readouterr().out
    assert [line for line in printed.splitlines() if "left out" in line][:2] == [
        "one is left out",
        "two is left out",
    ]
    overall, each = read_tables(out.read_text()).values()
    assert [row["part"] for row in overall] == ["0%", "100%", "100%, seen"]
    assert [row["character"] for row in each] == ["one_bar", "two_bar"]
    assert each[0]["L1, 0%"] != each[0]["L1, 100%"]  # it learned from the other artist
