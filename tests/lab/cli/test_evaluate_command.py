"""`cutcell evaluate`: files, folders, what does not match, and every kind of output."""

import json
import shutil

import numpy as np
import pytest

import cutcell
from cutcell import Rig, Skeleton, TriangleMesh
from tests.cutcell.cli.files import refused

SQUARE = [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
FACES = [[0, 1, 2], [0, 2, 3]]
REFERENCE = np.array([[1.0, 0], [0, 1], [0, 1], [1, 0]])
PREDICTED = np.array([[1.0, 0], [0.5, 0.5], [0, 1], [1, 0]])


@pytest.fixture
def save(tmp_path):
    def write(name, weights, names=("root", "tip"), joints=((0.0, 0, 0), (1, 1, 0))):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True, parents=True)
        skeleton = Skeleton(np.array(joints), [-1, 0], names)
        cutcell.save(path, Rig(TriangleMesh(SQUARE, FACES), skeleton, weights=weights))
        return path

    return write


def measured(result):
    """Return the document of a run with --json."""
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)


def test_one_file_by_hand(run, save):
    predicted, reference = save("guess.npz", PREDICTED), save("truth.glb", REFERENCE)
    document = measured(run("evaluate", predicted, reference, "--json"))
    (rig,) = document["rigs"]
    assert (rig["name"], rig["vertices"], rig["joints"]) == ("truth", 4, 2)
    assert rig["errors"]["paper"]["l1"] == pytest.approx(1 / 4)
    assert rig["errors"]["paper"]["precision"] == pytest.approx(4 / 5)
    assert rig["errors"]["unirig"]["l1"] == pytest.approx(1 / 8)
    chord = 2 * (1 - np.cos(np.pi / 6)) * 1e4
    assert rig["errors"]["paper"]["deformation"] == pytest.approx(chord * 0.5**2 / 4)
    assert document["summary"]["paper"]["l1"] == {"median": 0.25, "mean": 0.25}
    assert "0.0001" in document["definitions"]["rignet"]
    lines = [line.split() for line in run("evaluate", predicted, reference).stdout.splitlines()]
    assert ["rig", "L1", "precision", "recall", "deformation", "cm²"] in lines
    assert ["truth", "0.250", "0.800", "1.000", "167.47"] in lines
    assert ["Paper"] in lines
    assert ["RigNet"] in lines
    assert ["UniRig"] in lines
    assert not [line for line in lines if "median" in line]


def test_a_copy_has_no_error(run, save):
    path = save("rig.glb", REFERENCE)
    errors = measured(run("evaluate", path, path, "--json"))["rigs"][0]["errors"]
    for values in errors.values():
        for measure, value in values.items():
            assert value == (measure in ("precision", "recall"))


def test_the_numbers_of_compare(run, bar, tmp_path):
    rigged, again = tmp_path / "rigged.glb", tmp_path / "again.glb"
    run("bind", bar, rigged, "-r", 8)
    run("bind", rigged, again, "-r", 8, "--method", "paper")
    options = ("--methods", "cutcell", "-r", 8, "--turned", "all", "--json")
    document = run("compare", rigged, *options).stdout
    compared = json.loads(document)["rigs"][0]["scores"][0]
    errors = measured(run("evaluate", again, rigged, "--json"))["rigs"][0]["errors"]["paper"]
    for measure, value in errors.items():
        assert value == pytest.approx(compared[measure], rel=1e-4), measure  # saved in 32 bits


def test_folders_are_matched_by_name(run, save, tmp_path):
    save("guess/a.npz", PREDICTED)
    save("guess/deep/b.npz", REFERENCE)
    save("guess/lonely.npz", REFERENCE)
    save("truth/a.glb", REFERENCE)
    save("truth/other/b.glb", REFERENCE)
    save("truth/waiting.glb", REFERENCE)
    save("guess/c.npz", np.array(PREDICTED), joints=((5.0, 5, 0), (6, 5, 0)), names=("x", "y"))
    save("truth/c.glb", REFERENCE)
    folders = (tmp_path / "guess", tmp_path / "truth")
    result = run("evaluate", *folders, "--json")
    document = measured(result)
    assert [rig["name"] for rig in document["rigs"]] == ["a", "other/b"]
    assert document["summary"]["paper"]["l1"] == {"median": 0.125, "mean": 0.125}
    assert (document["predicted_only"], document["reference_only"]) == (["lonely"], ["waiting"])
    assert list(document["failed"]) == ["c"]
    assert "c.npz: 2 of its joints carry weight and match no joint" in document["failed"]["c"]
    for words in ("lonely: there is no reference", "waiting: there is no prediction", "c: c.npz"):
        assert words in result.stderr

    words = run("evaluate", *folders, "--quiet")
    assert words.stderr == ""
    assert "median" in words.stdout
    table = run("evaluate", *folders, "--markdown").stdout
    assert "| a | 0.250 | 0.800 | 1.000 | 167.47 |\n" in table
    assert "| mean | 0.125 | 0.900 | 1.000 | 83.73 |\n" in table
    assert "- waiting: there is no prediction of this name\n" in table
    assert table.endswith("\n")


