"""A graph and its distances in numbers, for the command line and for scripts."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from ..geodesics import FALLBACK_REASONS, BoneDistances
from ..geometry.triangles import face_edges, label_components
from ..graph import INTERIOR, MESH, SURFACE, CutCellGraph
from ..rig import Rig, Skeleton, TriangleMesh

GRAPH_KINDS = {"mesh": MESH, "interior": INTERIOR, "surface": SURFACE}
"""Name of each kind of node and edge."""


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


def summarize_parts(rig: Rig) -> dict[str, list[dict[str, Any]]]:
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


def summarize_skeleton(skeleton: Skeleton) -> dict[str, int]:
    """Count the joints, those that may carry weight (`deform`), and the roots."""
    return {
        "joints": len(skeleton.joints),
        "deform": int(skeleton.deform.sum()),
        "roots": int((skeleton.parents < 0).sum()),
    }


def summarize_graph(graph: CutCellGraph) -> dict[str, Any]:
    """Count the nodes and edges of each kind."""
    sizes = np.bincount(connected_components(graph.csr(), directed=False)[1])
    return {
        "resolution": graph.lattice.resolution,
        "nodes": _by_kind(graph.node_kind),
        "edges": _by_kind(graph.edge_kind),
        "components": len(sizes),
        "largest_component": float(sizes.max() / sizes.sum()),
    }


def summarize_fallback(distances: BoneDistances) -> dict[str, Any]:
    """Count the vertices that no path reached, by the reason."""
    codes = np.asarray(distances.fallback)
    counts = {int(code): int((codes == code).sum()) for code in np.unique(codes) if code}
    total = sum(counts.values())
    return {
        "vertices": total,
        "share": total / len(codes),
        "reasons": {str(FALLBACK_REASONS[code]): count for code, count in counts.items()},
    }


def summarize_weights(weights: NDArray[np.float64]) -> dict[str, float]:
    """Count the influences, joints with a weight above zero, of the vertices: mean and most."""
    influences = (weights > 0).sum(axis=1)
    return {"mean": float(influences.mean()), "most": int(influences.max())}


def _by_kind(kinds: NDArray[np.uint8]) -> dict[str, int]:
    counts = {name: int((kinds == code).sum()) for name, code in GRAPH_KINDS.items()}
    return counts | {"total": len(kinds)}
