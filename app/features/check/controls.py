"""The panel Check: what is wrong with the character, where, and what to do about it."""

from collections import Counter
from collections.abc import Mapping
from contextlib import suppress
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.diagnosis import SEVERITIES, TITLES, Finding
from cutcell.diagnosis.leaks import moves_own_part
from cutcell.editing import Attached, Edits, Filled, FromFile
from cutcell.editing.layers.contents import Content
from cutcell.errors import CutcellError
from cutcell.rig import Rig

from ...document.session import Session
from ...document.state import State
from ...editing.binding.results import weights_with
from ...editing.compute import stack
from ...editing.compute.stack import components_of, part_layers
from ...editing.correct.commands import correct, leave_out, lock
from ...editing.layers.buttons import blend_button, file_button, recompute_button
from ...editing.select.selections import finding_vertices, select_finding
from ...widgets import controls as ui
from ...widgets.rows import Rows
from .choices import EXPORT, is_done
from .results import exchange_joints, look_at, repair, take_back

ICONS = {"error": "error", "warning": "warning", "note": "info"}
MAX_DETAILS = 8
SAME = 1e-9
"""Weights that differ by less are equal."""
OF_PARTS = ("boneless-components", "unreachable-vertices")
"""Findings mended by choosing what parts of the mesh follow."""
LEFT_OUT = ("stray-weights", "joints-outside")
"""Findings mended by locking or excluding joints."""


def summary(state: State) -> str:
    """Say how much was found."""
    if state.rig is None:
        return ""
    if state.diagnosis is None:
        return "The file is checked once weights are computed."
    if not state.open_findings:
        return "No problems in the mesh, skeleton or weights."
    counts = Counter(one.severity for one in state.open_findings)
    return f"{counted(counts)}. Choose one to see it."


def counted(counts: Mapping[str, int]) -> str:
    """Say how many findings there are of each severity."""
    parts = [f"{counts[s]} {s}{'s' * (counts[s] != 1)}" for s in SEVERITIES if counts[s]]
    return ", ".join(parts) or "nothing"


def _line(text: str, **style: str) -> Any:
    return ui.caption(text, margin=(0, 0, 4, 6), sx={**ui.QUIET, **style})


def _strong_line(text: str) -> Any:
    return _line(text, color="text.primary")


def _findings(state: State) -> list[Any]:
    """Return the findings below a heading for each severity, and last what is done."""
    if state.diagnosis is None:
        return []
    titles = (*(f"{severity}s" for severity in SEVERITIES), "Done")
    groups: dict[str, list[Finding]] = {title: [] for title in titles}
    for one in state.diagnosis.findings:
        groups[f"{one.severity}s" if one in state.open_findings else "Done"].append(one)
    return [
        ui.section(title, [_entry(finding, finding.code) for finding in group], margin=(8, 0))
        for title, group in groups.items()
        if group
    ]


def _exported(state: State) -> list[Any]:
    """Return the findings about the weights that an export contains."""
    if state.edits.base == "file" and not state.edits.layers:
        lines: list[Any] = [_line("The same as in the file.")]
    elif state.export_diagnosis is None:
        lines = [_line("Checking the weights ...")]
    else:
        findings = state.export_diagnosis.findings
        lines = [_entry(one, EXPORT + one.code) for one in findings
                 if not is_done(one, state.edits, state.rig.skeleton.names)]  # fmt: skip
    return [ui.section("Weights in the export", lines or _line("No faults."), margin=(8, 0))]


def _entry(finding: Finding, code: str) -> Any:
    """Return a finding as a button and a line, with its details while it is the chosen one."""
    return ui.column(
        ui.button(
            finding.title, partial(look_at, code=code), icon=ICONS[finding.severity], **ui.LINE
        ),
        _line(finding.message),
        # All buttons stay when another one is chosen, and the focus with them.
        partial(_place, code=code),
        margin=(0, 0, 6, 0),
    )


def _place(session: Session, code: str) -> ui.Control:
    """Return the place of a finding's details, which are there while it is the chosen one."""

    def rows(state: State) -> list[Any]:
        # But no weights that are not checked yet.
        followed = (state.finding, state.export_diagnosis, state.edits)
        return _details(session) if followed[0] == code else []

    return ui.listed(rows)


def _details(session: Session) -> list[Any]:
    """Return details of the chosen finding, its advice, and what repairs it."""
    state, finding = session.state, session.state.selected_finding
    if finding is None:
        return []
    details = () if finding.parts else finding.details[:MAX_DETAILS]
    rows: list[Any] = [_line(text) for text in details]
    if not state.bare and (len(finding.vertices) or len(finding.faces)):
        rows.append(ui.button("Select its vertices", select_finding, icon="highlight_alt"))
    if finding.exchanged and not state.bare and state.binding is not None:
        rows.append(ui.button("Exchange these weights", exchange_joints, icon="swap_horiz"))
    if state.finding.startswith(EXPORT):
        rows += _part_choices(session, finding)
        return rows + _layers(state, finding)
    more = len(finding.details) - MAX_DETAILS
    rows += [_line(f"and {more} more")] if more > 0 else []
    rows.append(_strong_line(finding.advice))
    if finding.code in _in_vain(state):
        rows.append(_line("Its repair did not help, so that nothing was changed."))
    elif finding.repair:
        rows.append(_strong_line(f"Repair: {finding.repair}."))
        rows.append(ui.button("Repair", partial(repair, codes=[finding.code]), icon="build"))
    rows += _part_choices(session, finding)
    if finding.code in LEFT_OUT:
        rows += _joint_choices(state, finding.joints)
    if finding.code in OF_PARTS and not state.bare:
        see = partial(_see_part, vertex=int(finding.vertices[0]))
        rows.append(ui.button("Choose how these parts are bound", see, icon="category"))
    return rows


