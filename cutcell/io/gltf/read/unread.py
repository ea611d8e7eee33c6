"""Sentences about what a document has and nobody reads."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ....runtime.display import listed
from ..container import Document
from ..nodes import targets
from .primitives import primitives

HARMLESS = re.compile(
    "KHR_(mesh_quantization|animation_pointer|node_visibility|lights_.*)|VRM.*|"
    "[A-Z]+_(materials?|textures?|images?|lights?)_.*"
)
"""Extensions that are read, or change neither shapes, skins nor motion."""


def unread(document: Document) -> Iterator[str]:
    """Yield a sentence for each kind of what is not read."""
    required = document.json.get("extensionsRequired")
    names = required if isinstance(required, list) else []
    names = [n for n in names if isinstance(n, str) and not HARMLESS.fullmatch(n)]
    if names:
        yield (
            f"the file requires extensions that are not read ({listed(names)}): what they add or "
            "change is missing, and stays in a saved document"
        )
    morphed = [
        document.label("meshes", m)
        for m, mesh in enumerate(document.items("meshes"))
        if "primitives" in mesh
        and any("targets" in one for one in primitives(document, m, f"meshes[{m}]"))
    ]
    if morphed:
        yield (
            f"morph targets are not read ({listed(morphed)}): meshes are bound without them, and "
            "they stay in a saved document"
        )
    properties = dict.fromkeys(str(path)[:80] for _, path in targets(document))
    pointers = [path for path in properties if path.startswith("/")]
    if pointers:
        yield (
            f"animations of other properties than those of nodes are not read ({listed(pointers)})"
            "; they stay in a saved document"
        )
