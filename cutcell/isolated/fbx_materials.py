"""What colours the meshes of an FBX: base colours, their images, and where corners lie in these."""

from __future__ import annotations

import numpy as np
import ufbx

from .scene import upper_left

LONGEST = 1000
"""Characters of an image's name that are handed on."""
UNSEEN = 0.02
"""Opacity treated as unset: many programs write 0 and mean 1."""
KEEP: list[list] = []
"""Elements of ufbx that must never be released: its bindings let go of them too often."""


def kept(elements):
    """Return a list's elements; they stay as long as the process."""
    KEEP.append(list(elements))
    return KEEP[-1]


def describe(scene, material):
    """Describe a material for `Scene.material`; its reader is the texture."""
    kept([material])
    texture, image = base_texture(material), -1
    if texture is not None:
        names = (texture.relative_filename, texture.filename, texture.absolute_filename)
        image = scene.add_image(tuple(name[:LONGEST] for name in names), texture.content)
    color, cut = base_color(material), is_cut(material)
    return material.name, color, opacity(material), image, cut, texture


def base_texture(material):
    """Return the texture of the base colour that has a file; None if there is none."""
    for channel in (material.pbr.base_color, material.fbx.diffuse_color):
        texture = channel.texture
        if texture is None or not channel.texture_enabled:
            continue
        kept([texture])
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


def surface(mesh, node, corners, polygons, scene):
    """Return what colours the triangles of a mesh at a node; corners (m, 3), polygons (m,)."""
    materials = kept(node.materials) or kept(mesh.materials)
    numbers = [
        -1 if one is None else scene.material(one.element_id, lambda one=one: describe(scene, one))
        for one in materials
    ]
    which = np.array(list(mesh.face_material), int)
    which = which[polygons] if len(which) else np.zeros(len(polygons), int)
    has_material = (which >= 0) & (which < len(materials))
    material = np.array([*numbers, -1])[np.where(has_material, which, -1)]
    arrays = {"materials": material}
    if mesh.vertex_color.exists:
        colors = at_corners(mesh.vertex_color, corners)[..., :3]
        arrays["colors"] = np.round(255 * np.clip(np.nan_to_num(colors), 0, 1)).astype(np.uint8)
    if mesh.vertex_uv.exists:
        sets = {one.name: one.vertex_uv for one in kept(mesh.uv_sets)}
        places = upper_left(at_corners(mesh.vertex_uv, corners))
        for k in np.unique(material[material >= 0]).tolist():
            texture, rows = scene.reader(k), np.flatnonzero(material == k)
            if texture is not None:
                uv = at_corners(sets.get(texture.uv_set) or mesh.vertex_uv, corners[rows])
                places[rows] = in_image(uv, texture)
        arrays["places"] = places
    return arrays


def at_corners(attribute, corners):
    """Return the values of an attribute at corners (m, 3), shape (m, 3, width)."""
    values = np.array([tuple(value) for value in attribute.values], float)
    return values[np.array(list(attribute.indices), int)[corners]]


def in_image(uv, texture):
    """Return where texture coordinates (..., 2) lie in the image, from its upper left corner."""
    if texture.has_uv_transform:
        columns = np.array([tuple(column) for column in texture.uv_to_texture])
        uv = uv @ columns[:2, :2] + columns[3, :2]
    return upper_left(uv)
