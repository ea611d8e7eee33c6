"""People stand upright, with the weights that the package anny has, and results stay alone."""

from types import SimpleNamespace

import numpy as np
import pytest
import torch

from cutcell_assets.generate import generate, people


class Model(SimpleNamespace):
    """A square with two bones, one above the other, as anny has them: z is up."""

    bone_count = 2
    bone_labels = ("root", "spine01")
    bone_parents = (-1, 0)
    phenotype_labels = ("age",)
    faces = ((0, 1, 2, 3),)
    vertex_bone_indices = ((0, 1), (0, 1), (0, 1), (0, 1))
    vertex_bone_weights = ((2.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.25, 0.75))

    def __call__(self, pose_parameters, phenotype_kwargs):
        print("compiled")
        places = torch.tensor([[0.0, 0, 0], [1, 0, 0], [1, 0, 2], [0, 0, 2]])
        poses = torch.eye(4).repeat(1, 2, 1, 1)
        poses[0, 1, :3, 3] = torch.tensor([0.5, -0.25, 1])
        return {"vertices": places[None], "bone_poses": poses}


@pytest.fixture(autouse=True)
def model(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "anny", SimpleNamespace())
    monkeypatch.setattr(people, "_model", Model)


def test_hand_made_weights_arrive_and_y_is_up():
    rig = generate("person", 3, clean=True)
    np.testing.assert_allclose(rig.weights, [[1, 0], [0.5, 0.5], [0, 1], [0.25, 0.75]])
    np.testing.assert_allclose(rig.mesh.vertices[2], [1, 2, 0])
    np.testing.assert_allclose(rig.skeleton.joints[1], [0.5, 1, 0.25])
    assert rig.mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_what_the_kernels_print_is_no_result(capsys):
    generate("person", 0, clean=True)
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "compiled" in printed.err
