"""All checks of a rig, one after the other."""

from __future__ import annotations

from ..errors import CutcellError
from ..geodesics import BoneDistances
from ..method import check_resolution
from ..progress import Progress, silent
from ..rig import Rig
from .finding import Diagnosis, Finding, by_gravity
from .joints import check_joints
from .leaks import check_leaks
from .mesh import check_mesh
from .parts import check_parts
from .subject import Subject
from .sweep import check_sweep
from .weights import check_weights

CHECKS = (check_mesh, check_joints, check_parts, check_weights, check_leaks, check_sweep)


def diagnose(
    rig: Rig,
    resolution: int = 64,
    *,
    distances: BoneDistances | None = None,
    progress: Progress = silent,
) -> Diagnosis:
    """Say what is wrong with a rig.

    Parameters
    ----------
    rig : Rig
        Its mesh, its skeleton, and its weights if it has any.
    resolution : int
        R, as of `build_graph`: for this lattice it is told what is too thin.
    distances : BoneDistances, optional
        Of this rig, such as those of a `Binding`; measured when left out.
    progress : callable
        See `cutcell.progress`; stages are "graph", "distances" and "checks".

    Returns
    -------
    Diagnosis

    Raises
    ------
    ParameterError
        `resolution` is not a whole number from 2 to 1024, or the graph would not fit in memory.
    MeshError
        Every triangle of the mesh has collapsed into a point.

    Examples
    --------
    >>> rig = cutcell.load("character.glb")  # doctest: +SKIP
    >>> for finding in cutcell.diagnose(rig).findings:  # doctest: +SKIP
    ...     print(finding.severity, finding.message)
    """
    resolution = check_resolution(resolution)
    subject = Subject(rig, resolution, distances, progress=progress)
    found: list[Finding] = []
    _ = subject.graph
    _ = subject.distances
    for done, check in enumerate(CHECKS):
        progress("checks", done / len(CHECKS))
        found += check(subject)
    progress("checks", 1.0)
    return Diagnosis(rig, by_gravity(found))


def unreadable(error: CutcellError) -> Finding:
    """Return the finding that stands for a file that cannot be loaded."""
    text = str(error)
    cyclic = "the skeleton has a cycle" in text
    return Finding(
        "cyclic-joints" if cyclic else "unreadable",
        "error",
        text,
        "Let each joint hang on one above it." if cyclic else "Mend the file as the sentence says.",
    )
