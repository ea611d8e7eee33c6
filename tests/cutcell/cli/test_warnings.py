"""What a person should know of a file is told by every command that reads it."""

import json

import numpy as np

from tests.cutcell.io.test_odd_weights import TWO, odd_glb

TOLD = f'mesh "column", primitive 0: {TWO}'


def test_commands_tell_of_odd_weights(run, tmp_path):
    path = odd_glb(tmp_path / "rig.glb", np.nan)
    result = run("bind", path, tmp_path / "out.glb", "-r", 8, "--json")
    assert json.loads(result.stdout)["warnings"][0] == TOLD
    assert f"warning: {TOLD}\n" in result.stderr
    assert json.loads(run("graph", path, "-r", 8, "--json").stdout)["warnings"] == [TOLD]
    assert f"warning: {TOLD}\n" in run("graph", path, "-r", 8).stderr
    compared = run("compare", path, "-r", 8, "--methods", "euclidean", "--json")
    assert f"warning: rig.glb: {TOLD}\n" in compared.stderr
    assert run("bind", path, tmp_path / "out.glb", "-r", 8, "--quiet").stderr == ""
