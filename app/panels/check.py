"""The panel Check: what is wrong with the character, where, and what to do about it."""

from functools import partial
from typing import Any

import numpy as np
import panel_material_ui as pmui
from numpy.typing import NDArray

from cutcell.diagnosis import SEVERITIES, Finding
from cutcell.diagnosis.leaks import moves_own_part
from cutcell.editing.corrections import PartCorrection
from cutcell.rig import Rig
from cutcell.weights.rig_falloff.surface_operators import SurfaceOperators

from ..commands.check import look_at, repair, take_back
from ..commands.correct import correct_part, keep_file_vertices, leave_out, lock
from ..commands.session import Session
from ..state import State
from ..state.check import EXPORT
from .controls import (
    LINE,
    button,
    caption,
    column,
    has_weights,
    intro,
    joint_title,
    section,
    text_line,
    when,
)

ICONS = {"error": "error", "warning": "warning", "note": "info"}
MAX_DETAILS = 8
SAME = 1e-9
"""Weights that differ by less are equal."""
OF_PARTS = ("boneless-components", "unreachable-vertices")
"""Findings mended by choosing what parts of the mesh follow."""
LEFT_OUT = ("stray-weights", "joints-outside")
"""Findings mended by locking or excluding joints."""


def check(session: Session) -> pmui.Column:
    """Return the controls of the panel Check."""
    state = session.state
    places: dict[str, pmui.Column] = {}  # of the details, by the code of the finding
    repairs, findings, exported = column(), column(), column()

    def list_repairs(*events: Any) -> None:
        repairs.objects = _repairs(session)

    def list_findings(*events: Any) -> None:
        findings.objects = _findings(session, places)
        show_details()

    def list_exported(*events: Any) -> None:
        exported.objects = _exported(session, places)
        show_details()

    def show_details(*events: Any) -> None:
        """Show details of the chosen finding alone; all buttons stay, and the focus with them."""
        for code, place in places.items():
            details = _details(session) if code == state.finding else []
            if details or place.objects:
                place.objects = details

    state.param.watch(list_repairs, ["diagnosis", "repair"])
    state.param.watch(list_findings, "diagnosis")
    state.param.watch(list_exported, ["diagnosis", "export_diagnosis"])
    state.param.watch(show_details, "finding")
    list_repairs()
    list_findings()
    list_exported()
    return column(
        intro(when(lambda *_: summary(state), state.param.diagnosis, state.param.rig)),
        section("", repairs, findings, exported, margin=(6, 20, 4, 20)),
    )


def summary(state: State) -> str:
    """Say how much was found."""
    if state.rig is None:
        return ""
    if state.diagnosis is None:
        return "The file is checked once weights are computed."
    if not state.diagnosis.findings:
        return "No problems in the mesh, skeleton or weights."
    return f"{counted(state.diagnosis.counts)}. Choose one to see it."


def counted(counts: dict[str, int]) -> str:
    """Say how many findings there are of each severity."""
    parts = [f"{counts[s]} {s}{'s' * (counts[s] != 1)}" for s in SEVERITIES if counts[s]]
    return ", ".join(parts) or "nothing"


def _findings(session: Session, places: dict[str, pmui.Column]) -> list[Any]:
    """Return the findings below a heading for each severity."""
    diagnosis = session.state.diagnosis
    if diagnosis is None:
        return []
    return [
        section(
            f"{severity}s",
            *(_entry(session, finding, finding.code, places) for finding in diagnosis.of(severity)),
            margin=(8, 0),
        )
        for severity in SEVERITIES
        if diagnosis.of(severity)
    ]


def _exported(session: Session, places: dict[str, pmui.Column]) -> list[Any]:
    """Return the findings about the weights that an export contains."""
    state = session.state
    if state.bare or state.binding is None:
        return []
    if state.export_diagnosis is None:
        lines: list[Any] = [_line("Checking the weights ...")]
    else:
        lines = [
            _entry(session, finding, EXPORT + finding.code, places)
            for finding in state.export_diagnosis.findings
        ]
    return [section("Weights in the export", *(lines or [_line("No faults.")]), margin=(8, 0))]


def _entry(
    session: Session, finding: Finding, code: str, places: dict[str, pmui.Column]
) -> pmui.Column:
    """Return a finding as a button and a line, with a place for its details."""
    title = button(
        finding.title, lambda: look_at(session, code), icon=ICONS[finding.severity], **LINE
    )
    places[code] = column()
    return column(title, _line(finding.message), places[code], margin=(0, 0, 6, 0))


