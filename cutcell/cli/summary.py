"""A character, its graph and distances in numbers, as JSON and as the rows of a table."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from ..geodesics import FALLBACK_REASONS, BoneDistances
from ..geometry.triangles import face_edges, label_components
from ..graph import INTERIOR, MESH, SURFACE, CutCellGraph
from ..rig import Rig, TriangleMesh
from ..runtime.display import count

GRAPH_KINDS = {"mesh": MESH, "interior": INTERIOR, "surface": SURFACE}
"""Name of each kind of node and edge."""
ROW_NAMES = 12
"""Maximum number of names in one row; `--json` lists all."""


def described(
    rig: Rig, graph: CutCellGraph, distances: BoneDistances | None, seconds: Mapping[str, float]
) -> dict[str, Any]:
    """Return a rig, its graph and distances in numbers, as `report_rows` and `--json` list them."""
    sizes = np.bincount(connected_components(graph.csr(), directed=False)[1])
    joints = {
        "joints": len(rig.skeleton.joints),
        "deform": int(rig.skeleton.deform.sum()),
        "roots": int((rig.skeleton.parents < 0).sum()),
    }
    return {
        "mesh": summarize_mesh(rig.mesh, graph),
        "meshes": _parts(rig),
        "skeleton": None if distances is None else joints,
        "graph": {
            "resolution": graph.lattice.resolution,
            "nodes": _by_kind(graph.node_kind),
            "edges": _by_kind(graph.edge_kind),
            "components": len(sizes),
            "largest_component": float(sizes.max() / sizes.sum()),
        },
        "fallback": None if distances is None else _fallback(distances),
        "seconds": {name: round(value, 4) for name, value in seconds.items()},
    }


def summarize_mesh(mesh: TriangleMesh, graph: CutCellGraph) -> dict[str, Any]:
    """Count the elements of a mesh once equal positions are welded."""
    faces = graph.faces
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]  # welded to nothing
    uses = np.unique(face_edges(faces), axis=0, return_counts=True)[1]
    welded = int((graph.node_kind == MESH).sum())
    return {
        "vertices": len(mesh.vertices),
        "welded_vertices": welded,
        "triangles": len(mesh.faces),
        "components": len(np.unique(label_components(faces, welded)[faces])),
        "open_edges": int((uses == 1).sum()),
        "non_manifold_edges": int((uses > 2).sum()),
        "closed": bool(graph.is_closed),
    }


def _parts(rig: Rig) -> dict[str, list[dict[str, Any]]]:
    """List the meshes of a rig's file by name."""
    return {
        "parts": [
            {
                "name": part.name,
                "first": part.vertices.start,
                "vertices": part.vertices.stop - part.vertices.start,
                "hidden": part.hidden,
            }
            for part in rig.parts
        ],
        "attachments": [
            {"name": a.name, "joint": rig.skeleton.names[a.joint], "hidden": a.hidden}
            for a in rig.attachments
        ],
        "left_out": [{"name": out.name, "why": out.why} for out in rig.left_out],
    }


def _fallback(distances: BoneDistances) -> dict[str, Any]:
    """Count the vertices that no path reached, by the reason."""
    codes = np.asarray(distances.fallback)
    counts = {int(code): int((codes == code).sum()) for code in np.unique(codes) if code}
    total = sum(counts.values())
    return {
        "vertices": total,
        "share": total / len(codes),
        "reasons": {str(FALLBACK_REASONS[code]): number for code, number in counts.items()},
    }


def summarize_weights(weights: NDArray[np.float64]) -> dict[str, float]:
    """Count the influences, joints with a weight above zero, of the vertices: mean and most."""
    influences = (weights > 0).sum(axis=1)
    return {"mean": float(influences.mean()), "most": int(influences.max())}


def _by_kind(kinds: NDArray[np.uint8]) -> dict[str, int]:
    counts = {name: int((kinds == code).sum()) for name, code in GRAPH_KINDS.items()}
    return counts | {"total": len(kinds)}


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
        yield "not reached", _reached(document["fallback"])
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


def _reached(fallback: Mapping[str, Any]) -> str:
    if not fallback["vertices"]:
        return "none: a path inside leads from a bone to every vertex"
    reasons = "; ".join(f"{number:,} {reason}" for reason, number in fallback["reasons"].items())
    return f"{fallback['share']:.1%} of the vertices ({reasons})"
