"""Which faces are inconsistently oriented."""

import numpy as np
import pytest

from cutcell.geometry.welded import WeldedMesh
from cutcell.graph.orientation.patches import find_patches, measure_faces
from tests import meshes


def inconsistent_faces(vertices, faces):
    """Tell which faces are to be flipped."""
    areas, _ = measure_faces(vertices, faces)
    return find_patches(WeldedMesh.of(vertices, faces), areas).flips


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
