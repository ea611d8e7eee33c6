"""The audit equals brute force on every pair, and finds what was planted."""

import numpy as np
import pytest
from scipy.spatial.distance import cdist

import cutcell
from cutcell.errors import MeshError, ParameterError
from cutcell_assets.generate import KINDS, generate
from cutcell_lab.dataset.audit.audit_files import save_audit
from cutcell_lab.dataset.audit.auditing import audit
from cutcell_lab.dataset.audit.chamfer import CELLS, CODE, block_of, close_joints, close_surfaces
from cutcell_lab.dataset.audit.duplicates import Pair, clusters
from cutcell_lab.dataset.audit.likeness import Similarity, features_of, likeness, same_skeletons
from cutcell_lab.dataset.audit.points import Normalised, normalised, sample_surface
from cutcell_lab.dataset.read.store import read_table
from tests.lab.dataset.planted import planted

ALIKE = Similarity("copy", True, 0.0, 0.0, 0.0, 1.0, 0.0)

pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]


def chamfer(a, b) -> float:
    """Return the paper's distance by comparing all points with all."""
    squares = cdist(np.asarray(a, float), np.asarray(b, float), "sqeuclidean")
    return squares.min(axis=1).mean() + squares.min(axis=0).mean()


def some(count: int, points: int = 64) -> list[Normalised]:
    """Return characters, some of them nearly alike, some exactly, some with joints outside."""
    random = np.random.default_rng(5)
    found = []
    for k in range(count):
        rig = generate(KINDS[k % 5], k // 7, detail=12)
        one = normalised(rig, points, seed=k % 2)
        if k % 3 == 0:
            one = Normalised(one.joints, one.points + random.normal(0, 0.02, (points, 3)))
        if k % 11 == 0:
            one = Normalised(one.joints * np.float32(1.3), one.points)
        found.append(Normalised(one.joints, one.points.clip(0, 1).astype(np.float32)))
    return [*found, found[0], found[3]]


@pytest.mark.parametrize("limits", [(0.01, 0.01), (0.05, 0.002), (1.0, 1.0)])
def test_both_stages_equal_brute_force_on_every_pair(limits):
    characters = some(50)
    block = block_of(characters)
    pairs, joints = close_joints(block, block, limits[0], True)
    surface = close_surfaces(block, block, pairs, limits[1])
    found = {tuple(p): (j, s) for p, j, s in zip(pairs.tolist(), joints, surface, strict=True)}
    count = 0
    for a in range(len(characters)):
        for b in range(a + 1, len(characters)):
            of_joints = chamfer(characters[a].joints, characters[b].joints)
            assert ((a, b) in found) == (of_joints < limits[0])
            if (a, b) in found:
                of_points = chamfer(characters[a].points, characters[b].points)
                near = of_points < limits[1]
                assert np.isfinite(found[a, b][1]) == near
                np.testing.assert_allclose(found[a, b][0], of_joints, rtol=1e-9, atol=1e-15)
                if near:
                    np.testing.assert_allclose(found[a, b][1], of_points, rtol=1e-9, atol=1e-15)
                    count += 1
    assert count > 1


def test_two_blocks_give_what_one_gives():
    characters = some(20)
    one, left, right = block_of(characters), block_of(characters[:9]), block_of(characters[9:])
    pairs, distances = close_joints(one, one, 0.05, True)
    across, apart = close_joints(left, right, 0.05, False)
    wanted = (pairs[:, 0] < 9) & (pairs[:, 1] >= 9)
    assert across.tolist() == (pairs[wanted] - [0, 9]).tolist()
    np.testing.assert_array_equal(apart, distances[wanted])


def test_cells_are_never_said_to_be_farther_than_they_are():
    random = np.random.default_rng(1)
    for one in some(6):
        block = block_of([one])
        probes = random.random((2000, 3)).astype(np.float32)
        index = (probes * CELLS).astype(int)
        cell = (index[:, 0] * CELLS + index[:, 1]) * CELLS + index[:, 2]
        bound = block.near[0][cell] * CODE
        true = cdist(probes.astype(float), one.points.astype(float)).min(axis=1)
        assert (bound <= true).all()
        assert (true - bound).max() < 2 * np.sqrt(3) / CELLS


def test_points_follow_the_area_and_the_seed():
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [9, 0, 0]]
    drawn = sample_surface(vertices, [[0, 1, 2], [1, 3, 2]], 900, 3)
    assert (drawn.face == 0).sum() == 100
    np.testing.assert_array_equal(
        drawn.places, sample_surface(vertices, [[0, 1, 2], [1, 3, 2]], 900, 3).places
    )
    np.testing.assert_allclose(drawn.shares.sum(axis=1), 1)
    with pytest.raises(MeshError, match="no area"):
        sample_surface(vertices, [[0, 0, 1]], 5, 0)


