"""What colours the meshes of an FBX: base colours, their images, and where corners lie in these.

`cutcell.io.materials.surfaces` says what the arrays are.
"""

from __future__ import annotations

import numpy as np
import ufbx

from .fbx_kept import keep, kept
from .palette import Palette

LONGEST = 1000
"""Characters of an image's name that are handed on."""
UNSEEN = 0.02
"""Opacity of what nobody would model: many programs write 0 and mean 1."""


class FbxPalette(Palette):
    """The materials of an FBX, by its elements."""

    def __init__(self):
        super().__init__()
        self.textures: list = []
        self._numbers: dict[int, int] = {}

    def number(self, material):
        """Return the number of a material, -1 for none."""
        if material is None:
            return -1
        number = self._numbers.get(material.element_id)
        if number is not None:
            return number
        keep(material)
        texture = base_texture(material)
        image = -1
        if texture is not None:
            names = (texture.relative_filename, texture.filename, texture.absolute_filename)
            image = self.add_image(tuple(name[:LONGEST] for name in names), texture.content)
        color, cut = base_color(material), is_cut(material)
        number = self.add_material(material.name, color, opacity(material), image, cut)
        self._numbers[material.element_id] = number
        self.textures.append(texture)
        return number


def base_texture(material):
    """Return the texture of the base colour that has a file; None if there is none."""
    for channel in (material.pbr.base_color, material.fbx.diffuse_color):
        texture = channel.texture
        if texture is None or not channel.texture_enabled:
            continue
        keep(texture)
        for one in [texture, *kept(texture.file_textures)]:
            if one.type == ufbx.TextureType.FILE and (one.filename or len(one.content)):
                return one
    return None


def base_color(material):
    """Return red, green and blue, times the factor."""
    for color, factor in (
        (material.pbr.base_color, material.pbr.base_factor),
        (material.fbx.diffuse_color, material.fbx.diffuse_factor),
    ):
        if color.has_value:
            share = factor.value_vec4.x if factor.has_value else 1.0
            return tuple(share * x for x in tuple(color.value_vec4)[:3])
    return (1.0, 1.0, 1.0)


def opacity(material):
    """Return how opaque a material is, from 0 to 1."""
    if material.pbr.opacity.has_value:
        value = material.pbr.opacity.value_vec4.x
    else:
        color, factor = material.fbx.transparency_color, material.fbx.transparency_factor
        if not color.has_value or not factor.has_value:
            return 1.0
        value = 1 - factor.value_vec4.x * sum(tuple(color.value_vec4)[:3]) / 3
    return float(value) if UNSEEN < value < 1 else 1.0


def is_cut(material):
    """Return whether an image says where a material is not."""
    maps = (material.pbr.opacity, material.fbx.transparency_color, material.fbx.transparency_factor)
    return any(one.texture is not None and one.texture_enabled for one in maps)


def surface(mesh, node, corners, polygons, palette):
    """Return what colours the triangles of a mesh at a place.

    Shapes: corners (m, 3), polygons (m,).
    """
    materials = kept(node.materials) or kept(mesh.materials)
    numbers = np.array([*(palette.number(one) for one in materials), -1])
    which = np.array(list(mesh.face_material), int)
    which = which[polygons] if len(which) else np.zeros(len(polygons), int)
    has_material = (which >= 0) & (which < len(materials))
    material = numbers[np.where(has_material, which, -1)]
    arrays = {"materials": material}
    if mesh.vertex_color.exists:
        values, indices = stored(mesh.vertex_color)
        colors = values[indices[corners]][..., :3]
        arrays["colors"] = np.round(255 * np.clip(np.nan_to_num(colors), 0, 1)).astype(np.uint8)
    textured = [k for k in np.unique(material) if k >= 0 and palette.textures[k] is not None]
    if mesh.vertex_uv.exists:
        sets = {one.name: one.vertex_uv for one in kept(mesh.uv_sets)}
        names = {palette.textures[k].uv_set for k in textured}
        coordinates = {name: stored(sets.get(name) or mesh.vertex_uv) for name in names}
        values, indices = stored(mesh.vertex_uv)
        places = upper_left(values[indices[corners]]).astype(np.float32)
        for k in textured:
            texture, rows = palette.textures[k], np.flatnonzero(material == k)
            values, indices = coordinates[texture.uv_set]
            places[rows] = in_image(values[indices[corners[rows]]], texture)
        arrays["places"] = places
    return arrays


def stored(attribute):
    """Return the values of an attribute, and which each corner has."""
    values = np.array([tuple(value) for value in attribute.values], float)
    return values, np.array(list(attribute.indices), int)


def in_image(uv, texture):
    """Return where texture coordinates lie in the image, from its upper left corner."""
    if texture.has_uv_transform:
        columns = np.array([tuple(column) for column in texture.uv_to_texture])
        uv = uv @ columns[:2, :2] + columns[3, :2]
    return upper_left(uv)


def upper_left(uv):
    """Return texture coordinates from the upper left corner of an image, shape (..., 2)."""
    return np.stack([uv[..., 0], 1 - uv[..., 1]], axis=-1)
