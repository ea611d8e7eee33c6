"""What is exported loads by loaders written from the three projects' descriptions."""

import sys
from collections import defaultdict
from types import SimpleNamespace

import h5py
import numpy as np
import pyarrow.parquet as parquet
import pytest

import cutcell
import cutcell_lab
from cutcell.errors import FileError, MissingLibraryError, ParameterError
from cutcell_assets.generate import KINDS, generate
from cutcell_lab.dataset.bind.binding import bind_all
from cutcell_lab.dataset.export import export
from cutcell_lab.dataset.read.store import Parameters, Store
from cutcell_lab.dataset.torch_data import RigDataset, RigSamples, collate_samples

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]


@pytest.fixture(scope="module")
def store(tmp_path_factory, scheduler):
    root = tmp_path_factory.mktemp("exported")
    (root / "rigs").mkdir()
    for k, kind in enumerate(("body", "robot", "hand")):
        cutcell.save(root / "rigs" / f"{k}.npz", generate(kind, k, detail=14, clean=True))
    method = cutcell.PAPER.with_options(resolution=16)
    bind_all([root / "rigs"], root / "store", Parameters(method), scheduler=scheduler)
    return root / "store"


def entry_of(store, name):
    return dict(Store(store).entries())[name]


def rignet_bones(info) -> list[tuple[str, str]]:
    """List bones as RigNet's code is described to: by levels, with a leaf after a last joint."""
    joints, children, root = {}, defaultdict(list), None
    for line in info.read_text().splitlines():
        kind, *words = line.split()
        if kind == "joints":
            joints[words[0]] = np.array(words[1:], float)
        elif kind == "root":
            root = words[0]
        elif kind == "hier":
            children[words[0]].append(words[1])
    bones, level = [], [root]
    while level:
        following = []
        for parent in level:
            following += children[parent]
            for child in children[parent]:
                bones.append((joints[parent], joints[child]))
                if not children[child]:
                    bones.append((joints[child], joints[child]))
        level = following
    return bones


def test_rignet(store, tmp_path):
    assert export(store, tmp_path, "rignet") == 3
    for name in "012":
        distances = np.load(tmp_path / "volumetric_geodesic" / f"{name}_volumetric_geo.npy")
        bones = rignet_bones(tmp_path / "rig_info" / f"{name}.txt")
        rig = cutcell_lab.dataset.find_sources([tmp_path / "obj" / f"{name}.obj"])[0]
        assert rig.kind == "rignet"
        entry = entry_of(store, name)
        assert distances.shape == (len(entry.vertices), len(bones))
        assert np.isfinite(distances).all()
        for k, (start, end) in enumerate(bones):
            along = end - start
            t = np.clip((entry.vertices - start) @ along / max(along @ along, 1e-12), 0, 1)
            straight = np.linalg.norm(entry.vertices - start - t[:, None] * along, axis=1)
            lattice = 2 * entry.scale / 16
            assert (distances[:, k] > straight - lattice).all(), "no path is shorter"


def test_unirig(store, tmp_path):
    assert export(store, tmp_path, "unirig") == 3
    for name in "012":
        entry = entry_of(store, name)
        with np.load(tmp_path / name / "raw_data.npz", allow_pickle=True) as file:
            raw = {key: file[key][()] for key in file}
        parents = list(raw["parents"])
        assert parents[0] is None
        assert all(parent < k for k, parent in enumerate(parents) if k)
        count = len(entry.joints)
        assert raw["matrix_local"].shape == (count, 4, 4)
        assert raw["tails"].shape == raw["joints"].shape == (count, 3)
        np.testing.assert_allclose(np.linalg.norm(raw["face_normals"], axis=1), 1, atol=1e-5)
        order = [entry.names.index(str(n)) for n in raw["names"]]
        np.testing.assert_array_equal(raw["joints"], entry.joints[order])
        np.testing.assert_array_equal(raw["skin"], entry.artist[:, order])
        prior = np.load(tmp_path / name / "voxel_skin.npy")
        np.testing.assert_array_equal(prior, entry.weights[:, order])
        for k, parent in enumerate(parents[1:], start=1):
            assert entry.parents[order[k]] == order[parent]


def test_puppeteer(store, tmp_path):
    assert export(store, tmp_path / "train.h5", "puppeteer") == 3
    with h5py.File(tmp_path / "train.h5", "r") as file:
        assert sorted(file) == ["sample_0", "sample_1", "sample_2"]
        for k in range(3):
            data = file[f"sample_{k}"]
            name = data["file_name"][()].decode("utf-8")
            entry = entry_of(store, name)
            count, points = len(entry.joints), data["pc_w_norm"][:]
            assert points.shape == (8192, 6)
            np.testing.assert_allclose(np.linalg.norm(points[:, 3:], axis=1), 1, atol=1e-5)
            assert data["graph_dist"].shape == (count, count)
            for parent, child in data["bones"][:]:
                assert entry.parents[child] == parent
                assert data["graph_dist"][parent, child] == 1
            assert entry.parents[data["root_index"][()]] == -1
            np.testing.assert_array_equal(data["skin"][:], entry.artist)
            np.testing.assert_array_equal(data["prior"][:], entry.weights)
            assert data["prior_points"].shape == (8192, count)
            np.testing.assert_allclose(data["prior_points"][:].sum(axis=1), 1, atol=1e-4)
            assert data["edges"][:].max() < len(entry.vertices)


