"""The command `cutcell graph`: contents of the cut-cell graph of a character."""

from __future__ import annotations

import time
from dataclasses import asdict
from typing import Any

from .console import for_people, print_json, print_table, print_warnings, progress_bars
from .options import (
    Deform,
    Fresh,
    Json,
    NoDeform,
    RigFile,
    SkeletonFile,
    chosen_method,
    with_method,
)
from .report import report_rows

EPILOG = """Examples:

- `cutcell graph character.glb`

- `cutcell graph scan.ply -r 128`  (a mesh alone: no skeleton is needed)

- `cutcell graph character.glb --json | jq .graph.edges.total`"""

GRAPH_OPTIONS = ("resolution", "connectivity", "winding_threshold", "orient", "samples", "leaf")
"""Options of the method that graph and distances depend on."""


@for_people
@with_method("method", *GRAPH_OPTIONS)
def graph(
    rig: RigFile,
    options: dict[str, Any],
    deform: Deform = None,
    no_deform: NoDeform = None,
    fresh: Fresh = False,
    skeleton: SkeletonFile = None,
    json: Json = False,
) -> None:
    """Build the cut-cell graph of RIG and list its contents; nothing is written.

    Counts nodes and edges (of the mesh, inside, on the surface), connected components,
    and the share of vertices that no bone reaches through the graph.
    """
    from ..geodesics import bone_distances
    from ..graph import build_graph
    from ..io import load
    from ..io.files import naming
    from ..metrics import summary
    from ..rig.deform_joints import choose_deform

    how = chosen_method(options)
    loaded = load(rig, skeleton=skeleton)
    with naming(rig):
        loaded = choose_deform(loaded, deform or (), no_deform or (), fresh=fresh)
    seconds: dict[str, float] = {}
    start = time.perf_counter()
    with progress_bars(quiet=json) as progress:
        built = build_graph(loaded.mesh, method=how, progress=progress)
        seconds["graph"] = round(time.perf_counter() - start, 4)
        distances = None
        if len(loaded.skeleton.joints):
            start = time.perf_counter()
            distances = bone_distances(
                built, loaded.skeleton, method=how, allowed=loaded.allowed, progress=progress
            )
            seconds["distances"] = round(time.perf_counter() - start, 4)
    document = {
        "input": str(rig),
        "method": options["method"],
        "parameters": {name: value for name, value in asdict(how).items() if name in GRAPH_OPTIONS},
        "mesh": summary.summarize_mesh(loaded.mesh, built),
        "meshes": summary.summarize_parts(loaded),
        "skeleton": distances and summary.summarize_skeleton(loaded.skeleton),
        "graph": summary.summarize_graph(built),
        "fallback": distances and summary.summarize_fallback(distances),
        "seconds": seconds,
        "warnings": list(loaded.warnings),
    }
    if json:
        print_json(document)
    else:
        print_warnings(loaded.warnings)
        print_table(rig.name, report_rows(document))
