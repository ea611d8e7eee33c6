"""The arrays of a scene, collected by the readers of FBX and USD.

`cutcell.io.formats.scene` and `cutcell.io.materials.surfaces` explain them.
"""

from __future__ import annotations

import numpy as np

LONGEST_NAME = 200
"""Characters of a material's name that are handed on."""


class Scene:
    """Nodes, meshes, clips and materials, listed one after the other."""

    def __init__(self):
        self._nodes, self._meshes, self._mesh_arrays = [], [], {}
        self._clips, self._tracks, self._keys = [], [], [np.zeros((0, 5))]
        self._materials, self._numbers, self._images = [], {}, {}

    def add_node(self, name, parent, transform, hidden, is_bone):
        """Add a node, with its transform as a row (10,); return its number."""
        self._nodes.append((name, parent, transform, hidden, is_bone))
        return len(self._nodes) - 1

    def add_mesh(self, name, node, arrays):
        """Add a mesh at a node."""
        self._mesh_arrays |= {f"mesh_{len(self._meshes)}_{k}": v for k, v in arrays.items()}
        self._meshes.append((name, node))

    def add_track(self, node, path, seconds, values):
        """Add the motion of a node to the next clip; shapes seconds (k,), values (k, 3 or 4)."""
        keys = np.zeros((len(seconds), 5))
        keys[:, 0], keys[:, 1 : 1 + values.shape[1]] = seconds, values
        self._keys.append(keys)
        self._tracks.append((len(self._clips), node, path, len(keys)))

    def end_clip(self, name):
        """Make a clip of the tracks that were added since the last one, if there are any."""
        if self._tracks and self._tracks[-1][0] == len(self._clips):
            self._clips.append(name)

    def material(self, key, describe):
        """Return the number of a material, -1 if `describe` returns None, else a row of them.

        A row has name, color, opacity, image, whether alpha cuts, and the reader of positions.
        """
        if key not in self._numbers:
            row = describe()
            self._numbers[key] = -1 if row is None else len(self._materials)
            self._materials += [] if row is None else [row]
        return self._numbers[key]

    def reader(self, number):
        """Return what tells the position in the image of a material."""
        return self._materials[number][-1]

    def add_image(self, names, content):
        """Add an image, if it is new; return its number."""
        key = names, len(content)
        return self._images.setdefault(key, (len(self._images), content))[0]

    def arrays(self):
        """Return what the process hands on."""
        names, parents, transforms, hidden, bones = zip(*self._nodes, strict=True)
        rows = self._materials
        arrays = {
            "node_names": np.array(names, np.str_),
            "node_parents": np.array(parents),
            "node_transforms": np.array(transforms, float),
            "node_hidden": np.array(hidden),
            "node_bones": np.array(bones),
            "mesh_names": np.array([name for name, _ in self._meshes], np.str_),
            "mesh_nodes": np.array([node for _, node in self._meshes], int),
            "clip_names": np.array(self._clips, np.str_),
            "tracks": np.array(self._tracks, int).reshape(-1, 4),
            "keys": np.concatenate(self._keys),
            "material_names": np.array([row[0][:LONGEST_NAME] for row in rows], np.str_),
            "material_values": np.array([(*row[1], row[2]) for row in rows], float).reshape(-1, 4),
            "material_uses": np.array([row[3:5] for row in rows], int).reshape(-1, 2),
            "image_files": np.array([names for names, _ in self._images], np.str_).reshape(-1, 3),
        }
        for k, content in self._images.values():
            arrays[f"image_{k}_content"] = np.frombuffer(content, np.uint8)
        return arrays | self._mesh_arrays


def upper_left(uv):
    """Return texture coordinates (..., 2) from the upper left corner of an image."""
    return np.stack([uv[..., 0], 1 - uv[..., 1]], axis=-1).astype(np.float32)
