"""The character with what a finding names marked on it."""

from dataclasses import replace

from cutcell.diagnosis import Finding
from cutcell.runtime.display import count
from cutcell_viewers.description import Description, Legend
from cutcell_viewers.finding_scene import finding_marks, finding_pose
from cutcell_viewers.palette import BODY, MARK, Color
from cutcell_viewers.skin import skin_of_weights

from ..state import State
from ..state.check import EXPORT
from .common import character
from .memo import Memo

BODY_OPACITY_OF_FINDINGS = 0.5
"""How opaque the body is while a finding is marked: it may be behind or inside."""


def named(finding: Finding) -> str:
    """Say how many elements a finding names: "945 vertices"."""
    kinds = {"face": finding.faces, "vertex": finding.vertices, "joint": finding.joints}
    return ", ".join(count(len(which), kind) for kind, which in kinds.items() if len(which))


def check(state: State, memo: Memo) -> Description:
    """Return the scene of the panel Check; plain while no finding is looked at."""
    rig, finding = state.rig, state.selected_finding
    if finding is None:
        return Description(character(state, memo))
    marks = memo("finding", (rig, finding), lambda: finding_marks(rig, finding))
    if not marks:
        return Description(character(state, memo))
    actors = character(state, memo, opacity=BODY_OPACITY_OF_FINDINGS, behind=True)
    swatches: tuple[tuple[Color, str], ...] = ((MARK, named(finding)),)
    placed = memo("finding pose", (rig, finding), lambda: finding_pose(rig, finding))
    if placed is not None:
        is_export = state.finding.startswith(EXPORT)
        weighted = state.export_diagnosis.rig if is_export else rig
        skin = memo("finding skin", (weighted,), lambda: skin_of_weights(weighted.weights))
        actors["body"] = replace(actors["body"], skin=skin)
        actors.pop("vertex", None)  # it stays where it is at rest
        turned = rig.skeleton.names[finding.pose.joint]
        swatches += (
            (
                BODY,
                f"posed by {'exported' if is_export else 'file'} weights: {turned} turned by "
                f"{abs(finding.pose.degrees):g}°",
            ),
        )
    legend = Legend(finding.title, swatches=swatches)
    return Description({**actors, **marks}, pose=placed, legend=legend)
