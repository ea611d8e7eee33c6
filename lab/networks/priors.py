"""The priors that networks are compared with, computed once for each rig and kept in a folder."""

from __future__ import annotations

import hashlib
import io
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import platformdirs
from numpy.typing import NDArray

from cutcell.binding import bind
from cutcell.checks import check_choice
from cutcell.errors import CutcellError, ParameterError, WeightsError
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress, silent
from cutcell.runtime.sources import PACKAGE, source_digest
from cutcell.runtime.writing import write_all

from ..baselines import METHODS, Baseline, BaselineBinding
from ..baselines.methods import accepted_options
from ..dataset.read.sources import Source, find_sources, read_source
from .recipe import PRIOR_NAMES
from .samples import Sample, sample_rig


def bound(rig: Rig, resolution: int = 64, progress: Progress = silent) -> BaselineBinding:
    """Bind by `cutcell.bind` as it is, with its limit of influences."""
    binding = bind(rig, resolution, progress=progress)
    return BaselineBinding(binding.weights, binding.seconds, binding.warnings)


PRIORS: dict[str, Baseline | None] = {
    "none": None,
    **{name: METHODS[name] for name in PRIOR_NAMES if name in METHODS},
    "bind": bound,
}
"""Methods by name: no prior, RigNet's distance, UniRig's voxels, Dionne's voxels, the paper's
cut-cell graph, the same with paths at any angle, and what `bind` gives."""

OWN = ("__init__.py", "priors.py", "samples.py")
"""Files beside this one that samples and priors depend on; the others are of networks."""


def prior_of(
    name: str, rig: Rig, resolution: int = 64, progress: Progress = silent
) -> NDArray[np.float64] | None:
    """Compute a prior of a rig.

    Returns shapes (n, j).
    """
    method = PRIORS[check_choice("prior", name, PRIORS)]
    if method is None:
        return None
    options = accepted_options(method, resolution=resolution, progress=progress)
    binding = method(rig, **options)
    if binding.weights is None:
        raise WeightsError(f"the prior {name} cannot be computed: {binding.failed}")
    return binding.weights


@cache
def code_digest() -> str:
    """Hash the code that samples and priors depend on: all but the networks themselves."""
    networks = Path(__file__).resolve().parent
    packages = (networks.parent / name for name in ("baselines", "dataset"))
    return source_digest(PACKAGE, *packages, *(networks / name for name in OWN))


def cache_folder() -> Path:
    """Return where prepared samples are kept if no other folder is named.

    Raises
    ------
    ParameterError
        The user has no home folder.
    """
    try:
        return platformdirs.user_cache_path("cutcell", appauthor=False) / "networks"
    except RuntimeError:
        message = "the user has no home folder to keep samples in; name a folder (--cache)"
        raise ParameterError(message) from None


class Samples:
    """Prepared samples of rigs, one prior each.

    Parameters
    ----------
    paths : iterable of Path
        Files and folders of rigs, or stores; see `cutcell_lab.dataset.find_sources`.
    prior : str
        Of `PRIORS`.
    points : int
        Points a rig; 0 for all vertices.
    resolution : int
        R of the priors.
    cache : Path, optional
        Where what was computed is kept, until the code that computes it changes; `cache_folder`
        when left out.

    Raises
    ------
    ParameterError
        There is no such prior.
    FileError
        A path holds no rigs.
    """

    def __init__(
        self,
        paths: Iterable[Path],
        *,
        prior: str,
        points: int = 512,
        resolution: int = 64,
        cache: Path | None = None,
    ) -> None:
        self.prior = check_choice("prior", prior, PRIORS)
        self.points, self.resolution = points, resolution
        self.sources = find_sources(paths)
        self._cache = cache or cache_folder()

    def load(self, report: Callable[[str], None] = lambda text: None) -> list[Sample]:
        """Return the samples of all rigs that have weights, computing those that are not cached.

        Parameters
        ----------
        report : callable
            Called with the reason for each rig that is left out.
        """
        samples = []
        for source in self.sources:
            try:
                samples.append(self._sample(source))
            except CutcellError as error:
                report(f"{source.name} is left out: {error}")
        return samples

    def _sample(self, source: Source) -> Sample:
        key = self._key(source)
        whole = self._cache / f"{key}.npz"
        weights = self._cache / f"{key}-{self.prior}.npz"
        rig = None
        if not whole.exists():
            rig = _with_weights(source)
            _write(whole, vars(sample_rig(rig, self.points, seed=0)))
        sample = _read_sample(whole, source.name)
        if self.prior == "none":
            return sample
        if not weights.exists():
            rig = rig or _with_weights(source)
            prior = prior_of(self.prior, rig, self.resolution)
            _write(weights, {"prior": sample.of_rig(prior)})  # type: ignore[arg-type]
        with np.load(weights) as arrays:
            return replace(sample, prior=arrays["prior"])

    def _key(self, source: Source) -> str:
        digest = hashlib.blake2b(digest_size=12)
        for name, data in sorted(source.content().files.items()):
            digest.update(name.encode() + data)
        digest.update(f"{self.points} {self.resolution} {code_digest()}".encode())
        return digest.hexdigest()


def _with_weights(source: Source) -> Rig:
    with tempfile.TemporaryDirectory() as folder:
        rig = read_source(source, Path(folder))
    if rig.weights is None or not rig.weights.any():
        raise WeightsError("it has no weights to learn from")
    return rig


def _write(path: Path, arrays: dict) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    packed = io.BytesIO()
    stored = {key: value for key, value in arrays.items() if isinstance(value, np.ndarray)}
    np.savez_compressed(packed, **stored)  # type: ignore[arg-type]
    write_all({path: packed.getvalue()})


def _read_sample(path: Path, name: str) -> Sample:
    with np.load(path) as arrays:
        stored = {key: arrays[key] for key in arrays.files}
    return Sample(**{"name": name, "prior": None, "target": None, **stored})
