"""The store: complete, resumable, the same however it is made, and no asset spoils another."""

import json
import os
import pickle
import shutil
import signal
import subprocess
import sys
import threading
import time
import zipfile
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import psutil
import pytest

import cutcell
import cutcell_lab
from cutcell.errors import CutcellError, FileError, ParameterError
from cutcell.runtime.memory import SHARE
from cutcell_assets.generate import KINDS, generate
from cutcell_lab.cli.dataset import print_stretched
from cutcell_lab.dataset.audit.report import bind_counts, write_bind_report
from cutcell_lab.dataset.bind import binding
from cutcell_lab.dataset.bind.binding import bind_all, bind_isolated
from cutcell_lab.dataset.bind.cluster import connected
from cutcell_lab.dataset.bind.runner import AssetLostError, Runner
from cutcell_lab.dataset.bind.work import bind_content, memory_needed, rignet_bones
from cutcell_lab.dataset.export import export
from cutcell_lab.dataset.read.entry import read_entry
from cutcell_lab.dataset.read.formats import faces_of_edges
from cutcell_lab.dataset.read.sources import Content, find_sources
from cutcell_lab.dataset.read.store import Parameters, Store

QUICK = Parameters(cutcell.PAPER.with_options(resolution=12))

# What Dask leaves to the garbage collector is not ours.
pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]


def rigs_in(folder: Path, count: int = 4) -> Path:
    folder.mkdir()
    for k in range(count):
        rig = generate(KINDS[k % 4], k, detail=16)
        cutcell.save(folder / f"rig{k}.npz", rig)
    return folder


def files_of(store: Path) -> dict[str, bytes]:
    return {p.name: p.read_bytes() for p in store.glob("??/*.npz")}


@pytest.fixture(scope="module")
def made(tmp_path_factory, scheduler):
    """Return rigs, one of them broken and one twice, a store of them, and its report."""
    root = tmp_path_factory.mktemp("made")
    folder = rigs_in(root / "rigs")
    (folder / "broken.npz").write_bytes(b"PK broken")
    (folder / "copy.npz").write_bytes((folder / "rig0.npz").read_bytes())
    report = bind_all([folder], root / "store", QUICK, scheduler=scheduler)
    return folder, root / "store", report


def test_every_asset_is_there_or_says_why_not(made):
    folder, store, report = made
    assert len(report.rows) == 6
    assert list(report.failures) == ["broken"]
    assert "npz archive" in report.failures["broken"]
    rows = {row["name"]: row for row in Store(store).manifest()}
    assert rows["copy"]["path"] == rows["rig0"]["path"], "computed once"
    rig = cutcell.load(folder / "rig2.npz")
    entry = read_entry(store / rows["rig2"]["path"])
    binding = cutcell.bind(rig, method=QUICK.method)
    np.testing.assert_array_equal(entry.weights, binding.weights.astype(np.float32))
    np.testing.assert_array_equal(entry.distances, binding.distances.joint.T.astype(np.float32))
    np.testing.assert_array_equal(entry.artist, rig.weights.astype(np.float32))
    assert rows["rig2"]["nodes"] == len(binding.graph.nodes)
    assert rows["rig2"]["l1"] == cutcell_lab.metrics.weight_l1(binding.weights, rig.weights)
    assert rows["rig2"]["stretch"] == binding.stretch.share


def test_assets_that_stretch_are_listed_the_worst_first(made, capsys):
    _, _, report = made
    shares = {"rig0": 0.2, "rig1": 0.04, "rig2": 0.4, "broken": None}
    rows = [{**row, "stretch": shares.get(row["name"], 0.0)} for row in report.rows]
    stretched = replace(report, rows=rows).stretched
    assert list(stretched.items()) == [("rig2", 0.4), ("rig0", 0.2)]
    assert bind_counts(replace(report, rows=rows))["stretched"] == "2"
    print_stretched(stretched)
    assert "rig2: 40% of the surface stretches" in capsys.readouterr().err


def test_single_bones_are_at_least_as_far_as_their_joint(made):
    """Leaf bones are points: the least over a joint's bones is the joint's own distance."""
    _, store, _ = made
    for _, entry in Store(store).entries():
        least = np.full(entry.distances.shape, np.inf, np.float32)
        for bone, (joint, _) in enumerate(entry.bone_joints):
            least[:, joint] = np.minimum(least[:, joint], entry.bone_distances[:, bone])
        there = np.isfinite(entry.distances)
        np.testing.assert_allclose(least[there], entry.distances[there], rtol=1e-5, atol=1e-6)