def test_weights_alone_as_arrays(run, save, tmp_path):
    truth = save("truth/a.glb", REFERENCE)
    guesses = tmp_path / "guess"
    guesses.mkdir()
    array = guesses / "a.npy"
    np.save(array, np.float32(2 * PREDICTED))  # is scaled, as in files of rigs
    for paths in ((array, truth), (guesses, truth.parent)):
        errors = measured(run("evaluate", *paths, "--json"))["rigs"][0]["errors"]
        assert errors["paper"]["l1"] == pytest.approx(1 / 4)
    for wrong, words in (
        (PREDICTED[:3], "a.npy: has the shape (3, 2), but the reference has 4 vertices"),
        (-PREDICTED, "a.npy: has weights that are negative"),
        (np.array(["x"]), "a.npy: is no readable array"),
        (np.array([{}]), "a.npy: is no readable array"),
    ):
        np.save(array, wrong)
        assert words in refused(run("evaluate", array, truth))


def test_joints_of_other_names_and_order(run, save):
    truth = save("truth.glb", REFERENCE)
    options = {"names": ("bone_1", "bone_0"), "joints": ((1.0, 1, 0), (0, 0, 0))}
    other = save("other.npz", PREDICTED[:, ::-1], **options)
    result = run("evaluate", other, truth, "--json")
    assert measured(result)["rigs"][0]["errors"]["paper"]["l1"] == pytest.approx(1 / 4)
    assert "other.npz: joints matched by position, because their names differ" in result.stderr


def test_what_cannot_be_compared_is_refused(run, save, demo_paths, tmp_path):
    truth, bare = save("truth/a.glb", REFERENCE), save("bare.npz", None)
    assert "bare.npz: has no weights to evaluate" in refused(run("evaluate", bare, truth))
    assert "bare.npz: the reference has no weights" in refused(run("evaluate", truth, bare))
    larger = next(path for path in demo_paths if path.stem == "rabbit")
    words = refused(run("evaluate", larger, truth))
    assert "rabbit.glb: has " in words
    assert "the reference has 4" in words
    assert "Predict weights for the mesh of the reference" in words
    assert "no such file" in refused(run("evaluate", tmp_path / "none", truth))

    others = tmp_path / "others"
    others.mkdir()
    shutil.copy(truth, others / "b.glb")
    words = refused(run("evaluate", others, truth.parent))
    assert "no file has the name of one in" in words
    assert "It has b; the reference has a." in words
    shutil.copy(truth, truth.parent / "c.glb")
    for name in ("a", "c"):
        shutil.copy(larger, others / f"{name}.glb")
    words = refused(run("evaluate", others, truth.parent))
    assert "none of 2 rigs could be evaluated. a: a.glb: has" in words


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::ResourceWarning")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_stores_and_what_networks_are_trained_on(run, demo_paths, tmp_path):
    """A store's own weights against its artists', and RigNet's and UniRig's files of them."""
    rigs, store = tmp_path / "rigs", tmp_path / "store"
    rigs.mkdir()
    shutil.copy(next(path for path in demo_paths if path.stem == "rabbit"), rigs)
    run("dataset", "bind", rigs, store, "-r", 16, "--workers", 1)
    run("dataset", "export", store, tmp_path / "rignet", "--format", "rignet")
    run("dataset", "export", store, tmp_path / "unirig", "--format", "unirig")
    (rig,) = measured(run("evaluate", store, rigs, "--json"))["rigs"]
    assert 0.1 < rig["errors"]["paper"]["l1"] < 1.5
    (again,) = measured(run("evaluate", store, store, "--json"))["rigs"]
    assert again["errors"]["paper"] == pytest.approx(rig["errors"]["paper"], rel=1e-3)
    for name in ("rignet", "unirig"):
        (exported,) = measured(run("evaluate", tmp_path / name, rigs, "--json"))["rigs"]
        assert exported["errors"]["paper"]["l1"] < 1e-3
        assert exported["errors"]["rignet"]["mean_distance"] < 1e-4
