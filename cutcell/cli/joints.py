"""The command `cutcell joints`: deforming joints of a character."""

from __future__ import annotations

from typing import Any

from .console import for_people, print_result
from .options import Deform, Fresh, Json, NoDeform, RigFile, SkeletonFile

EPILOG = """Examples:

- `cutcell joints character.glb`

- `cutcell joints character.glb --fresh --no-deform '*_IK'`  (as `bind` would take it)

- `cutcell joints character.glb --json | jq '.joints[] | select(.deform | not)'`"""


@for_people
def joints(
    rig: RigFile,
    deform: Deform = None,
    no_deform: NoDeform = None,
    fresh: Fresh = False,
    skeleton: SkeletonFile = None,
    json: Json = False,
) -> None:
    """List the joints of RIG: which may carry weight, and why.

    The weights in the file decide. Without weights, names and positions do: end markers,
    controls, and roots outside the body are excluded. Doubtful joints may carry weight;
    exclude them with `--no-deform`. `cutcell bind` has the same options.
    """
    from ..io import load
    from ..io.files import naming
    from ..rig.deform_joints import choose_deform, deform_joints

    loaded = load(rig, skeleton=skeleton)
    with naming(rig):
        loaded.require_joints()
        chosen = choose_deform(loaded, deform or (), no_deform or (), fresh=fresh)
    guess = deform_joints(loaded.mesh, loaded.skeleton)
    rows: list[dict[str, Any]] = []
    cells: list[tuple[str, str]] = []
    for j, name in enumerate(chosen.skeleton.names):
        carries = bool(chosen.skeleton.deform[j])
        reason = guess.reason[j]
        if bool(guess.deform[j]) != carries:
            by_weights = chosen.weights is not None and carries == loaded.skeleton.deform[j]
            reason = "by the file" if by_weights else "chosen"
        doubtful = carries and bool(guess.doubtful[j]) and reason == guess.reason[j]
        row = {"name": name, "parent": int(chosen.skeleton.parents[j]), "deform": carries}
        rows.append({**row, "reason": reason, "doubtful": doubtful})
        answer = "doubtful" if doubtful else "yes" if carries else "no"
        cells.append((name, f"{answer} · {reason}"))
    document = {"input": str(rig), "joints": rows, "warnings": list(loaded.warnings)}
    count = int(chosen.skeleton.deform.sum())
    print_result(document, f"{rig.name}: {count} of {len(rows)} joints deform", cells, json)
