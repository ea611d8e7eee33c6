"""What containers may take counts as the machine's memory; matrices that do not fit are refused."""

from types import SimpleNamespace

import numpy as np
import psutil
import pytest

import cutcell
from cutcell import Rig, Skeleton, TooLargeError, TriangleMesh
from cutcell.runtime import memory
from cutcell.runtime.memory import available_memory, check_matrix, gigabytes
from tests import meshes

GB = 10**9


@pytest.fixture
def cgroups(tmp_path, monkeypatch):
    """Give a function that lays out control groups, and says in which this process is."""

    def lay_out(lines, files):
        for name, content in files.items():
            path = tmp_path / "fs" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(f"{content}\n")
        (tmp_path / "own").write_text("\n".join(lines) + "\n")
        memory._limited_groups.cache_clear()

    monkeypatch.setattr(memory, "CGROUPS", tmp_path / "fs")
    monkeypatch.setattr(memory, "OWN_CGROUP", tmp_path / "own")
    monkeypatch.setattr(psutil, "virtual_memory", lambda: SimpleNamespace(available=64 * GB))
    yield lay_out
    memory._limited_groups.cache_clear()


def version_2(folder, limit, usage, reclaimable=0):
    names = {
        "memory.max": limit,
        "memory.current": usage,
        "memory.stat": f"anon 5\ninactive_file {reclaimable}\nactive_file 7",
    }
    return {f"{folder}/{name}": value for name, value in names.items()}


CASES = {
    "no groups": ([], {}, 64),
    "version 2": (["0::/"], version_2(".", 4 * GB, GB), 3),
    "version 2, a group": (["0::/a/b"], version_2("a/b", 4 * GB, GB), 3),
    "version 2, its parent": (
        ["0::/a/b"],
        version_2("a/b", "max", GB) | version_2("a", 2 * GB, GB),
        1,
    ),
    "version 2, the least of all": (
        ["0::/a/b"],
        version_2("a/b", 5 * GB, GB) | version_2("a", 9 * GB, 7 * GB),
        2,
    ),
    "version 2, another group": (["0::/a"], version_2("b", 2 * GB, GB), 64),
    "version 2, no limit": (["0::/"], version_2(".", "max", GB), 64),
    "files in memory make way": (["0::/"], version_2(".", 4 * GB, 3 * GB, 2 * GB), 3),
    "over its limit": (["0::/"], version_2(".", GB, 2 * GB), 0),
    "version 1 alone": (["4:memory:/a"], version_2("a", GB, 0), 64),
    "a broken file": (["0::/"], version_2(".", "many", GB), 64),
}


@pytest.mark.parametrize("name", CASES)
def test_limits_of_control_groups_count_as_the_memory_of_the_machine(name, cgroups):
    lines, files, free = CASES[name]
    cgroups(lines, files)
    assert available_memory() == free * GB


def test_a_matrix_that_does_not_fit_is_refused(monkeypatch):
    monkeypatch.setattr(memory, "available_memory", lambda: GB)
    check_matrix(1000, 1000)
    check_matrix(10_000, 5_000, copies=2)
    sentence = "weights of 10,000 vertices for 6,000 joints need about 0.96 GB, but only 0.8 GB"
    with pytest.raises(TooLargeError, match=sentence):
        check_matrix(10_000, 6_000, copies=2)


def test_sizes_are_written_with_two_digits():
    sizes = {521e9: "520 GB", 44.1e9: "44 GB", 3e12: "3,000 GB", 1.26e6: "0.0013 GB", 0: "0 GB"}
    assert [gigabytes(size) for size in sizes] == list(sizes.values())


def rig(joints=3):
    return Rig(TriangleMesh(*meshes.box()), Skeleton(np.zeros((joints, 3)), [-1] * joints))


def test_weights_that_do_not_fit_are_refused_before_they_are_copied(monkeypatch):
    weights = np.broadcast_to(1.0, (8, 3))
    rig().with_weights(weights)
    monkeypatch.setattr(memory, "available_memory", lambda: 100)
    with pytest.raises(TooLargeError, match="weights of 8 vertices for 3 joints"):
        rig().with_weights(weights)


def test_a_binding_whose_weights_do_not_fit_is_refused_at_once(monkeypatch):
    monkeypatch.setattr(memory, "available_memory", lambda: 100)
    with pytest.raises(TooLargeError, match="weights of 8 vertices for 3 joints"):
        cutcell.bind(rig(), progress=lambda stage, done: pytest.fail("it has begun"))
