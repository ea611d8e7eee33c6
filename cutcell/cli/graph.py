"""The command `cutcell graph`: contents of the cut-cell graph of a character."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from ..method import STAGE_OPTIONS
from . import options as given
from .console import for_people, print_result, progress_bars

EPILOG = """Examples:

- `cutcell graph character.glb`

- `cutcell graph scan.ply -r 128`  (a mesh alone: no skeleton is needed)

- `cutcell graph character.glb --json | jq .graph.edges.total`"""

GRAPH_OPTIONS = STAGE_OPTIONS["graph"] + STAGE_OPTIONS["distances"]
"""Options of the method that graph and distances depend on."""


@for_people
@given.with_method("method", *GRAPH_OPTIONS)
def graph(
    rig: given.RigFile,
    options: dict[str, Any],
    deform: given.Deform = None,
    no_deform: given.NoDeform = None,
    fresh: given.Fresh = False,
    skeleton: given.SkeletonFile = None,
    json: given.Json = False,
) -> None:
    """Build the cut-cell graph of RIG and list its contents; nothing is written.

    Counts nodes and edges (of the mesh, inside, on the surface), connected components,
    and the share of vertices that no bone reaches through the graph.
    """
    from ..binding.stages import measure, timed
    from ..editing import Computed
    from ..graph import build_graph
    from ..io import load
    from ..io.files import naming
    from ..rig.deform_joints import choose_deform
    from .summary import described, report_rows

    how = given.chosen_method(options)
    loaded = load(rig, skeleton=skeleton)
    with naming(rig):
        loaded = choose_deform(loaded, deform or (), no_deform or (), fresh=fresh)
    seconds: dict[str, float] = {}
    with progress_bars(quiet=json) as progress:
        with timed(seconds, "graph"):
            built = build_graph(loaded.mesh, method=how, progress=progress)
        distances = None
        if len(loaded.skeleton.joints):
            distances = measure(loaded, how, Computed(), seconds, built, progress)
    document = {
        "input": str(rig),
        "method": options["method"] or "animation",
        "parameters": {name: value for name, value in asdict(how).items() if name in GRAPH_OPTIONS},
        **described(loaded, built, distances, seconds),
        "warnings": list(loaded.warnings),
    }
    print_result(document, rig.name, report_rows(document), json)