def pair(a, b, distance) -> Pair:
    return Pair(a, b, 0.0, distance, ALIKE)


def test_exact_duplicates_do_not_vanish_and_minpts_counts():
    # 0.0069 is the last distance within eps: 1 - exp(-0.69) < 0.5 < 1 - exp(-0.70)
    pairs = [pair(0, 1, 0.0), pair(2, 3, 0.0069), pair(4, 5, 0.0070), pair(6, 7, 0.0)]
    pairs += [pair(7, 8, 0.0), pair(6, 8, 0.0)]
    assert clusters(9, pairs, 0.01, 2).tolist() == [0, 0, 1, 1, -1, -1, 2, 2, 2]
    assert clusters(9, pairs, 0.01, 3).tolist() == [-1] * 6 + [0, 0, 0]
    assert clusters(3, [], 0.01, 2).tolist() == [-1] * 3


@pytest.fixture(scope="module")
def found(tmp_path_factory, scheduler):
    folder = tmp_path_factory.mktemp("planted")
    for name, rig in planted().items():
        weights = np.zeros((len(rig.mesh.vertices), len(rig.skeleton.joints)))
        weights[:, 0] = 1
        cutcell.save(folder / f"{name}.npz", rig.with_weights(weights))
    (folder / "broken.npz").write_bytes(b"broken")
    return audit([folder], points=2048, scheduler=scheduler), folder


@pytest.mark.slow
def test_planted_duplicates_are_found_each_at_its_tier(found):
    result, _ = found
    of_original = {}
    for row in result.rows():
        if "original" in (row["a"], row["b"]):
            name = row["a"] if row["b"] == "original" else row["b"]
            of_original[name] = row["tier"], row["kind"]
    assert of_original["units"] == ("twin", "copy")
    assert of_original["order"][1] == "copy"
    assert of_original["remeshed"][1] == "remeshed"
    assert of_original["clothes"][1] == "clothes"
    assert of_original["pose"][1] == "pose"
    assert of_original["mirrored"] == ("near", "mirrored")
    assert of_original.get("other", ("", "similar"))[1] == "similar"
    assert list(result.failed) == ["broken"]


@pytest.mark.slow
def test_one_of_each_cluster_is_kept(found, tmp_path):
    result, _ = found
    assert len(result.keep) < len(result.names)
    labels = dict(zip(result.names, result.labels.tolist(), strict=True))
    assert labels["units"] == labels["original"] == labels["order"] >= 0
    assert sum(labels[name] == labels["units"] for name in result.keep) == 1
    save_audit(result, tmp_path)
    assert len(read_table(tmp_path / "pairs.parquet")) == len(result.rows())
    kept = [row["name"] for row in read_table(tmp_path / "clusters.parquet") if row["keep"]]
    assert kept == result.keep


@pytest.mark.slow
def test_two_sets_give_the_pairs_across_them(found, scheduler):
    result, folder = found
    one = [folder / "original.npz"]
    crossed = audit(one, [folder], points=2048, scheduler=scheduler)
    assert crossed.labels is None
    assert crossed.keep == []
    names = {result.names[p.a] for p in result.pairs if result.names[p.b] == "original"}
    names |= {result.names[p.b] for p in result.pairs if result.names[p.a] == "original"}
    assert {crossed.others[p.b] for p in crossed.pairs} == names | {"original"}


def test_one_skeleton_is_found_in_other_poses_alone():
    rigs = planted()
    traits = [features_of(rigs[name]) for name in ("original", "pose", "other")]
    assert same_skeletons(traits, None).tolist() == [[0, 1]]
    assert same_skeletons(traits[:1], traits[1:]).tolist() == [[0, 0]]
    assert likeness(traits[0], traits[2], 1.0, 0.0).kind == "similar"


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"joint_threshold": 0}, "joint_threshold"),
        ({"surface_threshold": -1}, "surface_threshold"),
        ({"points": 3}, "points"),
        ({"least": 1}, "least"),
    ],
)
def test_wrong_thresholds_are_told(tmp_path, options, told):
    with pytest.raises(ParameterError, match=told):
        audit([tmp_path], **options)