def _details(session: Session) -> list[Any]:
    """Return details of the chosen finding, its advice, and what repairs it."""
    state = session.state
    finding = state.selected_finding
    if finding is None:
        return []
    lines: list[Any] = [_line(text) for text in finding.details[:MAX_DETAILS]]
    if state.finding.startswith(EXPORT):
        lines += _part_choices(session, finding)
        if _differs_from_file(state, finding):
            keep = partial(keep_file_vertices, session, finding.vertices)
            lines.append(button("Use the file's weights there", keep, icon="history"))
        elif has_weights(state.rig) and len(finding.vertices):
            lines.append(_line("The weights there are the file's.", "text.primary"))
            lines.append(_line(finding.advice, "text.primary"))
        return lines
    more = len(finding.details) - MAX_DETAILS
    lines += [_line(f"and {more} more")] if more > 0 else []
    lines.append(_line(finding.advice, "text.primary"))
    if finding.code in _in_vain(state):
        lines.append(_line("Its repair did not help, so that nothing was changed."))
    elif finding.repair:
        lines.append(_line(f"Repair: {finding.repair}.", "text.primary"))
        lines.append(button("Repair", lambda: repair(session, [finding.code]), icon="build"))
    lines += _part_choices(session, finding)
    if finding.code in LEFT_OUT:
        lines += _joint_choices(session, finding.joints)
    if finding.code in OF_PARTS and not state.bare:
        vertex = int(finding.vertices[0])
        see = partial(state.param.update, panel="weights", part=vertex)
        lines.append(button("Choose how these parts are bound", see, icon="category"))
    return lines


def _differs_from_file(state: State, finding: Finding) -> bool:
    """Return whether an export has other weights than the file at vertices of a finding."""
    if not has_weights(state.rig) or state.binding is None or not len(finding.vertices):
        return False
    in_file = state.rig.weights[finding.vertices]
    differs = np.abs(state.binding.weights[finding.vertices] - in_file).max(axis=1) > SAME
    return bool((differs & in_file.any(axis=1)).any())


def _part_choices(session: Session, finding: Finding) -> list[pmui.Button]:
    """Return buttons that make parts rigid to the joint that a finding names for each."""
    state = session.state
    if state.bare or state.binding is None:
        return []
    names, graph = state.rig.skeleton.names, state.binding.graph
    component = SurfaceOperators.of(graph).component[graph.vertex_node] if finding.parts else []
    buttons = []
    for vertex, joint in finding.parts[:MAX_DETAILS]:
        part = PartCorrection("glued", names[joint])
        if state.corrections.parts.get(vertex) == part:
            continue
        vertices = np.flatnonzero(component == component[vertex]).tolist()
        act = partial(correct_part, session, vertices, part)
        buttons.append(button(f"Rigid to {joint_title(state.rig, joint)}", act, icon="link"))
    return buttons


def _joint_choices(session: Session, joints: NDArray[np.intp]) -> list[pmui.Button]:
    """Return buttons that lock joints with an own part of the mesh, and exclude the others."""
    rig = session.state.rig
    joints = joints[rig.skeleton.deform[joints]]
    moves = np.zeros(len(joints), bool)
    if has_weights(rig):
        moves = moves_own_part(rig.weights[:, joints])
    choices = (
        ("Lock {} to file weights", "lock", lock, joints[moves].tolist()),
        ("Exclude {} from binding", "link_off", leave_out, joints[~moves].tolist()),
    )
    return [
        button(label.format(_joints(rig, which)), partial(act, session, which), icon=icon)
        for label, icon, act, which in choices
        if which
    ]


def _joints(rig: Rig, joints: list[int]) -> str:
    if len(joints) == 1:
        return joint_title(rig, joints[0])
    return f"these {len(joints)} joints"


def _repairs(session: Session) -> list[Any]:
    """Return what can be repaired at once, and what was repaired: before and after."""
    state = session.state
    rows: list[Any] = []
    able = [] if state.diagnosis is None else [f for f in state.diagnosis.findings if f.repair]
    able = [finding for finding in able if finding.code not in _in_vain(state)]
    if len(able) > 1:
        codes = [finding.code for finding in able]
        label = f"Repair all {len(able)} findings"
        rows.append(button(label, lambda: repair(session, codes), icon="build"))
    if state.repair is None:
        return rows
    if state.repair.before is state.rig:
        return rows + [_line(text) for text in state.repair.done]
    now = "" if state.diagnosis is None else f" → {counted(state.diagnosis.counts)}"
    return [
        *rows,
        _line(f"Repaired: {counted(state.repair.counts)}{now}.", "text.primary"),
        *(_line(text) for text in state.repair.done),
        button("Undo repair", lambda: take_back(session), icon="undo"),
    ]


def _in_vain(state: State) -> frozenset[str]:
    """Return the codes of findings whose repair did not help."""
    return frozenset() if state.repair is None else state.repair.in_vain


def _line(text: str, color: str = "text.secondary") -> pmui.Typography:
    if color == "text.secondary":
        return caption(text, margin=(0, 0, 4, 6))
    style = {"color": color, "lineHeight": 1.45, "display": "block", "letterSpacing": 0}
    return text_line(
        text, variant="caption", sx=style, margin=(0, 0, 4, 6), sizing_mode="stretch_width"
    )
