"""Colours: the paper's three, maps that rise evenly, joints that can be told apart."""

from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell_assets import DEMOS, demo_path
from cutcell_viewers import palette
from cutcell_viewers.joint_colors import colors_of, joint_colors
from tests.conftest import SHARED_RIGS
from tests.viewers.arm import arm_rig


def test_the_papers_colours():
    assert palette.to_hex(palette.MESH) == "#90d2ec"
    assert palette.to_hex(palette.INTERIOR) == "#ff6c0c"
    assert palette.to_hex(palette.SURFACE) == "#99cb43"


@pytest.mark.parametrize("name", ["weight", "distance"])
def test_maps_go_from_light_to_dark(name):
    table = palette.colormap(name).astype(float)
    assert table.shape == (palette.TEXELS, 3)
    light = table @ [0.2126, 0.7152, 0.0722]
    # Iso-lines are dark on purpose: look between them.
    smooth = light[:: palette.TEXELS // palette.ISO_LINES]
    assert (np.diff(smooth) < 2).all()
    assert smooth[0] > 180
    assert smooth[-1] < 60


def test_colour_maps_cannot_be_changed_by_their_users():
    with pytest.raises(ValueError):
        palette.colormap("weight")[0] = 0


def test_iso_lines_are_as_many_as_they_say():
    dark = palette.colormap("distance").astype(float).sum(axis=1)
    drops = np.flatnonzero(np.diff(dark) < -60)
    assert len(drops) in (palette.ISO_LINES - 1, palette.ISO_LINES)


def test_maps_of_matplotlib_take_the_place_of_ours():
    from matplotlib import colormaps

    table = palette.colormap("weight:viridis")
    expected = 255 * colormaps["viridis"](np.linspace(0, 1, palette.TEXELS))[:, :3]
    np.testing.assert_allclose(table, expected, atol=0.5)
    lined, ours = palette.colormap("distance:gray"), palette.colormap("distance")
    assert (np.diff(lined.astype(int).sum(axis=1)) < -60).sum() >= palette.ISO_LINES // 2
    reached = palette.colormap("reached:turbo")
    assert (reached[-1] == palette.to_bytes(palette.UNREACHED)).all()
    assert reached.shape == lined.shape == ours.shape


def test_an_unknown_map_is_refused():
    with pytest.raises(cutcell.CutcellError, match="viridis"):
        palette.colormap("weight:no such map")


def test_neighbouring_joints_have_different_colours():
    colors = joint_colors(np.arange(60) - 1)
    assert ((colors >= 0) & (colors <= 1)).all()
    assert np.abs(np.diff(colors, axis=0)).max(axis=1).min() > 0.1


def test_greys_that_stand_for_different_things_are_told_apart():
    greys = [palette.BODY, palette.UNREACHED, palette.ATTACHMENT]
    light = np.array(greys) @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(light) < -0.12).all()


@pytest.mark.parametrize("theme", palette.THEMES.values(), ids=palette.THEMES)
def test_the_three_kinds_of_edges_are_told_apart_by_every_eye(theme):
    kinds = [theme.mesh_edge, palette.INTERIOR, theme.surface_edge]
    apart = palette.differences(kinds)[np.triu_indices(3, 1)]
    assert apart.min() > 0.15
    # Shading and haze change the lightness of lines: hue and saturation alone tell them apart, too.
    for eye in ("all cones", "no long cones", "no middle cones"):
        labs = palette._srgb_to_oklab(palette.as_seen(kinds, eye))[:, 1:]
        chroma = np.linalg.norm(labs[:, None] - labs, axis=2)[np.triu_indices(3, 1)]
        assert chroma.min() > 0.08
    # Green and orange of the paper are hardly two colours to an eye without middle cones.
    paper = palette.differences([palette.INTERIOR, palette.SURFACE])[0, 1]
    assert paper < 0.1


