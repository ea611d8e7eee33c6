"""The command `cutcell dataset audit`: near-duplicates in a data set, or between two."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from cutcell.cli.console import for_people, print_json, print_table
from cutcell.cli.options import Json, Quiet

from .dataset import Scheduler, Workers, counting, print_failures

EPILOG = """Examples:

- `cutcell dataset audit rigs`

- `cutcell dataset audit test train --out leaks`  (which of test are in train)

- `cutcell dataset audit store --json | jq .keep`"""

MEASURE = "Definition of a duplicate"


@for_people
def audit(
    first: Annotated[Path, typer.Argument(metavar="A", help="Rigs, or a store.")],
    second: Annotated[
        Path | None, typer.Argument(metavar="[B]", help="Rigs to compare A with.")
    ] = None,
    out: Annotated[
        Path, typer.Option("--out", metavar="FOLDER", help="Folder of the tables and the report.")
    ] = Path("audit"),
    joint_threshold: Annotated[
        float, typer.Option("--joints", help="T_J of stage 1, on joints.", rich_help_panel=MEASURE)
    ] = 0.01,
    surface_threshold: Annotated[
        float, typer.Option("--surface", help="T_V of stage 2.", rich_help_panel=MEASURE)
    ] = 0.01,
    points: Annotated[
        int, typer.Option("--points", help="Points on each surface.", rich_help_panel=MEASURE)
    ] = 2048,
    least: Annotated[
        int,
        typer.Option(
            "--min-points",
            help="DBSCAN's MinPts; the paper gives no value.",
            rich_help_panel=MEASURE,
        ),
    ] = 2,
    poses: Annotated[
        bool,
        typer.Option(
            "--poses/--no-poses",
            help="Find the same skeleton in other poses, too.",
            rich_help_panel=MEASURE,
        ),
    ] = True,
    scheduler: Scheduler = None,
    workers: Workers = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Find near-duplicates in A, or characters of A that are in B, as the paper does.

    All pairs are covered; lower bounds exclude pairs that cannot be duplicates. The results are
    pairs.parquet, clusters.parquet, audit.json and report.html in FOLDER. cutcell app --pairs
    FOLDER shows the pairs side by side for review; verdicts are kept when FOLDER is audited again.
    """
    from ..dataset.audit.audit_files import read_verdicts, save_audit
    from ..dataset.audit.auditing import audit as compare
    from ..dataset.audit.report import write_audit_report

    verdicts = read_verdicts(out)
    inputs = [first], [] if second is None else [second]
    with counting("Comparing", quiet or json) as step:
        result = compare(
            *inputs,
            joint_threshold=joint_threshold,
            surface_threshold=surface_threshold,
            points=points,
            least=least,
            poses=poses,
            scheduler=scheduler,
            workers=workers,
            report=step,
        )
    result = replace(result, verdicts=verdicts)
    save_audit(result, out, *inputs)
    write_audit_report(result, out / "report.html")
    document = result.to_dict()
    if json:
        print_json(document)
    elif not quiet:
        print_failures(result.failed)
        rows = [
            ("assets", f"{document['assets']:,}"),
            ("candidates", f"{result.candidates:,} pairs with similar joints"),
            ("near-duplicates", f"{len(result.pairs):,} pairs"),
            *((f"  {tier}", f"{count:,}") for tier, count in document["tiers"].items()),
            ("clusters", f"{len(document['clusters']):,}"),
            *([("overruled", f"{len(verdicts):,} pairs")] if verdicts else []),
            ("to keep", f"{len(document['keep']):,}"),
            ("report", str(out / "report.html")),
        ]
        print_table(str(first) if second is None else f"{first} in {second}", rows)
