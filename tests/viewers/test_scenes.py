"""What each scene says before anything is drawn."""

from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell.graph import INTERIOR, MESH, SURFACE
from cutcell.pose import axis_rotation, pose_at
from cutcell.rig import Skeleton
from cutcell_viewers import palette
from cutcell_viewers.character import (
    body,
    bones,
    drawn_segments,
    pose_in_scene,
    smooth_normals,
    to_scene,
)
from cutcell_viewers.description import Description
from cutcell_viewers.distance_scene import distance_scene
from cutcell_viewers.graph_scene import LAYERS, NODES, cut_at, graph_scene
from cutcell_viewers.joint_colors import colors_of
from cutcell_viewers.palette import UNREACHED, colormap, to_bytes
from cutcell_viewers.pose_scene import joint_turns, pose_scene, swing
from cutcell_viewers.weights_scene import weights_scene
from tests.viewers.arm import WORLD


def test_the_body_stands_upright_in_the_scene(rig):
    actor = body(rig)
    np.testing.assert_allclose(actor.points, rig.mesh.vertices @ WORLD[:3, :3].T, atol=1e-6)
    assert np.array_equal(actor.cells, rig.mesh.faces)


def test_normals_point_outwards_and_corners_stay_sharp(rig):
    actor = body(rig)
    outward = (actor.normals * actor.points).sum(axis=1)
    assert (outward > 0).all()
    np.testing.assert_allclose(np.linalg.norm(actor.normals, axis=1), 1, atol=1e-5)


def test_split_vertices_share_normals_on_smooth_surfaces_only():
    # Two triangles share an edge, each with corners of its own: first flat, then at 90 degrees.
    flat = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [1, 0.99, 0.02], [0, 1, 0]])
    sharp = flat.copy()
    sharp[4] = [0.5, 0.5, 1]
    faces = np.array([[0, 1, 2], [3, 4, 5]])
    index = np.array([0, 1, 2, 1, 3, 2])
    joined = smooth_normals(flat.astype(float), faces, index)
    np.testing.assert_allclose(joined[1], joined[3])
    apart = smooth_normals(sharp.astype(float), faces, index)
    assert (apart[1] * apart[3]).sum() < 0.5


def test_a_mirrored_space_turns_the_faces_back(rig):
    mirrored = replace(rig, world=np.diag([-1.0, 1, 1, 1]))
    actor = body(mirrored)
    assert (actor.normals * actor.points).sum(axis=1).min() > 0


def test_every_bone_is_drawn_and_leaves_get_a_stub(rig):
    start, end, joint = drawn_segments(rig)
    assert joint.tolist() == [0, 1, 2]
    np.testing.assert_allclose(start, to_scene(rig, rig.skeleton.joints))
    np.testing.assert_allclose(end[:2], to_scene(rig, rig.skeleton.joints[1:]))
    stub = np.linalg.norm(end[2] - start[2])
    assert 0 < stub < 0.5


def test_joints_in_one_place_do_not_break_the_bones(rig):
    skeleton = cutcell.Skeleton([[0, 0, 0], [0, 0, 0], [0, 0, 0]], [-1, 0, 1])
    for actor in bones(replace(rig, skeleton=skeleton, clips=(), attachments=())).values():
        assert np.isfinite(actor.points).all()


def test_the_chosen_bone_stands_out(rig):
    actor = bones(rig, chosen=1)["bones"]
    chosen = (actor.colors == palette.to_bytes(palette.BONE_CHOSEN)).all(axis=1)
    assert chosen.reshape(3, 6).all(axis=1).tolist() == [False, True, False]
    assert actor.overlay
    assert not actor.clipped


def test_what_carries_no_weight_is_drawn_apart_from_bones(rig):
    skeleton = replace(rig.skeleton, deform=[True, False, True])
    colors = np.eye(3)
    drawn = bones(replace(rig, skeleton=skeleton), 0, colors=colors)["bones"].colors
    of = drawn.reshape(-1, 6, 3)[:, 0]
    assert of.tolist() == to_bytes([colors[0], palette.BONE_IDLE, colors[2]]).tolist()


