"""The published archive: read as data alone, one asset at a time, whatever is in it."""

import io
import os
import pickle
import subprocess
import sys
import zipfile
from collections import OrderedDict, deque
from fractions import Fraction

import numpy as np
import pytest

import cutcell
from cutcell.errors import FileError
from cutcell_lab.dataset.read import unpickle
from cutcell_lab.dataset.read.archive import read_archive, split


class Attack:
    """Runs a command when it is unpickled by Python's own means."""

    def __init__(self, mark):
        self.mark = mark

    def __reduce__(self):
        return os.makedirs, (str(self.mark), 0o755, True)


def asset(seed: int, plural: bool = False) -> dict:
    r = np.random.default_rng(seed)
    s = "s" if plural else ""
    return {
        "vertices": r.random((20, 3)),
        "faces": np.arange(18).reshape(6, 3),
        "joints": r.random((3, 3)).astype(np.float32),
        "bones": [[0, 1], [1, 2]],
        "root_index": np.int64(0),
        "uuid": f"made/{seed}",
        "joint_names": ["hips", "spine", "head"],
        "skinning_weights_value": np.ones(20),
        f"skinning_weights_row{s}": np.arange(20),
        f"skinning_weights_col{s}": np.zeros(20, np.int64),
        "skinning_weights_shape": (20, 3),
        "by_columns": np.asfortranarray(r.random((2, 3))),
    }


def write(path, entries, protocol=4):
    array = np.empty(len(entries), object)
    array[:] = entries
    data = io.BytesIO()
    header = {"descr": "|O", "fortran_order": False, "shape": array.shape}
    np.lib.format.write_array_header_1_0(data, header)
    pickle.dump(array, data, protocol=protocol)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("arr_0.npy", data.getvalue())
        archive.writestr("allow_pickle.npy", b"")
    return path


@pytest.mark.parametrize(
    ("protocol", "count"), [(2, 1), (2, 3), (3, 2), (4, 1), (4, 2), (4, 1001), (5, 2)]
)
def test_every_asset_comes_back_as_it_was(tmp_path, protocol, count):
    entries = [asset(k) for k in range(count)]
    result = list(read_archive(write(tmp_path / "a.npz", entries, protocol)))
    assert [f.name for f in result] == [f"made_{k}" for k in range(count)]
    for entry, one in zip(entries, result, strict=True):
        assert not one.error
        assert set(one.arrays) == set(entry)
        for key, value in entry.items():
            np.testing.assert_array_equal(one.arrays[key], np.array(value))


def test_numpy_saves_what_is_read(tmp_path):
    np.savez_compressed(tmp_path / "a.npz", [asset(0), asset(1)])
    assert len(list(read_archive(tmp_path / "a.npz"))) == 2


@pytest.mark.parametrize("protocol", [2, 4, 5])
def test_an_attack_is_told_and_not_run(tmp_path, protocol):
    mark = tmp_path / "ran"
    entries = [asset(k) for k in range(8)]
    entries[2] = Attack(mark)
    entries[4]["vertices"] = Attack(mark)
    entries[5]["joint_names"] = ["a", Attack(mark)]
    entries[6]["more"] = {1, 2}
    path = write(tmp_path / "a.npz", entries, protocol)
    result = list(read_archive(path))
    assert not mark.exists()
    assert [k for k, f in enumerate(result) if f.error] == [2, 4, 5, 6]
    assert all("makedirs" in result[k].error for k in (2, 4, 5))
    with np.load(path, allow_pickle=True) as python:
        python["arr_0"]
    assert mark.exists(), "it would have run otherwise"


def test_what_comes_from_outside_of_the_pickle_is_refused(tmp_path):
    class Persistent(pickle.Pickler):
        def persistent_id(self, thing):
            return "elsewhere" if thing == "take me" else None

    data = io.BytesIO()
    header = {"descr": "|O", "fortran_order": False, "shape": (2,)}
    np.lib.format.write_array_header_1_0(data, header)
    Persistent(data, 4).dump([{"uuid": "a", "x": "take me"}, {"uuid": "b"}])
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("arr_0.npy", data.getvalue())
    first, second = read_archive(tmp_path / "a.npz")
    assert "outside" in first.error
    assert not second.error


