"""Tasks of `cutcell.isolated` that need torch: they take arrays and return arrays."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutcell.errors import CutcellError
from cutcell.rig import Rig, Skeleton, TriangleMesh

from .samples import deal_rig


def recipes(folders: NDArray[np.str_]) -> dict[str, NDArray]:
    """Read the recipes of trained networks."""
    from .training import read_recipe

    texts, problems = [], []
    for folder in folders:
        recipe, problem = "", ""
        try:
            recipe = json.dumps(asdict(read_recipe(Path(str(folder)))))
        except CutcellError as error:
            problem = str(error)
        texts.append(recipe)
        problems.append(problem)
    return {"recipes": np.array(texts), "problems": np.array(problems)}


def weights(
    folder: NDArray[np.str_],
    vertices: NDArray[np.float64],
    faces: NDArray[np.integer],
    joints: NDArray[np.float64],
    parents: NDArray[np.integer],
    deform: NDArray[np.bool_],
    prior: NDArray[np.float64] | None = None,
) -> dict[str, NDArray]:
    """Predict the weights of a rig by the network in a folder.

    Shapes: vertices (n, 3), faces (m, 3), joints (j, 3), parents and deform (j,), prior (n, j);
    returns "vertices" (p,), the first one of each welded vertex with faces, and "weights" (p, j).
    """
    from .heads.heads import predict
    from .training import load_network

    network, recipe = load_network(Path(str(folder)))
    rig = Rig(TriangleMesh(vertices, faces), Skeleton(joints, parents, deform=deform))
    where, parts = [], []
    # Drawn as densely as in training, and then looked at as many together.
    for sample in deal_rig(rig, 4 * recipe.points):
        part = np.zeros((len(sample.points), len(joints)))
        part[:, sample.deform] = predict(network, [sample.with_prior(prior)], recipe.points)[0]
        where.append(sample.vertices)
        parts.append(part)
    return {"vertices": np.concatenate(where), "weights": np.concatenate(parts)}
