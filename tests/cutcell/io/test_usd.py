"""USD with UsdSkel: the column as text, as a crate, and in a package."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from pxr import Usd, UsdUtils

import cutcell
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES, REST, SHARES
from tests.gltf_validator.validator import errors, reports

TEXT = """#usda 1.0
(
    defaultPrim = "Character"
    metersPerUnit = %(unit)s
    upAxis = "%(up)s"
    timeCodesPerSecond = 24
)
def SkelRoot "Character" (%(more)s)
{
    def Skeleton "Armature" (prepend apiSchemas = ["SkelBindingAPI"])
    {
        uniform token[] joints = ["root", "root/tip"]
        uniform matrix4d[] bindTransforms = [%(root)s, %(tip)s]
        uniform matrix4d[] restTransforms = [%(root)s, %(up_one)s]
        rel skel:animationSource = </Character/bow>
    }
    def SkelAnimation "bow"
    {
        uniform token[] joints = ["root/tip"]
        float3[] translations.timeSamples = { 0: [(0, 1, 0)], 24: [(0, 1, 0)] }
        quatf[] rotations.timeSamples = { 0: [(1, 0, 0, 0)], 24: [(0.7071068, 0.7071068, 0, 0)] }
        half3[] scales.timeSamples = { 0: [(1, 1, 1)], 24: [(1, 1, 1)] }
    }
    def Mesh "body" (prepend apiSchemas = ["SkelBindingAPI"])
    {
        point3f[] points = [%(points)s]
        int[] faceVertexCounts = [%(counts)s]
        int[] faceVertexIndices = [%(corners)s]
        matrix4d primvars:skel:geomBindTransform = %(place)s
        int[] primvars:skel:jointIndices = [%(joints)s] (
            elementSize = 2
            interpolation = "vertex"
        )
        float[] primvars:skel:jointWeights = [%(shares)s] (
            elementSize = 2
            interpolation = "vertex"
        )
        rel skel:skeleton = </Character/Armature>
        token visibility = "%(visibility)s"
    }
    def Mesh "floor"
    {
        point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)]
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
    }
}
"""


def moved(x, y, z):
    return f"( (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), ({x}, {y}, {z}, 1) )"


def text(**changes):
    """Return the column as USD text."""
    result = {
        "unit": 0.01,
        "up": "Y",
        "more": "",
        "root": moved(*REST[0]),
        "tip": moved(*REST[1]),
        "up_one": moved(0, 1, 0),
        "points": ", ".join(str(tuple(p)) for p in COLUMN.tolist()),
        "counts": ", ".join(["3"] * len(FACES)),
        "corners": ", ".join(map(str, FACES.ravel().tolist())),
        "place": moved(0, 0, 0),
        "joints": ", ".join(["0, 1"] * 12),
        "shares": ", ".join(map(str, SHARES[:, :2].ravel().tolist())),
        "visibility": "inherited",
    }
    return TEXT % (result | changes)


@pytest.fixture
def load(tmp_path):
    def loaded(content, name="column.usda"):
        (tmp_path / name).write_text(content)
        return cutcell.load(tmp_path / name)

    return loaded


def check(rig):
    assert_allclose(rig.mesh.vertices, COLUMN, atol=1e-6)
    assert_array_equal(rig.mesh.faces, FACES)
    assert_allclose(rig.skeleton.joints, REST, atol=1e-6)
    assert_allclose(rig.weights, SHARES[:, :2], atol=1e-6)
    assert_allclose(rig.skeleton.orientations, np.tile(np.eye(3), (2, 1, 1)), atol=1e-6)
    assert rig.skeleton.names == ("root", "tip")
    assert rig.skeleton.parents.tolist() == [-1, 0]
    assert [part.name for part in rig.parts] == ["body"]
    assert [(out.name, out.why) for out in rig.left_out] == [
        ("floor", "has no skin and hangs on no joint")
    ]
    (clip,) = rig.clips
    assert clip.name == "bow"
    assert clip.duration == pytest.approx(1)
    assert_allclose(clip.transforms[-1][1, :3, :3], [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-6)


@pytest.mark.parametrize("end", [".usda", ".usd", ".usdc", ".usdz"])
def test_every_container_gives_the_same_rig(load, tmp_path, end):
    rig = load(text())
    if end != ".usda":
        Usd.Stage.Open(str(tmp_path / "column.usda")).Export(str(tmp_path / "out.usdc"))
        path = tmp_path / "out.usdc"
        if end == ".usdz":
            path = tmp_path / "out.usdz"
            assert UsdUtils.CreateNewUsdzPackage(str(tmp_path / "out.usdc"), str(path))
        rig = cutcell.load(path.rename(tmp_path / f"rig{end}"))
    check(rig)
    assert_allclose(rig.world, np.diag([0.01, 0.01, 0.01, 1]), atol=1e-9)
    assert rig.warnings[0].startswith("of a USD, the meshes, skeletons, weights and motion are")


def test_the_axis_that_is_up_and_the_unit_lead_to_the_scene(load):
    rig = load(text(up="Z", unit=1))
    check(rig)
    x, y, z = COLUMN.T
    scene = COLUMN @ rig.world[:3, :3].T + rig.world[:3, 3]
    assert_allclose(scene, np.stack([x, z, -y], axis=1), atol=1e-6)


def test_a_mesh_bound_off_its_place_comes_to_its_joints(load):
    rig = load(text(place=moved(0, 0, 3)))
    assert_allclose(rig.skeleton.joints, REST - [0, 0, 3], atol=1e-6)


def test_hidden_meshes_are_told(load):
    assert load(text(visibility="invisible")).parts[0].hidden


def test_saved_as_a_glb_that_loads_again(load, tmp_path):
    rig = load(text())
    cutcell.save(tmp_path / "out.glb", rig)
    again = cutcell.load(tmp_path / "out.glb")
    assert_allclose(again.weights, rig.weights, atol=1e-6)
    assert_allclose(again.skeleton.joints, rig.skeleton.joints, atol=1e-6)
    (report,) = reports(tmp_path / "out.glb")
    assert not errors(report)
    with pytest.raises(cutcell.FileError, match=r'^out\.usda: a rig cannot be saved as "\.usda"'):
        cutcell.save(tmp_path / "out.usda", rig)


def test_meshes_that_follow_no_skeleton_are_bound_to_its_joints(load):
    rig = load(text().replace("rel skel:skeleton", "rel other:skeleton"))
    assert rig.skeleton.names == ("root", "tip")
    assert_allclose(rig.skeleton.joints, REST, atol=1e-6)
    assert rig.weights is None


def test_a_mesh_without_a_skeleton_loads(load):
    without = text().replace("rel skel:skeleton", "rel other:skeleton")
    rig = load(without.replace("def Skeleton", "def Scope"))
    assert rig.skeleton.joints.shape == (0, 3)
    assert {part.name for part in rig.parts} == {"body", "floor"}


@pytest.mark.isolated
class TestDamage:
    @pytest.mark.parametrize(
        ("content", "message"),
        [
            (text()[:900], "cannot be read as USD: it is damaged"),
            ("this is a letter", "cannot be read as USD: it is damaged"),
            ("", "the file is empty"),
            (text(joints=", ".join(["0, 7"] * 12)), "weighted to joints out of range"),
            (text(corners="0, 1, 2"), "body lacks corners"),
            (text(corners=", ".join(["99"] * FACES.size)), 'mesh "body": a face uses a vertex'),
            (text(up_one=moved("nan", 0, 0)), 'node "tip" has a place, turn or scale that is not'),
            ('#usda 1.0\ndef Xform "nothing"\n{\n}\n', "has no mesh"),
        ],
    )
    def test_is_a_sentence(self, load, content, message):
        with pytest.raises(cutcell.CutcellError, match=rf"^column\.usda: .*{message}"):
            load(content)

    def test_a_crate_cut_short(self, load, tmp_path):
        load(text())
        Usd.Stage.Open(str(tmp_path / "column.usda")).Export(str(tmp_path / "out.usdc"))
        data = (tmp_path / "out.usdc").read_bytes()
        (tmp_path / "cut.usdc").write_bytes(data[: len(data) // 2])
        with pytest.raises(cutcell.FileError, match=r"^cut\.usdc: cannot be read as USD"):
            cutcell.load(tmp_path / "cut.usdc")

    def test_other_folders_are_not_reached(self, load, tmp_path):
        (tmp_path / "secret").mkdir()
        (tmp_path / "secret" / "own.usda").write_text(text())
        inner = tmp_path / "public"
        inner.mkdir()
        content = text(more=f"prepend references = @{tmp_path}/secret/own.usda@</Character>")
        (inner / "a.usda").write_text(content)
        with pytest.raises(cutcell.FileError, match=r"^a\.usda: .*file outside of its folder"):
            cutcell.load(inner / "a.usda")


@pytest.mark.isolated
def test_without_the_library_it_says_what_to_install(load, tmp_path, monkeypatch):
    (tmp_path / "pxr.py").write_text("raise ModuleNotFoundError(name='pxr')")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(
        cutcell.FileError,
        match=r"^column\.usda: .*pxr is not installed; try: pip install 'cutcell\[usd\]'",
    ):
        load(text())


def test_a_mesh_bound_in_a_place_that_is_too_large_is_refused(load):
    place = "( (1e160, 0, 0, 0), (0, 1e160, 0, 0), (0, 0, 1e160, 0), (0, 0, 0, 1) )"
    with pytest.raises(cutcell.SkeletonError, match=r"^column\.usda: .* cannot be inverted"):
        load(text(place=place))


IDENTITY = moved(0, 0, 0)
FLAT = "( (1, 0, 0, 0), (0, 0, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1) )"


def with_end(bind, **changes):
    """Return the column with a third joint one above the tip, which holds nothing."""
    content = text(**changes).replace('"root/tip"]\n        uniform matrix4d[] bind', "BIND")
    content = content.replace(
        "BIND", '"root/tip", "root/tip/end"]\n        uniform matrix4d[] bind'
    )
    content = content.replace(moved(*REST[1]) + "]", f"{moved(*REST[1])}, {bind}]")
    return content.replace(moved(0, 1, 0) + "]", f"{moved(0, 1, 0)}, {moved(0, 1, 0)}]")


@pytest.mark.parametrize("bind", [IDENTITY, FLAT])
@pytest.mark.parametrize("place", [IDENTITY, moved(0, 0, 3)])
def test_a_joint_whose_bind_contradicts_its_rest_stands_at_its_rest(load, tmp_path, bind, place):
    rig = load(with_end(bind, place=place))
    offset = [0, 0, 3] if place != IDENTITY else [0, 0, 0]
    places = np.array([*REST, REST[1] + [0, 1, 0]]) - offset
    assert_allclose(rig.skeleton.joints, places, atol=1e-6)
    assert sum('"end"' in warning for warning in rig.warnings) == 1
    cutcell.save(tmp_path / "out.glb", rig)
    again = cutcell.load(tmp_path / "out.glb")
    assert_allclose(again.skeleton.joints, places, atol=1e-6)
    assert not any('"end"' in warning for warning in again.warnings)


def test_a_joint_with_a_good_bind_stands_there(load):
    rig = load(with_end(moved(*REST[1] + [0, 1.5, 0])))
    assert_allclose(rig.skeleton.joints[2], REST[1] + [0, 1.5, 0], atol=1e-6)


def test_a_joint_that_holds_vertices_and_cannot_be_bound_is_refused(load):
    with pytest.raises(cutcell.SkeletonError, match='"tip" cannot be inverted'):
        load(text(tip=FLAT))


BIG = {
    "root": moved(*100 * REST[0]),
    "tip": moved(*100 * REST[1]),
    "up_one": moved(0, 100, 0),
    "place": "( (100, 0, 0, 0), (0, 100, 0, 0), (0, 0, 100, 0), (0, 0, 0, 1) )",
    "unit": 1,
}
"""Joints in centimetres, and a mesh in metres that its bind transform brings to them."""
SMALL = """{
    matrix4d xformOp:transform = ( (0.01, 0, 0, 0), (0, 0.01, 0, 0), (0, 0, 0.01, 0), (0, 0, 0, 1) )
    uniform token[] xformOpOrder = ["xformOp:transform"]
"""


@pytest.mark.parametrize("is_applied", [True, False])
@pytest.mark.parametrize("owner", ["Skeleton", "SkelRoot", "Mesh"])
def test_a_bind_transform_that_scales_places_mesh_and_joints_alike(load, owner, is_applied):
    content = text(**BIG).replace("(0, 1, 0)]", "(0, 100, 0)]")
    head, rest = content.split(f"def {owner} ", 1)
    content = f"{head}def {owner} {rest.replace('{', SMALL, 1)}"
    if not is_applied:
        content = content.replace('(prepend apiSchemas = ["SkelBindingAPI"])', "")
    rig = load(content)
    check(rig)
    assert_allclose(rig.world, np.diag([100, 100, 100, 1] if owner == "Mesh" else np.ones(4)))


def test_a_bind_transform_places_a_mesh_that_follows_no_skeleton(load):
    rig = load(text(**BIG).replace("rel skel:skeleton", "rel other:skeleton"))
    assert_allclose(rig.mesh.vertices[:12], COLUMN, atol=1e-6)  # the floor follows
    assert_allclose(rig.skeleton.joints, REST, atol=1e-6)


@pytest.mark.parametrize("purpose", ["proxy", "guide", "render", "default"])
def test_meshes_for_other_purposes_are_left_out_and_told(load, purpose):
    owner = 'def Mesh "floor"\n    {'
    rig = load(text().replace(owner, f'{owner}\n        token purpose = "{purpose}"'))
    is_out = purpose in ("proxy", "guide")
    assert len(rig.left_out) == (not is_out)
    assert sum("proxy" in w and "floor" in w for w in rig.warnings) == is_out
    owner = 'def SkelRoot "Character" ()\n{'
    content = text().replace(owner, f'{owner}\n    token purpose = "{purpose}"')
    if is_out:
        with pytest.raises(cutcell.FileError, match=r"has no mesh, but a skeleton.*body"):
            load(content)
    else:
        check(load(content))


def test_what_of_a_skin_is_not_read_is_listed_once(load):
    shapes = """
        uniform token primvars:skel:skinningMethod = "dualQuaternion"
        uniform token[] skel:blendShapes = ["smile"]
        rel skel:blendShapeTargets = </Character/body/smile>
        def BlendShape "smile"
        {
            uniform vector3f[] offsets = [(0, 0, 1)]
            uniform int[] pointIndices = [0]
        }
    """
    rig = load(text().replace("token visibility", f"{shapes}\n        token visibility"))
    check(rig)
    for part in ("morph targets", "dual-quaternion skinning"):
        assert sum(f"{part} (body)" in w for w in rig.warnings) == 1
