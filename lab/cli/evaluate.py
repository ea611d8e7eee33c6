"""The command `cutcell evaluate`: predicted weights measured against other weights."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cutcell.cli.console import for_people, print_json, print_warnings
from cutcell.cli.options import Json, Quiet

from .dataset import counting

EPILOG = """Examples:

- `cutcell evaluate predicted.glb character.glb`

- `cutcell evaluate predictions test_rigs`  (matched by file name)

- `cutcell evaluate weights.npy character.glb`  (weights alone, a row a vertex)

- `cutcell evaluate predictions test_rigs --markdown > errors.md`

- `cutcell evaluate predictions test_rigs --json | jq .summary.paper.l1.median`"""


@for_people
def evaluate(
    predicted: Annotated[
        Path,
        typer.Argument(
            metavar="PREDICTED",
            help="Weights to measure: a rig, an array of weights (.npy), or a folder of either.",
        ),
    ],
    reference: Annotated[
        Path,
        typer.Argument(metavar="REFERENCE", help="The right weights: a rig, or a folder of rigs."),
    ],
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Print Markdown, with a table for each definition.")
    ] = False,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Measure the weights of PREDICTED against those of REFERENCE, by three papers' definitions.

    Folders contain what `dataset bind` reads, and are matched by file name, without ending.
    Vertices are matched in order or by position, joints by name or by position. What cannot be
    matched is named, and left out. `docs/networks.md` defines every number.
    """
    from ..evaluation import evaluate as measure
    from ..evaluation import evaluation_markdown, left_out_lines, print_evaluation

    with counting("Evaluating", quiet or json) as step:
        evaluation = measure(predicted, reference, report=step)
    if not quiet:
        print_warnings(text for rig in evaluation.rigs for text in rig.warnings)
        print_warnings(left_out_lines(evaluation))
    if json:
        print_json(evaluation.to_dict())
    elif markdown:
        print(evaluation_markdown(evaluation), end="")
    else:
        print_evaluation(evaluation)
