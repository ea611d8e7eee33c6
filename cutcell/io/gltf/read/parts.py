"""What is left of a glTF document: meshes that are hidden, left out, and what is not read."""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np

from ....rig import Attachment, LeftOut
from ....runtime.display import listed
from ..container import Document, extensions
from ..nodes import Nodes, target_of
from .primitives import drawn_primitives

READ_EXTENSIONS = re.compile(
    "KHR_(mesh_quantization|animation_pointer|node_visibility)|VRM.*|"
    "[A-Z]+_(materials?|textures?|images?|lights?)_.*"
)
"""Extensions that are read, or change neither shapes, skins nor motion."""
OUTSIDE_SCENE = "is outside of the scene"
UNATTACHED = "has no skin and hangs on no joint"


def unread(document: Document) -> list[str]:
    """Return a sentence for each kind of what is not read; channels are checked."""
    required = document.json.get("extensionsRequired") or ()
    paths = {str(target_of(c)[1])[:80] for a in document.items("animations") for c in a["channels"]}
    kinds = {
        "required extensions": [
            str(name) for name in required if not READ_EXTENSIONS.fullmatch(str(name))
        ],
        "morph targets": [
            document.label("meshes", m)
            for m, mesh in enumerate(document.items("meshes"))
            if any(primitive.get("targets") for primitive in mesh.get("primitives", ()))
        ],
        "animations of other properties than nodes have": sorted(p for p in paths if p[:1] == "/"),
    }
    return [
        f"{kind} are not read ({listed(names)}): what they change is missing, and saved as it was"
        for kind, names in kinds.items()
        if names
    ]


def mesh_name(document: Document, nodes: Nodes, node: int) -> str:
    """Return the name of a node's mesh: the node's, the mesh's, or its number."""
    for owner in (nodes.raw[node], document.items("meshes")[nodes.raw[node]["mesh"]]):
        if isinstance(owner.get("name"), str) and owner["name"]:
            return owner["name"]
    return f"mesh {nodes.raw[node]['mesh']}"


def hidden_nodes(nodes: Nodes) -> set[int]:
    """Return the nodes that `KHR_node_visibility` hides, and all below them."""
    hidden: set[int] = set()
    for level in nodes.levels:
        for i in level.tolist():
            visibility = extensions(nodes.raw[i]).get("KHR_node_visibility")
            off = isinstance(visibility, dict) and visibility.get("visible", True) is False
            if off or nodes.parents[i] in hidden:
                hidden.add(i)
    return hidden


def vanishes(nodes: Nodes, node: int) -> bool:
    """Return whether a node is scaled to nothing, as game characters hide their weapons."""
    return bool(np.linalg.matrix_rank(nodes.world[node][:3, :3]) < 2)


def draws_mesh(document: Document, nodes: Nodes, node: int) -> bool:
    """Return whether a node's mesh has triangles, not only points or lines."""
    user = document.label("nodes", node)
    return bool(drawn_primitives(document, nodes.raw[node]["mesh"], user))


def left_out_meshes(
    document: Document, nodes: Nodes, bound: Iterable[int], attached: Iterable[int]
) -> tuple[LeftOut, ...]:
    """List the meshes that no part and no attachment shows, with the reason."""
    in_scene, used = set(nodes.in_scene()), {*bound, *attached}
    left_out = []
    draws: dict[int, bool] = {}
    for i, node in enumerate(nodes.raw):
        if "mesh" not in node or i in used:
            continue
        mesh = node["mesh"]
        if mesh not in draws:
            draws[mesh] = draws_mesh(document, nodes, i)
        if not draws[mesh]:
            why = "is points or lines"
        elif i not in in_scene:
            why = OUTSIDE_SCENE
        elif vanishes(nodes, i):
            why = "is scaled to nothing"
        else:
            why = UNATTACHED
        left_out.append(LeftOut(mesh_name(document, nodes, i), why))
    return tuple(left_out)


def left_out_warnings(
    left_out: Iterable[LeftOut], attachments: Iterable[Attachment]
) -> tuple[str, ...]:
    """List the meshes that are seen in the file and are not bound, in sentences."""
    groups = (
        [one.name for one in attachments if not one.hidden],
        [one.name for one in left_out if one.why == UNATTACHED],
        [one.name for one in left_out if one.why == OUTSIDE_SCENE],
    )
    reasons = (
        "move rigidly with a joint and are only bound if they are loaded as accessories",
        "have no skin, hang on no joint, and are left out unless they are loaded as accessories",
        "are outside of the default scene, and are left out. Move them to that scene",
    )
    pairs = zip(groups, reasons, strict=True)
    return tuple(f"some meshes ({listed(names)}) {reason}" for names, reason in pairs if names)
