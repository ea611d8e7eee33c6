"""The character with the elements of a finding marked on it."""

from dataclasses import replace

from cutcell.diagnosis import Finding
from cutcell.runtime.display import count
from cutcell_viewers.description import Description, Legend
from cutcell_viewers.finding_scene import finding_marks, finding_pose
from cutcell_viewers.palette import BODY, MARK, Color
from cutcell_viewers.skin import Skin
from cutcell_viewers.weights_scene import weight_colors

from ...document.state import State
from ...looks.character import character, plain
from .choices import EXPORT

BODY_OPACITY_OF_FINDINGS = 0.5
"""Opacity of the body while marks may be behind or inside it."""


def named(finding: Finding) -> str:
    """Return the numbers of elements of a finding, such as "945 vertices"."""
    kinds = {"face": finding.faces, "vertex": finding.vertices, "joint": finding.joints}
    return ", ".join(count(len(which), kind) for kind, which in kinds.items() if len(which))


def scene(state: State) -> Description:
    """Return the scene of the panel Check; plain while no finding is selected."""
    rig, finding = state.rig, state.selected_finding
    if state.tried is not None:
        style, legend = state.memo(
            "tried", (rig, state.tried), lambda: weight_colors(rig, state.tried)
        )
        return Description(character(state, bones_coloured=True, **style), legend=legend)
    marks = {}
    if finding is not None:
        marks = state.memo("finding", (rig, finding), lambda: finding_marks(rig, finding))
    if not marks:
        return plain(state)
    actors = character(state, opacity=BODY_OPACITY_OF_FINDINGS, behind=True)
    swatches: tuple[tuple[Color, str], ...] = ((MARK, named(finding)),)
    placed = state.memo("finding pose", (rig, finding), lambda: finding_pose(rig, finding))
    if placed is not None:
        is_export = state.finding.startswith(EXPORT)
        weighted = state.export_diagnosis.rig if is_export else rig
        skin = state.memo("finding skin", (weighted,), lambda: Skin.of_weights(weighted.weights))
        actors["body"] = replace(actors["body"], skin=skin)
        actors.pop("vertex", None)  # it would stay at its place at rest
        whose, turned = "exported" if is_export else "file", rig.skeleton.names[finding.pose.joint]
        turn = f"{turned} turned by {abs(finding.pose.degrees):g}°"
        swatches += ((BODY, f"posed by {whose} weights: {turn}"),)
    legend = Legend(finding.title, swatches=swatches)
    return Description({**actors, **marks}, pose=placed, legend=legend)