def test_bones_come_in_rignets_order():
    skeleton = cutcell.Skeleton(np.arange(15.0).reshape(5, 3), [-1, 0, 0, 1, 1])
    assert rignet_bones(skeleton).tolist() == [
        [0, 1], [0, 2], [2, 2], [1, 3], [3, 3], [1, 4], [4, 4],
    ]  # fmt: skip
    assert rignet_bones(cutcell.Skeleton([[0, 0, 0]], [-1])).tolist() == [[0, 0]]


@pytest.fixture
def copied(made, tmp_path):
    """Return the same with a copy of the store, which a test may change."""
    folder, store, report = made
    return folder, Path(shutil.copytree(store, tmp_path / "copy")), report


def test_a_second_run_computes_nothing_and_a_change_one(copied, tmp_path, scheduler):
    folder, store, _ = copied
    before = {p: p.stat().st_mtime_ns for p in store.glob("??/*")}
    again = bind_all([folder], store, QUICK, scheduler=scheduler)
    assert (again.bound, again.known, again.failed) == (0, 6, 1)
    assert {p: p.stat().st_mtime_ns for p in store.glob("??/*")} == before
    other = rigs_in(tmp_path / "rigs")
    cutcell.save(other / "rig0.npz", generate("hand", 99, detail=16))
    changed = bind_all([other], store, QUICK, scheduler=scheduler)
    assert (changed.bound, changed.known) == (1, 3)


def test_a_damaged_record_is_made_again(copied, scheduler):
    folder, store, report = copied
    expected = files_of(store)
    (path,) = {row["path"] for row in report.rows if row["name"] == "rig0"}
    victim = (store / path).with_suffix(".json")
    assert victim.exists()
    victim.write_text("{")
    half = victim.parent / ".cutcell-0123456789abcdef.npz"
    half.write_bytes(b"half")
    os.utime(half, (0, 0))
    again = bind_all([folder], store, QUICK, scheduler=scheduler)
    assert again.bound == 1
    assert files_of(store) == expected
    assert not list(store.rglob(".cutcell-*"))


def test_precision_and_parameters_name_other_files(made):
    folder, _, _ = made
    content = find_sources([folder / "rig1.npz"])[0].content()
    full = bind_content(content, "k", QUICK)
    half = bind_content(content, "k", Parameters(QUICK.method, "float16"))
    assert len(half.data) < 0.7 * len(full.data)
    assert (
        len({p.digest() for p in (QUICK, Parameters(QUICK.method, "float16"), Parameters())}) == 3
    )
    with pytest.raises(ParameterError, match="precision"):
        Parameters(precision="float8")


def test_too_little_memory_is_told_before_it_is_taken(made, monkeypatch):
    folder, _, _ = made
    rig = cutcell.load(folder / "rig1.npz")

    class Asking:
        def bind(self, content, key, parameters, limit, reserve):
            reserve(memory_needed(rig, parameters))
            raise AssertionError("it was let")

    monkeypatch.setattr(binding, "available_memory", lambda: 1000)
    monkeypatch.setattr(binding, "lend_runner", lambda: nullcontext(Asking()))
    outcome = bind_isolated(Content("file", {}), "k", QUICK, 60, 1)
    assert "memory" in outcome.error
    assert outcome.record["passing"]


def test_a_second_attempt_charges_memory_once(monkeypatch):
    """A second charge would wait for the memory of the first for ever."""

    class Killed:
        def bind(self, content, key, parameters, limit, reserve):
            reserve(600)
            raise AssetLostError("it was killed", passing=True)

    monkeypatch.setattr(binding, "available_memory", lambda: int(1000 / SHARE))
    monkeypatch.setattr(binding, "lend_runner", lambda: nullcontext(Killed()))
    arguments = (Content("file", {}), "k", QUICK, 60, 1)
    thread = threading.Thread(target=binding.bind_isolated, args=arguments, daemon=True)
    thread.start()
    thread.join(10)
    assert not thread.is_alive()
    assert binding._budget.charged == 0


FAKE = """
import sys, os, time
from pickle import dump, load
def write(pipe, message):
    dump(message, pipe)
    pipe.flush()
out = os.fdopen(os.dup(1), "wb")
write(out, "ready")
while True:
    content, key, parameters = load(sys.stdin.buffer)
    write(out, 5)
    load(sys.stdin.buffer)
    if key == "hang": time.sleep(1000)
    if key == "crash": os.abort()
    if key == "exit": sys.exit("no more")
    if key == "killed": os.kill(os.getpid(), 9)
    write(out, key + " done")
"""