def test_bones_have_the_colours_of_their_joints_and_outlines_around_them(rig):
    colors = colors_of(rig)
    drawn = bones(rig, 1, colors=colors)
    own = palette.to_bytes(colors)
    assert (drawn["bones"].colors.reshape(3, 6, 3) == own[:, None]).all()
    edge = drawn["bone outlines"].colors.reshape(3, 6, 3)
    assert (edge[1] == palette.to_bytes(palette.BONE_CHOSEN)).all()
    assert (edge[[0, 2]] == palette.to_bytes(palette.BONE_EDGE)).all()
    inner, outer = (drawn[name].points.reshape(3, 6, 3) for name in ("bones", "bone outlines"))
    wide = [np.ptp(points, axis=1).max(axis=1) for points in (inner, outer)]
    assert (wide[1] > wide[0]).all()
    assert len(bones(rig, 1, shown=[True, False, True])["bones"].points) == 12


def test_weights_of_one_joint_and_of_all(rig):
    one = weights_scene(rig, rig.weights, 1)
    np.testing.assert_array_equal(one.actors["body"].scalars, rig.weights[:, 1])
    assert one.legend is not None
    assert "elbow" in one.legend.title
    every = weights_scene(rig, rig.weights)
    expected = palette.to_bytes(rig.weights @ colors_of(rig))
    np.testing.assert_array_equal(every.actors["body"].colors, expected)
    assert "Each bone" in every.legend.title


def test_what_no_path_reaches_is_grey_and_the_legend_says_so(rig, binding):
    distance = binding.distances.joint[1].copy()
    distance[0] = np.inf
    scene = distance_scene(rig, distance, 1)
    actor = scene.actors["body"]
    assert np.isfinite(actor.scalars).all()
    table = colormap(actor.colormap)
    low, high = actor.limits
    texel = ((actor.scalars - low) / (high - low) * (len(table) - 1)).astype(int)
    grey = to_bytes(UNREACHED)
    assert (table[texel[0]] == grey).all()
    assert not (table[texel[1:]] == grey).all(axis=1).any()
    assert "no path" in scene.legend.swatches[0][1]
    assert distance_scene(rig, binding.distances.joint[1], 1).legend.swatches == ()


def test_nothing_reached_at_all_is_a_scene_still(rig):
    scene = distance_scene(rig, np.full(len(rig.mesh.vertices), np.inf), 1)
    assert np.isfinite(scene.actors["body"].scalars).all()


def test_the_graph_has_its_three_layers_where_the_body_is(rig, binding):
    scene = graph_scene(rig, binding.graph)
    assert tuple(scene.actors) == (*LAYERS, *NODES)
    for (name, kind), color in zip(
        LAYERS.items(),
        (palette.LIGHT.mesh_edge, palette.INTERIOR, palette.LIGHT.surface_edge),
        strict=True,
    ):
        actor = scene.actors[name]
        assert len(actor.cells) == (binding.graph.edge_kind == kind).sum() > 0
        assert actor.color == color
    low, high = body(rig).points.min(axis=0), body(rig).points.max(axis=0)
    for actor in scene.actors.values():
        assert (actor.points > low - 1e-4).all()
        assert (actor.points < high + 1e-4).all()
    assert list(LAYERS.values()) == [MESH, INTERIOR, SURFACE]


def test_graph_edges_have_the_graphs_lengths(rig, binding):
    graph = binding.graph
    actor = graph_scene(rig, graph).actors["interior edges"]
    drawn = np.linalg.norm(np.diff(actor.points[actor.cells], axis=1)[:, 0], axis=1)
    expected = graph.lengths[graph.edge_kind == INTERIOR] * 3.0  # the beam is 3 long
    np.testing.assert_allclose(drawn, expected, rtol=1e-4, atol=1e-6)


def test_layers_are_hidden_not_left_out(rig, binding):
    scene = graph_scene(rig, binding.graph, layers=("mesh edges",))
    assert {n: a.visible for n, a in scene.actors.items()} == {
        "mesh edges": True,
        "interior edges": False,
        "surface edges": False,
        **dict.fromkeys(NODES, False),
    }


