"""Measure predicted weights in files against the weights of other files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.checks import one_line
from cutcell.errors import Cancelled, CutcellError, FileError, WeightsError
from cutcell.io import load
from cutcell.io.files import naming
from cutcell.io.weights import normalised
from cutcell.rig import Rig

from ..dataset.read.entry import read_entry
from ..dataset.read.sources import Source, read_source
from ..metrics import errors_by_definition
from .align import align_weights
from .pairs import Pair, find_pairs
from .scores import Evaluation, RigErrors


def evaluate(
    predicted: str | Path,
    reference: str | Path,
    *,
    report: Callable[[int, int, str], Any] | None = None,
) -> Evaluation:
    """Measure weights in files against those in other files, by the definitions of three papers.

    Parameters
    ----------
    predicted : path
        A rig with the weights to measure, a NumPy array of weights (``.npy``, in the reference's
        order of vertices and joints), or a folder of either.
    reference : path
        The rig with the right weights, or a folder of such rigs. Those of folders are matched by
        file name, without ending.
    report : callable, optional
        Called before each rig with the number done, the number of all, and its name.

    Returns
    -------
    Evaluation

    Raises
    ------
    FileError
        A file that cannot be read, or no files to match.
    SkeletonError, WeightsError
        Weights that cannot be compared. In folders, such rigs are listed in `failed`; an error is
        raised if there are no others.
    """
    matches = find_pairs(Path(predicted), Path(reference))
    rigs: list[RigErrors] = []
    failed: dict[str, str] = {}
    for done, pair in enumerate(matches.pairs):
        if report is not None:
            report(done, len(matches.pairs), pair.name)
        try:
            rigs.append(_evaluate_pair(pair))
        except Cancelled:
            raise
        except CutcellError as error:
            if len(matches.pairs) == 1:
                raise
            failed[pair.name] = str(error)
    if not rigs:
        name, reason = next(iter(failed.items()))
        raise FileError(f"none of {len(failed)} rigs could be evaluated. {name}: {reason}")
    return Evaluation(tuple(rigs), failed, matches.predicted_only, matches.reference_only)


def _evaluate_pair(pair: Pair) -> RigErrors:
    reference = _read(pair.reference)
    with naming(_label(pair.reference)):
        reference.require_joints()
        if reference.weights is None:
            raise WeightsError("the reference has no weights to compare with")
    warnings = [f"{_label(pair.reference)}: {text}" for text in reference.warnings]
    if pair.predicted.kind == "weights":
        with naming(_label(pair.predicted)):
            weights = _read_array(pair.predicted.path, reference)
    else:
        prediction = _read_prediction(pair.predicted)
        with naming(_label(pair.predicted)):
            weights, notes = align_weights(prediction, reference)
        warnings += [f"{_label(pair.predicted)}: {text}" for text in (*prediction.warnings, *notes)]
    return RigErrors(
        pair.name,
        str(pair.predicted.path),
        str(pair.reference.path),
        len(reference.mesh.vertices),
        len(reference.skeleton.joints),
        errors_by_definition(reference, weights, reference.weights),
        tuple(dict.fromkeys(warnings)),
    )


def _label(source: Source) -> Path:
    """Return the name that a user knows a rig by: its file's, unless that holds several."""
    return Path(source.path.name if source.kind in ("file", "weights") else source.name)


def _read(source: Source) -> Rig:
    if source.kind == "file":
        return load(source.path)
    with TemporaryDirectory() as folder:
        return read_source(source, Path(folder))


def _read_prediction(source: Source) -> Rig:
    """Return a rig with the weights to measure: of a store, those that it computed."""
    rig = _read(source)
    if source.kind == "stored":
        return rig.with_weights(read_entry(source.path).weights.astype(np.float64))
    return rig


def _read_array(path: Path, reference: Rig) -> NDArray[np.float64]:
    """Return weights (n, j) of a NumPy file, scaled so that rows sum to one."""
    try:
        array = np.asarray(np.load(path, allow_pickle=False))
    except (OSError, ValueError, EOFError) as error:
        raise FileError(f"is no readable array of numbers ({one_line(error)[:200]})") from None
    if array.dtype.kind not in "fiu":
        raise FileError(f"is no readable array of numbers (its type is {array.dtype})")
    array = array.astype(np.float64)
    expected = (len(reference.mesh.vertices), len(reference.skeleton.joints))
    if array.shape != expected:
        raise WeightsError(
            f"has the shape {array.shape}, but the reference has {expected[0]:,} vertices and "
            f"{expected[1]:,} joints. Save a row for each vertex and a column for each joint, in "
            "its order"
        )
    if not (np.isfinite(array) & (array >= 0)).all():
        raise WeightsError("has weights that are negative or not finite")
    return normalised(array)
