"""The code of docs/priors.md runs from its first block to its last."""

import re

import numpy as np

from tests.conftest import ROOT

PAGE = (ROOT / "docs" / "priors.md").read_text(encoding="utf-8")


def test_the_code_for_other_networks_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for block in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL):
        exec(block, names)
    vertices, joints = len(names["vertices"]), len(names["joints"])
    assert names["skin"].shape == (vertices, joints)
    np.testing.assert_allclose(names["skin"].sum(axis=1), 1, atol=1e-9)
    assert list((tmp_path / "priors").glob("*.npy"))
    assert names["geodesic"].shape == (vertices, names["count"])
    # The least over a joint's bones is what the skeleton itself gives.
    direct = names["cutcell"].bone_distances(names["graph"], names["rig"].skeleton, leaf="point")
    joint = int(names["parents"][names["child"][-1]])
    of_joint = names["parents"][names["child"]] == joint
    np.testing.assert_allclose(
        names["geodesic"][:, of_joint].min(axis=1),
        direct.on_mesh(joint) * names["graph"].lattice.size,
        atol=1e-6,
    )