def test_a_crash_or_a_hang_costs_one_asset():
    runner = Runner(command=[sys.executable, "-c", FAKE])
    content = Content("file", {"a.npz": b""})

    def ask(key: str, limit: float = 60):
        return runner.bind(content, key, QUICK, limit)

    try:
        assert ask("a") == "a done"
        with pytest.raises(AssetLostError, match="crashed") as crash:
            ask("crash")
        assert not crash.value.passing
        with pytest.raises(AssetLostError, match="killed") as killed:
            ask("killed")
        assert killed.value.passing, "another try may do better"
        assert ask("b") == "b done"
        with pytest.raises(AssetLostError, match="longer than 1 seconds"):
            ask("hang", 1)
        with pytest.raises(AssetLostError, match="exit code 1: no more"):
            ask("exit")
        assert ask("c") == "c done"
    finally:
        runner.stop()


def test_a_killed_run_goes_on_to_the_same_store(made, tmp_path):
    """The command is killed with all that it started, as soon as it has written a file."""
    folder, store, _ = made
    goal = tmp_path / "store"
    options = ["--resolution", "12", "--workers", "1", "--quiet"]
    command = [sys.executable, "-m", "cutcell", "dataset", "bind", str(folder), str(goal), *options]
    process = subprocess.Popen(command, start_new_session=True)
    while process.poll() is None and not list(goal.glob("??/*.npz")):
        time.sleep(0.01)
    assert process.poll() is None, "it ended before it was killed"
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    for half in goal.rglob(".cutcell-*"):
        os.utime(half, (0, 0))
    subprocess.run(command, check=True)
    assert files_of(goal) == {k: v for k, v in files_of(store).items() if k in files_of(goal)}
    assert len(files_of(goal)) == 4
    assert not list(goal.rglob(".cutcell-*"))
    manifest = {row["name"]: row["error"] for row in Store(goal).manifest()}
    assert len(manifest) == 6
    assert (goal / "report.html").read_text().startswith("<!doctype html>")


@pytest.mark.parametrize("processes", [False, True])
def test_no_other_machine_can_reach_the_workers(processes):
    with connected(None, 1, processes):
        computed = [psutil.Process(), *psutil.Process().children(recursive=True)]
        sockets = [socket for process in computed for socket in process.net_connections("inet")]
        addresses = {s.laddr.ip for s in sockets if s.status == psutil.CONN_LISTEN}
    assert addresses <= {"127.0.0.1", "::1"}


def test_sources_of_every_kind_are_found(made, tmp_path):
    folder, store, _ = made
    rig = cutcell.load(folder / "rig3.npz")
    for name in ("obj", "rig_info"):
        (tmp_path / name).mkdir()
    cutcell.save(tmp_path / "both.txt", rig)
    (tmp_path / "both.obj").rename(tmp_path / "obj" / "7.obj")
    (tmp_path / "both.txt").rename(tmp_path / "rig_info" / "7.txt")
    cutcell_lab.dataset.export(store, tmp_path / "unirig", "unirig")
    cutcell_lab.dataset.export(store, tmp_path / "puppeteer.h5", "puppeteer")
    cutcell.save(tmp_path / "one.glb", rig)
    sources = {s.name: s for s in find_sources([tmp_path])}
    assert {s.kind for s in sources.values()} == {"file", "rignet", "unirig", "puppeteer"}
    assert {"obj/7", "unirig/rig3", "puppeteer/sample_0", "one"} <= set(sources)
    for name in ("obj/7", "unirig/rig3", "one"):
        outcome = bind_content(sources[name].content(), "k", QUICK)
        assert not outcome.error
        assert outcome.record["sizes"]["joints"] == len(rig.skeleton.joints)
    assert not bind_content(sources["puppeteer/sample_0"].content(), "k", QUICK).error


def test_faces_are_found_from_edges():
    mesh = generate("beast", 3, detail=16, clean=True).mesh
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    faces = faces_of_edges(mesh.vertices, edges)
    known = {tuple(sorted(f)) for f in mesh.faces.tolist()}
    result = {tuple(sorted(f)) for f in faces.tolist()}
    assert len(known - result) == 0
    assert len(result) < 1.02 * len(known)
    square = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    with pytest.raises(FileError, match="no triangles"):
        faces_of_edges(np.zeros((4, 3)), square)


