"""The twins are broken in the ways that their titles claim, and only so."""

import numpy as np
import trimesh

import cutcell

from .conftest import load


def test_the_soup_shares_no_vertex_and_has_holes():
    soup = load("biped_soup")
    faces = soup.rig.mesh.faces
    assert len(np.unique(faces)) == faces.size == len(soup.rig.mesh.vertices)
    welded = trimesh.Trimesh(soup.vertices, soup.faces, process=False)
    assert not welded.is_watertight
    rims = welded.edges[trimesh.grouping.group_rows(welded.edges_sorted, require_count=1)]
    assert len(rims) > 300
    assert len(rims) < 0.1 * len(welded.edges_unique)  # yet most of the surface is there


def test_the_flipped_arm_differs_in_orientation_only():
    whole, twin = load("biped").rig, load("biped_flipped_arm").rig
    np.testing.assert_array_equal(whole.mesh.vertices, twin.mesh.vertices)
    np.testing.assert_array_equal(whole.weights, twin.weights)
    same = (whole.mesh.faces == twin.mesh.faces).all(axis=1)
    turned = np.sort(whole.mesh.faces, axis=1) == np.sort(twin.mesh.faces, axis=1)
    assert turned.all()
    skeleton = whole.skeleton
    arm = skeleton.subtree[skeleton.names.index("upper_arm.R")]
    share = whole.weights[:, arm].sum(axis=1)[whole.mesh.faces].mean(axis=1)
    np.testing.assert_array_equal(~same, share > 0.5)
    assert 1000 < (~same).sum() < 0.3 * len(same)


def test_the_cape_is_one_open_sheet_away_from_the_body():
    whole, caped = load("biped"), load("biped_cape")
    count = len(whole.rig.mesh.vertices)
    np.testing.assert_array_equal(caped.rig.mesh.vertices[:count], whole.rig.mesh.vertices)
    cape = caped.rig.mesh.faces[len(whole.rig.mesh.faces) :] - count
    sheet = trimesh.Trimesh(caped.rig.mesh.vertices[count:], cape, process=False)
    assert sheet.body_count == 1
    assert sheet.is_winding_consistent
    assert sheet.euler_number == 1  # a disc: one rim, no handle
    distance = trimesh.proximity.ProximityQuery(
        trimesh.Trimesh(whole.vertices, whole.faces, process=False)
    ).vertex(sheet.vertices)[0]
    assert 0.01 < distance.min() < 0.03
    samples = np.concatenate([sheet.vertices, sheet.triangles_center])
    assert cutcell.winding_number(whole.rig.mesh, samples).max() < 0.5  # it pierces nothing


def test_the_cape_hangs_on_the_trunk_and_moves_with_it():
    caped = load("biped_cape").rig
    count = len(load("biped").rig.mesh.vertices)
    used = np.array(caped.skeleton.names)[(caped.weights[count:] > 0).any(axis=0)]
    assert {"chest", "spine1", "hips", "clavicle.L", "clavicle.R"} <= set(used)
