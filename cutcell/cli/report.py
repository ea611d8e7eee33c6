"""Tables of the commands, with the same numbers as their JSON."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..runtime.display import count

if TYPE_CHECKING:
    from ..geodesics import BoneDistances
    from ..graph import CutCellGraph
    from ..rig import Rig

ROW_NAMES = 12
"""Maximum number of names in one row; `--json` lists all."""


def described(
    rig: Rig, graph: CutCellGraph, distances: BoneDistances | None, seconds: Mapping[str, float]
) -> dict[str, Any]:
    """Return a rig, its graph and distances in numbers, as `report_rows` and `--json` list them."""
    from . import summary

    return {
        "mesh": summary.summarize_mesh(rig.mesh, graph),
        "meshes": summary.summarize_parts(rig),
        "skeleton": distances and summary.summarize_skeleton(rig.skeleton),
        "graph": summary.summarize_graph(graph),
        "fallback": distances and summary.summarize_fallback(distances),
        "seconds": {name: round(value, 4) for name, value in seconds.items()},
    }


def report_rows(document: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Return the rows of a table as pairs of a name and a text."""
    mesh, graph, skeleton = document["mesh"], document["graph"], document["skeleton"]
    vertices, triangles = count(mesh["vertices"], "vertex"), count(mesh["triangles"], "triangle")
    components = count(mesh["components"], "component")
    yield "mesh", f"{vertices} ({mesh['welded_vertices']:,} welded), {triangles}, {components}"
    yield from _part_rows(document["meshes"])
    if mesh["closed"]:
        yield "surface", "closed"
    else:
        yield "surface", f"open: {count(mesh['open_edges'], 'edge')} with one triangle"
    if skeleton:
        joints, roots = count(skeleton["joints"], "joint"), count(skeleton["roots"], "root")
        yield "skeleton", f"{joints}, {skeleton['deform']:,} may carry weight; {roots}"
    yield "resolution", f"{graph['resolution']}"
    for what in ("nodes", "edges"):
        kinds = ", ".join(f"{graph[what][k]:,} {k}" for k in ("mesh", "interior", "surface"))
        yield what, f"{graph[what]['total']:,}: {kinds}"
    components = count(graph["components"], "component")
    yield "connected", f"{graph['largest_component']:.1%} of the nodes; {components} in all"
    if document["fallback"]:
        yield "not reached", _fallback(document["fallback"])
    if "influences" in document:
        influences = document["influences"]
        yield "influences", f"{influences['mean']:.2f} a vertex, {influences['most']} at most"
    if len(document.get("files", ())) > 1:
        yield "files", ", ".join(Path(file).name for file in document["files"])
    yield "seconds", ", ".join(f"{name} {value:.2f}" for name, value in document["seconds"].items())


def _part_rows(meshes: Mapping[str, Sequence[Mapping[str, Any]]]) -> Iterator[tuple[str, str]]:
    parts = meshes["parts"]
    if len(parts) > 1 or parts[0]["hidden"]:
        yield "parts", _named(parts, ["hidden" * part["hidden"] for part in parts])
    if meshes["attachments"]:
        notes = [f"on {a['joint']}" + (", hidden" * a["hidden"]) for a in meshes["attachments"]]
        yield "attachments", _named(meshes["attachments"], notes)
    if meshes["left_out"]:
        yield "left out", _named(meshes["left_out"], [out["why"] for out in meshes["left_out"]])


def _named(items: Sequence[Mapping[str, Any]], notes: Sequence[str]) -> str:
    entries = [
        item["name"] + (f" ({note})" if note else "")
        for item, note in zip(items[:ROW_NAMES], notes, strict=False)
    ]
    more = [f"and {len(items) - ROW_NAMES} more"] if len(items) > ROW_NAMES else []
    return f"{len(items):,}: " + ", ".join(entries + more)


def _fallback(fallback: Mapping[str, Any]) -> str:
    if not fallback["vertices"]:
        return "none: a path inside leads from a bone to every vertex"
    reasons = "; ".join(f"{number:,} {reason}" for reason, number in fallback["reasons"].items())
    return f"{fallback['share']:.1%} of the vertices ({reasons})"
