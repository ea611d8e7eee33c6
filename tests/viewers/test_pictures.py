"""Scenes drawn off-screen: something is there, where and as it should be."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import cutcell
from cutcell.errors import ParameterError
from cutcell.pose import axis_rotation
from cutcell_viewers import palette
from cutcell_viewers.camera import Camera, framing
from cutcell_viewers.description import Actor, Description
from cutcell_viewers.distance_scene import distance_scene
from cutcell_viewers.graph_scene import cut_at, graph_scene
from cutcell_viewers.order import ground
from cutcell_viewers.palette import LIGHT
from cutcell_viewers.pose_scene import joint_turns, pose_scene
from cutcell_viewers.scene import Scene, render_png
from cutcell_viewers.studio import Studio
from cutcell_viewers.weights_scene import weights_scene

SIZE = (240, 180)


@pytest.fixture(scope="module")
def scenes(rig, binding):
    bent = cutcell.forward_kinematics(rig.skeleton, joint_turns(rig, {1: axis_rotation("z", 60)}))
    return {
        "graph": graph_scene(rig, binding.graph),
        "distance": distance_scene(rig, binding.distances.joint[1], 1),
        "weights": weights_scene(rig, binding.weights, 1),
        "bones": weights_scene(rig, binding.weights),
        "pose": pose_scene(rig, binding.weights, bent),
    }


def drawn(scene, **options):
    """Return the picture, and which pixels differ from an empty one."""
    camera = framing(scene.bounds, SIZE[0] / SIZE[1])
    picture = render_png(scene, size=SIZE, camera=camera, **options).astype(int)
    options.pop("path", None)
    empty = render_png(Description(), size=SIZE, camera=camera, **options).astype(int)
    return picture, np.abs(picture - empty).max(axis=2) > 12


@pytest.mark.parametrize("theme", [palette.LIGHT, palette.DARK], ids=lambda t: t.name)
@pytest.mark.parametrize("name", ["graph", "distance", "weights", "bones", "pose"])
def test_each_scene_fills_its_picture_and_stays_inside(scenes, name, theme):
    _, seen = drawn(scenes[name], theme=theme)
    assert 0.03 < seen.mean() < 0.8
    if name != "pose":  # bounds are those of the rest pose
        border = np.ones(seen.shape, bool)
        border[2:-2, 2:-2] = False
        assert not seen[border].any()


def test_dual_quaternions_are_drawn_where_they_move_the_points(scenes):
    linear = scenes["pose"]
    dual = replace(linear, blending="dual")
    moved = {
        name: replace(
            actor,
            points=actor.points_in(dual.pose, "dual"),
            normals=None if (n := actor.normals) is None else actor.skin.turn(n, dual.pose, "dual"),
            skin=None,
        )
        for name, actor in dual.actors.items()
    }
    camera = framing(dual.bounds, SIZE[0] / SIZE[1])
    pictures = [
        render_png(scene, size=SIZE, camera=camera).astype(int)
        for scene in (dual, Description(moved), linear)
    ]
    np.testing.assert_array_equal(pictures[0], pictures[1])
    assert (np.abs(pictures[0] - pictures[2]).max(axis=2) > 12).mean() > 1e-3


def test_the_picture_is_written_as_a_png(scenes, tmp_path):
    path = tmp_path / "scene.png"
    picture, _ = drawn(scenes["weights"], path=path)
    with Image.open(path) as image:
        assert image.format == "PNG"
        assert np.array_equal(np.asarray(image.convert("RGB")), picture)


def test_the_graph_is_in_the_papers_colours(scenes):
    inks = (("interior edges", palette.INTERIOR), ("surface edges", palette.LIGHT.surface_edge))
    for name, color in inks:
        actors = {name: scenes["graph"].actors[name]}
        picture, seen = drawn(Description(actors))
        # Lines are thin: where they cross, their colour is there undiluted.
        nearest = np.abs(picture[seen] - palette.to_bytes(color).astype(int)).max(axis=1).min()
        assert nearest < 48


def test_a_cut_takes_away_what_lies_before_it(rig, scenes):
    scene = Description({"body": scenes["weights"].actors["body"]})
    _, whole = drawn(scene)
    counts = []
    for position in (0.75, 0.5, 0.25):
        cut = cut_at(scene.bounds, "x", position)
        _, seen = drawn(replace(scene, cut=cut))
        counts.append(seen.sum())
    assert whole.sum() > counts[0] > counts[1] > counts[2] > 0


def test_a_slab_shows_less_than_all_behind_the_cut(rig, binding):
    def seen(slab):
        scene = graph_scene(rig, binding.graph, layers=("interior edges",), slab=slab)
        return drawn(replace(scene, cut=cut_at(scene.bounds, "x", 0.6)))[1].sum()

    assert 0 < seen(0.3) < seen(0.0)


def test_bones_are_seen_through_the_body(rig):
    with_bones = render_png(weights_scene(rig, rig.weights), size=SIZE)
    without = render_png(weights_scene(rig, rig.weights, skeleton=False), size=SIZE)
    assert (np.abs(with_bones.astype(int) - without).max(axis=2) > 12).mean() > 0.005


def test_a_scene_can_be_changed_in_place(rig, scenes):
    scene = Scene(size=SIZE)
    try:
        scene.show(scenes["weights"])
        assert set(scene.names) == {"body", "bones", "bone outlines", "attachment 0"}
        scene.show(scenes["graph"])
        assert set(scene.names) == {"mesh edges", "interior edges", "surface edges"}
        scene.set_camera(framing(scenes["graph"].bounds))
        changed = scene.render_png()
    finally:
        scene.close()
    fresh = render_png(scenes["graph"], size=SIZE, camera=framing(scenes["graph"].bounds))
    assert np.abs(changed.astype(int) - fresh).mean() < 0.5


def test_nodes_have_their_forms_in_pictures():
    def pixels(form):
        point = Actor(
            "points", np.zeros((1, 3), np.float32), np.zeros((1, 1), np.int32),
            color=(1.0, 0.0, 0.0), width=60, form=form,
        )  # fmt: skip
        camera = Camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0))
        picture = render_png(Description({"node": point}), size=(800, 800), camera=camera)
        red = picture.astype(int)
        return (red[:, :, 0] - red[:, :, 1] > 60).sum(axis=1)

    ball, square, triangle = (pixels(form) for form in ("round", "square", "triangle"))
    assert square.sum() > ball.sum() > triangle.sum() > 500
    rows = np.flatnonzero(triangle)
    assert triangle[rows[-1] - 3] > 2 * triangle[rows[0] + 3]  # it stands on its base


def test_widths_are_the_same_part_of_a_picture_of_any_size():
    ends = np.array([[-1, 0, 0], [1, 0, 0]], np.float32)
    camera = Camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0))

    def part(side, **width):
        line = Actor("lines", ends, np.array([[0, 1]], np.int32), color=(1.0, 0.0, 0.0), **width)
        picture = render_png(Description({"line": line}), size=(side, side), camera=camera)
        column = picture[:, side // 2].astype(int)
        return (column[:, 0] - column[:, 1] > 60).sum() / side

    for width in ({"width": 20}, {"width": 4, "thick": 0.02}):
        assert part(300, **width) == pytest.approx(part(1200, **width), abs=0.006)
    # A radius of the scene: as thick as a surface of that size.
    assert part(1200, width=4, thick=0.02) == pytest.approx(
        0.04 / (8 * np.tan(np.radians(15))), abs=0.002
    )


def test_where_no_corner_is_free_the_legend_stands_below_the_figures(rig):
    scene = weights_scene(rig, rig.weights)
    near = Camera((0.5, 0.0, 0.6), (0.5, 0.0, 0.0))  # the body fills the picture
    with Studio(scene, size=(300, 300)) as studio:
        picture = studio.draw(near)
    strip = np.abs(picture[-3, :].astype(int) - 255 * np.array(LIGHT.bottom)).max(axis=1)
    assert (strip < 3).all()


def test_a_ground_of_one_colour_or_none(rig):
    scene = weights_scene(rig, rig.weights)
    theme, clear = ground("light", "#102030")
    assert not clear
    with Studio(scene, theme, (200, 150)) as studio:
        assert studio.draw(studio.camera())[0, 0].tolist() == [16, 32, 48]
    theme, clear = ground("light", "transparent")
    with Studio(scene, theme, (200, 150), transparent=clear) as studio:
        picture = studio.draw(studio.camera())
    assert picture.shape == (150, 200, 4)
    assert picture[0, 0, 3] == 0
    assert picture[:, :, 3].max() == 255
    for background, kind in (("transparent", ".jpg"), ("kitchen", ".png")):
        with pytest.raises(ParameterError):
            ground("light", background, kind)
