"""Trained networks as methods. A crash of torch, or cancelling, ends only a subprocess."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from cutcell.errors import FileError
from cutcell.isolated.run import run_isolated
from cutcell.method import PAPER
from cutcell.rig import Rig
from cutcell.runtime.memory import BYTES_PER_WEIGHT, check_room
from cutcell.runtime.progress import Progress, silent

from ..baselines import BaselineBinding
from ..baselines.body import Body
from ..baselines.frame import Run, bind_by
from .priors import prior_of
from .recipe import Recipe
from .samples import LENGTHS, STORED_NEIGHBOURS
from .torch_required import check_torch

LIMIT = 600.0
"""Seconds that a prediction may take."""
WORKER, EXTRA = "cutcell_lab.networks.worker", "cutcell[networks]"
"""Module whose functions need torch, and what installs that."""
TORCH_BYTES = 400_000_000
"""Memory of torch after its import."""
HIDDEN_BYTES = 16_384
"""Bytes of the widest layers for each point and joint of a batch."""


@dataclass(frozen=True)
class TrainedNetwork:
    """A trained network as a method: its prior is computed, then it predicts the weights.

    Parameters
    ----------
    folder : Path
        Of `cutcell networks train`; read at each call.
    recipe : Recipe
    title : str
        For tables and menus.
    """

    folder: Path
    recipe: Recipe
    title: str

    def __call__(
        self,
        rig: Rig,
        *,
        max_influences: int | None = None,
        threshold: float = 0.0,
        progress: Progress = silent,
    ) -> BaselineBinding:
        """Bind a rig; its resolution is the one that the network was trained with."""
        check_torch()
        self._check_memory(rig)
        recipe = self.recipe

        def solve(body: Body, run: Run) -> NDArray[np.float64]:
            prior = prior_of(recipe.prior, rig, recipe.resolution, progress)
            run.end("prior")
            predict = self._predicted(rig, prior)
            run.end("network")
            return predict(body)

        method = PAPER.with_options(max_influences=max_influences, threshold=threshold)
        return bind_by(solve, rig, method)

    def _predicted(
        self, rig: Rig, prior: NDArray[np.float64] | None
    ) -> Callable[[Body], NDArray[np.float64]]:
        job = {
            "folder": np.array(str(self.folder.resolve())),
            "vertices": rig.mesh.vertices,
            "faces": rig.mesh.faces,
            "joints": rig.skeleton.joints,
            "parents": rig.skeleton.parents,
            "deform": rig.skeleton.deform,
            **({} if prior is None else {"prior": prior}),
        }
        result = run_isolated(f"{WORKER}:weights", job, LIMIT, "the network", extra=EXTRA)
        return partial(_of_body, result["vertices"], result["weights"])

    def _check_memory(self, rig: Rig) -> None:
        path = self.folder / "network.pt"
        size = path.stat().st_size if path.exists() else 0
        count, joints = len(rig.mesh.vertices), len(rig.skeleton.joints)
        points = 4 * self.recipe.points
        check_room(
            TORCH_BYTES
            + size
            + 4 * count * joints * BYTES_PER_WEIGHT
            + 2 * min(512 * count, max(LENGTHS, count)) * 8
            + points * STORED_NEIGHBOURS * 8
            + self.recipe.points * joints * HIDDEN_BYTES,
            f"a network that looks at {count:,} vertices and {joints:,} joints",
            "leave out vertices or joints",
        )


def _of_body(vertices: NDArray, weights: NDArray, body: Body) -> NDArray[np.float64]:
    """Return weights of all welded vertices, (k, j), from those of some vertices.

    Vertices without faces follow their nearest.
    """
    full = np.zeros((len(body.points), weights.shape[1]))
    at = body.index[vertices]
    full[at] = weights
    left = np.setdiff1d(np.arange(len(full)), at)
    if len(left):
        full[left] = full[at[cKDTree(body.points[at]).query(body.points[left])[1]]]
    return full


def trained_networks(
    folders: Iterable[Path], report: Callable[[str], None] = lambda text: None
) -> dict[str, TrainedNetwork]:
    """Find trained networks.

    Parameters
    ----------
    folders : iterable of Path
        Folders of `cutcell networks train`, or folders that hold such.
    report : callable
        Called with the reason for each that cannot be used.

    Returns
    -------
    dict of str to TrainedNetwork
        By name: head, prior, size and seed, such as "rignet-cutcell-tiny-0"; where several have the
        same, their folders make the difference.

    Raises
    ------
    MissingLibraryError
        torch is not installed.
    FileError
        A folder holds no trained network, or none that can be used.
    """
    check_torch()
    runs = [run for folder in folders for run in _runs(Path(folder))]
    job = {"folders": np.array([str(run.resolve()) for run in runs], np.str_)}
    read = run_isolated(f"{WORKER}:recipes", job, LIMIT, "torch", extra=EXTRA)
    usable = []
    for run, recipe, problem in zip(runs, read["recipes"], read["problems"], strict=True):
        if recipe:
            usable.append((run, Recipe(**json.loads(str(recipe)))))
        else:
            report(f"left out: {problem}")
    if runs and not usable:
        raise FileError(f"none of the networks can be used: {read['problems'][0]}")
    counts = Counter(recipe.name for _, recipe in usable)
    methods: dict[str, TrainedNetwork] = {}
    for run, recipe in usable:
        name, title = recipe.name, recipe.title
        if counts[name] > 1:
            title = f"{title} ({run.name})"
            name = f"{name}-{sum(one.startswith(recipe.name) for one in methods) + 1}"
        methods[name] = TrainedNetwork(run, recipe, title)
    return methods


def _runs(folder: Path) -> list[Path]:
    """List the folders of trained networks: this one, or those in it."""
    if (folder / "network.pt").is_file():
        return [folder]
    if not folder.is_dir():
        raise FileError(f"{folder}: there is no such folder")
    runs = sorted(path.parent for path in folder.glob("*/network.pt"))
    if not runs:
        raise FileError(f"{folder}: holds no trained network (network.pt), nor do its folders")
    return runs
