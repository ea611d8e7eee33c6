"""Meshes of one file that are each rounded to a grid of their own stay shut where they were."""

import DracoPy
import numpy as np
import pytest
from numpy.testing import assert_array_equal

import cutcell
from cutcell.geometry.triangles import face_edges
from cutcell.geometry.weld import weld
from cutcell.io.gltf.container import read_document
from tests.cutcell.io.gltf.compressed import DRACO, used
from tests.cutcell.io.gltf.gltf_builder import Builder, moved

RINGS, AROUND, BITS = 13, 24, 14


def cylinder():
    """Return vertices and faces of a capped cylinder with rings that are not quite even."""
    angle = 2 * np.pi * np.arange(AROUND) / AROUND
    height = np.linspace(0, 2, RINGS) + 0.013 * np.sin(7 * np.arange(RINGS))
    circle = np.stack([0.31 * np.cos(angle), 0 * angle, 0.27 * np.sin(angle)], axis=1)
    vertices = np.concatenate([circle + np.array([0.05 * y, y, 0]) for y in height])
    k = np.arange(AROUND)
    right = (k + 1) % AROUND
    faces = []
    for r in range(RINGS - 1):
        a, b, c, d = (AROUND * r + k, AROUND * r + right, AROUND * (r + 1) + k,
                      AROUND * (r + 1) + right)  # fmt: skip
        faces += [np.stack([a, c, b], axis=1), np.stack([b, c, d], axis=1)]
    low, high = k[1:-1], AROUND * (RINGS - 1) + k[1:-1]
    faces += [np.stack([0 * low, low, low + 1], axis=1)]
    faces += [np.stack([0 * high + high[0] - 1, high + 1, high], axis=1)]
    return vertices, np.concatenate(faces)


