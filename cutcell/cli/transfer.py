"""The command `cutcell transfer`: weights for clothes and levels of detail."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import ParameterError
from .console import for_people, print_result, progress_bars
from .options import Json, Quiet, RigFile

EPILOG = """Examples:

- `cutcell transfer body.glb coat.obj coat.glb`

- `cutcell transfer body.glb lod1.glb new1.glb lod2.glb new2.glb`  (several targets)

- `cutcell transfer body.glb coat.glb new.glb --joint 'Arm.L' --mix 0.5`  (some of a joint's weight)

- `cutcell transfer body.glb coat.glb new.glb --names Spine2=Chest`  (other names of joints)"""

MATCHES, CHANGES = "Matches", "What changes"


@for_people
def transfer(
    source: RigFile,
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="TARGET OUT [TARGET OUT]...",
            help="Meshes or rigs that lie on the character, each before its output file.",
        ),
    ],
    distance: Annotated[
        float,
        typer.Option(
            metavar="D", rich_help_panel=MATCHES,
            help="Greatest distance of a match, as part of the diagonal of RIG.",
        ),
    ] = 0.05,
    angle: Annotated[
        float,
        typer.Option(
            metavar="DEGREES", rich_help_panel=MATCHES,
            help="Greatest angle between the normals of a match.",
        ),
    ] = 30.0,
    flipped: Annotated[
        bool,
        typer.Option(
            "--flipped", rich_help_panel=MATCHES,
            help="Match opposite normals, too: the inside of layered cloth.",
        ),
    ] = False,
    joint: Annotated[
        list[str] | None,
        typer.Option(
            metavar="JOINT", rich_help_panel=CHANGES,
            help="Transfer the weights of this joint only. May be given several times.",
        ),
    ] = None,
    mix: Annotated[
        float,
        typer.Option(
            metavar="PART", rich_help_panel=CHANGES,
            help="Part of the new weights, 0 to 1; the rest are TARGET's own.",
        ),
    ] = 1.0,
    lock: Annotated[
        list[str] | None,
        typer.Option(
            metavar="JOINT", rich_help_panel=CHANGES,
            help="Joint that keeps TARGET's weights. May be given several times.",
        ),
    ] = None,
    max_influences: Annotated[
        int,
        typer.Option(
            metavar="K", rich_help_panel=CHANGES, help="Largest number of weights of a vertex."
        ),
    ] = 4,
    names: Annotated[
        list[str] | None,
        typer.Option(
            metavar="JOINT=NAME", rich_help_panel=CHANGES,
            help="TARGET's name of a joint of RIG; nothing after = for none. May be given several"
            " times.",
        ),
    ] = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:  # fmt: skip
    """Transfer the weights of RIG to meshes that lie on it, such as clothes, and save these.

    A vertex takes the weights of the closest point whose normal fits, and of the right one where
    several parts of the body are near. The other vertices are in-painted: smoothly, from those
    around them.
    """
    from ..editing.transfer import transfer as compute
    from ..io import check_output, load, save, saving_notes
    from ..io.files import naming

    if len(files) % 2:
        raise ParameterError(f"{files[-1]} has no output file; name one after each target")
    if wrong := [name for name in names or () if "=" not in name]:
        raise ParameterError(f'--names {wrong[0]} lacks "="; give JOINT=NAME')
    renamed = {joint: other for joint, _, other in (name.partition("=") for name in names or ())}
    outs = files[1::2]
    for out in outs:
        check_output(out)
    rig = load(source)
    targets = [load(file) for file in files[::2]]
    with naming(source), progress_bars(quiet) as progress:
        results = compute(
            rig, targets, distance=distance, angle=angle, flipped=flipped, joints=joint, mix=mix,
            locked=lock or (), max_influences=max_influences, names=renamed, progress=progress,
        )  # fmt: skip
    rows: list[tuple[str, str]] = []
    warnings, documents = list(rig.warnings), list[dict[str, Any]]()
    for target, out, result in zip(files[::2], outs, results, strict=True):
        check_output(out, result.rig)
        saved = save(out, result.rig)
        warnings += saving_notes(out, result.rig)
        documents.append(
            {"input": str(target), "files": [str(file) for file in saved], **result.report}
        )
        counts = ", ".join(f"{count:,} {state}" for state, count in result.report.items() if count)
        rows.append((out.name, counts))
    document = {"source": str(source), "targets": documents, "warnings": warnings}
    print_result(
        document, f"{source.name} -> {', '.join(out.name for out in outs)}", rows, json, quiet
    )
