"""Base colours of USD: UsdPreviewSurface and displayColor, images beside and in packages."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from pxr import Sdf, Usd, UsdGeom, UsdShade, UsdUtils, Vt

import cutcell
from cutcell.io.materials.face_colors import BLENDED, Layer
from cutcell.io.materials.transfer import has_materials, read_materials
from cutcell.runtime.colors import srgb
from tests.cutcell.io.gltf.gltf_builder import FACES
from tests.cutcell.io.materials.test_gltf_colored import SKIN_PNG, check_same
from tests.cutcell.io.test_usd import text

UV = np.random.default_rng(9).uniform(0, 1, (3 * len(FACES), 2)).round(3)
IN_IMAGE = np.stack([UV[:, 0], 1 - UV[:, 1]], axis=1).reshape(-1, 3, 2)
RED = (0.5, 0, 0)


class Painted:
    """A stage of the column that gets materials."""

    def __init__(self, path):
        path.write_text(text())
        self.path = path
        self.stage = Usd.Stage.Open(str(path))
        self.body = self.stage.GetPrimAtPath("/Character/body")

    def material(self, name, color=RED, file=None, opacity=None):
        """Return a material, with an image if there is a file."""
        material = UsdShade.Material.Define(self.stage, f"/Character/{name}")
        shader = UsdShade.Shader.Define(self.stage, f"/Character/{name}/shader")
        shader.CreateIdAttr("UsdPreviewSurface")
        diffuse = shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f)
        diffuse.Set(color)
        if opacity is not None:
            shader.CreateInput("opacity", Sdf.ValueTypeNames.Float).Set(opacity)
        if file is not None:
            reader = UsdShade.Shader.Define(self.stage, f"/Character/{name}/reader")
            reader.CreateIdAttr("UsdPrimvarReader_float2")
            reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("map")
            texture = UsdShade.Shader.Define(self.stage, f"/Character/{name}/texture")
            texture.CreateIdAttr("UsdUVTexture")
            texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(file)
            texture.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(
                reader.ConnectableAPI(), "result"
            )
            diffuse.ConnectToSource(texture.ConnectableAPI(), "rgb")
        material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
        return material

    def bind(self, material, faces=None):
        """Let all faces, or some, have a material."""
        api = UsdShade.MaterialBindingAPI.Apply(self.body)
        if faces is not None:
            subset = api.CreateMaterialBindSubset("some", Vt.IntArray(faces))
            api = UsdShade.MaterialBindingAPI.Apply(subset.GetPrim())
        api.Bind(material)

    def primvar(self, name, kind, how, values):
        primvars = UsdGeom.PrimvarsAPI(self.body)
        primvars.CreatePrimvar(name, kind, how).Set(values)

    def load(self):
        self.stage.Save()
        return cutcell.load(self.path)


@pytest.fixture
def painted(tmp_path):
    painted = Painted(tmp_path / "column.usda")
    painted.primvar("map", Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying", UV.tolist())
    return painted


def test_faces_have_materials_by_mesh_and_subset(painted):
    painted.bind(painted.material("red"))
    painted.bind(painted.material("blue", (0, 0, 1), opacity=0.5), [1, 3])
    rig = painted.load()
    assert has_materials(rig)
    body = read_materials(rig).body
    some = np.isin(np.arange(len(FACES)), [1, 3])
    assert (body.tints[~some] == srgb(RED)).all()
    assert (body.tints[some] == (0, 0, 255)).all()
    assert (body.opacity[some] == 128).all()
    assert (body.corners[some][..., 3] == BLENDED).all()


def test_an_image_beside(painted, tmp_path):
    (tmp_path / "skin.png").write_bytes(b"an image")
    painted.bind(painted.material("skin", file="./skin.png"))
    result = read_materials(painted.load())
    assert result.notes == ()
    assert [(one.name, one.content) for one in result.images] == [('image "skin.png"', b"an image")]
    assert result.layers == (Layer(0, color=(255, 255, 255)),)
    assert_allclose(result.body.corners[..., :2], IN_IMAGE, atol=1e-6)


def test_an_image_in_a_package(painted, tmp_path):
    (tmp_path / "skin.png").write_bytes(b"an image")
    painted.bind(painted.material("skin", file="./skin.png"))
    painted.stage.Save()
    package = tmp_path / "packed" / "column.usdz"
    package.parent.mkdir()
    assert UsdUtils.CreateNewUsdzPackage(str(painted.path), str(package))
    result = read_materials(cutcell.load(package))
    assert [one.content for one in result.images] == [b"an image"]


@pytest.mark.parametrize("file", ["../secret.png", "/etc/hostname", "missing.png"])
def test_no_image_is_read_from_elsewhere(painted, tmp_path, file):
    (tmp_path.parent / "secret.png").write_bytes(b"of somebody else")
    painted.bind(painted.material("skin", file=file))
    result = read_materials(painted.load())
    assert result.images == ()
    assert "is not in the folder of column.usda" in result.notes[0]


def test_colours_to_be_displayed(painted):
    colors = np.random.default_rng(4).uniform(0, 1, (12, 3)).round(2)
    painted.primvar("displayColor", Sdf.ValueTypeNames.Color3fArray, "vertex", colors.tolist())
    rig = painted.load()
    assert has_materials(rig)
    assert_array_equal(read_materials(rig).body.tints, srgb(colors)[FACES])


def test_without_any_there_is_nothing_to_see(painted):
    assert not has_materials(painted.load())


def test_what_is_saved_has_them_too(painted, tmp_path):
    (tmp_path / "skin.png").write_bytes(SKIN_PNG)
    painted.bind(painted.material("skin", file="./skin.png"))
    painted.bind(painted.material("blue", (0, 0, 1), opacity=0.5), [1, 3])
    rig = painted.load()
    cutcell.save(tmp_path / "out.glb", rig)
    some = np.isin(np.arange(len(FACES)), [1, 3])
    order = np.argsort(some, kind="stable")
    result = check_same(rig, cutcell.load(tmp_path / "out.glb"), order)
    assert result.names == ("skin", "blue")
