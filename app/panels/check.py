"""Diagnose: what is wrong with the character, where, and what to do about it."""

from functools import partial
from typing import Any

import panel_material_ui as pmui

from cutcell.diagnosis import SEVERITIES, Finding
from cutcell.rig import Rig
from cutcell.runtime.display import shown_name

from ..commands.check import look_at, repair, take_back
from ..commands.correct import leave_out
from ..commands.export import export_repaired
from ..commands.session import Session
from ..state import State
from .controls import LINE, button, caption, column, lead, section, when, words

ICONS = {"error": "error", "warning": "warning", "note": "info"}
MAX_DETAILS = 8
OF_PARTS = ("boneless-components", "unreachable-vertices")
"""What can be mended by a choice of what parts of the mesh follow."""
LEFT_OUT = ("stray-weights", "joints-outside")
"""What is mended by joints that carry no weight."""


def check(session: Session) -> pmui.Column:
    """Return the controls of the panel Diagnose."""
    state = session.state
    place = column()

    def listed(*events: Any) -> None:
        place.objects = [*_repairs(session), *_findings(session)]

    state.param.watch(listed, ["diagnosis", "finding", "repair"])
    listed()
    return column(
        lead(when(lambda *_: told(state), state.param.diagnosis, state.param.rig)),
        section("", place, margin=(6, 20, 4, 20)),
    )


def told(state: State) -> str:
    """Say how much was found."""
    if state.rig is None:
        return ""
    if state.diagnosis is None:
        return "The mesh, the skeleton and the weights of the file are checked once it is bound."
    if not state.diagnosis.findings:
        return "Nothing is wrong with the mesh, the skeleton or the weights of the file."
    return f"Found: {counted(state.diagnosis.counts)}. Choose one to see where it is."


def counted(counts: dict[str, int]) -> str:
    """Say how many findings there are of each severity."""
    parts = [f"{counts[s]} {s}{'s' * (counts[s] != 1)}" for s in SEVERITIES if counts[s]]
    return ", ".join(parts) or "nothing"


def _findings(session: Session) -> list[Any]:
    """Return the findings below a heading for each severity."""
    diagnosis = session.state.diagnosis
    if diagnosis is None:
        return []
    return [
        section(
            f"{severity}s", *(_entry(session, one) for one in diagnosis.of(severity)), margin=(8, 0)
        )
        for severity in SEVERITIES
        if diagnosis.of(severity)
    ]


def _entry(session: Session, finding: Finding) -> pmui.Column:
    """Return a finding as a line; with advice and repair if it is looked at."""
    is_chosen = session.state.finding == finding.code
    title = button(
        finding.title,
        lambda: look_at(session, finding.code),
        icon=ICONS[finding.severity],
        **LINE,
    )
    lines = [title, _line(finding.message)]
    if is_chosen:
        more = len(finding.details) - MAX_DETAILS
        lines += [_line(text) for text in finding.details[:MAX_DETAILS]]
        lines += [_line(f"and {more} more")] if more > 0 else []
        lines.append(_line(finding.advice, "text.primary"))
        if finding.repair:
            lines.append(_line(f"Repair: {finding.repair}.", "text.primary"))
            lines.append(button("Repair", lambda: repair(session, [finding.code]), icon="build"))
        carrying = [j for j in finding.joints if session.state.rig.skeleton.deform[j]]
        if finding.code in LEFT_OUT and carrying:
            label = _left_out(session.state.rig, carrying)
            lines.append(button(label, lambda: leave_out(session, carrying), icon="link_off"))
        if finding.code in OF_PARTS and not session.state.bare:
            vertex = int(finding.vertices[0])
            see = partial(session.state.param.update, panel="weights", part=vertex)
            lines.append(button("Choose what its parts follow", see, icon="category"))
    return column(*lines, margin=(0, 0, 6, 0))


def _left_out(rig: Rig, joints: list[int]) -> str:
    subject = f"these {len(joints)} joints"
    if len(joints) == 1:
        subject = shown_name(rig.skeleton.names[joints[0]])
    return f"Let {subject} carry no weight"


def _repairs(session: Session) -> list[Any]:
    """Return what can be repaired at once, and what was repaired: before and after."""
    state = session.state
    rows: list[Any] = []
    able = [] if state.diagnosis is None else [f for f in state.diagnosis.findings if f.repair]
    if len(able) > 1:
        codes = [finding.code for finding in able]
        rows.append(button(f"Repair all {len(able)}", lambda: repair(session, codes), icon="build"))
    if state.repair is None:
        return rows
    now = "" if state.diagnosis is None else f", now {counted(state.diagnosis.counts)}"
    return [
        *rows,
        _line(f"Repaired. Before: {counted(state.repair.counts)}{now}.", "text.primary"),
        *(_line(text) for text in state.repair.done),
        button(
            "Download it with its own weights",
            lambda: export_repaired(session, session.view.offer),
            icon="download",
        ),
        button("Undo repair", lambda: take_back(session), icon="undo"),
    ]


def _line(text: str, color: str = "text.secondary") -> pmui.Typography:
    if color == "text.secondary":
        return caption(text, margin=(0, 0, 4, 6))
    style = {"color": color, "lineHeight": 1.45, "display": "block", "letterSpacing": 0}
    return words(
        text, variant="caption", sx=style, margin=(0, 0, 4, 6), sizing_mode="stretch_width"
    )
