"""Making the characters again gives the same files."""

import numpy as np
import pytest

from cutcell_assets import __main__ as command
from cutcell_assets import demo_path, glb
from cutcell_assets.body import Body
from cutcell_assets.character import Bones
from cutcell_assets.meshing import mesh_of
from cutcell_assets.plates import barrel, box, globe
from cutcell_assets.remesh import edges_of
from cutcell_assets.sdf import ball, ellipsoid, round_cone, smooth_min
from cutcell_assets.seams import with_seams
from cutcell_assets.weights import from_parts, quantised

pytest.importorskip("skimage")


def dumbbell(gap=0.3):
    """Return a body of two balls and a bar: one bone a ball."""
    body, bones = Body(), Bones()
    bones.add("a", None, [-gap, 0, 0])
    bones.add("b", "a", [gap, 0, 0])
    body.add(ball([-gap, 0, 0], 0.2), "a", edge=0.05, colour="red")
    body.add(ball([gap, 0, 0], 0.2), "b", edge=0.05, colour="blue")
    body.add(
        round_cone([-gap, 0, 0], [gap, 0, 0], 0.08, 0.08), "b", blend=0.05, edge=0.04, colour="blue"
    )
    return body, bones


def mesh(body, spacing=0.02):
    return mesh_of(body, np.full(3, -0.7), np.full(3, 0.7), spacing)


@pytest.mark.slow
def test_the_robot_is_made_with_the_committed_bytes():
    assert glb.to_bytes(command.make("robot")) == demo_path("robot").read_bytes()


def test_meshing_twice_gives_the_same():
    body, _ = dumbbell()
    first, second = mesh(body), mesh(body)
    np.testing.assert_array_equal(first[0], second[0])
    np.testing.assert_array_equal(first[1], second[1])


def test_meshes_are_closed_and_on_the_surface():
    body, _ = dumbbell()
    vertices, faces = mesh(body)
    edges_of(faces)  # raises where the mesh is open
    assert np.abs(body.distance(vertices)).max() < 1e-3
    lengths = np.linalg.norm(vertices[faces] - vertices[np.roll(faces, 1, axis=1)], axis=2)
    assert 0.03 < np.median(lengths) < 0.06


def test_an_open_mesh_is_refused():
    with pytest.raises(ValueError, match="not closed"):
        edges_of(np.array([[0, 1, 2]]))


def test_limbs_melt_only_where_they_are_attached():
    body = Body()
    body.add(ball([0, 0, 0], 0.2), "a")
    body.add(ball([0.45, 0, 0], 0.2), "b", blend=0.2, at=np.array([9.0, 0, 0]), reach=1.0)
    assert body.distance(np.array([[0.225, 0, 0]]))[0] == pytest.approx(0.025)


def test_seams_run_along_edges():
    body, _ = dumbbell()
    vertices, faces = mesh(body)
    vertices, faces, colours = with_seams(body, vertices, faces)
    edges_of(faces)
    assert set(colours) == {"red", "blue"}
    red, blue = (set(faces[colours == name].ravel()) for name in ("red", "blue"))
    seam = vertices[sorted(red & blue)]
    near, far = (body.parts[k].shape.distance(seam) for k in (0, 2))
    assert np.abs(near - far).max() < 0.004


def test_reference_weights_blend_along_the_limb():
    body, bones = dumbbell()
    vertices, faces = mesh(body)
    weights = from_parts(body, bones, vertices, faces)
    np.testing.assert_array_equal(weights.sum(axis=1), 1)
    assert weights[vertices[:, 0].argmin(), 0] == 1
    assert weights[vertices[:, 0].argmax(), 1] == 1
    assert ((weights > 0.3) & (weights < 0.7)).any()


def test_quantised_weights_are_exact():
    weights = np.random.default_rng(3).random((50, 9))
    kept = quantised(weights)
    assert (kept.sum(axis=1, dtype=np.float32) == 1).all()
    assert ((kept > 0).sum(axis=1) <= 4).all()
    np.testing.assert_array_equal(kept.argmax(axis=1), weights.argmax(axis=1))


@pytest.mark.parametrize(
    "plate",
    [
        box([0.1, 0.2, 0.3], 0.03),
        barrel(0.1, 0.2, 0.5),
        globe(0.2),
        globe(0.2, -0.3, 0.5),
        box([0.1, 0.2, 0.3], 0.03).mirrored(),
    ],
)
def test_plates_are_closed_and_outward(plate):
    edges_of(plate.faces)
    a, b, c = (plate.vertices[plate.faces[:, k]] for k in range(3))
    assert (a * np.cross(b, c)).sum() > 0
    assert ((plate.normals() * plate.vertices).sum(axis=1) > 0).mean() > 0.99


def test_smooth_min_is_below_both_and_exact_far_away():
    a, b = np.array([1.0, 0.0, 0.1]), np.array([0.0, 1.0, 0.1])
    result = smooth_min(a, b, 0.2)
    assert (result <= np.minimum(a, b)).all()
    np.testing.assert_array_equal(result[:2], 0)
    assert result[2] == pytest.approx(0.05)


def test_ellipsoids_are_exact_on_their_surface():
    shape = ellipsoid([1, 2, 3], [0.3, 0.2, 0.1])
    assert shape.distance(np.array([[1.3, 2, 3], [1, 2.2, 3], [1, 2, 3.1]])) == pytest.approx(0)
    assert shape.distance(np.array([[1.0, 2, 3]]))[0] < 0


def test_an_unknown_name_is_told(capsys):
    assert command.main(["biped", "unicorn"]) == 2
    assert "'unicorn'" in capsys.readouterr().out


@pytest.mark.slow
def test_the_command_writes_files(tmp_path, monkeypatch):
    monkeypatch.setattr(command, "demo_path", lambda id: tmp_path / f"{id}.glb")
    assert command.main(["robot"]) == 0
    assert (tmp_path / "robot.glb").stat().st_size > 1e5
