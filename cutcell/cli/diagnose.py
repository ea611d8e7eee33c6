"""The command `cutcell diagnose`: faults of a rig, and a repaired copy."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.text import Text

from ..errors import CutcellError
from ..runtime.display import printable
from .console import WRONG_INPUT, for_people, print_json, print_warnings, progress_bars
from .options import FILES, Json, Resolution, RigFile, SkeletonFile

if TYPE_CHECKING:
    from ..diagnosis import Diagnosis, Finding, Repaired

EPILOG = """Examples:

- `cutcell diagnose character.glb`

- `cutcell diagnose character.glb --fix repaired.glb`

- `cutcell diagnose character.glb --json | jq '.findings[].code'`  (for a script)"""

COLORS = {"error": "bold red", "warning": "bold yellow", "note": "bold cyan"}
FEW = 5
"""Lines of details that are printed of one finding; `--json` has them all."""


@for_people
def diagnose(
    rig: RigFile,
    fix: Annotated[
        Path | None,
        typer.Option(
            "--fix",
            metavar="OUT",
            help="Save a copy with all safe repairs; nothing else in it changes.",
            rich_help_panel=FILES,
        ),
    ] = None,
    resolution: Resolution = 64,
    skeleton: SkeletonFile = None,
    json: Json = False,
) -> None:
    """Check RIG for faults of its mesh, skeleton and weights.

    Each finding is an error (a binding or another program goes wrong because of it), a warning
    (most likely a fault) or a note (good to know), with advice. With --json each names the
    vertices, faces and joints at fault.
    """
    from ..diagnosis import diagnose as examine
    from ..diagnosis import unreadable
    from ..io import check_output, load, save, saving_notes

    if fix is not None:
        check_output(fix)
    try:
        loaded = load(rig, skeleton=skeleton)
    except CutcellError as error:
        if not rig.is_file():
            raise
        _print_unreadable(rig, unreadable(error), json)
        raise typer.Exit(WRONG_INPUT) from None
    with progress_bars(quiet=json) as progress:
        before = examine(loaded, resolution, progress=progress)
        repaired = after = None
        if fix is not None and any(finding.repair for finding in before.findings):
            repaired = before.repaired()
            check_output(fix, repaired.rig)
            after = examine(repaired.rig, resolution, progress=progress)
    warnings = list(loaded.warnings)
    if repaired is not None and fix is not None:
        save(fix, repaired.rig)
        warnings += saving_notes(fix, repaired.rig)
    if json:
        print_json(
            {
                "input": str(rig),
                "resolution": resolution,
                **before.to_dict(),
                "repair": _repair(fix, repaired, after),
                "warnings": warnings,
            }
        )
        return
    print_warnings(warnings)
    _print(rig.name, before)
    if fix is not None:
        _print_repair(fix, before, repaired, after)


def _repair(
    fix: Path | None, repaired: Repaired | None, after: Diagnosis | None
) -> dict[str, Any] | None:
    """Return the repair as plain data; None without one."""
    if repaired is None or after is None:
        return None
    codes = [finding.code for finding in repaired.repaired]
    return {"output": str(fix), "codes": codes, "done": list(repaired.done), **after.to_dict()}


def _print_unreadable(path: Path, finding: Finding, json: bool) -> None:
    if json:
        counts = {"error": 1, "warning": 0, "note": 0}
        print_json({"input": str(path), "counts": counts, "findings": [finding.to_dict()]})
        return
    _print_findings(path.name, (finding,))


def _print(name: str, diagnosis: Diagnosis) -> None:
    if diagnosis.findings:
        _print_findings(f"{name}: {_counts(diagnosis.counts)}", diagnosis.findings)
    else:
        _line(Text(f"{printable(name)}: nothing found", "bold"))


def _print_findings(heading: str, findings: tuple[Finding, ...]) -> None:
    _line(Text(printable(heading), "bold"))
    for finding in findings:
        _line(
            Text.assemble(
                (f"{finding.severity:<8}", COLORS[finding.severity]), (finding.title, "bold")
            )
        )
        more = len(finding.details) - FEW
        for text in (finding.message, *finding.details[:FEW]):
            _line(Text(f"        {printable(text)}"))
        if more > 0:
            _line(Text(f"        and {more} more"))
        _line(Text(f"        {printable(finding.advice)}", "dim"))
        if finding.repair:
            _line(Text(f"        --fix: {finding.repair}", "dim"))


def _print_repair(
    fix: Path, before: Diagnosis, repaired: Repaired | None, after: Diagnosis | None
) -> None:
    if repaired is None or after is None:
        _line(Text(f"nothing to repair: {printable(fix.name)} was not written"))
        return
    name = printable(fix.name)
    _line(Text(f"saved {name}, repaired:", "bold"))
    for text in repaired.done:
        _line(Text(f"        {printable(text)}"))
    _line(Text(f"before: {_counts(before.counts)}; after: {_counts(after.counts)}"))


def _counts(counts: dict[str, int]) -> str:
    """Return the number of findings: "1 error, 2 notes"."""
    counted = [f"{n} {severity}{'s' * (n != 1)}" for severity, n in counts.items() if n]
    return ", ".join(counted) or "nothing found"


def _line(text: Text) -> None:
    # Soft wrapping leaves lines whole, so that a sentence can be searched for and copied.
    Console(highlight=False, soft_wrap=True).print(text)
