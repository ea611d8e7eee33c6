"""Articulation-XL 2.0 archives."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES, REST, SHARES
from tests.cutcell.io.gltf.test_gltf_fresh import small_rig

ROWS, COLUMNS = np.nonzero(SHARES[:, :2])


def arrays(**changed):
    """Return the arrays of the column's archive; None leaves one out."""
    whole = {
        "vertices": COLUMN,
        "faces": FACES,
        "joints": REST,
        "bones": np.array([[0, 1]]),
        "root_index": np.array(0),
        "joint_names": np.array(["root", "tip"]),
        "skinning_weights_value": SHARES[ROWS, COLUMNS],
        "skinning_weights_row": ROWS,
        "skinning_weights_col": COLUMNS,
        "skinning_weights_shape": np.array([12, 2]),
    }
    return {k: v for k, v in {**whole, **changed}.items() if v is not None}


def write(tmp_path, **changed):
    np.savez(tmp_path / "one.npz", **arrays(**changed))
    return tmp_path / "one.npz"


def test_loading(tmp_path):
    rig = cutcell.load(write(tmp_path))
    assert_allclose(rig.mesh.vertices, COLUMN)
    assert_array_equal(rig.mesh.faces, FACES)
    assert_allclose(rig.skeleton.joints, REST)
    assert rig.skeleton.parents.tolist() == [-1, 0]
    assert rig.skeleton.names == ("root", "tip")
    assert_allclose(rig.weights, SHARES[:, :2])


def test_the_plural_names_and_no_names(tmp_path):
    names = {
        "skinning_weights_rows": ROWS,
        "skinning_weights_cols": COLUMNS,
        "skinning_weights_row": None,
        "skinning_weights_col": None,
        "joint_names": None,
        "root_index": None,
        "skinning_weights_shape": None,
    }
    rig = cutcell.load(write(tmp_path, **names))
    assert_allclose(rig.weights, SHARES[:, :2])
    assert rig.skeleton.names == ("joint 0", "joint 1")


def test_without_weights(tmp_path):
    assert cutcell.load(write(tmp_path, skinning_weights_value=None)).weights is None


def test_saving_keeps_every_bit(tmp_path):
    rig = small_rig()
    weights = rig.weights.copy()
    weights[3] = 0
    cutcell.save(tmp_path / "out.npz", rig.with_weights(weights))
    again = cutcell.load(tmp_path / "out.npz")
    assert_array_equal(again.mesh.vertices, rig.mesh.vertices)
    assert_array_equal(again.mesh.faces, rig.mesh.faces)
    assert_array_equal(again.skeleton.joints, rig.skeleton.joints)
    assert_array_equal(again.skeleton.parents, rig.skeleton.parents)
    assert again.skeleton.names == rig.skeleton.names
    assert_allclose(again.weights, weights, atol=1e-15)
    cutcell.save(tmp_path / "bare.npz", rig.with_weights(None))
    assert cutcell.load(tmp_path / "bare.npz").weights is None


F, M, S, W = cutcell.FileError, cutcell.MeshError, cutcell.SkeletonError, cutcell.WeightsError


@pytest.mark.parametrize(
    ("changed", "kind", "message"),
    [
        ({"bones": None, "faces": None}, F, "lacks faces, bones"),
        ({"joint_names": np.array(["a", None], object)}, F, "pickled Python objects"),
        ({"vertices": np.full((12, 3), np.nan)}, M, "vertex 0 has a coordinate"),
        ({"faces": FACES + 1}, M, "only 12"),
        ({"joints": REST[:, :2]}, S, "joints has the shape"),
        ({"joints": np.array(1.0)}, S, "joints has the shape"),
        ({"bones": np.array([[0, 2]])}, S, "bones must be pairs of joint numbers, 0 to 1"),
        ({"bones": np.array([[0.0, 1.0]])}, S, "bones must be pairs"),
        ({"bones": np.array([0, 1, 0])}, S, "bones must be pairs"),
        ({"bones": np.array([[0, 1], [1, 0]])}, S, "joint 0 is the root but hangs on joint 1"),
        ({"bones": np.array([[0, 1], [1, 0]]), "root_index": None}, S, "cycle"),
        (
            {
                "joints": np.zeros((3, 3)),
                "bones": np.array([[0, 1], [2, 1]]),
                "skinning_weights_value": None,
            },
            S,
            "joint 1 hangs on two joints, 0 and 2",
        ),
        ({"root_index": np.array([5])}, S, "root_index must be one joint number"),
        ({"joint_names": np.array(["one"])}, S, "joint_names must be 2 texts"),
        ({"joint_names": np.array([1, 2])}, S, "joint_names must be 2 texts"),
        ({"skinning_weights_row": None}, F, "no skinning_weights_row"),
        ({"skinning_weights_row": ROWS * 1.5}, W, "must be numbers"),
        ({"skinning_weights_row": ROWS[1:]}, W, "rows and"),
        ({"skinning_weights_row": ROWS + 1}, W, "lies outside of 12 vertices and 2 joints"),
        ({"skinning_weights_shape": np.array([2, 12])}, W, r"are \[2, 12\], but the mesh has 12"),
    ],
)
def test_errors_name_the_file(tmp_path, changed, kind, message):
    with pytest.raises(kind, match=rf"^one\.npz: .*{message}"):
        cutcell.load(write(tmp_path, **changed))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"no archive", "is not a readable npz archive|pickled"),
        (b"PK\x03\x04 half an archive", "is not a readable npz archive"),
        (b"\x80\x04K\x01.", "is not a readable npz archive"),
    ],
)
def test_what_is_no_archive(tmp_path, content, message):
    (tmp_path / "one.npz").write_bytes(content)
    with pytest.raises(F, match=message):
        cutcell.load(tmp_path / "one.npz")


def test_a_single_array_is_no_archive(tmp_path):
    np.save(tmp_path / "one.npy", REST)
    (tmp_path / "one.npy").rename(tmp_path / "one.npz")
    with pytest.raises(F, match=r"one\.npz: is a single array"):
        cutcell.load(tmp_path / "one.npz")


@settings(
    max_examples=200,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(data=st.data())
def test_damaged_archives_never_escape_as_anything_else(tmp_path, data):
    content = bytearray(write(tmp_path).read_bytes())
    for _ in range(data.draw(st.integers(1, 6))):
        content[data.draw(st.integers(0, len(content) - 1))] ^= data.draw(st.integers(1, 255))
    (tmp_path / "bad.npz").write_bytes(content[: data.draw(st.integers(0, len(content)))])
    try:
        cutcell.load(tmp_path / "bad.npz")
    except cutcell.CutcellError as error:
        message = str(error)
    else:
        return
    assert "bad.npz" in message


def test_triangles_that_16_bits_collapse_are_counted(tmp_path):
    aside = np.array([4000.0, 0, 0])  # float16 has steps of 2 there
    vertices = (COLUMN + aside).astype(np.float16)
    rig = cutcell.load(write(tmp_path, vertices=vertices, joints=REST + aside))
    collapsed = int((~rig.mesh.welded.is_whole).sum())
    assert collapsed > 0
    (warning,) = [text for text in rig.warnings if "16" in text]
    assert warning.startswith(f"{collapsed} of {len(FACES)} ")
    whole = cutcell.load(write(tmp_path, vertices=COLUMN.astype(np.float16)))
    assert not [text for text in whole.warnings if "16" in text]
