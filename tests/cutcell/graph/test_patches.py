"""Which faces run against their neighbours."""

import numpy as np
import pytest

from cutcell.graph.boundary import find_boundary
from cutcell.graph.caps import cap_holes
from cutcell.graph.patches import inconsistent_faces
from tests import meshes


@pytest.mark.parametrize("share", [0.0, 0.1, 0.4])
def test_turned_faces_are_found(share):
    vertices, faces = meshes.ball(2)
    turned = np.random.default_rng(0).random(len(faces)) < share
    faces = np.where(turned[:, None], faces[:, ::-1], faces)
    np.testing.assert_array_equal(inconsistent_faces(vertices, faces), turned)


def test_what_has_one_side_alone_is_left_as_it_is():
    turn = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    middle = np.stack([np.cos(turn), np.sin(turn), np.zeros(12)], axis=1) / 4 + 0.5
    out = np.stack([np.cos(turn / 2) * np.cos(turn), np.cos(turn / 2) * np.sin(turn)], axis=1)
    wide = np.concatenate([out, np.sin(turn / 2)[:, None]], axis=1) / 16
    a = np.arange(11)
    strip = [[a, a + 1, a + 13], [a, a + 13, a + 12]]
    faces = np.concatenate([np.stack(f, axis=1) for f in strip] + [[[11, 12, 0], [11, 0, 23]]])
    vertices = np.concatenate([middle - wide, middle + wide])
    assert not inconsistent_faces(vertices, faces.astype(np.int32)).any()


def test_caps_of_many_turned_faces_close_the_mesh_and_are_small():
    vertices, faces = meshes.ball(4)
    turned = np.random.default_rng(1).random(len(faces)) < 0.4
    faces = np.where(turned[:, None], faces[:, ::-1], faces)
    caps = cap_holes(vertices, faces, find_boundary(faces))
    assert len(find_boundary(np.concatenate([faces, caps.faces])).loop) == 0
    corners = vertices[faces]
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert caps.area <= np.linalg.norm(sides, axis=1)[turned].sum() * (1 + 1e-9)
