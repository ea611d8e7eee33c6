"""The commands, from an archive to training data."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import cutcell
from cutcell.cli.app import app
from cutcell_assets.generate import generate
from cutcell_lab.dataset.read.archive import ArchivedAsset, asset_bytes

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]


def run(*words):
    runner = CliRunner(env={"COLUMNS": "120", "NO_COLOR": "1", "TERM": "dumb"})
    result = runner.invoke(app, ["dataset", *map(str, words)])
    if result.exception and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result


def test_from_an_archive_to_training_data(tmp_path):
    made = run("generate", "any", 3, tmp_path / "made", "--detail", 12, "--clean", "--json")
    assert json.loads(made.stdout)["assets"] == 3
    entries = []
    for path in sorted((tmp_path / "made").iterdir()):
        with np.load(path) as file:
            entries.append({**{key: file[key] for key in file.files}, "uuid": path.stem})
    entries += [{**entries[0], "uuid": "twin"}, {"uuid": "broken", "vertices": np.zeros((3, 3))}]
    entries[3] = {key: np.copy(v) if key != "uuid" else v for key, v in entries[3].items()}
    np.savez_compressed(tmp_path / "all.npz", entries)

    split = run("split", tmp_path / "all.npz", tmp_path / "rigs", "--json")
    assert json.loads(split.stdout) == {"written": 5, "kept": 0, "refused": {}}

    store = tmp_path / "store"
    bound = run("bind", tmp_path / "rigs", store, "-r", 12, "--workers", 1, "--json")
    document = json.loads(bound.stdout)
    assert (document["assets"], document["bound"]) == (5, 4)
    assert "lacks faces" in document["failed"]["broken"]
    report = (store / "report.html").read_text()
    assert "lacks faces" in report
    assert "data:image/png;base64" in report

    options = ("--points", 64, "--workers", 1, "--json")
    audited = run("audit", store, "--out", tmp_path / "audit", *options)
    assert len(json.loads(audited.stdout)["keep"]) == 3
    assert "twin" in (tmp_path / "audit" / "report.html").read_text()

    exported = run("export", store, tmp_path / "out.h5", "--format", "puppeteer")
    assert "puppeteer" in exported.stdout


def test_wrong_inputs_are_sentences(tmp_path):
    for words, reports in (
        (("split", tmp_path / "none.npz", tmp_path / "out"), "no such file"),
        (("bind", tmp_path / "alone"), "give rigs"),
        (("bind", tmp_path / "none", tmp_path / "out"), "no such file"),
        (("export", tmp_path, tmp_path / "out", "--format", "rignet"), "is no store"),
        (("generate", "dragon", 1, tmp_path / "out"), "kind must be one of"),
        (("audit", tmp_path / "none"), "no such file"),
    ):
        result = run(*words)
        assert result.exit_code == 2
        assert reports in result.stderr


@pytest.mark.parametrize("command", ["split", "bind", "audit", "export", "generate"])
def test_each_command_shows_examples(command):
    shown = run(command, "--help").stdout
    assert f"cutcell dataset {command} " in shown.partition("Example")[2]


def test_what_is_written_of_an_asset_loads(tmp_path):
    rig = generate("hand", 1, detail=12)
    cutcell.save(tmp_path / "a.npz", rig)
    with np.load(tmp_path / "a.npz") as file:
        asset = ArchivedAsset(0, "a", {key: file[key] for key in file.files})
    (tmp_path / "b.npz").write_bytes(asset_bytes(asset))
    np.testing.assert_allclose(cutcell.load(tmp_path / "b.npz").weights, rig.weights)
