"""Safe repairs: they change only the elements at fault, and lose nothing of the file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..geometry.weld import weld
from ..graph.lattice import Lattice
from ..io.gltf.write.faces import with_faces, with_rescaled
from ..rig import Rig
from ..weights.prune import prune
from .cleaning import clean
from .finding import Finding
from .leaks import check_leaks
from .subject import Subject
from .weights import INFLUENCES, check_weights

TURNED = ("inverted-faces",)
NOTHING = "unchanged, because this repair does not help"
ROUNDING = 1e-9
MIN_GAIN = 0.01
"""Part of its severity that a finding must lose for its repair to have helped."""
DROPPED = ("duplicate-faces", "degenerate-faces")


@dataclass(frozen=True, eq=False)
class Repaired:
    """A rig after its repair.

    Parameters
    ----------
    rig : Rig
    done : tuple of str
        Descriptions of the repairs.
    repaired : tuple of Finding
        The repaired findings.
    in_vain : tuple of Finding
        Findings whose repair did not help; nothing of it is left.
    """

    rig: Rig
    done: tuple[str, ...]
    repaired: tuple[Finding, ...]
    in_vain: tuple[Finding, ...] = ()


def repair(rig: Rig, findings: Sequence[Finding]) -> Repaired:
    """Repair findings of a rig."""
    before, by_code = rig, {finding.code: finding for finding in findings}
    in_vain = []
    for code, mend in WEIGHTS.items():  # of vertices, whose numbers stay
        if code in by_code and rig.weights is not None:
            weights = _allowed(rig, mend(rig, by_code[code]))
            if mend is not _as_they_are and not _helps(rig, weights, by_code[code]):
                in_vain.append(code)
                continue
            rig = rig.with_weights(weights)
            if mend is _as_they_are:
                rig = with_rescaled(rig, by_code[code].vertices)
    turned, dropped = (
        _mask(len(before.mesh.faces), [by_code[code].faces for code in codes if code in by_code])
        for codes in (TURNED, DROPPED)
    )
    if turned.any() or dropped.any():
        rig = with_faces(rig, ~dropped, turned)
    done = tuple(
        f"{finding.title}: {NOTHING if finding.code in in_vain else finding.repair}."
        for finding in findings
    )
    return Repaired(
        rig,
        done,
        tuple(finding for finding in findings if finding.code not in in_vain),
        tuple(finding for finding in findings if finding.code in in_vain),
    )


def _helps(rig: Rig, weights: NDArray[np.float64], finding: Finding) -> bool:
    """Return whether new weights, shape (n, j), make a finding less severe."""
    if np.abs(weights - _weights(rig)).max() < ROUNDING:
        return False
    if WEIGHTS[finding.code] is not _cleaned:
        return True
    before = Subject(rig)
    after = Subject(rig.with_weights(weights), distances=before.distances)
    return _excess(after, finding.code) < (1 - MIN_GAIN) * _excess(before, finding.code)


def _excess(subject: Subject, code: str) -> float:
    """Return how much the joints of a finding weigh at its vertices; 0 without the finding."""
    for check in (check_weights, check_leaks):
        for finding in check(subject):
            if finding.code == code:
                return float(_weights(subject.rig)[np.ix_(finding.vertices, finding.joints)].sum())
    return 0.0


def _mask(count: int, which: list[NDArray[np.intp]]) -> NDArray[np.bool_]:
    mask = np.zeros(count, bool)
    for rows in which:
        mask[rows] = True
    return mask


def _allowed(rig: Rig, weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return weights on joints that the file can store, scaled to sum to one."""
    if rig.allowed is not None:
        permitted = np.where(rig.allowed, weights, 0)
        weights = np.where(permitted.any(axis=1, keepdims=True), permitted, _weights(rig))
    sums = weights.sum(axis=1, keepdims=True)
    return np.divide(weights, sums, out=np.zeros_like(weights), where=sums > 0)


def _as_they_are(rig: Rig, finding: Finding) -> NDArray[np.float64]:
    """Return the weights: loading drops invalid ones, and sums are scaled afterwards."""
    return _weights(rig)


def _filled(rig: Rig, finding: Finding) -> NDArray[np.float64]:
    """Give vertices without weight those of the nearest vertex with some."""
    weights = _weights(rig).copy()
    having = np.flatnonzero(weights.any(axis=1))
    if len(having):
        vertices = rig.mesh.vertices
        nearest = cKDTree(vertices[having]).query(vertices[finding.vertices])[1]
        weights[finding.vertices] = weights[having[nearest]]
    return weights


def _together(rig: Rig, finding: Finding) -> NDArray[np.float64]:
    """Give vertices in one place the mean of their weights."""
    weights = _weights(rig).copy()
    _, place = weld(Lattice.around(rig.mesh, 2).to_unit(rig.mesh.vertices))
    group = place[finding.vertices]
    places, which = np.unique(group, return_inverse=True)
    sums = np.zeros((len(places), weights.shape[1]))
    np.add.at(sums, which, weights[finding.vertices])
    weights[finding.vertices] = (sums / np.bincount(which)[:, None])[which]
    most = max(INFLUENCES, int((_weights(rig) > 0).sum(axis=1).max()))
    return prune(weights, most, 0.0, np.arange(weights.shape[1]))


def _pruned(rig: Rig, finding: Finding) -> NDArray[np.float64]:
    weights = _weights(rig)
    return prune(weights, INFLUENCES, 0.0, np.arange(weights.shape[1]))


def _cleaned(rig: Rig, finding: Finding) -> NDArray[np.float64]:
    """Remove implausible weights from the vertices of a finding."""
    weights = _weights(rig).copy()
    weights[finding.vertices] = clean(rig).weights[finding.vertices]
    return weights


def _weights(rig: Rig) -> NDArray[np.float64]:
    assert rig.weights is not None  # findings about weights are of rigs that have some
    return rig.weights


WEIGHTS: dict[str, Callable[[Rig, Finding], NDArray[np.float64]]] = {
    "invalid-weights": _as_they_are,
    "unweighted-vertices": _filled,
    "unnormalised-weights": _as_they_are,
    "leaked-weights": _cleaned,
    "weight-islands": _cleaned,
    "torn-seams": _together,
    "many-influences": _pruned,
}
"""How weights are repaired, in this order."""
