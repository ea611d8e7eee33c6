"""The materials and images of a scene, as arrays that `scene_surfaces` in cutcell.io reads."""

from __future__ import annotations

import numpy as np

NAME = 200
"""Characters of a material's name that are handed on."""


class Palette:
    """Lists each material and each image once; only those that a mesh has are to be listed."""

    def __init__(self):
        self._names: list[str] = []
        self._values: list[tuple[float, ...]] = []
        self._uses: list[tuple[int, ...]] = []
        self._images: dict[tuple, int] = {}
        self._contents: list[bytes] = []

    def add_material(self, name, color, opacity, image, cut):
        """List a material; return its number."""
        self._names.append(name[:NAME])
        self._values.append((*color, opacity))
        self._uses.append((image, int(cut)))
        return len(self._names) - 1

    def add_image(self, names, content):
        """List an image, if that was not done; return its number."""
        key = (names, len(content))
        if key not in self._images:
            self._images[key] = len(self._contents)
            self._contents.append(content)
        return self._images[key]

    def arrays(self):
        """Return what the process hands on."""
        arrays = {
            "material_names": np.array(self._names, np.str_),
            "material_values": np.array(self._values, float).reshape(-1, 4),
            "material_uses": np.array(self._uses, int).reshape(-1, 2),
            "image_files": np.array([names for names, _ in self._images], np.str_).reshape(-1, 3),
        }
        for k, content in enumerate(self._contents):
            arrays[f"image_{k}_content"] = np.frombuffer(content, np.uint8)
        return arrays
