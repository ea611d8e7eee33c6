"""FBX, binary and text, 6.1 to 7.7: read by ufbx, handed on as the arrays of a scene.

The process must end without cleaning up, since ufbx' bindings let go of elements too often.
"""

from __future__ import annotations

import numpy as np
import ufbx

from ..geometry.polygons import cut_polygons
from .fbx_names import label, read_names, retain
from .scene import Scene, upper_left

SAMPLED_RATE = 30.0
DUAL = ufbx.SkinningMethod.DUAL_QUATERNION, ufbx.SkinningMethod.BLENDED_DQ_LINEAR


def read(data):
    """Read a file; shape data (b,)."""
    try:
        file = ufbx.load_memory(data.tobytes(), **options())
        warnings = [one.type for one in retain(retain([file])[0].metadata.warnings)]
        is_utf8 = ufbx.WarningType.BAD_UNICODE not in warnings
        if not is_utf8:
            file = ufbx.load_memory(data.tobytes(), **options(), retain_dom=True)
    except ufbx.UfbxError as error:
        raise RuntimeError(f"it is damaged ({error})") from None
    retain([file])
    scene, nodes = Scene(), retain(file.nodes)
    named = [*nodes, *retain(file.meshes), *retain(file.anim_stacks), *retain(file.materials)]
    notes = read_names([] if is_utf8 else named)
    place = {node.element_id: i for i, node in enumerate(nodes)}
    for node in nodes:
        parent = place[p.element_id] if (p := node.parent) else -1
        is_bone = node.attrib_type == ufbx.ElementType.BONE
        local = node.local_transform
        row = [*local.translation, *local.rotation, *local.scale]
        scene.add_node(label(node), parent, row, not node.visible, is_bone)
    for mesh in retain(file.meshes):
        places = retain(mesh.instances)
        if not mesh.num_faces or not places:
            continue
        shape, corners, polygons = geometry(mesh)
        skins = retain(mesh.skin_deformers)
        name = label(places[0]) or label(mesh)
        if skins and len(places) > 1:
            others = ", ".join(label(node) for node in places[1:][:6])
            notes.append(
                f'the skinned mesh "{name}" is read once, as "{name}"; its other instances '
                f"({others}) are left out. Duplicate the mesh data of those to read them"
            )
        skin = influences(skins, place) if skins else {}
        # A skin holds for one place of a mesh; other meshes may stand anywhere.
        for node in places[:1] if skins else places:
            colours = surface(mesh, node, corners, polygons, scene)
            arrays = shape | colours | {"place": matrix(node.geometry_to_node)} | skin
            scene.add_mesh(label(node) or label(mesh), place[node.element_id], arrays)
    add_clips(scene, file, place)
    return scene.arrays() | {"notes": np.array(notes, np.str_)}


def options():
    """Return how to read: in the file's units, with the root leading to metres, y up."""
    axis = ufbx.CoordinateAxis
    return {
        "target_axes": ufbx.CoordinateAxes(axis.POSITIVE_X, axis.POSITIVE_Y, axis.POSITIVE_Z),
        "target_unit_meters": 1.0,
        "space_conversion": ufbx.SpaceConversion.TRANSFORM_ROOT,
        "geometry_transform_handling": ufbx.GeometryTransformHandling.PRESERVE,
        "inherit_mode_handling": ufbx.InheritModeHandling.HELPER_NODES,
        "index_error_handling": ufbx.IndexErrorHandling.NO_INDEX,  # -1 stands for no value
        "generate_missing_normals": True,
    }


def matrix(columns):
    """Return a 3 x 4 matrix of ufbx as an array, shape (4, 4)."""
    full = np.eye(4)
    full[:3] = np.array([tuple(column) for column in columns]).T
    return full


def geometry(mesh):
    """Return a mesh's arrays, the corners of its triangles by its own numbers, and the polygons."""
    vertices = np.array(list(mesh.vertex_indices), int)
    points = np.array([tuple(point) for point in mesh.vertices], float).reshape(-1, 3)
    if vertices.max(initial=-1) >= len(points):
        raise RuntimeError(f'it is damaged (mesh "{label(mesh)}": a face uses a missing vertex)')
    counts = np.array([face.num_indices for face in mesh.faces], int)
    corners, polygons = cut_polygons(points, vertices, counts)
    arrays = {"vertices": points, "faces": vertices[corners], "dropped": dropped(mesh)}
    is_smoothed = len(mesh.face_smoothing) or len(mesh.edge_smoothing)
    if mesh.vertex_normal.exists and (not mesh.generated_normals or is_smoothed):
        arrays["normals"] = at_corners(mesh.vertex_normal, corners, (0, 0, 0)).astype(np.float32)
    return arrays, corners, polygons


def dropped(mesh):
    """Return what of a mesh is not read."""
    skinned = [skin.skinning_method for skin in retain(mesh.skin_deformers)]
    parts = {
        "morph targets": len(mesh.blend_deformers),
        "dual-quaternion skinning": any(method in DUAL for method in skinned),
        "texture coordinates after the first set": len(mesh.uv_sets) > 1,
        "vertex colours after the first set": len(mesh.color_sets) > 1,
        "tangents": mesh.vertex_tangent.exists,
    }
    return np.array([part for part, exists in parts.items() if exists], np.str_)


