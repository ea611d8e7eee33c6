"""Safe repairs: they change only the elements at fault, and lose nothing of the file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from ..geometry.weld import weld
from ..graph.lattice import Lattice
from ..io.gltf.write.faces import with_faces, with_rescaled
from ..rig import Rig
from ..rig.rig import normalised
from ..weights.prune import prune
from .cleaning import clean
from .finding import Finding
from .leaks import check_leaks
from .subject import Subject
from .weights import INFLUENCES, check_weights

Weights = NDArray[np.float64]

TURNED = "inverted-faces"
FACES = {TURNED, "hollow-body", "duplicate-faces", "degenerate-faces"}
NOTHING = "unchanged, because this repair does not help"
UNCHANGED_WEIGHT = 1e-9
MIN_IMPROVEMENT = 0.01
"""Part of its severity that a finding must lose for its repair to have helped."""


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
    by_code = {finding.code: finding for finding in findings}
    turned, dropped = np.zeros((2, len(rig.mesh.faces)), bool)
    in_vain = []
    for code, mend in WEIGHT_REPAIRS.items():  # of vertices, whose numbers stay
        if code in by_code and rig.weights is not None:
            vertices = by_code[code].vertices
            weights = _allowed(rig, mend(rig, rig.weights.copy(), vertices))
            if mend is not _as_they_are and not _helps(rig, weights, by_code[code]):
                in_vain.append(code)
                continue
            rig = rig.with_weights(weights)
            if mend is _as_they_are:
                rig = with_rescaled(rig, vertices)
    for code in FACES & by_code.keys():
        (turned if code == TURNED else dropped)[by_code[code].faces] = True
    if turned.any() or dropped.any():
        rig = with_faces(rig, ~dropped, turned)
    done = tuple(
        f"{finding.title}: {NOTHING if finding.code in in_vain else finding.repair}."
        for finding in findings
    )
    repaired = tuple(finding for finding in findings if finding.code not in in_vain)
    unchanged = tuple(finding for finding in findings if finding.code in in_vain)
    return Repaired(rig, done, repaired, unchanged)


def _helps(rig: Rig, weights: NDArray[np.float64], finding: Finding) -> bool:
    """Return whether new weights, shape (n, j), make a finding less severe."""
    if np.abs(weights - _weights(rig)).max() < UNCHANGED_WEIGHT:
        return False
    if WEIGHT_REPAIRS[finding.code] is not _cleaned:
        return True
    before = Subject(rig)
    after = Subject(rig.with_weights(weights), distances=before.distances)
    return _excess(after, finding.code) < (1 - MIN_IMPROVEMENT) * _excess(before, finding.code)


def _excess(subject: Subject, code: str) -> float:
    """Return how much the joints of a finding weigh at its vertices; 0 without the finding."""
    for check in (check_weights, check_leaks):
        for finding in check(subject):
            if finding.code == code:
                return float(_weights(subject.rig)[np.ix_(finding.vertices, finding.joints)].sum())
    return 0.0


def _allowed(rig: Rig, weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return weights on joints that the file can store, scaled to sum to one."""
    if rig.allowed is not None:
        permitted = np.where(rig.allowed, weights, 0)
        weights = np.where(permitted.any(axis=1, keepdims=True), permitted, _weights(rig))
    return normalised(weights)


def _as_they_are(rig: Rig, weights: Weights, vertices: NDArray[np.intp]) -> Weights:
    """Return the weights: loading drops invalid ones, and sums are scaled afterwards."""
    return weights


def _filled(rig: Rig, weights: Weights, vertices: NDArray[np.intp]) -> Weights:
    """Give vertices without weight those of the nearest vertex with some."""
    having = np.flatnonzero(weights.any(axis=1))
    if len(having):
        places = rig.mesh.vertices
        weights[vertices] = weights[having[cKDTree(places[having]).query(places[vertices])[1]]]
    return weights


def _together(rig: Rig, weights: Weights, vertices: NDArray[np.intp]) -> Weights:
    """Give vertices in one place the mean of their weights."""
    most = max(INFLUENCES, int((weights > 0).sum(axis=1).max()))
    _, place = weld(Lattice.around(rig.mesh, 2).to_unit(rig.mesh.vertices))
    places, which = np.unique(place[vertices], return_inverse=True)
    sums = np.zeros((len(places), weights.shape[1]))
    np.add.at(sums, which, weights[vertices])
    weights[vertices] = (sums / np.bincount(which)[:, None])[which]
    return prune(csr_array(weights), most, 0.0, np.arange(weights.shape[1])).toarray()


def _pruned(rig: Rig, weights: Weights, vertices: NDArray[np.intp]) -> Weights:
    return prune(csr_array(weights), INFLUENCES, 0.0, np.arange(weights.shape[1])).toarray()


def _cleaned(rig: Rig, weights: Weights, vertices: NDArray[np.intp]) -> Weights:
    """Remove implausible weights from the vertices of a finding."""
    weights[vertices] = clean(rig).weights[vertices]
    return weights


def _weights(rig: Rig) -> NDArray[np.float64]:
    assert rig.weights is not None  # findings about weights are of rigs that have some
    return rig.weights


WEIGHT_REPAIRS: dict[str, Callable[[Rig, Weights, NDArray[np.intp]], Weights]] = {
    "invalid-weights": _as_they_are,
    "unweighted-vertices": _filled,
    "unnormalised-weights": _as_they_are,
    "leaked-weights": _cleaned,
    "weight-islands": _cleaned,
    "torn-seams": _together,
    "many-influences": _pruned,
}
"""How weights are repaired, in this order."""
