"""What colours the meshes of a scene of another format.

Of materials: `material_names`, `material_values` (k, 4: red, green, blue, sRGB, and opacity) and
`material_uses` (k, 3: image or -1, how it goes on (see `face_colors.REPEAT`), and whether its alpha
counts); the image takes the place of the colour. Of images: `image_files` (i, names that a file
beside may have), and the content of those that are inside, `image_I_content`. Of each mesh K that
is coloured: `mesh_K_materials` (m,), and perhaps `mesh_K_places` and
`mesh_K_colors`; see `Surface`.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .surfaces import ImageFile, Material, Surface, Surfaces


def scene_surfaces(
    scene: Mapping[str, NDArray], path: Path, numbers: Mapping[int, int]
) -> Surfaces | None:
    """Return what colours the meshes of a scene; None if nothing does."""
    meshes = {number: _surface(scene, k) for k, number in numbers.items() if _is_coloured(scene, k)}
    if not meshes:
        return None
    materials = [
        Material(str(name), tuple(values[:3]), int(image), int(wrap), values[3], bool(cut), True)
        for name, values, (image, wrap, cut) in zip(
            scene["material_names"],
            scene["material_values"].tolist(),
            scene["material_uses"].tolist(),
            strict=True,
        )
    ]
    images = [
        ImageFile(tuple(map(str, names)), scene[f"image_{i}_content"].tobytes())
        for i, names in enumerate(scene["image_files"])
    ]
    return Surfaces(path, meshes, tuple(materials), tuple(images))


def _is_coloured(scene: Mapping[str, NDArray], k: int) -> bool:
    return f"mesh_{k}_colors" in scene or bool((scene.get(f"mesh_{k}_materials", _NONE) >= 0).any())


_NONE = np.zeros(0, int)


def _surface(scene: Mapping[str, NDArray], k: int) -> Surface:
    faces = scene[f"mesh_{k}_faces"].astype(np.int32)
    material = scene[f"mesh_{k}_materials"].astype(np.int32)
    return Surface(faces, material, scene.get(f"mesh_{k}_places"), scene.get(f"mesh_{k}_colors"))
