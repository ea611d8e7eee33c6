"""The command `cutcell diagnose`: faults of a rig, and a repaired copy."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.text import Text

from ..errors import CutcellError
from ..runtime.display import count, printable
from .console import WRONG_INPUT, for_people, print_json, print_warnings, progress_bars
from .options import FixFile, Json, Resolution, RigFile, SkeletonFile

if TYPE_CHECKING:
    from ..diagnosis import Diagnosis, Finding

EPILOG = """Examples:

- `cutcell diagnose character.glb`

- `cutcell diagnose character.glb --fix repaired.glb`

- `cutcell diagnose character.glb --json | jq '.findings[].code'`  (for a script)

- `cutcell diagnose character.glb --fail-on error`  (for continuous integration)"""

COLORS = {"error": "bold red", "warning": "bold yellow", "note": "bold cyan"}
INDENT = " " * 8
FAIL_ON = ("error", "warning")
"""Severities that `--fail-on` accepts, the most severe first."""
FAILED = 1
"""Exit code where a finding is at least that severe."""
LISTED_DETAILS = 5
"""Lines of details that are printed of one finding; `--json` has them all."""


@for_people
def diagnose(
    rig: RigFile,
    fix: FixFile = None,
    resolution: Resolution = 64,
    skeleton: SkeletonFile = None,
    fail_on: Annotated[
        str | None,
        typer.Option(
            "--fail-on",
            metavar="SEVERITY",
            help="Exit with code 1 if a finding is at least as severe: error or warning. With"
            " --fix, findings of the repaired copy count.",
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Check RIG for faults of its mesh, skeleton and weights.

    Each finding is an error (a binding or another program goes wrong because of it), a warning
    (most likely a fault) or a note (good to know), with advice. With --json each names the
    vertices, faces and joints at fault.
    """
    from ..checks import check_choice
    from ..diagnosis import diagnose as examine
    from ..diagnosis import unreadable
    from ..io import check_output, load, save, saving_notes

    if fail_on is not None:
        check_choice("--fail-on", fail_on, FAIL_ON)
    if fix is not None:
        check_output(fix)
    try:
        loaded = load(rig, skeleton=skeleton)
    except CutcellError as error:
        if not rig.is_file():
            raise
        finding = unreadable(error)
        if json:
            counts = {"error": 1, "warning": 0, "note": 0}
            print_json({"input": str(rig), "counts": counts, "findings": [finding.to_dict()]})
        else:
            _print_findings(rig.name, (finding,))
        raise typer.Exit(WRONG_INPUT) from None
    with progress_bars(quiet=json) as progress:
        before = examine(loaded, resolution, progress=progress)
        repaired = after = None
        if fix is not None and any(finding.repair for finding in before.findings):
            repaired = before.repaired()
            check_output(fix, repaired.rig)
            after = examine(repaired.rig, resolution, progress=progress)
    warnings = list(loaded.warnings)
    repair = None
    if fix is not None and repaired is not None and after is not None:
        save(fix, repaired.rig)
        warnings += saving_notes(fix, repaired.rig)
        codes = [finding.code for finding in repaired.repaired]
        done = list(repaired.done)
        repair = {"output": str(fix), "codes": codes, "done": done, **after.to_dict()}
    if json:
        document = {"input": str(rig), "resolution": resolution, **before.to_dict()}
        print_json({**document, "repair": repair, "warnings": warnings})
    else:
        print_warnings(warnings)
        _print_diagnosis(rig, fix, before, repair)
    counts = (after or before).counts
    if fail_on is not None and any(counts[s] for s in FAIL_ON[: FAIL_ON.index(fail_on) + 1]):
        raise typer.Exit(FAILED)


def _print_diagnosis(
    rig: Path, fix: Path | None, before: Diagnosis, repair: dict[str, Any] | None
) -> None:
    _print_findings(f"{rig.name}: {_counts(before.counts)}", before.findings)
    if fix is not None and repair is None:
        _line(f"nothing to repair: {fix.name} was not written")
    elif fix is not None and repair is not None:
        _line(f"saved {fix.name}, repaired:", "bold")
        for text in repair["done"]:
            _line(INDENT + text)
        _line(f"before: {_counts(before.counts)}; after: {_counts(repair['counts'])}")


def _print_findings(heading: str, findings: tuple[Finding, ...]) -> None:
    _line(heading, "bold")
    for finding in findings:
        label = (f"{finding.severity:<8}", COLORS[finding.severity])
        _line(Text.assemble(label, (finding.title, "bold")))
        more = len(finding.details) - LISTED_DETAILS
        for text in (finding.message, *finding.details[:LISTED_DETAILS]):
            _line(INDENT + text)
        if more > 0:
            _line(f"{INDENT}and {more} more")
        _line(INDENT + finding.advice, "dim")
        if finding.repair:
            _line(f"{INDENT}--fix: {finding.repair}", "dim")


def _counts(counts: dict[str, int]) -> str:
    """Return the number of findings: "1 error, 2 notes"."""
    return ", ".join(count(n, severity) for severity, n in counts.items() if n) or "nothing found"


def _line(text: str | Text, style: str = "") -> None:
    # Soft wrapping leaves lines whole, so that a sentence can be searched for and copied.
    line = Text(printable(text), style) if isinstance(text, str) else text
    Console(highlight=False, soft_wrap=True).print(line)