def influences(skins, place):
    """Return the joints of a mesh, their inverse bind matrices, and the weights."""
    clusters = [c for skin in skins for c in retain(skin.clusters)]
    bones = retain(c.bone_node for c in clusters)
    joints = list(dict.fromkeys(place[b.element_id] for b in bones if b is not None))
    inverse = [np.eye(4)] * len(joints)
    rows, columns, values = [], [], []
    for cluster, bone in zip(clusters, bones, strict=True):
        if bone is None:
            continue
        column = joints.index(place[bone.element_id])
        inverse[column] = matrix(cluster.geometry_to_bone)
        rows.append(np.array(list(cluster.vertices), int))
        values.append(np.array(list(cluster.weights), float))
        columns.append(np.full(len(rows[-1]), column))
    return {
        "joints": np.array(joints, int),
        "inverse": np.array(inverse).reshape(-1, 4, 4),
        "rows": np.concatenate([*rows, np.zeros(0, int)]),
        "columns": np.concatenate([*columns, np.zeros(0, int)]),
        "values": np.concatenate([*values, np.zeros(0)]),
    }


def add_clips(scene, file, place):
    """Add every animation as keys of its nodes, from time 0 on, to be joined by lines."""
    for stack in retain(file.anim_stacks):
        baked = ufbx.bake_anim(
            file,
            stack.anim,
            trim_start_time=True,
            resample_rate=SAMPLED_RATE,
            maximum_sample_rate=SAMPLED_RATE,
            key_reduction_enabled=True,
            key_reduction_rotation=True,
        )
        retain([baked])
        for node in retain(baked.nodes):
            moves = (node.translation_keys, node.rotation_keys, node.scale_keys)
            for path, moved in enumerate(moves):
                rows = np.array([(key.time, *key.value) for key in moved])
                if len(rows) and node.element_id in place:
                    scene.add_track(place[node.element_id], path, rows[:, 0], rows[:, 1:])
        scene.end_clip(label(stack))


MAX_IMAGE_NAME = 1000
"""Characters of an image's name that are handed on."""
UNSET_OPACITY = 0.02
"""Opacity treated as unset: many programs write 0 and mean 1."""


def describe(scene, material):
    """Describe a material for `Scene.material`; its reader is the texture."""
    retain([material])
    texture, image = base_texture(material), -1
    if texture is not None:
        names = (texture.relative_filename, texture.filename, texture.absolute_filename)
        image = scene.add_image(tuple(name[:MAX_IMAGE_NAME] for name in names), texture.content)
    color, cut = base_color(material), is_cut(material)
    return label(material), color, opacity(material), image, cut, texture


def base_texture(material):
    """Return the texture of the base colour that has a file; None if there is none."""
    for channel in (material.pbr.base_color, material.fbx.diffuse_color):
        texture = channel.texture
        if texture is None or not channel.texture_enabled:
            continue
        retain([texture])
        for one in [texture, *retain(texture.file_textures)]:
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
    return float(value) if UNSET_OPACITY < value < 1 else 1.0


def is_cut(material):
    """Return whether an image says where a material is not."""
    maps = (material.pbr.opacity, material.fbx.transparency_color, material.fbx.transparency_factor)
    return any(one.texture is not None and one.texture_enabled for one in maps)


def surface(mesh, node, corners, polygons, scene):
    """Return what colours the triangles of a mesh at a node; corners (m, 3), polygons (m,)."""
    materials = retain(node.materials) or retain(mesh.materials)
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
        colors = at_corners(mesh.vertex_color, corners, (1, 1, 1, 1))[..., :3]
        arrays["colors"] = np.round(255 * np.clip(np.nan_to_num(colors), 0, 1)).astype(np.uint8)
    if mesh.vertex_uv.exists:
        sets = {one.name: one.vertex_uv for one in retain(mesh.uv_sets)}
        places = upper_left(at_corners(mesh.vertex_uv, corners, (0, 0)))
        for k in np.unique(material[material >= 0]).tolist():
            texture, rows = scene.reader(k), np.flatnonzero(material == k)
            if texture is not None:
                uv = at_corners(sets.get(texture.uv_set) or mesh.vertex_uv, corners[rows], (0, 0))
                places[rows] = in_image(uv, texture)
        arrays["places"] = places
    return arrays


def at_corners(attribute, corners, missing):
    """Return the values of an attribute at corners (m, 3), shape (m, 3, width)."""
    values = np.array([*(tuple(value) for value in attribute.values), missing], float)
    return values[np.minimum(np.array(list(attribute.indices), int)[corners], len(values) - 1)]


def in_image(uv, texture):
    """Return where texture coordinates (..., 2) lie in the image, from its upper left corner."""
    if texture.has_uv_transform:
        columns = np.array([tuple(column) for column in texture.uv_to_texture])
        uv = uv @ columns[:2, :2] + columns[3, :2]
    return upper_left(uv)
