"""State of the panel Check: findings, and repairs."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import param

from cutcell.diagnosis import TITLES, Finding
from cutcell.editing import Edits, Remapped

from ...document.state import Panel
from ...editing.compute.stack import part_layers

EXPORT = "export:"
"""Before the code of a finding about the weights that an export contains."""

OF_WEIGHTS = ("stretched-surface",)
"""Findings of weights: those of a binding are checked in what an export contains."""


@dataclass(frozen=True)
class WarningLink:
    """A warning, and the finding that shows its elements as `Choices.finding` has it, or empty."""

    text: str
    code: str = ""

    @property
    def label(self) -> str:
        """The label of the button that leads there."""
        return f"Show: {TITLES[self.code.removeprefix(EXPORT)].lower()}" if self.code else ""


PANEL = Panel(
    "Check", '<path d="M2.5 12.5h4l2.5-6 4 12 3-9 1.5 3h4"/>', works_without_skeleton=True
)


def exchange(finding: Finding, names: Sequence[str]) -> Remapped:
    """Return the content of a layer that exchanges the weights of a finding's joints."""
    return Remapped({names[one]: names[other] for one, other in finding.exchanged})


def is_done(finding: Finding, edits: Edits, names: Sequence[str]) -> bool:
    """Return whether a layer binds each part, or exchanges the joints, that a finding names."""
    if finding.exchanged:
        content = exchange(finding, names)
        return any(layer.is_active and layer.content == content for layer in edits.layers)
    return bool(finding.parts) and {vertex for vertex, _ in finding.parts} <= {*part_layers(edits)}


class Choices(param.Parameterized):
    """The findings, and which of them is looked at."""

    if TYPE_CHECKING:
        binding_warnings: Any
        edits: Edits
        graph: Any
        rig: Any

    diagnosis: Any = param.Parameter(None, doc="The cutcell.Diagnosis, or None so far.")
    export_diagnosis: Any = param.Parameter(
        None, doc="The cutcell.Diagnosis of the weights that an export contains, or None so far."
    )
    finding = param.String(
        "", doc="Code of the selected finding, after `EXPORT` one of the export; else empty."
    )
    tried: Any = param.Parameter(None, doc="Weights that are previewed, shape (n, j), or None.")
    repair: Any = param.Parameter(None, doc="The `Repair` of this character, or None.")

    @property
    def open_findings(self) -> list[Any]:
        """The findings of the file but for those of what was mended or kept by now."""
        findings = () if self.diagnosis is None else self.diagnosis.findings
        names = () if self.rig is None else self.rig.skeleton.names
        return [one for one in findings if not is_done(one, self.edits, names)]

    @property
    def selected_finding(self) -> Any:
        """The finding that is looked at, or None."""
        code = self.finding.removeprefix(EXPORT)
        diagnosis = self.diagnosis if code == self.finding else self.export_diagnosis
        return diagnosis[code] if diagnosis is not None and code in diagnosis else None

    @property
    def warnings(self) -> list[WarningLink]:
        """The warnings about the character and its weights."""
        if self.graph is None:
            return []
        links = [
            WarningLink(text, getattr(text, "code", ""))
            for text in (*self.rig.warnings, *(self.binding_warnings or ()))
        ]
        return [
            replace(link, code=EXPORT + link.code) if link.code in OF_WEIGHTS else link
            for link in links
        ]