def test_a_field_colours_the_interior(rig, binding):
    field = binding.distances.field(1)
    scene = graph_scene(rig, binding.graph, field=field, slab=0.2)
    actor = scene.actors["interior edges"]
    assert actor.scalars.shape == (len(actor.points),)
    assert actor.slab == 0.2
    assert scene.actors["mesh edges"].scalars is None
    assert scene.actors["mesh edges"].slab == 0


@pytest.mark.parametrize(("axis", "k"), [("x", 0), ("y", 1), ("z", 2)])
def test_the_cut_lies_where_it_is_asked(axis, k):
    cut = cut_at(np.array([[-1.0, -2, -3], [1, 2, 3]]), axis, 0.75)
    expected = [0.0, 0, 0]
    expected[k] = 0.5 * (k + 1)
    assert cut.origin == tuple(expected)
    assert cut.normal[k] == 1


def test_a_pose_moves_the_scene_as_it_moves_the_rig(rig):
    transforms = cutcell.forward_kinematics(
        rig.skeleton, joint_turns(rig, {1: axis_rotation("y", 40)})
    )
    scene = pose_scene(rig, rig.weights, transforms)
    actor = scene.actors["body"]
    expected = to_scene(
        rig, cutcell.linear_blend_skinning(rig.mesh.vertices, rig.weights, transforms)
    )
    np.testing.assert_allclose(actor.points_in(scene.pose), expected, atol=1e-5)


def test_turns_are_about_the_scenes_axes(rig):
    # The scene's y is the rig's z: turning about y keeps the beam's heights.
    transforms = cutcell.forward_kinematics(
        rig.skeleton, joint_turns(rig, {0: axis_rotation("y", 30)})
    )
    posed = cutcell.linear_blend_skinning(rig.mesh.vertices, rig.weights, transforms)
    np.testing.assert_allclose(posed[:, 2], rig.mesh.vertices[:, 2], atol=1e-12)


@pytest.mark.parametrize("axis", "xyz")
def test_a_turn_is_a_rotation_about_its_axis(axis):
    rotation = axis_rotation(axis, 90)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1)
    k = "xyz".index(axis)
    a, b = np.eye(3)[(k + 1) % 3], np.eye(3)[(k + 2) % 3]
    np.testing.assert_allclose(rotation @ a, b, atol=1e-12)


def test_a_swing_begins_and_ends_at_rest(rig):
    clip = swing(rig, 1, "z", 50)
    identity = np.tile(np.eye(4), (3, 1, 1))
    np.testing.assert_allclose(clip.transforms[0], identity, atol=1e-12)
    np.testing.assert_allclose(clip.transforms[-1], identity, atol=1e-12)
    assert np.abs(clip.transforms - identity).max() > 0.5


def test_a_motion_can_be_read_between_its_frames_and_repeats(rig):
    clip = rig.clips[0]
    half = pose_in_scene(rig, pose_at(clip, 0.5))
    expected = pose_in_scene(rig, (clip.transforms[0] + clip.transforms[1]) / 2)
    np.testing.assert_allclose(half, expected)
    np.testing.assert_allclose(pose_in_scene(rig, pose_at(clip, 3.5)), half)
    still = cutcell.Clip("still", np.zeros(1), clip.transforms[:1])
    np.testing.assert_allclose(
        pose_in_scene(rig, pose_at(still, 2.0)), pose_in_scene(rig, clip.transforms[0])
    )


def test_bones_far_out_of_the_body_do_not_shrink_it(rig):
    body_alone = Description({"body": body(rig)}).bounds
    skeleton = Skeleton(
        [*rig.skeleton.joints, [0, 5, 0]], [*rig.skeleton.parents, -1],
        (*rig.skeleton.names, "target"),
    )  # fmt: skip
    far = replace(rig, skeleton=skeleton, weights=None, clips=())
    scene = Description({"body": body(far), **bones(far)})
    np.testing.assert_array_equal(scene.bounds, body_alone)
