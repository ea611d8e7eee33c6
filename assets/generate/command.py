"""The command `cutcell dataset generate`, added by the entry point `cutcell.commands`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from cutcell.cli.console import for_people, print_json, print_table
from cutcell.cli.options import Json, Quiet
from cutcell_lab.cli.dataset import counting, dataset

EPILOG = """Examples:

- `cutcell dataset generate beast 100 rigs`

- `cutcell dataset generate any 2000 rigs --seed 5 --detail 96`"""


def add_command(app: typer.Typer) -> None:
    """Add the command to `cutcell dataset`."""
    dataset.command(epilog=EPILOG)(generate)


@for_people
def generate(
    kind: Annotated[
        str,
        typer.Argument(
            metavar="KIND", help="body, hand, beast, octopus, robot, person (needs anny), or any."
        ),
    ],
    count: Annotated[int, typer.Argument(metavar="COUNT", help="How many.", min=1)],
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="Gets an npz file for each.")],
    seed: Annotated[int, typer.Option("--seed", help="Of the first; the next has the next.")] = 0,
    detail: Annotated[
        int, typer.Option("--detail", help="Samples along the longest side, 12 to 512.")
    ] = 48,
    clean: Annotated[bool, typer.Option("--clean", help="No holes, loose parts or soups.")] = False,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Generate COUNT characters with weights, each as an Articulation-XL npz.

    The seed determines proportions and pose.
    """
    from cutcell.io import save

    from .characters import KINDS
    from .characters import generate as make

    folder.mkdir(parents=True, exist_ok=True)
    kinds = [name for name in KINDS if name != "person"] if kind == "any" else [kind]
    with counting("Generating", quiet or json) as step:
        for k in range(count):
            rig = make(kinds[k % len(kinds)], seed + k, detail=detail, clean=clean)  # type: ignore[arg-type]
            save(folder / f"{rig.name}.npz", replace(rig, parts=()))
            step(k + 1, count, rig.name)
    if json:
        print_json({"output": str(folder), "assets": count})
    elif not quiet:
        print_table(str(folder), [("assets", f"{count:,}")])
