"""The command `cutcell weights`: weights to and from other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .console import for_people, print_result
from .options import FILES, Json, Quiet, RigFile, SkeletonFile

EPILOG = """Examples:

- `cutcell weights character.glb character.xml`  (Maya's deformerWeights, a file for each mesh)

- `cutcell weights character.glb character.json`  (ngSkinTools)

- `cutcell weights character.glb new.glb --weights body.xml --weights coat.csv`  (onto the rig)"""


@for_people
def weights(
    rig: RigFile,
    out: Annotated[
        Path,
        typer.Argument(
            metavar="OUT",
            help="Ends in .xml (Maya), .json (ngSkinTools) or .csv for weights alone, else as a rig"
            " is saved.",
        ),
    ],
    files: Annotated[
        list[Path] | None,
        typer.Option(
            "--weights",
            metavar="FILE",
            rich_help_panel=FILES,
            help="Take the weights from this .xml, .json or .csv, by the names of meshes and joints"
            " and the nearest vertices. May be given several times.",
        ),
    ] = None,
    skeleton: SkeletonFile = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write the weights of RIG for another program, or put its weights onto RIG.

    Each mesh of several gets a file of its own, with its name before the ending of OUT. Vertices
    are in the order of RIG's file, with their positions.
    """
    from ..io import check_output, load, save, saving_notes
    from ..io.exchange import WEIGHT_FILES, save_weights, with_saved_weights
    from ..io.files import naming

    alone = out.suffix.lower() in WEIGHT_FILES
    if not alone:
        check_output(out)
    loaded = load(rig, skeleton=skeleton)
    with naming(rig):
        loaded.require_joints()
    if files:
        loaded = with_saved_weights(loaded, files)
    if alone:
        with naming(rig):
            saved, notes = save_weights(out, loaded), []
    else:
        check_output(out, loaded)
        saved, notes = save(out, loaded), list(saving_notes(out, loaded))
    document = {
        "input": str(rig),
        "weights": [str(file) for file in files or ()],
        "files": [str(file) for file in saved],
        "warnings": [*loaded.warnings, *notes],
    }
    rows = [
        (part.name, f"{part.vertices.stop - part.vertices.start:,} vertices")
        for part in loaded.parts
    ]
    rows += [("file", str(file)) for file in saved]
    print_result(document, f"{rig.name} -> {out}", rows, json, quiet)