def test_colours_of_joints_repeat_only_when_all_are_used():
    count = len(palette.JOINT_COLORS)
    # Joints in a star, of which four have no skin.
    parents, idle = np.array([-1, *[0] * (count + 3)]), [1, 2, 3, 4]
    sizes = np.ones(count + 4)
    sizes[idle] = 0
    colors = joint_colors(parents, sizes=sizes)
    assert len(np.unique(np.delete(colors, idle, axis=0), axis=0)) == count


def test_parts_whose_skin_touches_have_other_colours():
    rng = np.random.default_rng(0)
    parents = np.concatenate([[-1], [int(rng.integers(k)) for k in range(1, 80)]])
    touching = np.array([(a, b) for a in range(80) for b in (a + 7, a + 20, a + 33) if b < 80])
    colors = joint_colors(parents, touching)
    assert (np.abs(colors[touching[:, 0]] - colors[touching[:, 1]]).max(axis=1) > 0).all()


CHARACTERS = [*(demo_path(demo.id) for demo in DEMOS), *sorted(SHARED_RIGS.glob("*.glb"))]


@pytest.mark.parametrize("path", CHARACTERS, ids=lambda path: path.stem)
def test_neighbours_differ_clearly_on_characters(path):
    rig = cutcell.load(path)
    colors, parents = colors_of(rig), rig.skeleton.parents
    strongest = rig.weights.argmax(axis=1)
    corners = strongest[rig.mesh.faces]
    touching = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    family = np.stack([np.flatnonzero(parents >= 0), parents[parents >= 0]], axis=1)
    family = family[np.isin(family, strongest).all(axis=1)]
    pairs = np.concatenate([touching, family])
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    labs = palette._srgb_to_oklab(colors)
    assert np.linalg.norm(labs[pairs[:, 0]] - labs[pairs[:, 1]], axis=1).min() > 0.14
    assert palette.differences(colors)[pairs[:, 0], pairs[:, 1]].min() > 0.08


def test_large_parts_do_not_share_colours():
    rig = cutcell.load(demo_path("biped"))
    largest = np.argsort(-np.bincount(rig.weights.argmax(axis=1)))[:12]
    assert len(np.unique(colors_of(rig)[largest], axis=0)) >= 11


def test_all_colours_of_joints_are_told_apart():
    colors, pairs = (
        np.array(palette.JOINT_COLORS) / 255,
        np.triu_indices(len(palette.JOINT_COLORS), 1),
    )
    assert palette.differences(colors, ("all cones",))[pairs].min() > 0.09
    assert palette.differences(colors, ("no middle cones",))[pairs].min() > 0.06
    assert palette.differences(colors)[pairs].min() > 0.06


def test_hand_spine_and_the_opposite_thigh_differ():
    rig = cutcell.load(demo_path("biped"))
    joints = [rig.skeleton.names.index(name) for name in ("hand.L", "spine2", "thigh.R")]
    assert palette.differences(colors_of(rig)[joints])[np.triu_indices(3, 1)].min() > 0.08


def test_parts_that_are_near_in_space_differ_without_touching():
    nearby = np.array([(a, b) for a in range(60) for b in (a + 16, a + 32) if b < 60])
    colors = joint_colors(np.full(60, -1), nearby=nearby)
    labs = palette._srgb_to_oklab(colors)
    assert np.linalg.norm(labs[nearby[:, 0]] - labs[nearby[:, 1]], axis=1).min() > 0.14


def test_a_rig_without_weights_has_neighbours_too():
    rig = cutcell.load(demo_path("biped"))
    colors = colors_of(replace(rig, weights=None))
    names = {name: colors[joint] for joint, name in enumerate(rig.skeleton.names)}
    assert (names["hips"] != names["thigh.L"]).any()
    assert (names["hand.L"] != names["thigh.L"]).any()


def test_a_rig_takes_its_touching_parts_from_the_files_weights():
    rig = arm_rig()
    weights = np.zeros_like(rig.weights)
    weights[:, 2] = rig.mesh.vertices[:, 0] > 0
    weights[:, 0] = 1 - weights[:, 2]
    rig = rig.with_weights(weights)
    colors = colors_of(rig)
    assert colors_of(rig) is colors
    assert (colors[0] != colors[2]).any()
