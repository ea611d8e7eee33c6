"""Templates that are fitted into bodies whose own skeletons are forgotten."""

import numpy as np
import pytest
import trimesh
from skimage.measure import marching_cubes

import cutcell
from cutcell import MeshError, ParameterError, SkeletonError, TriangleMesh
from cutcell.templates import TEMPLATES, fit_skeleton
from cutcell_assets import demo_path

RESOLUTION = 48


def size_of(mesh):
    return float(np.ptp(mesh.bounds, axis=0).max())


def outside(mesh, skeleton):
    numbers = cutcell.winding_number(mesh, skeleton.joints)
    return [name for name, number in zip(skeleton.names, numbers, strict=True) if number < 0.5]


def place(skeleton, name):
    return skeleton.joints[skeleton.names.index(name)]


def capsules(*segments, radius=0.06, spacing=0.03):
    """Return one closed mesh around segments, each with a radius of its own if it has one."""
    ends = np.array([[a, b] for a, b, *_ in segments], float)
    radii = [rest[0] if rest else radius for _, _, *rest in segments]
    low = ends.min(axis=(0, 1)) - max(radii) - 2 * spacing
    high = ends.max(axis=(0, 1)) + max(radii) + 2 * spacing
    axes = [np.arange(a, b, spacing) for a, b in zip(low, high, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    field = np.full(points.shape[:3], np.inf)
    for (a, b), thick in zip(ends, radii, strict=True):
        share = np.clip((points - a) @ (b - a) / max((b - a) @ (b - a), 1e-12), 0, 1)
        away = np.linalg.norm(points - a - share[..., None] * (b - a), axis=-1)
        field = np.minimum(field, away - thick)
    vertices, faces, *_ = marching_cubes(field, 0, spacing=(spacing,) * 3)
    return TriangleMesh(vertices + low, faces)


def dog():
    legs = [([x, 0, z], [x, 0.6, z]) for x in (-0.12, 0.12) for z in (-0.5, 0.5)]
    hips = [([x, 0.6, z], [0, 0.65, z]) for x in (-0.12, 0.12) for z in (-0.5, 0.5)]
    trunk = [([0, 0.65, -0.5], [0, 0.65, 0.5])]
    neck = [([0, 0.65, 0.5], [0, 1.0, 0.8]), ([0, 1.0, 0.8], [0, 1.0, 1.0])]
    tail = [([0, 0.65, -0.5], [0, 0.7, -1.0])]
    return capsules(*legs, *hips, *trunk, *neck, *tail)


@pytest.mark.parametrize("demo", ["biped", "biped_cape"])
def test_a_biped_is_found_in_its_body(demo):
    rig = cutcell.load(demo_path(demo))
    skeleton = fit_skeleton(rig.mesh, "biped", graph=cutcell.build_graph(rig.mesh, RESOLUTION))
    assert not outside(rig.mesh, skeleton)
    for name, own in (
        ("forearm", "forearm"), ("thigh", "thigh"), ("shin", "shin"), ("upper_arm", "upper_arm"),
    ):  # fmt: skip
        for side in "LR":
            artist = [
                n for n in rig.skeleton.names if n.lower().startswith(own) and n.endswith(side)
            ]
            assert artist, rig.skeleton.names
            gap = place(skeleton, f"{name}.{side}") - place(rig.skeleton, artist[0])
            assert np.linalg.norm(gap) < 0.13 * size_of(rig.mesh), (name, side)
    left, right = place(skeleton, "hand.L"), place(skeleton, "hand.R")
    np.testing.assert_allclose(left * [-1, 1, 1], right, atol=0.02 * size_of(rig.mesh))
    assert left[0] > 0 > right[0]
    assert place(skeleton, "toe.L")[2] > place(skeleton, "foot.L")[2]


def test_a_body_that_stands_along_z_is_found_alike():
    rig = cutcell.load(demo_path("biped"))
    upright = fit_skeleton(rig.mesh, "biped", graph=cutcell.build_graph(rig.mesh, RESOLUTION))
    turned = rig.mesh.vertices[:, [0, 2, 1]] * [1, -1, 1]
    mesh = TriangleMesh(turned, rig.mesh.faces)
    skeleton = fit_skeleton(mesh, "biped", graph=cutcell.build_graph(mesh, RESOLUTION))
    back = skeleton.joints[:, [0, 2, 1]] * [1, 1, -1]
    assert np.abs(back - upright.joints).max() < 0.05 * size_of(mesh)


def test_a_quadruped_has_its_feet_on_the_ground_and_its_head_in_front():
    mesh = dog()
    skeleton = fit_skeleton(mesh, "quadruped", graph=cutcell.build_graph(mesh, RESOLUTION))
    assert not outside(mesh, skeleton)
    for name, near in (
        ("head", [0, 1, 0.85]), ("tail.3", [0, 0.7, -0.9]), ("chest", [0, 0.65, 0.5]),
        ("hips", [0, 0.65, -0.5]), ("front_shin.L", [0.12, 0.3, 0.5]),
        ("shin.R", [-0.12, 0.3, -0.5]), ("foot.L", [0.12, 0.05, -0.5]),
    ):  # fmt: skip
        assert np.linalg.norm(place(skeleton, name) - near) < 0.2, name
    assert skeleton.parents[skeleton.names.index("front_thigh.L")] == skeleton.names.index("chest")


def test_a_hand_is_told_from_its_thumb():
    fingers = [
        ([x, 0, 0], [x, 0, end]) for x, end in ((-0.3, 0.7), (-0.1, 0.85), (0.1, 0.8), (0.3, 0.55))
    ]
    palm = [([x, 0, -0.6], [x, 0, 0.05], 0.12) for x in (-0.25, -0.1, 0.1, 0.25)]
    thumb = [([-0.25, 0, -0.4], [-0.75, 0, 0.0]), ([0, 0, -0.5], [0, 0, -1.0], 0.18)]
    mesh = capsules(*fingers, *palm, *thumb, radius=0.08)
    skeleton = fit_skeleton(mesh, "hand", graph=cutcell.build_graph(mesh, RESOLUTION))
    assert len(skeleton.names) == 16
    assert not outside(mesh, skeleton)
    for name, x in (
        ("thumb", -0.65),
        ("index", -0.3),
        ("middle", -0.1),
        ("ring", 0.1),
        ("pinky", 0.3),
    ):
        assert place(skeleton, f"{name}.3")[0] == pytest.approx(x, abs=0.12), name


@pytest.mark.parametrize("template", ["snake", "chain"])
def test_a_chain_runs_from_the_thick_end_to_the_thin_one(template):
    mesh = capsules(
        ([0, 0, 0], [0.1, 0, 0], 0.15),
        ([0, 0, 0], [1, 0, 0]),
        ([1, 0, 0], [1.6, 0.5, 0]),
        ([1.6, 0.5, 0], [2.6, 0.5, 0]),
    )
    skeleton = fit_skeleton(mesh, template, graph=cutcell.build_graph(mesh, RESOLUTION))
    assert not outside(mesh, skeleton)
    assert (np.diff(skeleton.joints[:, 0]) > 0).all()
    np.testing.assert_array_equal(skeleton.parents, np.arange(len(skeleton.parents)) - 1)


def test_parts_that_do_not_touch_belong_to_one_body():
    mesh = capsules(([0, 0, 0], [0, 1, 0]), ([0, 1.2, 0], [0, 2, 0]))
    skeleton = fit_skeleton(mesh, "chain", graph=cutcell.build_graph(mesh, RESOLUTION))
    assert np.ptp(skeleton.joints[:, 1]) > 1.2


def test_what_cannot_be_is_said():
    ball = trimesh.creation.icosphere(subdivisions=3)
    flat = TriangleMesh(ball.vertices * [1.0, 0.2, 1.0], ball.faces)
    with pytest.raises(ParameterError, match="template"):
        fit_skeleton(flat, "centaur")
    with pytest.raises(SkeletonError, match="no three fingers"):
        fit_skeleton(flat, "hand")
    with pytest.raises(MeshError, match="no inside"):
        fit_skeleton(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), "chain")


@pytest.mark.parametrize("template", [t for t in TEMPLATES if t != "hand"])
@pytest.mark.parametrize("shape", ["ball", "box"])
def test_every_template_fits_into_anything_solid(template, shape):
    made = trimesh.creation.icosphere(subdivisions=2) if shape == "ball" else trimesh.creation.box()
    mesh = TriangleMesh(made.vertices * [0.5, 1.0, 0.3], made.faces)
    skeleton = fit_skeleton(mesh, template)
    assert np.isfinite(skeleton.joints).all()
    assert not outside(mesh, skeleton)
