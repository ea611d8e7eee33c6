"""The data set of docs/dataset.md reads what `dataset export --format parquet` writes."""

import re

import pytest
import torch

import cutcell
from cutcell_assets.generate import generate
from cutcell_lab.dataset import bind_all, export
from cutcell_lab.dataset.read.store import Parameters
from tests.conftest import ROOT


@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::DeprecationWarning")
def test_three_lines_are_a_data_set(tmp_path, monkeypatch):
    (tmp_path / "rigs").mkdir()
    for seed, kind in enumerate(("hand", "robot")):
        cutcell.save(tmp_path / "rigs" / f"{kind}.npz", generate(kind, seed, detail=12))
    how = Parameters(cutcell.PAPER.with_options(resolution=8))
    bind_all([tmp_path / "rigs"], tmp_path / "store", how)
    export(tmp_path / "store", tmp_path / "rigs.parquet", "parquet")
    monkeypatch.chdir(tmp_path)
    page = (ROOT / "docs" / "dataset.md").read_text(encoding="utf-8")
    (block,) = [
        block for block in re.findall(r"```python\n(.*?)```", page, re.S) if "parquet" in block
    ]
    names: dict = {}
    exec(block, names)
    loader = torch.utils.data.DataLoader(names["Rigs"](), batch_size=None)
    rigs = {rig["name"]: rig for rig in loader}
    assert set(rigs) == {"hand", "robot"}
    for rig in rigs.values():
        prior = torch.tensor(rig["prior"])
        assert prior.shape == (len(rig["vertices"]), len(rig["joints"]))
        torch.testing.assert_close(prior.sum(dim=1), torch.ones(len(prior)))