def test_wrong_inputs_are_told(tmp_path, made, monkeypatch):
    folder, _, _ = made
    with pytest.raises(FileError, match="no such file"):
        find_sources([tmp_path / "none"])
    (tmp_path / "empty").mkdir()
    with pytest.raises(FileError, match="holds no rigs"):
        find_sources([tmp_path / "empty"])
    np.savez(tmp_path / "all.npz", [{"uuid": "a"}])
    with pytest.raises(FileError, match="split it first"):
        find_sources([tmp_path / "all.npz"])
    with pytest.raises(FileError, match="holds other files"):
        bind_all([folder], folder, QUICK)
    for key, why in (("pc", "points and no faces"), ("mesh_face", "save each")):
        (tmp_path / key).mkdir()
        with zipfile.ZipFile(tmp_path / key / "anymate.pt", "w") as archive:
            archive.writestr("anymate/data.pkl", pickle.dumps([{key: [1]}]))
        for place in (tmp_path / key, tmp_path / key / "anymate.pt"):
            with pytest.raises(FileError, match=why):
                find_sources([place])
    (tmp_path / "pc" / "anymate.pt").write_bytes(b"PK")
    with pytest.raises(FileError, match="no readable file"):
        find_sources([tmp_path / "pc"])
    monkeypatch.setattr("cutcell_lab.dataset.bind.cluster.CONNECT", "100ms")
    with pytest.raises(CutcellError, match="no Dask scheduler"):
        bind_all([folder], tmp_path / "s", QUICK, scheduler="tcp://127.0.0.1:1")
    with pytest.raises(ParameterError, match="time_limit"):
        bind_all([folder], tmp_path / "s", QUICK, time_limit=0)
    with pytest.raises(FileError, match="is no store"):
        Store(folder).manifest()


def test_the_manifest_has_hashes_times_and_memory(made):
    _, store, _ = made
    row = next(r for r in Store(store).manifest() if r["name"] == "rig0")
    for column in ("content", "key", "bytes", "seconds_graph", "memory", "version", "warnings"):
        assert row[column] is not None
    assert json.loads((store / "store.json").read_text())["method"]["resolution"] == 12


def test_a_second_call_keeps_the_rows_of_the_first(made, tmp_path, scheduler):
    folder, _, _ = made
    for name in ("rig0", "rig1"):
        report = bind_all([folder / f"{name}.npz"], tmp_path / "store", QUICK, scheduler=scheduler)
        assert [row["name"] for row in report.rows] == [name]
    store = Store(tmp_path / "store")
    assert [row["name"] for row in store.manifest()] == ["rig0", "rig1"]
    assert [name for name, _ in store.entries()] == ["rig0", "rig1"]


@pytest.mark.parametrize("size", [0, 0.5, 0.99])
def test_a_file_that_was_cut_short_is_named_and_bound_again(made, tmp_path, scheduler, size):
    folder, store, _ = made
    shutil.copytree(store, tmp_path / "store")
    row = next(r for r in Store(store).manifest() if r["name"] == "rig1")
    file, whole = tmp_path / "store" / row["path"], (store / row["path"]).read_bytes()
    file.write_bytes(whole[: int(size * len(whole))])
    with pytest.raises(cutcell.FileError, match=rf"^{file.name}: is damaged.* bind` again"):
        export(tmp_path / "store", tmp_path / "out", "rignet")
    report = bind_all([folder], tmp_path / "store", QUICK, scheduler=scheduler)
    assert report.damaged == ("rig1",)
    assert (report.bound, report.known) == (1, 5)
    write_bind_report(report, tmp_path / "report.html")
    assert file.read_bytes() == whole


@pytest.mark.parametrize("at", [0, 40, -30])
def test_a_file_with_wrong_bytes_is_named(made, tmp_path, at):
    _, store, report = made
    shutil.copytree(store, tmp_path / "store")
    row = next(r for r in report.rows if r["name"] == "rig1")
    file = tmp_path / "store" / row["path"]
    data = bytearray(file.read_bytes())
    data[at : at + 8] = b"\xff" * 8
    file.write_bytes(data)
    with pytest.raises(cutcell.FileError, match=rf"^{file.name}: is damaged"):
        export(tmp_path / "store", tmp_path / "out", "rignet")
    page = replace(report, store=tmp_path / "store")
    write_bind_report(page, tmp_path / "report.html")
    assert file.name in (tmp_path / "report.html").read_text()


def test_a_change_of_the_code_makes_the_assets_of_a_store_stale(monkeypatch):
    before = QUICK.digest()
    assert before == QUICK.digest()
    monkeypatch.setattr("cutcell_lab.dataset.read.store.source_digest", lambda *left_out: "other")
    assert QUICK.digest() != before
