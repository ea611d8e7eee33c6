"""Normals and texture coordinates of FBX, USD and OBJ in the saved GLB, by another reader."""

import json
import struct
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from pxr import Sdf, Usd, UsdGeom
from scipy.spatial import KDTree

import cutcell
from cutcell.io.gltf.write.faces import with_faces
from tests.cutcell.io.fbx_builder import (
    MESH,
    TIP,
    binary,
    column_scene,
    layer,
    model,
    record,
    text,
    vector,
    with_materials,
)
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES
from tests.cutcell.io.test_usd import text as usd_text
from tests.gltf_validator.validator import errors, reports

TOLERANCE = 1e-5
RNG = np.random.default_rng(4)
UV = RNG.uniform(-1, 2, (len(FACES), 3, 2)).round(4)
HARD = np.cross(
    COLUMN[FACES[:, 1]] - COLUMN[FACES[:, 0]], COLUMN[FACES[:, 2]] - COLUMN[FACES[:, 0]]
)
HARD = np.repeat((HARD / np.linalg.norm(HARD, axis=1, keepdims=True))[:, None], 3, axis=1)
SMOOTH = RNG.normal(size=COLUMN.shape)
SMOOTH /= np.linalg.norm(SMOOTH, axis=1, keepdims=True)


def primitives(path):
    """Read a GLB by its bytes: the attributes of the corners of each primitive, by mesh name."""
    data = path.read_bytes()
    (size,) = struct.unpack_from("<I", data, 12)
    document, content = json.loads(data[20 : 20 + size]), data[28 + size :]

    def read(number):
        accessor = document["accessors"][number]
        view = document["bufferViews"][accessor["bufferView"]]
        kind = {5126: "<f4", 5125: "<u4", 5123: "<u2", 5121: "u1"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        step = view.get("byteStride", width * np.dtype(kind).itemsize)
        rows = np.ndarray((accessor["count"], width), kind, content, start, (step, int(kind[-1])))
        return rows.astype(float) if kind == "<f4" else rows

    for mesh in document["meshes"]:
        for one in mesh["primitives"]:
            at = read(one["indices"])[:, 0]
            yield mesh["name"], {name: read(k)[at] for name, k in one["attributes"].items()}


def saved(folder, rig):
    """Save a rig, bound if need be, and read its corners: by mesh name, attributes of corners."""
    if rig.weights is None:
        skeleton = cutcell.Skeleton(rig.mesh.bounds, [-1, 0], ("root", "tip"))
        weights = np.tile([1.0, 0.0], (len(rig.mesh.vertices), 1))
        rig = replace(rig, skeleton=skeleton, weights=weights)
    cutcell.save(folder / "out.glb", rig)
    (report,) = reports(folder / "out.glb")
    assert not errors(report)
    meshes = {}
    for name, result in primitives(folder / "out.glb"):
        meshes.setdefault(name, []).append(result)
    return {
        name: {key: np.concatenate([one[key] for one in parts]) for key in parts[0]}
        for name, parts in meshes.items()
    }


def check(corners, points, normals, uv):
    """Check that the corners of a GLB are those of a file, whose v goes up; shapes (k, ...)."""
    down = np.stack([uv[:, 0], 1 - uv[:, 1]], axis=1)
    expected = np.concatenate([points, normals, down], axis=1)
    stored = np.concatenate([corners[n] for n in ("POSITION", "NORMAL", "TEXCOORD_0")], axis=1)
    assert KDTree(expected).query(stored)[0].max() < TOLERANCE
    assert KDTree(stored).query(expected)[0].max() < TOLERANCE
    assert_allclose(np.linalg.norm(corners["NORMAL"], axis=1), 1, atol=1e-5)


def flat(values):
    return np.asarray(values).reshape(-1, np.shape(values)[-1])


BY_NORMALS = {"hard": HARD, "smooth": SMOOTH[FACES]}
MATERIALS = {
    "none": {},
    "colour": {"materials": [([vector("DiffuseColor", (1, 0, 0))], None)]},
    "no image there": {"materials": [([], {"file": "gone.png"})]},
}


class TestFbx:
    def load(self, folder, scene, write=binary):
        (folder / "a.fbx").write_bytes(write(scene))
        return cutcell.load(folder / "a.fbx")

    def layered(self, normals=None, how="ByPolygonVertex", mesh=(), uv=UV, materials=(), **given):
        elements = [] if normals is None else [normal_layer(normals, how)]
        return with_materials(column_scene(mesh=[*mesh, *elements], curves=False, **given), uv,
                              materials=materials)  # fmt: skip

    @pytest.mark.parametrize("write", [binary, text])
    @pytest.mark.parametrize("kind", BY_NORMALS)
    @pytest.mark.parametrize("material", MATERIALS)
    def test_of_corners(self, tmp_path, write, kind, material):
        scene = self.layered(BY_NORMALS[kind], **MATERIALS[material])
        rig = self.load(tmp_path, scene, write)
        assert len(rig.mesh.vertices) == len(COLUMN), "the file's own vertices"
        (corners,) = saved(tmp_path, rig).values()
        check(corners, COLUMN[FACES.ravel()], flat(BY_NORMALS[kind]), flat(UV))
        again = cutcell.load(tmp_path / "out.glb")
        order = KDTree(again.mesh.vertices).query(rig.mesh.vertices)[1]
        assert_allclose(again.weights[order], rig.weights, atol=1e-6)

    @pytest.mark.parametrize(("how", "values"), [
        ("ByVertice", SMOOTH), ("ByPolygon", HARD[:, 0]), ("ByPolygonVertex", 7 * HARD),
    ])  # fmt: skip
    def test_of_other_mappings_and_lengths(self, tmp_path, how, values):
        rig = self.load(tmp_path, self.layered(values, how))
        (corners,) = saved(tmp_path, rig).values()
        expected = SMOOTH[FACES] if how == "ByVertice" else HARD
        check(corners, COLUMN[FACES.ravel()], flat(expected), flat(UV))

    def test_of_a_mesh_without_a_skin_that_its_node_scales_and_mirrors(self, tmp_path):
        node = [vector("Lcl Scaling", (-1, 2, 0.5)), vector("Lcl Rotation", (30, 40, 50))]
        head, objects, connections = self.layered(HARD, node=node)
        geometry, body = objects[2][:2]
        materials = [link for link in connections[2] if link[1][1:] in ((MESH, 0), (100, MESH))]
        scene = [head, record("Objects", children=[geometry, body]),
                 record("Connections", children=materials)]  # fmt: skip
        rig = self.load(tmp_path, scene)
        (corners,) = saved(tmp_path, rig).values()
        positions = corners["POSITION"].reshape(-1, 3, 3)
        facing = np.cross(positions[:, 1] - positions[:, 0], positions[:, 2] - positions[:, 0])
        facing /= np.linalg.norm(facing, axis=1, keepdims=True)
        assert_allclose(
            corners["NORMAL"].reshape(-1, 3, 3), facing[:, None].repeat(3, 1), atol=1e-4
        )

    def test_of_what_hangs_on_a_joint(self, tmp_path):
        head, objects, connections = self.layered(HARD)
        name, (_, *rest), below = objects[2][0]
        sword = [(name, (700, *rest), below), model(701, "sword", "Mesh", ())]
        links = [record("C", "OO", *pair) for pair in ((700, 701), (701, TIP))]
        scene = [head, record("Objects", children=[*objects[2], *sword]),
                 record("Connections", children=[*connections[2], *links])]  # fmt: skip
        for corners in saved(tmp_path, self.load(tmp_path, scene)).values():
            check(corners, COLUMN[FACES.ravel()], flat(HARD), flat(UV))

    def test_without_any_nothing_is_made_up(self, tmp_path):
        rig = self.load(tmp_path, column_scene(curves=False))
        (corners,) = saved(tmp_path, rig).values()
        assert not corners.keys() & {"NORMAL", "TEXCOORD_0"}

    def test_normals_without_a_direction_are_those_of_the_surface(self, tmp_path):
        normals = HARD.copy()
        normals[3, 1], normals[5] = 0, np.nan
        (corners,) = saved(tmp_path, self.load(tmp_path, self.layered(normals))).values()
        assert_allclose(np.linalg.norm(corners["NORMAL"], axis=1), 1, atol=1e-5)

    @pytest.mark.parametrize("sign", [-1, 1])
    def test_faces_that_were_turned_and_dropped(self, tmp_path, sign):
        rig = self.load(tmp_path, self.layered(sign * HARD))
        stays = np.arange(len(FACES)) != 4
        (corners,) = saved(tmp_path, with_faces(rig, stays, np.ones(len(FACES), bool))).values()
        check(corners, COLUMN[FACES[stays].ravel()], flat(-HARD[stays]), flat(UV[stays]))

    def test_what_is_not_read_is_listed_once_with_its_mesh(self, tmp_path):
        more = record("LayerElementUV", 1, children=layer("UV", "ByPolygonVertex", [
            record("UV", flat(UV).ravel()),
            record("UVIndex", np.arange(FACES.size, dtype=np.int32))])[2])  # fmt: skip
        rig = self.load(tmp_path, self.layered(HARD, mesh=[more]))
        (warning,) = [w for w in rig.warnings if "texture coordinates after the first set" in w]
        assert warning.count("(body)") == 1


def normal_layer(values, how):
    return record("LayerElementNormal", 0, children=[
        record("Version", 101), record("Name", ""), record("MappingInformationType", how),
        record("ReferenceInformationType", "Direct"),
        record("Normals", np.asarray(values, float).ravel())])  # fmt: skip


class TestUsd:
    def load(self, folder, edit, content=None):
        (folder / "a.usda").write_text(content or usd_text())
        stage = Usd.Stage.Open(str(folder / "a.usda"))
        edit(UsdGeom.Mesh(stage.GetPrimAtPath("/Character/body")))
        stage.Save()
        return cutcell.load(folder / "a.usda")

    @pytest.mark.parametrize("how", ["faceVarying", "vertex", "varying", "uniform", "constant"])
    @pytest.mark.parametrize(("is_indexed", "orientation", "name"), [
        (False, "rightHanded", "st"), (True, "leftHanded", "UVMap")])  # fmt: skip
    def test_of_primvars(self, tmp_path, how, is_indexed, orientation, name):
        of_faces = {"uniform": HARD[:, :1], "constant": HARD[:1, :1], "faceVarying": HARD}
        of_uv = {"uniform": UV[:, :1], "constant": UV[:1, :1], "faceVarying": UV}
        values, uv = of_faces.get(how, SMOOTH), of_uv.get(how, UV.reshape(-1, 2)[: len(COLUMN)])

        def edit(mesh):
            mesh.GetOrientationAttr().Set(orientation)
            put(mesh, "normals", Sdf.ValueTypeNames.Normal3fArray, how, values, is_indexed)
            put(mesh, name, Sdf.ValueTypeNames.TexCoord2fArray, how, uv, is_indexed)

        corners = saved(tmp_path, self.load(tmp_path, edit))["body"]
        spread = [
            np.broadcast_to(one, (*FACES.shape, one.shape[-1])) if one.ndim == 3 else one[FACES]
            for one in (values, uv)
        ]
        check(corners, COLUMN[FACES.ravel()], *map(flat, spread))

    def test_of_the_attribute_normals(self, tmp_path):
        def edit(mesh):
            mesh.CreateNormalsAttr(flat(HARD).tolist())
            mesh.SetNormalsInterpolation("faceVarying")
            put(mesh, "st", Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying", UV, False)
            put(mesh, "st1", Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying", UV, False)

        rig = self.load(tmp_path, edit)
        check(saved(tmp_path, rig)["body"], COLUMN[FACES.ravel()], flat(HARD), flat(UV))
        assert sum("texture coordinates after the first set (body)" in w for w in rig.warnings) == 1

    @pytest.mark.parametrize(("scheme", "is_smooth"), [("none", False), ("catmullClark", True)])
    def test_without_any_a_subdivided_surface_is_smooth(self, tmp_path, scheme, is_smooth):
        rig = self.load(tmp_path, lambda mesh: mesh.GetSubdivisionSchemeAttr().Set(scheme))
        assert ("NORMAL" in saved(tmp_path, rig)["body"]) == is_smooth


def put(mesh, name, kind, how, values, is_indexed):
    """Write a primvar."""
    primvar = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar(name, kind, how)
    rows = flat(values)
    if is_indexed:
        rows, which = np.unique(rows, axis=0, return_inverse=True)
        primvar.SetIndices(which.ravel().tolist())
    primvar.Set(rows.tolist())


class TestObj:
    def load(self, folder, word, head=()):
        lines = [*head, *(f"v {x} {y} {z}" for x, y, z in COLUMN)]
        lines += [f"vt {u} {v}" for u, v in flat(UV)]
        lines += [f"vn {x} {y} {z}" for x, y, z in flat(HARD)]
        for k, face in enumerate(FACES):
            corners = [word.format(v=v + 1, t=3 * k + c + 1, back=3 * k + c - FACES.size)
                       for c, v in enumerate(face)]  # fmt: skip
            lines.append("f " + " ".join(corners))
        (folder / "a.obj").write_text("\n".join(lines))
        return cutcell.load(folder / "a.obj")

    @pytest.mark.parametrize("word", ["{v}/{t}/{t}", "{v}/{back}/{back}"])
    @pytest.mark.parametrize("head", [(), ("usemtl gone",)])
    def test_of_corners(self, tmp_path, word, head):
        (corners,) = saved(tmp_path, self.load(tmp_path, word, head)).values()
        check(corners, COLUMN[FACES.ravel()], flat(HARD), flat(UV))

    def test_of_normals_alone(self, tmp_path):
        (corners,) = saved(tmp_path, self.load(tmp_path, "{v}//{t}")).values()
        assert "TEXCOORD_0" not in corners
        corners["TEXCOORD_0"] = np.zeros((FACES.size, 2))
        check(corners, COLUMN[FACES.ravel()], flat(HARD), np.tile([0, 1], (FACES.size, 1)))

    def test_of_texture_coordinates_alone(self, tmp_path):
        (corners,) = saved(tmp_path, self.load(tmp_path, "{v}/{t}")).values()
        vertices = {tuple(row) for row in corners["POSITION"]}
        both = {tuple(row) for row in np.c_[corners["POSITION"], corners["NORMAL"]]}
        assert len(both) == len(vertices), "smooth, as without texture coordinates"
        corners["NORMAL"] = flat(HARD)
        check(corners, COLUMN[FACES.ravel()], flat(HARD), flat(UV))

    def test_polygons_are_cut_with_their_corners(self, tmp_path):
        points = [(0, 0, 0), (2, -1, 0), (0.5, 0, 0), (2, 1, 0)]
        lines = [f"v {x} {y} {z}\nvt {x} {y}\nvn 0 {y} 1" for x, y, z in points]
        (tmp_path / "a.obj").write_text("\n".join([*lines, "f 1/1/1 2/2/2 3/3/3 4/4/4"]))
        (corners,) = saved(tmp_path, cutcell.load(tmp_path / "a.obj")).values()
        normals = np.array([(0, y, 1) for _, y, _ in points], float)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        check(corners, np.array(points), normals, np.array(points)[:, :2])
