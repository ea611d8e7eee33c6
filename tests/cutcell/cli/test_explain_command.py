"""`cutcell explain`: why a vertex has its weights, for people and for scripts."""

import json

import cutcell
from tests.cutcell.cli.files import refused


def test_it_prints_steps_for_people_and_scripts(run, bar):
    words = run("explain", bar, 0, "-r", 16).stdout
    for line in ("distance", "through the air", "shares by distance", "normalised", "path to "):
        assert line in words
    document = json.loads(run("explain", bar, 0, "-r", 16, "--json").stdout)
    weights = cutcell.bind(cutcell.load(bar), 16).weights[0]
    for share in document["joints"]:
        assert abs(share["weight"] - weights[share["joint"]]) < 1e-12


def test_a_vertex_that_is_not_there_is_a_sentence(run, bar):
    assert "vertex must be a whole number" in refused(run("explain", bar, 1000000, "-r", 16))
