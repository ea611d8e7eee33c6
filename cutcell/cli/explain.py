"""The command `cutcell explain`: the origin of the weights of a vertex."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from ..runtime.display import shown_name
from .console import for_people, print_json, print_warnings, progress_bars
from .options import Json, LayersFile, RigFile, SkeletonFile, layered_method, with_method

if TYPE_CHECKING:
    from ..binding import Explanation, JointShare

EPILOG = """Examples:

- `cutcell explain character.glb 120`

- `cutcell explain character.glb 120 --joint hand.L`  (why not this joint?)

- `cutcell explain character.glb 120 --method paper`

- `cutcell explain character.glb 120 --json | jq '.joints[].steps'`  (for a script)"""

PRINTED_JOINTS = 6
"""Maximum number of printed joints; `--json` lists all."""


@for_people
@with_method()
def explain(
    rig: RigFile,
    vertex: Annotated[
        int, typer.Argument(metavar="VERTEX", help="Number of the vertex in the file, from 0.")
    ],
    options: dict[str, Any],
    joint: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Also explain why this joint has no weight there."),
    ] = None,
    layers: LayersFile = None,
    skeleton: SkeletonFile = None,
    json: Json = False,
) -> None:
    """Explain the weights that `cutcell bind` computes for a VERTEX of RIG.

    The table lists for each joint the distance and its path, the factors of the falloff, the
    weight after each step, and the weight in the file.
    """
    from ..binding import explain as compute
    from ..editing.stored import load_edits, with_base
    from ..io import load

    stored = None if layers is None else load_edits(layers)
    how, resolution = layered_method(options, stored)
    loaded = load(rig, skeleton=skeleton)
    if stored is not None:
        loaded = with_base(loaded)
    with progress_bars(quiet=json) as progress:
        explanation = compute(
            loaded, vertex, resolution, joint=joint, method=how, edits=stored, progress=progress
        )
    if json:
        print_json({"input": str(rig), **explanation.to_dict(), "warnings": list(loaded.warnings)})
        return
    print_warnings(loaded.warnings)
    _print(f"{rig.name}, vertex {vertex}", explanation, joint)


def _print(heading: str, explanation: Explanation, joint: str | None) -> None:
    from ..binding.absence import STEP_LABELS

    console = Console(highlight=False)
    place = ", ".join(f"{x:.4g}" for x in explanation.position)
    table = Table(title=Text(f"{heading} at ({place})", "bold"), title_justify="left", box=None)
    table.add_column(style="dim", no_wrap=True)
    shares = explanation.joints[:PRINTED_JOINTS]
    absent = [share for share in explanation.joints if share.absence]
    shares += tuple(share for share in absent if share.name == joint and share not in shares)
    for share in shares:
        table.add_column(Text(shown_name(share.name), overflow="fold"), justify="right")
    for name, cells in _rows(shares, STEP_LABELS):
        table.add_row(name, *cells)
    console.print(table)
    if explanation.fallback:
        console.print(f"It follows its nearest bones in a straight line: {explanation.fallback}.")
    for share in shares:
        console.print(Text(f"path to {shown_name(share.name)}: {_path(share)}", "dim"))
    for share in shares:
        if share.absence:
            console.print(Text(f"no weight of {shown_name(share.name)}: {share.absence}"))
    if (more := len(explanation.joints) - len(shares)) > 0:
        console.print(f"and {more} more joints with less weight: --json")


def _rows(shares: tuple[JointShare, ...], steps: dict[str, str]) -> list[tuple[str, list[str]]]:
    """Return the rows of the table: names, and a cell for each joint."""
    rows = [
        ("distance", [_number(share.distance) for share in shares]),
        ("through the air", [_number(share.straight) for share in shares]),
        ("rank", [str(share.rank or "") for share in shares]),
    ]
    factors = dict.fromkeys(name for share in shares for name in share.factors)
    for name in factors:
        cells = [f"x {share.factors[name]:.3g}" if share.factors else "" for share in shares]
        rows.append((f"  {name}", cells))
    if factors:
        rows.append(("counts as", [_number(share.effective) for share in shares]))
    for name in dict.fromkeys(name for share in shares for name in share.steps):
        rows.append((steps.get(name, name), [f"{share.steps[name]:.4f}" for share in shares]))
    if any(share.file_weight is not None for share in shares):
        rows.append(("in the file", [f"{share.file_weight:.4f}" for share in shares]))
    return rows


def _number(length: float) -> str:
    return "farther" if length == float("inf") else f"{length:.4g}"


def _path(share: JointShare) -> str:
    """Return the kinds and lengths of the segments of a path, in order."""
    if not share.path:
        return "none leads through the body"
    parts = []
    for kind, pieces in groupby(share.path, lambda piece: piece.kind):
        run = list(pieces)
        many = f" ({len(run)})" if len(run) > 1 else ""
        parts.append(f"{kind} {sum(piece.length for piece in run):.4g}{many}")
    return ", ".join(parts)
