"""The file's materials on the panel Pose: offered, read when wanted, kept in the address."""

from dataclasses import replace

import numpy as np
import panel_material_ui as pmui
import pytest

import cutcell
from cutcell_app.document import loading
from cutcell_app.document.address import from_query, to_query
from cutcell_app.features.pose import materials
from cutcell_app.features.pose.controls import CONTROLS
from cutcell_app.features.scenes import following, resolve
from cutcell_app.shell.session import keys
from cutcell_app.widgets.changes import changes
from cutcell_app.widgets.controls import draw
from cutcell_viewers.description import Description
from tests.app.loop import settled
from tests.viewers.arm import arm_rig
from tests.viewers.textures import png, squares, wall


@pytest.fixture
def rig(tmp_path):
    return cutcell.load(wall(png(squares())).save(tmp_path / "wall.glb"))


@pytest.fixture
def posing(session, loop, rig):
    """Show the wall on the panel Pose."""
    session.state.resolution = 16
    session.state.panel = "pose"
    show(session, loop, rig)
    return session


def show(session, loop, rig):
    loading.show_rig(session, rig)
    settled(session, loop)


def buttons(session):
    groups = draw(session, CONTROLS).select(pmui.RadioButtonGroup)
    return next(one for one in groups if "plain" in one.options.values())


def test_materials_are_offered_where_the_file_has_any(posing, loop, rig):
    group = buttons(posing)
    assert group.options["Materials"] == "materials"
    group.value = "materials"
    assert posing.state.pose_colors == "materials"
    show(posing, loop, arm_rig())
    assert "Materials" not in group.options
    assert group.value == "weights"
    assert resolve(posing.state).actors["body"].materials is None
    show(posing, loop, rig)
    assert "Materials" in group.options


def test_nothing_is_read_before_it_is_wanted(posing, loop, monkeypatch):
    read, seen = materials.read, []
    monkeypatch.setattr(materials, "read", lambda *given: seen.append(1) or read(*given))
    posing.state.panel = "weights"
    posing.state.pose_colors = "materials"
    settled(posing, loop)
    assert seen == []
    assert posing.state.materials is None
    posing.state.panel = "pose"
    settled(posing, loop)
    assert posing.state.materials is not None
    posing.state.pose_colors = "plain"
    posing.state.pose_colors = "materials"
    posing.state.turns = {0: (0, 0, 30)}
    settled(posing, loop)
    assert seen == [1]


def test_the_body_is_seen_in_them_without_a_legend(posing, loop):
    state = posing.state
    state.pose_colors = "materials"
    assert resolve(state).legend is not None, "until they are read the weights are seen"
    settled(posing, loop)
    scene = resolve(state)
    actor = scene.actors["body"]
    assert scene.legend is actor.colors is actor.scalars is None
    assert scene.images.shape == (1, 128, 128, 4)
    assert len(actor.materials.corners) == len(actor.cells)
    state.moving = True
    assert following(state).images is scene.images
    state.rival = "beside"
    both = resolve(state).actors
    assert both["rival"].materials is both["body"].materials
    state.heat = True
    assert resolve(state).actors["body"].materials is None
    assert resolve(state).images is None


def test_what_hangs_on_the_body_has_its_materials_too(posing, loop, rig):
    sword = replace(
        rig, attachments=(cutcell.Attachment("sword", rig.mesh, 1),),
        source=replace(rig.source, attached=(2,)),
    )  # fmt: skip
    show(posing, loop, sword)
    posing.state.pose_colors = "materials"
    settled(posing, loop)
    actors = resolve(posing.state).actors
    given = actors["attachment 0"].materials
    np.testing.assert_array_equal(given.corners, actors["body"].materials.corners)


def test_they_are_in_the_address_and_undone(posing, loop):
    state = posing.state
    state.pose_colors = "materials"
    settled(posing, loop)
    choices, _, problems = from_query(to_query(state), state)
    assert choices["pose_colors"] == "materials"
    assert problems == []
    keys.act(posing, "undo")
    settled(posing, loop)
    assert state.pose_colors == "weights"
    keys.act(posing, "redo")
    settled(posing, loop)
    assert state.pose_colors == "materials"


def test_a_repaired_mesh_gets_its_own(posing, loop, rig):
    from cutcell.io.gltf.write.faces import with_faces

    posing.state.pose_colors = "materials"
    settled(posing, loop)
    is_left = np.ones(len(rig.mesh.faces), bool)
    is_left[3] = False
    posing.state.rig = with_faces(rig, is_left, ~is_left)
    loop.rest(posing)
    textures = posing.state.materials
    assert len(textures.body.corners) == len(rig.mesh.faces) - 1


def test_a_broken_image_is_told_below_the_choice_and_is_no_error(posing, loop, tmp_path):
    broken = wall(b"no image", pbr={"baseColorFactor": [1, 0, 0, 1]})
    panel = draw(posing, CONTROLS)
    show(posing, loop, cutcell.load(broken.save(tmp_path / "broken.glb")))
    posing.state.pose_colors = "materials"
    settled(posing, loop)
    texts = [str(one.object) for one in panel.select(pmui.Typography)]
    assert any("cannot be shown" in text for text in texts)
    assert (resolve(posing.state).actors["body"].materials.tints == (255, 0, 0)).all()


def test_images_are_sent_once_and_given_back(posing, loop):
    posing.state.pose_colors = "materials"
    settled(posing, loop)
    scene = resolve(posing.state)
    sent = set()
    message = changes(Description(), scene, sent)
    assert {name: message["images"][name] for name in ("count", "side")} == {
        "count": 1,
        "side": 128,
    }
    assert len(message["images"]["pixels"]) == 128 * 128 * 4
    body = message["actors"]["body"]
    assert len(body["materials"]["corners"]) == 12 * len(scene.actors["body"].cells)
    assert body["paint"]["coloured"] is True
    posing.state.turns = {0: (0, 0, 30)}
    turned = resolve(posing.state)
    assert "images" not in (later := changes(scene, turned, sent))
    assert "materials" not in later.get("actors", {}).get("body", {})
    posing.state.pose_colors = "weights"
    back = changes(turned, resolve(posing.state), sent)
    assert back["images"] is None
    assert "colors" in back["actors"]["body"]