def test_parquet(store, tmp_path):
    assert export(store, tmp_path / "train.parquet", "parquet") == 3
    rows = parquet.read_table(tmp_path / "train.parquet").to_pylist()
    assert [row["name"] for row in rows] == ["0", "1", "2"]
    for row in rows:
        entry = entry_of(store, row["name"])
        assert row["joint_names"] == list(entry.names)
        assert row["scale"] == entry.scale
        pairs = {"prior": entry.weights, "skin": entry.artist, "distances": entry.distances}
        for key in ("vertices", "faces", "joints", "parents"):
            pairs[key] = getattr(entry, key)
        for key, expected in pairs.items():
            np.testing.assert_array_equal(np.array(row[key], expected.dtype), expected)


def test_parquet_asks_for_its_library(store, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(MissingLibraryError, match="pip install"):
        export(store, tmp_path / "train.parquet", "parquet")
    assert not list(tmp_path.iterdir())


def test_wrong_exports_are_told(store, tmp_path):
    with pytest.raises(ParameterError, match="kind"):
        export(store, tmp_path, "other")
    with pytest.raises(FileError, match="is no store"):
        export(tmp_path, tmp_path / "out", "rignet")


def test_samples_are_points_with_what_their_triangle_has(store):
    samples = RigSamples(store, points=200, prior="weights")
    one = samples.sample(1)
    assert one["points"].shape == (200, 3)
    np.testing.assert_allclose(one["prior"].sum(axis=1), 1, atol=1e-5)
    np.testing.assert_array_equal(one["points"], samples.sample(1)["points"])
    samples.epoch = 1
    assert not np.array_equal(one["points"], samples.sample(1)["points"])
    whole = RigSamples(store, points=0, prior="bone_distances", names=["2"])
    entry = entry_of(store, "2")
    np.testing.assert_array_equal(whole.sample(0)["prior"], entry.bone_distances)
    with pytest.raises(FileError, match="no asset 'x'"):
        RigSamples(store, names=["x"])
    with pytest.raises(ParameterError, match="prior"):
        RigSamples(store, prior="voxels")


def test_rigs_of_different_size_make_one_batch(store):
    samples = RigSamples(store, points=0, prior="distances")
    ones = [samples.sample(k) for k in range(3)]
    batch = collate_samples(ones, "distances")
    assert batch["point_mask"].sum(axis=1).tolist() == [len(o["points"]) for o in ones]
    assert batch["joint_mask"].sum(axis=1).tolist() == [len(o["joints"]) for o in ones]
    for k, one in enumerate(ones):
        rows, columns = one["prior"].shape
        np.testing.assert_array_equal(batch["prior"][k, :rows, :columns], one["prior"])
        assert np.isinf(batch["prior"][k, rows:]).all()
        assert (batch["parents"][k, columns:] == -1).all()


def test_torch_is_asked_for_by_name(store, monkeypatch):
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(MissingLibraryError, match="torch"):
        RigDataset(store)
    stand_in = SimpleNamespace(from_numpy=lambda array: ("tensor", array))
    monkeypatch.setitem(sys.modules, "torch", stand_in)
    kind, points = RigDataset(store, points=7)[0]["points"]
    assert (kind, points.shape) == ("tensor", (7, 3))


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "person"])
def test_characters_are_made_alike_from_one_seed(kind):
    one, again, other = (generate(kind, seed, detail=14) for seed in (3, 3, 4))
    np.testing.assert_array_equal(one.mesh.vertices, again.mesh.vertices)
    assert len(one.mesh.vertices) != len(other.mesh.vertices) or not np.array_equal(
        one.mesh.vertices, other.mesh.vertices
    )
    np.testing.assert_allclose(one.weights.sum(axis=1), 1)
    assert (one.weights > 0).sum(axis=1).max() <= 4
    clean = generate(kind, 3, detail=14, clean=True)
    graph = cutcell.build_graph(clean.mesh, resolution=12)
    assert graph.is_closed
    a, b, c = (clean.mesh.vertices[clean.mesh.faces[:, k]] for k in range(3))
    assert (a * np.cross(b, c)).sum() > 0, "faces look outwards"


def test_some_characters_have_holes_loose_parts_or_are_soups():
    rigs = [generate("hand", seed, detail=12) for seed in range(30)]
    soups = sum(len(rig.mesh.vertices) == 3 * len(rig.mesh.faces) for rig in rigs)
    assert 0 < soups < 10


def test_what_cannot_be_made_is_told(monkeypatch):
    with pytest.raises(ParameterError, match="kind"):
        generate("dragon", 0)
    with pytest.raises(ParameterError, match="detail"):
        generate("hand", 0, detail=1)
    monkeypatch.setitem(sys.modules, "anny", None)
    with pytest.raises(MissingLibraryError, match="anny"):
        generate("person", 0)
