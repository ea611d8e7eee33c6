"""`cutcell sweep`: a table, CSV and JSON of one option."""

import csv
import json

import cutcell
from tests.cutcell.cli.files import refused
from tests.viewers.arm import arm_rig


def test_prints_each_value_and_what_failed(run, tmp_path):
    path = tmp_path / "arm.glb"
    cutcell.save(path, arm_rig())
    options = ("sweep", path, "--values", "8,12,1", "-q")
    table = run(*options).stdout
    assert table.startswith("arm: resolution, against the file's weights")
    assert "resolution=1: resolution must be" in " ".join(table.split())
    document = json.loads(run(*options, "--json").stdout)
    rows = list(csv.DictReader(
        line for line in run(*options, "--csv").stdout.splitlines() if not line.startswith("#")
    ))  # fmt: skip
    assert [row["resolution"] for row in rows] == ["8", "12", "1"]
    assert [float(row["l1"]) for row in rows[:2]] == [p["l1"] for p in document["points"][:2]]
    assert "option must be one of" in refused(run("sweep", path, "--option", "radius"))
    assert "commas" in refused(run("sweep", path, "--values", ","))


def test_a_mesh_without_weights_is_measured_against_the_method(run, bar):
    result = run("sweep", bar, "--option", "alpha", "--values", "0.5", "--method", "paper", "-r", 8)
    assert result.exit_code == 0, result.stderr
    assert "against the weights of the method" in result.stdout
    assert "0.000" in result.stdout
