"""FBX, binary and text, 6.1 to 7.7: read by ufbx, handed on as the arrays of a scene.

ufbx' bindings let go of list elements too often: each list is walked once and kept (`kept`), and
the process must end without cleaning up.
"""

from __future__ import annotations

import numpy as np
import ufbx

from ..geometry.polygons import cut_polygons
from .fbx_materials import at_corners, kept, surface
from .scene import Scene

FRAMES_A_SECOND = 30.0


def read(data):
    """Read a file; shape data (b,)."""
    try:
        file = ufbx.load_memory(data.tobytes(), **options())
    except ufbx.UfbxError as error:
        raise RuntimeError(f"it is damaged ({error})") from None
    kept([file])
    scene, nodes = Scene(), kept(file.nodes)
    place = {node.element_id: i for i, node in enumerate(nodes)}
    for node in nodes:
        parent = place[p.element_id] if (p := node.parent) else -1
        is_bone = node.attrib_type == ufbx.ElementType.BONE
        scene.add_node(
            node.name, parent, transform(node.local_transform), not node.visible, is_bone
        )
    blended: list[str] = []
    notes: list[str] = []
    for mesh in kept(file.meshes):
        places = kept(mesh.instances)
        if not mesh.num_faces or not places:
            continue
        shape, corners, polygons = geometry(mesh)
        skins = kept(mesh.skin_deformers)
        name = places[0].name or mesh.name
        if skins and len(places) > 1:
            others = ", ".join(node.name for node in places[1:][:6])
            notes.append(
                f'the skinned mesh "{name}" is read once, as "{name}"; its other instances '
                f"({others}) are left out. Duplicate the mesh data of those to read them"
            )
        if len(kept(mesh.blend_deformers)):
            blended.append(name)
        skin = influences(skins, place) if skins else {}
        # A skin holds for one place of a mesh; other meshes may stand anywhere.
        for node in places[:1] if skins else places:
            colours = surface(mesh, node, corners, polygons, scene)
            arrays = shape | colours | {"place": matrix(node.geometry_to_node)} | skin
            scene.add_mesh(node.name or mesh.name, place[node.element_id], arrays)
    add_clips(scene, file, place)
    told = {"blended": np.array(blended, np.str_), "notes": np.array(notes, np.str_)}
    return scene.arrays() | told


def options():
    """Return how to read: in the file's units, with the root leading to metres, y up."""
    axis = ufbx.CoordinateAxis
    return {
        "target_axes": ufbx.CoordinateAxes(axis.POSITIVE_X, axis.POSITIVE_Y, axis.POSITIVE_Z),
        "target_unit_meters": 1.0,
        "space_conversion": ufbx.SpaceConversion.TRANSFORM_ROOT,
        "geometry_transform_handling": ufbx.GeometryTransformHandling.PRESERVE,
        "inherit_mode_handling": ufbx.InheritModeHandling.HELPER_NODES,
        "index_error_handling": ufbx.IndexErrorHandling.ABORT_LOADING,
        "generate_missing_normals": True,
    }


def matrix(columns):
    """Return a 3 x 4 matrix of ufbx as an array, shape (4, 4)."""
    full = np.eye(4)
    full[:3] = np.array([tuple(column) for column in columns]).T
    return full


def transform(one):
    """Return translation, rotation (x, y, z, w) and scale in a row, shape (10,)."""
    return [*one.translation, *one.rotation, *one.scale]


def geometry(mesh):
    """Return a mesh's arrays, the corners of its triangles by its own numbers, and the polygons."""
    vertices = np.array(list(mesh.vertex_indices), int)
    points = np.array([tuple(point) for point in mesh.vertices], float).reshape(-1, 3)
    counts = np.array([face.num_indices for face in mesh.faces], int)
    corners, polygons = cut_polygons(points, vertices, counts)
    arrays = {"vertices": points, "faces": vertices[corners], "dropped": dropped(mesh)}
    if mesh.vertex_normal.exists and (not mesh.generated_normals or is_smoothed(mesh)):
        arrays["normals"] = at_corners(mesh.vertex_normal, corners).astype(np.float32)
    return arrays, corners, polygons


def is_smoothed(mesh):
    """Return whether a file says which edges of a mesh are smooth."""
    return bool(len(mesh.face_smoothing) or len(mesh.edge_smoothing))


def dropped(mesh):
    """Return what of a mesh is not read."""
    parts = {
        "morph targets": len(mesh.blend_deformers),
        "texture coordinates after the first set": len(mesh.uv_sets) > 1,
        "vertex colours after the first set": len(mesh.color_sets) > 1,
        "tangents": mesh.vertex_tangent.exists,
    }
    return np.array([part for part, exists in parts.items() if exists], np.str_)


def influences(skins, place):
    """Return the joints of a mesh, their inverse bind matrices, and the weights."""
    clusters = [c for skin in skins for c in kept(skin.clusters)]
    bones = kept(c.bone_node for c in clusters)
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
    for stack in kept(file.anim_stacks):
        baked = ufbx.bake_anim(
            file,
            stack.anim,
            trim_start_time=True,
            resample_rate=FRAMES_A_SECOND,
            maximum_sample_rate=FRAMES_A_SECOND,
            key_reduction_enabled=True,
            key_reduction_rotation=True,
        )
        kept([baked])
        for node in kept(baked.nodes):
            moves = (node.translation_keys, node.rotation_keys, node.scale_keys)
            for path, moved in enumerate(moves):
                rows = np.array([(key.time, *key.value) for key in moved])
                if len(rows) and node.element_id in place:
                    scene.add_track(place[node.element_id], path, rows[:, 0], rows[:, 1:])
        scene.end_clip(stack.name)
