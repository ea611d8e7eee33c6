"""All checks of a rig, one after the other."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from ..errors import CutcellError, ParameterError
from ..geodesics import BoneDistances
from ..graph.fingerprint import data_fingerprint, require_same
from ..method import check_resolution
from ..rig import Rig
from ..rig.inputs import RigLike, as_rig
from ..runtime.progress import Progress, silent
from .exchanged import check_exchanged
from .finding import SEVERITIES, Finding, by_severity
from .joints import check_joints
from .kinds import FINDING_KINDS
from .leaks import check_leaks
from .mesh import check_mesh
from .parts import check_far_parts, check_parts
from .repair import Repaired, repair
from .subject import Subject
from .sweep import check_sweep
from .weights import check_weights

SHAPE_CHECKS = (check_mesh, check_joints, check_parts)
WEIGHT_CHECKS = (check_weights, check_exchanged, check_leaks, check_far_parts, check_sweep)

DIAGNOSED_RESOLUTION = 64
"""R of the graph of a rig that is examined without distances."""


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """All findings of a rig, the most severe first.

    Parameters
    ----------
    rig : Rig
        The examined rig.
    findings : tuple of Finding
    """

    rig: Rig
    findings: tuple[Finding, ...]

    def of(self, severity: str) -> tuple[Finding, ...]:
        """Return the findings of one severity."""
        return tuple(finding for finding in self.findings if finding.severity == severity)

    @property
    def counts(self) -> dict[str, int]:
        """How many findings there are of each severity."""
        return {severity: len(self.of(severity)) for severity in SEVERITIES}

    def __getitem__(self, code: str) -> Finding:
        """Return the finding of a code; KeyError if there is none."""
        for finding in self.findings:
            if finding.code == code:
                return finding
        raise KeyError(code)

    def __contains__(self, code: object) -> bool:
        """Whether there is a finding of a code."""
        return any(finding.code == code for finding in self.findings)

    def repaired(self, codes: Iterable[str] | None = None) -> Repaired:
        """Return the rig with its faults repaired, as far as that is safe.

        Parameters
        ----------
        codes : iterable of str, optional
            Which findings to repair; all that can be when left out.

        Raises
        ------
        ParameterError
            There is no finding of such a code, or no safe repair of it.
        """
        chosen = [finding for finding in self.findings if finding.repair]
        if codes is not None:
            able = {finding.code: finding for finding in chosen}
            requested = list(codes)
            for code in requested:
                if code not in able:
                    available = ", ".join(able) or "none"
                    raise ParameterError(
                        f'there is nothing to repair of the code "{code}"; repairable: {available}'
                    )
            chosen = [able[code] for code in dict.fromkeys(requested)]
        return repair(self.rig, chosen)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data."""
        return {"counts": self.counts, "findings": [finding.to_dict() for finding in self.findings]}


def diagnose(
    rig: RigLike,
    resolution: int | None = None,
    *,
    distances: BoneDistances | None = None,
    only_weights: bool = False,
    progress: Progress = silent,
) -> Diagnosis:
    """Find faults of a rig.

    Parameters
    ----------
    rig : Rig, (mesh, skeleton) or (vertices, faces, joints, parents)
        Its weights are checked if it has any.
    resolution : int, optional
        R, as of `build_graph`: thin parts are those of this lattice. When left out, that of the
        distances, else 64.
    distances : BoneDistances, optional
        Of this rig, such as those of a `Binding`; measured when left out.
    only_weights : bool
        Whether only the weights are checked.
    progress : callable
        See `cutcell.runtime.progress`; stages are "graph", "distances" and "checks".

    Returns
    -------
    Diagnosis

    Raises
    ------
    ParameterError
        `resolution` is not a whole number from 2 to 1024, the graph would not fit in memory, or the
        distances are of another rig or resolution.
    MeshError
        Every triangle of the mesh has collapsed into a point.

    Examples
    --------
    >>> rig = cutcell.load("character.glb")  # doctest: +SKIP
    >>> for finding in cutcell.diagnose(rig).findings:  # doctest: +SKIP
    ...     print(finding.severity, finding.message)
    """
    rig = as_rig(rig)
    if resolution is None:
        resolution = (
            DIAGNOSED_RESOLUTION if distances is None else distances.graph.lattice.resolution
        )
    resolution = check_resolution(resolution)
    if distances is not None:
        expected = data_fingerprint(rig.mesh, rig.skeleton)
        require_same("distances", distances.fingerprint, expected | {"resolution": resolution})
    subject = Subject(rig, resolution, distances, progress=progress)
    findings: list[Finding] = []
    checks = [] if only_weights else [*SHAPE_CHECKS]
    _ = subject.graph
    if len(rig.skeleton.joints):
        _ = subject.distances
        checks += WEIGHT_CHECKS if rig.weights is not None else ()
    for done, check in enumerate(checks):
        progress("checks", done / len(checks))
        findings += check(subject)
    progress("checks", 1.0)
    return Diagnosis(rig, by_severity(findings))


def unreadable(error: CutcellError) -> Finding:
    """Return the finding of a file that cannot be loaded."""
    is_cyclic = "the skeleton has a cycle" in str(error)
    code = "cyclic-joints" if is_cyclic else "unreadable"
    return Finding(code, FINDING_KINDS[code].severity, str(error), FINDING_KINDS[code].advice)
