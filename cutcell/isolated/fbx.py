"""FBX, binary and text, 6.1 to 7.7: read by ufbx, handed on as the arrays of a scene.

`cutcell.io.scenes.document` says what the arrays are. ufbx' bindings let go of list elements too
often: each list is walked once and kept (`fbx_kept`), and the process must end without cleaning up.
"""

from __future__ import annotations

import numpy as np
import ufbx

from ..geometry.polygons import cut_polygons
from .fbx_kept import keep, kept
from .fbx_materials import FbxPalette, stored, surface

FRAMES_A_SECOND = 30.0


def read(data):
    """Read a file.

    Shapes: data (b,).
    """
    try:
        scene = ufbx.load_memory(data.tobytes(), **options())
    except ufbx.UfbxError as error:
        raise RuntimeError(f"it is damaged ({error})") from None
    keep(scene)
    nodes = kept(scene.nodes)
    place = {node.element_id: i for i, node in enumerate(nodes)}
    parents = [place[p.element_id] if (p := node.parent) else -1 for node in nodes]
    arrays = {
        "node_names": np.array([node.name for node in nodes], np.str_),
        "node_parents": np.array(parents),
        "node_transforms": np.array([transform(node.local_transform) for node in nodes]),
        "node_hidden": np.array([not node.visible for node in nodes]),
        "node_bones": np.array([node.attrib_type == ufbx.ElementType.BONE for node in nodes]),
    }
    names: list[str] = []
    at: list[int] = []
    blended: list[str] = []
    notes: list[str] = []
    palette = FbxPalette()
    for mesh in kept(scene.meshes):
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
        # A skin holds for one place of a mesh; other meshes may stand anywhere.
        for node in places[:1] if skins else places:
            k = len(names)
            names.append(node.name or mesh.name)
            at.append(place[node.element_id])
            arrays |= {f"mesh_{k}_{key}": value for key, value in shape.items()}
            colours = surface(mesh, node, corners, polygons, palette)
            arrays |= {f"mesh_{k}_{key}": value for key, value in colours.items()}
            arrays[f"mesh_{k}_place"] = matrix(node.geometry_to_node)
            if skins:
                skin = influences(skins, place)
                arrays |= {f"mesh_{k}_{key}": value for key, value in skin.items()}
    arrays |= {"mesh_names": np.array(names, np.str_), "mesh_nodes": np.array(at, int)}
    arrays |= {"blended": np.array(blended, np.str_), "notes": np.array(notes, np.str_)}
    return arrays | palette.arrays() | clips(scene, place)


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
        values, indices = stored(mesh.vertex_normal)
        arrays["normals"] = values[indices[corners]].astype(np.float32)
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


def clips(scene, place):
    """Return every animation as keys of its nodes, from time 0 on, to be joined by lines."""
    names: list[str] = []
    tracks: list[tuple[int, ...]] = []
    keys = [np.zeros((0, 5))]
    for stack in kept(scene.anim_stacks):
        baked = ufbx.bake_anim(
            scene,
            stack.anim,
            trim_start_time=True,
            resample_rate=FRAMES_A_SECOND,
            maximum_sample_rate=FRAMES_A_SECOND,
            key_reduction_enabled=True,
            key_reduction_rotation=True,
        )
        keep(baked)
        before = len(tracks)
        for node in kept(baked.nodes):
            moves = (node.translation_keys, node.rotation_keys, node.scale_keys)
            for path, moved in enumerate(moves):
                rows = [(key.time, *key.value) for key in moved]
                if rows and node.element_id in place:
                    values = np.zeros((len(rows), 5))
                    values[:, : len(rows[0])] = rows
                    keys.append(values)
                    tracks.append((len(names), place[node.element_id], path, len(rows)))
        if len(tracks) > before:
            names.append(stack.name)
    return {
        "clip_names": np.array(names, np.str_),
        "tracks": np.array(tracks, int).reshape(-1, 4),
        "keys": np.concatenate(keys),
    }