def halves(cut=RINGS // 2, gap=0.0):
    """Return the lower and the upper half of the cylinder, vertices and faces each."""
    vertices, faces = cylinder()
    ring = np.arange(len(vertices)) // AROUND
    for is_in in (ring <= cut, ring >= cut):
        inside = is_in[faces].all(axis=1)
        used, corners = np.unique(faces[inside], return_inverse=True)
        yield vertices[used] + [0, gap * (is_in[-1]), 0], corners.reshape(-1, 3)


def rounded(vertices, kind):
    """Return integers on the smallest grid around some vertices, and the matrix back from them."""
    low, extent = vertices.min(axis=0), np.ptp(vertices, axis=0).max()
    if kind == "i2":  # normalised, from -1 to 1
        matrix = moved(*(low + extent / 2)) @ np.diag([extent / 2] * 3 + [1])
        steps = 2 ** (BITS - 1) - 1
        values = np.round((vertices - low - extent / 2) / (extent / 2) * steps) / steps
        return np.round(values * 32767).astype("i2"), matrix
    steps = 2**BITS - 1
    matrix = moved(*low) @ np.diag([extent / steps] * 3 + [1])
    return np.round((vertices - low) / extent * steps).astype("u2"), matrix


def document(parts, kind="u2", is_bare=False):
    """Return a builder with a mesh for each of the parts, on a grid of its own."""
    builder = Builder()
    root = builder.node(name="root")
    tip = builder.node(root, name="tip", translation=[0, 1, 0])
    builder.json["extensionsRequired"] = ["KHR_mesh_quantization"]
    for vertices, faces in parts:
        if kind == "f4":
            values, matrix = vertices.astype("f4"), np.eye(4)
        else:
            values, matrix = rounded(vertices, kind)
        padded = np.pad(values, ((0, 0), (0, 1))) if kind != "f4" else values
        view = builder.view(padded.tobytes(), byteStride=padded.shape[1] * padded.itemsize)
        positions = builder.accessor(values, view=view, normalized=kind == "i2",
                                     min=values.min(axis=0).tolist(),
                                     max=values.max(axis=0).tolist())  # fmt: skip
        share = np.clip(vertices[:, 1:2] / 2, 0, 1)
        weights = builder.accessor(np.concatenate([1 - share, share, 0 * share, 0 * share], axis=1))
        joints = builder.accessor(np.tile(np.array([0, 1, 0, 0], "u1"), (len(vertices), 1)))
        named = {"POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights}
        mesh = builder.mesh(named if not is_bare else {"POSITION": positions}, faces)
        if is_bare:
            builder.node(mesh=mesh, matrix=matrix.T.ravel().tolist())
        else:
            inverse = [matrix, moved(0, -1, 0) @ matrix]
            builder.node(mesh=mesh, skin=builder.skin([root, tip], inverse))
    return builder


def open_edges(mesh):
    size = np.ptp(mesh.vertices, axis=0).max()
    index = weld(mesh.vertices, 1e-6 * size)[1]
    return (np.unique(face_edges(index[mesh.faces]), axis=0, return_counts=True)[1] == 1).sum()


@pytest.mark.parametrize("is_bare", [False, True])
@pytest.mark.parametrize("kind", ["u2", "i2"])
@pytest.mark.parametrize("cut", [3, 6, 10])
def test_two_halves_stay_shut(loaded, tmp_path, kind, is_bare, cut):
    builder = document(halves(cut), kind, is_bare)
    rig = loaded(builder)
    assert open_edges(rig.mesh) == 0
    exact = loaded(document(halves(cut), "f4", is_bare))
    # The space of a rig is that of the first mesh, whose grid it is.
    world = np.eye(4) if is_bare else rounded(next(halves(cut))[0], kind)[1]
    placed = rig.mesh.vertices @ world[:3, :3].T + world[:3, 3]
    off = np.linalg.norm(placed - exact.mesh.vertices, axis=1)
    assert off.max() < 2 * 2 ** (1 - BITS) * 2
    if not is_bare:
        cutcell.save(tmp_path / "out.glb", rig)
        again = cutcell.load(tmp_path / "out.glb")
        assert_array_equal(again.mesh.vertices, rig.mesh.vertices)
        files = [read_document(p) for p in (tmp_path / "rig.glb", tmp_path / "out.glb")]
        assert files[0].json["meshes"] == files[1].json["meshes"]


def test_weights_cross_the_seam(loaded):
    """Weights of the halves are those of the whole, where an open seam is a wall for them."""
    whole = cutcell.bind(loaded(document([cylinder()], "u2")), 16).weights
    parts = cutcell.bind(loaded(document(halves(), "u2")), 16).weights
    ring = AROUND * (RINGS // 2)
    upper = parts[ring + AROUND :]
    assert np.abs(np.concatenate([parts[: ring + AROUND], upper[AROUND:]]) - whole).max() < 1e-3


def by_draco(parts, bits):
    """Return a builder with a mesh for each of the parts, compressed by Draco."""
    builder = document(parts, "f4")
    for mesh, (vertices, faces) in zip(builder.json["meshes"], parts, strict=True):
        (primitive,) = mesh["primitives"]
        data = DracoPy.encode(vertices, faces, quantization_bits=bits, preserve_order=True)
        extension = {"bufferView": builder.view(data), "attributes": {"POSITION": 0}}
        primitive["extensions"] = {DRACO: extension}
        builder.json["accessors"][primitive["attributes"]["POSITION"]].pop("bufferView")
        builder.json["accessors"][primitive["indices"]].pop("bufferView")
    used(builder, DRACO)
    return builder


@pytest.mark.parametrize("bits", [12, 14, 18])
def test_draco_rounds_each_mesh_to_a_grid_of_its_own(loaded, tmp_path, bits):
    rig = loaded(by_draco(list(halves()), bits))
    assert open_edges(rig.mesh) == 0
    cutcell.save(tmp_path / "out.glb", rig)
    assert_array_equal(cutcell.load(tmp_path / "out.glb").mesh.vertices, rig.mesh.vertices)


@pytest.mark.parametrize("gap", [1e-3, 1e-2])
def test_what_is_farther_apart_than_a_step_stays_open(loaded, gap):
    rig = loaded(document(halves(gap=gap)))
    assert open_edges(rig.mesh) == 2 * AROUND


def test_borders_that_touch_in_a_point_stay_apart(loaded):
    flat = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.1], [1, 1, 0.2]], float)
    faces = np.array([[0, 1, 2], [2, 1, 3]])
    other = flat * [1, 0.7, 1] + [1, 1, 0.2 + 1e-5]
    rig = loaded(document([(flat, faces), (other, faces)]))
    assert open_edges(rig.mesh) == 8


def test_floats_are_left_alone(loaded):
    rig = loaded(document(halves(gap=1e-5), "f4"))
    assert_array_equal(
        rig.mesh.vertices, np.concatenate([v for v, _ in halves(gap=1e-5)]).astype("f4")
    )


def test_shut_meshes_on_two_grids_are_left_alone(loaded):
    whole, faces = cylinder()
    rig = loaded(document([(whole, faces), (0.5 * whole + 1, faces)], is_bare=True))
    assert open_edges(rig.mesh) == 0
