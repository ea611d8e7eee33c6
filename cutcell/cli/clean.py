"""The command `cutcell clean`: remove implausible weights."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from ..runtime.display import count
from .console import for_people, print_result, progress_bars
from .options import Json, OutFile, Quiet, Resolution, RigFile, SkeletonFile

if TYPE_CHECKING:
    from ..diagnosis import Cleaned

EPILOG = """Examples:

- `cutcell clean network.glb clean.glb`

- `cutcell clean character.npz clean.npz -r 128`  (a finer lattice keeps close parts apart)

- `cutcell clean network.glb clean.glb --json | jq '.joints[] | {name, share}'`  (for a script)"""

LISTED_JOINTS = 12
"""Joints that the table lists; `--json` has them all."""


@for_people
def clean(
    rig: RigFile,
    out: OutFile,
    resolution: Resolution = 64,
    skeleton: SkeletonFile = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Remove implausible weights from RIG and save it as OUT.

    Weight is removed where its joint is far through the body, other joints are nearer, and no
    skin that follows the joint leads there: a hand's weight on the hip, islands, noise. The other
    weights keep their proportions. Painted weights that are connected with their joint stay.
    """
    from ..diagnosis import clean as remove
    from ..io import check_output, load, save, saving_notes
    from ..io.files import naming

    check_output(out)
    loaded = load(rig, skeleton=skeleton)
    check_output(out, loaded)
    with naming(rig), progress_bars(quiet) as progress:
        cleaned = remove(loaded, resolution, progress=progress)
    files = save(out, loaded.with_weights(cleaned.weights))
    warnings = [*loaded.warnings, *saving_notes(out, loaded)]
    document = {
        "input": str(rig),
        "output": str(out),
        "files": [str(file) for file in files],
        "resolution": resolution,
        "vertices": len(cleaned.weights),
        "changed": len(cleaned.vertices),
        "bound": len(cleaned.bound),
        "share": cleaned.share,
        "joints": [{**vars(loss), "vertices": loss.vertices.tolist()} for loss in cleaned.losses],
        "warnings": warnings,
    }
    print_result(document, f"{rig.name} -> {out}", _rows(document, cleaned), json, quiet)


def _rows(document: dict[str, Any], cleaned: Cleaned) -> Iterator[tuple[str, str]]:
    """Return the removed weight as pairs of a name and a text."""
    if not cleaned.losses:
        yield "removed", "nothing"
        return
    yield "removed", f"{cleaned.share:.2%} of all weight"
    yield "changed", f"{document['changed']:,} of {document['vertices']:,} vertices"
    if document["bound"]:
        yield "bound again", f"{document['bound']:,} that lost more than half of their weight"
    for loss in cleaned.losses[:LISTED_JOINTS]:
        vertices = count(len(loss.vertices), "vertex")
        share = f"{loss.share:.1%} of its weight, on {vertices}, up to {loss.largest:.0%} of one"
        yield loss.name, share
    if len(cleaned.losses) > LISTED_JOINTS:
        yield "", f"and {len(cleaned.losses) - LISTED_JOINTS} more joints"