def test_objects_refuse_their_own_asset_only(tmp_path):
    entries = [asset(k) for k in range(5)]
    entries[1]["more"] = OrderedDict(a=1)
    entries[2]["more"] = deque([1, 2])
    entries[3]["more"] = Fraction(1, 2)
    entries[4]["vertices"] = entries[4]["again"] = np.ones((2, 3))
    assets = list(read_archive(write(tmp_path / "a.npz", entries)))
    assert [k for k, one in enumerate(assets) if one.error] == [1, 2, 3]
    np.testing.assert_array_equal(assets[4].arrays["vertices"], assets[4].arrays["again"])


def test_the_oldest_protocol_is_read(tmp_path):
    entries = [{"uuid": f"{k}", "bones": [[0, 1]]} for k in range(3)]
    assets = list(read_archive(write(tmp_path / "a.npz", entries, 0)))
    assert [one.name for one in assets] == ["0", "1", "2"]


def test_an_asset_of_billions_of_items_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(unpickle, "MAX_ITEMS", 100_000)
    nested = [0]
    for _ in range(12):
        nested = [nested] * 40
    path = write(tmp_path / "a.npz", [{"uuid": "a", "vertices": nested}])
    with pytest.raises(FileError):
        list(read_archive(path))


def test_memory_is_that_of_one_asset(tmp_path):
    """200 assets of half a megabyte each are read in far less than the 100 MB that they take."""
    entries = [{"uuid": str(k), "vertices": np.full((20_000, 3), k, float)} for k in range(200)]
    path = write(tmp_path / "a.npz", entries)
    code = (
        "import resource, sys\nfrom pathlib import Path\n"
        "from cutcell_lab.dataset.read.archive import read_archive\n"
        "most = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "before = most()\n"
        "count = sum(1 for _ in read_archive(Path(sys.argv[1])))\n"
        "print(count, most() - before)"
    )
    done = subprocess.run([sys.executable, "-c", code, path], capture_output=True, text=True)
    count, kilobytes = map(int, done.stdout.split())
    assert count == 200
    assert kilobytes < 30_000


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (lambda data: data[: len(data) // 2], "damaged"),
        (lambda data: data[:128] + b"\x80\x04garbage.", "no pickle|damaged|instruction"),
        (lambda data: b"no array at all", "no array"),
    ],
)
def test_damage_is_a_sentence(tmp_path, spoil, told):
    path = write(tmp_path / "a.npz", [asset(0), asset(1), asset(2)])
    with zipfile.ZipFile(path) as archive:
        data = archive.read("arr_0.npy")
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("arr_0.npy", spoil(data))
    with pytest.raises(FileError, match=told):
        list(read_archive(path))


def test_other_files_are_told(tmp_path):
    with pytest.raises(FileError, match="no such file"):
        list(read_archive(tmp_path / "none.npz"))
    (tmp_path / "text.npz").write_text("text")
    with pytest.raises(FileError, match="no readable npz"):
        list(read_archive(tmp_path / "text.npz"))
    np.savez(tmp_path / "other.npz", vertices=np.zeros(3))
    with pytest.raises(FileError, match="no arr_0"):
        list(read_archive(tmp_path / "other.npz"))
    np.savez(tmp_path / "numbers.npz", np.zeros(3))
    with pytest.raises(FileError, match="plain numbers"):
        list(read_archive(tmp_path / "numbers.npz"))


def test_splitting_goes_on_where_it_stopped(tmp_path):
    entries = [asset(0), asset(1, plural=True), {"uuid": "made/1"}, Attack(tmp_path / "ran")]
    path, folder = write(tmp_path / "a.npz", entries), tmp_path / "rigs"
    first = split(path, folder)
    assert (first.written, first.kept, list(first.refused)) == (3, 0, ["asset_000003"])
    assert cutcell.load(folder / "made_1.npz").skeleton.names == ("hips", "spine", "head")
    assert cutcell.load(folder / "made_0.npz").weights[:, 0].min() == 1
    before = {p.name: p.stat().st_mtime_ns for p in folder.iterdir()}
    (folder / "made_0.npz").unlink()
    again = split(path, folder)
    assert (again.written, again.kept) == (1, 2)
    after = {p.name: p.stat().st_mtime_ns for p in folder.iterdir()}
    assert set(after) == set(before)
    assert after["made_1.npz"] == before["made_1.npz"]
