"""Training samples of a store: arrays, and a data set for torch where it is installed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cutcell.checks import check_choice, check_integer
from cutcell.errors import FileError, MissingLibraryError

from .audit.points import SurfacePoints, sample_surface
from .read.entry import read_entry
from .read.store import Store

Prior = Literal["weights", "distances", "bone_distances"]
PRIORS: tuple[Prior, ...] = ("weights", "distances", "bone_distances")


def at_points(table: NDArray, faces: NDArray, points: SurfacePoints) -> NDArray:
    """Interpolate values of the vertices, shape (n, k), at points on the faces, shape (p, k).

    Infinite where a corner of nonzero weight is infinite.
    """
    corners = faces[points.face]
    total = np.zeros((len(corners), table.shape[1]))
    for k in range(3):
        share = points.shares[:, k, None]
        values = table[corners[:, k]].astype(np.float64)
        total += np.where(share > 0, values, 0) * np.where(share > 0, share, 0)
    return total


class RigSamples:
    """Samples of a store, one an asset, as numpy arrays.

    Parameters
    ----------
    store : path
        Made by `bind_all`.
    points : int
        Points on the surface, by area; 0 for the vertices themselves.
    prior : {"weights", "distances", "bone_distances"}
        Input of the network.
    seed : int
        Seed of the points, which differ in each `epoch`.
    names : sequence of str, optional
        Only these assets, such as those that an audit keeps.

    Raises
    ------
    FileError
        It is no store, or holds no asset of such a name.
    ParameterError
        There is no such prior.
    """

    def __init__(
        self,
        store: str | Path,
        *,
        points: int = 2048,
        prior: Prior = "weights",
        seed: int = 0,
        names: Sequence[str] | None = None,
    ) -> None:
        self.prior = check_choice("prior", prior, PRIORS)
        self.points = check_integer("points", points, 0, 10_000_000)
        self.seed, self.epoch = seed, 0
        folder = Path(store)
        rows = [row for row in Store(folder).manifest() if not row["error"]]
        if names is not None:
            requested = set(names)
            rows = [row for row in rows if row["name"] in requested]
            missing = requested - {row["name"] for row in rows}
            if missing:
                raise FileError(f"{folder}: holds no asset {sorted(missing)[0]!r}")
        self.names = [row["name"] for row in rows]
        self._paths = [folder / row["path"] for row in rows]

    def __len__(self) -> int:
        return len(self._paths)

    def sample(self, index: int) -> dict[str, Any]:
        """Return one asset.

        Returns
        -------
        dict
            `points` (p, 3), `prior` (p, j) or (p, b), `target` (p, j), the artist's weights, ours
            where there are none; `joints` (j, 3), `parents` (j,), `name`.
        """
        entry = read_entry(self._paths[index])
        prior = {"weights": entry.weights, "distances": entry.distances,
                 "bone_distances": entry.bone_distances}[self.prior]  # fmt: skip
        target = entry.weights if entry.artist is None else entry.artist
        places: NDArray = entry.vertices
        if self.points:
            seed = int(np.random.SeedSequence([self.seed, self.epoch, index]).generate_state(1)[0])
            drawn = sample_surface(entry.vertices, entry.faces, self.points, seed)
            places = drawn.places
            prior = at_points(prior, entry.faces, drawn)
            target = at_points(target, entry.faces, drawn)
        return {
            "name": self.names[index],
            "points": places.astype(np.float32),
            "prior": prior.astype(np.float32),
            "target": target.astype(np.float32),
            "joints": entry.joints,
            "parents": entry.parents.astype(np.int64),
        }


def collate_samples(samples: Sequence[Mapping[str, Any]], prior: str) -> dict[str, Any]:
    """Put samples of different numbers of points and joints into one batch.

    Parameters
    ----------
    samples : sequence of dict
        See `RigSamples.sample`.
    prior : str
        Kind of the prior: distances are padded with infinity, weights with 0.

    Returns
    -------
    dict
        The arrays with a first axis for the samples, as large as the largest; `point_mask` (s, p)
        and `joint_mask` (s, j) are false for padding; `name` is a list.
    """
    batch: dict[str, Any] = {"name": [sample["name"] for sample in samples]}
    fill = {"parents": -1, "prior": 0.0 if prior == "weights" else np.inf}
    for key in ("points", "prior", "target", "joints", "parents"):
        arrays = [np.asarray(sample[key]) for sample in samples]
        shape = np.max([array.shape for array in arrays], axis=0)
        whole = np.full((len(arrays), *shape), fill.get(key, 0), arrays[0].dtype)
        for row, array in zip(whole, arrays, strict=True):
            row[tuple(slice(n) for n in array.shape)] = array
        batch[key] = whole
    for mask, key in (("point_mask", "points"), ("joint_mask", "joints")):
        counts = np.array([len(sample[key]) for sample in samples])
        batch[mask] = np.arange(batch[key].shape[1]) < counts[:, None]
    return batch


class RigDataset(RigSamples):
    """A store as a data set for `torch.utils.data.DataLoader`; needs torch.

    It has the parameters of `RigSamples`. Pass `collate` to the loader: rigs differ in size.

    Raises
    ------
    MissingLibraryError
        torch is not installed.

    Examples
    --------
    >>> rigs = cutcell_lab.dataset.RigDataset("store", points=4096)  # doctest: +SKIP
    >>> DataLoader(rigs, batch_size=8, collate_fn=rigs.collate)  # doctest: +SKIP
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        try:
            import torch
        except ImportError:
            raise MissingLibraryError(
                "RigDataset returns tensors of torch, which is not installed; try: pip install "
                "torch, or use RigSamples, which returns numpy arrays"
            ) from None
        super().__init__(*arguments, **options)
        self._tensor = torch.from_numpy

    def __getitem__(self, index: int) -> dict[str, Any]:
        return self._tensors(self.sample(index))

    def collate(self, samples: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
        """Return several samples as one batch; see `collate_samples`."""
        return self._tensors(collate_samples(samples, self.prior))

    def _tensors(self, values: Mapping[str, Any]) -> dict[str, Any]:
        return {
            key: self._tensor(np.ascontiguousarray(value))
            if isinstance(value, np.ndarray)
            else value
            for key, value in values.items()
        }
