"""RigNet's pair of text files."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from tests.cutcell.io.gltf.test_gltf_fresh import small_rig

OBJ = """# a tetrahedron
o thing
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
vt 0 0
f 1/1 3/1 2/1
f 1 2 4
f -4 4 3
f 2 3 4
"""
RIG = """joints base 0.1 0.1 0.1
joints tip 0.2 0.6 0.1
root base
hier base tip
skin 0 base 1.0
skin 1 base 0.5 tip 0.5
skin 3 tip 3 base 1
"""


def write(folder, obj=OBJ, rig=RIG, rig_name="thing.txt"):
    (folder / "thing.obj").write_text(obj)
    if rig is not None:
        (folder / rig_name).write_text(rig)
    return folder / rig_name


@pytest.mark.parametrize("rig_name", ["thing.txt", "thing_rig.txt"])
@pytest.mark.parametrize("given", ["mesh", "rig"])
def test_loading_either_of_the_two(tmp_path, rig_name, given):
    path = write(tmp_path, rig_name=rig_name)
    rig = cutcell.load(path if given == "rig" else tmp_path / "thing.obj")
    assert rig.name == "thing"
    assert_array_equal(rig.mesh.faces, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    assert rig.skeleton.names == ("base", "tip")
    assert rig.skeleton.parents.tolist() == [-1, 0]
    assert_allclose(rig.weights, [[1, 0], [0.5, 0.5], [0, 0], [0.25, 0.75]])


def test_without_skin_lines_there_are_no_weights(tmp_path):
    rig = cutcell.load(write(tmp_path, rig=RIG.split("skin")[0]))
    assert rig.weights is None
    assert rig.skeleton.deform.all()


def test_polygons_become_fans(tmp_path):
    rig = cutcell.load(write(tmp_path, obj="v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"))
    assert_array_equal(rig.mesh.faces, [[0, 1, 2], [0, 2, 3]])


def test_saving_keeps_every_bit(tmp_path):
    rng = np.random.default_rng(0)
    rig = small_rig()
    weights = rng.random(rig.weights.shape)
    weights /= weights.sum(axis=1, keepdims=True)
    weights[4] = 0
    cutcell.save(tmp_path / "out_rig.txt", rig.with_weights(weights))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out.obj", "out_rig.txt"]
    again = cutcell.load(tmp_path / "out.obj")
    assert_array_equal(again.mesh.vertices, rig.mesh.vertices)
    assert_array_equal(again.mesh.faces, rig.mesh.faces)
    assert_array_equal(again.skeleton.joints, rig.skeleton.joints)
    assert_array_equal(again.skeleton.parents, rig.skeleton.parents)
    assert_allclose(again.weights, weights, atol=1e-15)


def test_names_with_spaces_are_joined(tmp_path):
    rig = small_rig()
    names = cutcell.Skeleton(rig.skeleton.joints, [-1, 0], ("the tip", "the_tip"))
    cutcell.save(tmp_path / "a.txt", cutcell.Rig(rig.mesh, names))
    assert cutcell.load(tmp_path / "a.txt").skeleton.names == ("the_tip", "the_tip_2")


F, M, S, W = cutcell.FileError, cutcell.MeshError, cutcell.SkeletonError, cutcell.WeightsError


@pytest.mark.parametrize(
    ("line", "kind", "message"),
    [
        ("jonts a 0 0 0", F, 'line 8: starts with "jonts"'),
        ("joints", F, "line 8: a joint needs a name"),
        ("joints a 0 0", F, "line 8: 2 numbers, expected 3"),
        ("joints a 0 0 x", F, 'line 8: "x" is not a number'),
        ("joints a 0 0 nan", F, "line 8: 0 0 nan is not finite"),
        ("joints tip 0 0 0", S, 'line 8: the joint "tip" is there twice'),
        ("root", F, "line 8: the name of a joint is missing"),
        ("hier base", F, "line 8: the name of a joint is missing"),
        ("root nobody", S, '"nobody" has no line that gives its position'),
        ("root tip", S, '"tip" is a root but hangs on "base"'),
        ("joints a 0 0 0\nhier a tip", S, 'line 9: the joint "tip" has two parents'),
        ("hier tip base\n", S, '"base" is a root but hangs on "tip"'),
        ("joints a 0 0 0\nhier a a", S, 'a cycle: "a" -> "a"'),
        ("joints a 9e9 0 0", S, None),
        ("skin 4 tip 1", W, "line 8: there is no vertex 4; the mesh has 4"),
        ("skin x tip 1", W, "line 8: there is no vertex x"),
        ("skin", W, r"line 8: there is no vertex \(missing\)"),
        ("skin 2 tip", W, "line 8: joints and weights must come in pairs"),
        ("skin 2 toe 1", W, 'line 8: there is no joint "toe"'),
        ("skin 2 tip one", F, 'line 8: "one" is not a number'),
    ],
)
def test_errors_name_file_and_line(tmp_path, line, kind, message):
    path = write(tmp_path, rig=RIG + line + "\n")
    if message is None:  # far away, but it carries no weight: that is allowed
        assert not cutcell.load(path).skeleton.deform[2]
        return
    with pytest.raises(kind, match=rf"^thing\.txt: .*{message}"):
        cutcell.load(path)


@pytest.mark.parametrize(
    ("obj", "kind", "message"),
    [
        ("", F, "the file is empty"),
        ("# nothing\n", M, "has no vertices"),
        ("v 0 0 0\n", M, "the mesh has no faces"),
        ("v 0 0\n", F, "line 1: 2 numbers, expected 3"),
        ("v 0 0 inf\n", F, "line 1: 0 0 inf is not finite"),
        ("v 0 0 0\nf 1 2\n", F, "line 2: a face needs at least 3 corners"),
        ("v 0 0 0\nf a b c\n", F, 'line 2: "a" is not a corner'),
        ("v 0 0 0\nf 0 1 1\n", F, "line 2: vertex 0 is out of range"),
        ("v 0 0 0\nf -2 1 1\n", F, "line 2: vertex -2 is out of range"),
        ("v 0 0 0\nv 1 0 0\nf 1 2 9\n", M, "only 2"),
    ],
)
def test_errors_in_the_mesh_name_the_mesh(tmp_path, obj, kind, message):
    with pytest.raises(kind, match=rf"^thing\.obj: .*{message}"):
        cutcell.load(write(tmp_path, obj=obj))


def test_a_rig_without_its_mesh(tmp_path):
    (tmp_path / "a_rig.txt").write_text(RIG)
    with pytest.raises(F, match=r"a_rig\.txt: .* put a\.obj or a_rig\.obj beside it"):
        cutcell.load(tmp_path / "a_rig.txt")


def test_no_joints_at_all(tmp_path):
    with pytest.raises(S, match=r"thing\.txt: has no joints"):
        cutcell.load(write(tmp_path, rig="# empty\n"))