def _see_part(session: Session, vertex: int) -> None:
    session.state.param.update(panel="weights", part=vertex)


def _layers(state: State, finding: Finding) -> list[Any]:
    """Return buttons that put a layer over the vertices of a finding."""
    vertices = finding_vertices(state)
    if state.bare or state.binding is None or not len(vertices):
        return []
    rows = [recompute_button(finding_vertices), blend_button(finding_vertices)]
    if not ui.has_weights(state):
        return rows
    in_file = state.rig.weights[vertices]
    differs = np.abs(state.binding.weights[vertices] - in_file).max(axis=1) > SAME
    if (differs & in_file.any(axis=1)).any():
        return [*rows, file_button(finding_vertices)]
    return [_strong_line("The weights there are the file's."), _strong_line(finding.advice), *rows]


def _part_choices(session: Session, finding: Finding) -> list[Any]:
    """Return for each part that a finding names what it may follow, each with its preview."""
    state = session.state
    if state.bare or state.binding is None:
        return [_line(text) for text in finding.details[:MAX_DETAILS] if finding.parts]
    rig, component = state.rig, components_of(state.binding.graph)
    rows: list[Any] = []
    parts = zip(
        finding.parts, finding.empty or [-1] * len(finding.parts), finding.details, strict=False
    )
    for (vertex, nearest), empty, text in [*parts][:MAX_DETAILS]:
        contents: dict[str, Content] = {"with the body it touches": Attached()}
        notes = {empty: ", empty so far"}
        notes.setdefault(nearest, "")
        for joint, note in notes.items():
            if joint >= 0:
                title = f"rigid to {ui.joint_title(rig, joint)}{note}"
                contents[title] = Filled({rig.skeleton.names[joint]: 1.0})
        contents["keep as in the file"] = FromFile()
        vertices = np.flatnonzero(component == component[vertex]).tolist()
        tries = [with_part(state, vertices, one) for one in contents.values()]
        layer, title = part_layers(state.edits).get(vertex), text.partition(" (")[0]
        which = [*contents.values()]
        rows += [
            _line(text),
            ui.Control(
                partial(_tries, session, tries), act=partial(_take, tries), label=title,
                rows=[(f"{title}: {how}", "", 0.0) for how in contents],
                chosen=which.index(layer.content) if layer and layer.content in which else -1,
                **ui.FULL,
            ),
        ]  # fmt: skip
    return rows


def _tries(session: Session, tries: list[Edits], **options: Any) -> Rows:
    """Return a list of edits, of which the one under the pointer is previewed."""
    widget = Rows(points=True, **options)

    def point(event: Any) -> None:
        session.state.tried = None
        with suppress(CutcellError):  # it is said where it is chosen
            if event.new >= 0:
                session.state.tried = weights_with(session.state, tries[event.new])

    widget.param.watch(point, "pointed")
    return widget


def _take(tries: list[Edits], session: Session, row: int) -> None:
    session.history.part()
    correct(session, tries[row])


def with_part(state: State, vertices: list[int], content: Content) -> Edits:
    """Return the edits with a part bound otherwise; the joint that it follows carries weight."""
    edits = stack.with_part(state.edits, vertices, content)
    return stack.with_deform(edits, state.rig.skeleton, content.joints_named())


def _joint_choices(state: State, joints: NDArray[np.intp]) -> list[Any]:
    """Return buttons that lock joints with an own part of the mesh, and exclude the others."""
    rig = state.rig
    joints = joints[rig.skeleton.deform[joints]]
    moves = np.zeros(len(joints), bool)
    if ui.has_weights(state):
        moves = moves_own_part(rig.weights[:, joints])
    choices = (
        ("Lock {} to file weights", "lock", lock, joints[moves].tolist()),
        ("Exclude {} from binding", "link_off", leave_out, joints[~moves].tolist()),
    )
    return [
        ui.button(label.format(_joints(rig, which)), partial(act, joints=which), icon=icon)
        for label, icon, act, which in choices
        if which
    ]


def _joints(rig: Rig, joints: list[int]) -> str:
    return ui.joint_title(rig, joints[0]) if len(joints) == 1 else f"these {len(joints)} joints"


def _repairs(state: State) -> list[Any]:
    """Return the repair of all findings, and the repairs that were made: before and after."""
    findings = () if state.diagnosis is None else state.diagnosis.findings
    able = [one.code for one in findings if one.repair and one.code not in _in_vain(state)]
    rows: list[Any] = []
    if len(able) > 1:
        label = f"Repair all {len(able)} findings"
        rows.append(ui.button(label, partial(repair, codes=able), icon="build"))
        rows.append(_line(f"{', '.join(TITLES[code] for code in able)}."))
    if state.repair is None:
        return rows
    done = [_line(text) for text in state.repair.done]
    if not state.repair.codes:
        return rows + done
    now = "" if state.diagnosis is None else f" → {counted(state.diagnosis.counts)}"
    return [
        *rows,
        _strong_line(f"Repaired: {counted(state.repair.counts)}{now}."),
        *done,
        ui.button("Undo repair", take_back, icon="undo"),
    ]


def _in_vain(state: State) -> frozenset[str]:
    """Return the codes of findings whose repair did not help."""
    return frozenset() if state.repair is None else state.repair.in_vain


CONTROLS = ui.column(
    ui.intro(summary),
    ui.section(
        "",
        ui.listed(_repairs),
        ui.listed(_findings),
        ui.listed(_exported, visible=lambda state: not state.bare and state.binding is not None),
        top=6,
    ),
)
