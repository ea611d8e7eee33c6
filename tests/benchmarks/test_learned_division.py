"""The trial of a learned division leaves makers out, and sees neither names, scale nor axes."""

import numpy as np
import pytest
from scipy.sparse import csr_array

import cutcell
from cutcell.animation.falloff.pipeline import RigFalloff
from cutcell.rig import Rig, Skeleton, TriangleMesh
from cutcell.rig.rows import to_dense
from cutcell_lab.benchmarks import learned_division
from cutcell_lab.benchmarks.division_features import pair_features
from tests.benchmarks.markdown import read_tables

pytestmark = pytest.mark.nightly


def features(rig):
    """Each feature of all vertices and their nearest joints (n, j)."""
    distances = cutcell.bind(rig, 16).distances
    rows, of_vertices = distances.rows, {}
    for name, value in pair_features(RigFalloff.over(distances)).items():
        entries = csr_array((value, rows.indices, rows.indptr), rows.shape)
        of_vertices[name] = to_dense(entries)[distances.graph.vertex_node]
    return of_vertices


def test_other_names_scale_axes_and_a_mirror_change_no_feature(small):
    rig = cutcell.load(small)
    mesh, skeleton = rig.mesh, rig.skeleton
    names = [f"other {j}" for j in range(len(skeleton.joints))]
    other = Rig(
        TriangleMesh(2 * mesh.vertices[:, [1, 0, 2]], mesh.faces[:, ::-1]),
        Skeleton(2 * skeleton.joints[:, [1, 0, 2]], skeleton.parents, names, skeleton.deform),
    )
    plain = Rig(mesh, Skeleton(skeleton.joints, skeleton.parents, deform=skeleton.deform))
    before, after = features(plain), features(other)
    for name, value in before.items():
        np.testing.assert_allclose(after[name], value, atol=1e-6, err_msg=name)


def test_a_character_is_judged_by_trees_that_have_not_seen_its_maker(small, capsys, monkeypatch):
    rig = cutcell.load(small)
    names = {"rigs": "khronos_small", "wild": "quat_small", "more": "ozz_small", "train": "quat_2"}
    monkeypatch.setattr(learned_division, "characters", lambda group: [(names[group], rig)])
    learned = []

    def fit(samples):
        learned.append({one.maker for one in samples})
        return learned_division.HistGradientBoostingClassifier(max_iter=2).fit(
            np.concatenate([one.features for one in samples]),
            np.concatenate([one.strongest for one in samples]),
        )

    monkeypatch.setattr(learned_division, "fit", fit)
    learned_division.main([])
    for maker in ("Khronos", "Quaternius", "ProAnimationBank"):
        assert maker not in learned[learned_division.fold_of(maker)]
    (rows,) = read_tables(capsys.readouterr().out).values()
    assert [row["division"] for row in rows] == ["by distance", "learned", "mean of both"] * 2
    assert [row["better : worse"] for row in rows if row["division"] == "by distance"] == [
        "0 : 0"
    ] * 2
