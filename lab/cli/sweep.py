"""The command `cutcell sweep`: one option over several values, measured on one character."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from cutcell.cli.console import for_people, print_json, print_warnings, progress_bars
from cutcell.cli.options import Json, Quiet, RigFile, chosen_method, with_method

EPILOG = """Examples:

- `cutcell sweep character.glb`

- `cutcell sweep character.glb --option winding_threshold --values 0.1,0.3,0.5,0.7,0.9`

- `cutcell sweep character.glb --option alpha --values 0,0.5,1 --method paper`

- `cutcell sweep character.glb --values 32,64,128 --csv > resolution.csv`"""


@for_people
@with_method()
def sweep(
    rig: RigFile,
    options: dict[str, Any],
    option: Annotated[
        str, typer.Option("--option", metavar="NAME", help="Option of the method to vary.")
    ] = "resolution",
    values: Annotated[
        str, typer.Option("--values", metavar="A,B,...", help="Its values.")
    ] = "16,32,64,128",
    csv: Annotated[bool, typer.Option("--csv", help="Print CSV.")] = False,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Bind RIG with several values of one option, and measure each against the file's weights.

    Where the file has no weights, the reference is the binding without the change. L1, precision,
    recall and deformation error are those of `cutcell compare`. A setting that fails is listed with
    its error.
    """
    from cutcell.io import load

    from ..sweeps import parsed_values
    from ..sweeps import sweep as measure
    from ..sweeps.report import print_sweep

    loaded = load(rig)
    method, numbers = chosen_method(options), parsed_values(values)
    with progress_bars(quiet) as progress:
        result = measure(loaded, option, numbers, method=method, progress=progress)
    if not quiet:
        print_warnings(loaded.warnings)
    if csv:
        print(result.to_csv(), end="")
    elif json:
        print_json(result.to_dict())
    else:
        print_sweep(result)
