"""USD with UsdSkel: read by usd-core, handed on as the arrays of a scene.

`cutcell.io.scenes.document` says what the arrays are. Matrices of USD multiply from the right.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from pxr import Gf, Tf, Usd, UsdGeom, UsdSkel

from ..geometry.polygons import cut_polygons
from .usd_corners import corner_arrays
from .usd_materials import UsdPalette, surface


def read(path):
    """Read a file, and what it refers to in its own folder."""
    file = Path(str(path)).resolve()
    try:
        return read_stage(file)
    except Tf.ErrorException as error:
        reasons = [e.commentary for e in error.args] or [str(error)]
        reason = " ".join(reasons[0].replace(f"{file.parent}/", "").split())
        raise RuntimeError(f"it is damaged ({reason[:200]})") from None
    except (TypeError, AttributeError, IndexError, KeyError, np.linalg.LinAlgError) as error:
        raise RuntimeError(f"it is damaged ({error})") from None


def read_stage(file):
    """Read an opened file's meshes, skeletons and motion."""
    stage = Usd.Stage.Open(str(file))
    for layer in stage.GetUsedLayers():
        real = Path(layer.realPath or file)
        if real != file and file.parent not in real.parents:
            raise RuntimeError(f"it refers to a file outside of its folder ({real.name})")
    scene = Scene(stage, file)
    scene.add_skeletons()
    scene.add_meshes()
    return scene.arrays()


def matrix(value):
    """Return a Gf matrix as an array that multiplies from the left."""
    return np.array(value, float).reshape(4, 4).T


def parts(value):
    """Return a Gf matrix as translation, rotation (x, y, z, w) and scale, shape (10,)."""
    transform = Gf.Transform(Gf.Matrix4d(value))
    turn = transform.GetRotation().GetQuat()
    return [*transform.GetTranslation(), *turn.GetImaginary(), turn.GetReal(),
            *transform.GetScale()]  # fmt: skip


class Scene:
    """The arrays of a stage at rest, and its joints' motion."""

    def __init__(self, stage, file):
        self.stage, self.palette = stage, UsdPalette(file)
        scale = UsdGeom.GetStageMetersPerUnit(stage)
        turn = [0, 0, 0, 1.0]
        if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z:
            turn = [-np.sqrt(0.5), 0, 0, np.sqrt(0.5)]
        self.nodes = [("", -1, [0, 0, 0, *turn, *[scale] * 3], False, False)]
        self.meshes, self.mesh_arrays = [], {}
        self.bound = {}
        self.clips, self.tracks, self.keys = [], [], [np.zeros((0, 5))]
        self.cache = UsdSkel.Cache()
        self.places = UsdGeom.XformCache(Usd.TimeCode.EarliestTime())

    def add_skeletons(self):
        """Make nodes of all joints, and remember which meshes follow them."""
        everything = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
        for prim in self.stage.Traverse(everything):
            if not prim.IsA(UsdSkel.Root):
                continue
            root = UsdSkel.Root(prim)
            self.cache.Populate(root, everything)
            for binding in self.cache.ComputeSkelBindings(root, everything):
                query = self.cache.GetSkelQuery(binding.GetSkeleton())
                first = self.add_joints(query)
                for target in binding.GetSkinningTargets():
                    self.bound[target.GetPrim().GetPath()] = (target, query, first)
        if len(self.nodes) == 1:  # no mesh follows a skeleton
            for prim in self.stage.Traverse(everything):
                query = prim.IsA(UsdSkel.Skeleton) and self.cache.GetSkelQuery(
                    UsdSkel.Skeleton(prim)
                )
                if query:
                    self.add_joints(query)

    def add_joints(self, query):
        """Add a skeleton's joints; return the number of the first node."""
        skeleton = query.GetPrim()
        stands = self.places.GetLocalToWorldTransform(skeleton)
        self.nodes.append((skeleton.GetName(), 0, parts(stands), False, False))
        first = len(self.nodes)
        order, topology = query.GetJointOrder(), query.GetTopology()
        rest = query.GetSkeleton().GetRestTransformsAttr().Get()
        if rest is None or len(rest) != len(order):
            rest = query.ComputeJointLocalTransforms(Usd.TimeCode.EarliestTime())
        for k, (joint, local) in enumerate(zip(order, rest, strict=True)):
            above = topology.GetParent(k)
            parent = first + above if above >= 0 else first - 1
            self.nodes.append((joint.rsplit("/", 1)[-1], parent, parts(local), False, True))
        self.add_motion(query, first)
        return first

    def add_motion(self, query, first):
        """Add a skeleton's animation as keys of its joints."""
        motion = query.GetAnimQuery()
        times = motion.GetJointTransformTimeSamples() if motion else []
        if len(times) < 2:
            return
        rate = self.stage.GetTimeCodesPerSecond() or 24.0
        seconds = (np.array(times) - times[0]) / rate
        poses = [motion.ComputeJointLocalTransformComponents(time) for time in times]
        at = {joint: first + k for k, joint in enumerate(query.GetJointOrder())}
        for path, moved in enumerate(zip(*poses, strict=True)):
            values = np.array([np.array(one, float) for one in moved])
            for k, joint in enumerate(motion.GetJointOrder()):
                if joint in at:
                    self.keys.append(np.zeros((len(times), 5)))
                    self.keys[-1][:, 0] = seconds
                    self.keys[-1][:, 1 : 1 + values.shape[2]] = values[:, k]
                    self.tracks.append((len(self.clips), at[joint], path, len(times)))
        self.clips.append(motion.GetPrim().GetName())

    def add_meshes(self):
        """Add all meshes, each on a node of its own."""
        for prim in self.stage.Traverse(Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)):
            points = (
                UsdGeom.Mesh(prim).GetPointsAttr().Get(Usd.TimeCode.EarliestTime())
                if prim.IsA(UsdGeom.Mesh)
                else None
            )
            if not points:
                continue
            k = len(self.meshes)
            hidden = (
                UsdGeom.Imageable(prim).ComputeVisibility(Usd.TimeCode.EarliestTime())
                == UsdGeom.Tokens.invisible
            )
            self.meshes.append((prim.GetName(), len(self.nodes)))
            self.nodes.append((prim.GetName(), 0, [0, 0, 0, 0, 0, 0, 1, 1, 1, 1], hidden, False))
            place = matrix(self.places.GetLocalToWorldTransform(prim))
            vertices = np.array(points, float)
            triangles = faces, corners, polygons = cut(UsdGeom.Mesh(prim), vertices)
            arrays = {"vertices": vertices, "faces": faces}
            arrays |= corner_arrays(prim, *triangles)
            arrays |= surface(prim, corners, polygons, faces, self.palette, arrays.get("places"))
            if prim.GetPath() in self.bound:
                target, query, first = self.bound[prim.GetPath()]
                # Joints were bound in their skeleton's own space, and the mesh goes there.
                stands = self.places.GetLocalToWorldTransform(query.GetPrim())
                place = matrix(stands) @ matrix(target.GetGeomBindTransform())
                arrays |= influences(target, query, first, len(points))
            arrays["place"] = place
            self.mesh_arrays |= {f"mesh_{k}_{key}": value for key, value in arrays.items()}

    def arrays(self):
        """Return the arrays of the scene."""
        names, parents, transforms, hidden, bones = zip(*self.nodes, strict=True)
        return (
            self.mesh_arrays
            | self.palette.arrays()
            | {
                "node_names": np.array(names, np.str_),
                "node_parents": np.array(parents),
                "node_transforms": np.array(transforms, float),
                "node_hidden": np.array(hidden),
                "node_bones": np.array(bones),
                "mesh_names": np.array([name for name, _ in self.meshes], np.str_),
                "mesh_nodes": np.array([node for _, node in self.meshes], int),
                "clip_names": np.array(self.clips, np.str_),
                "tracks": np.array(self.tracks, int).reshape(-1, 4),
                "keys": np.concatenate(self.keys),
            }
        )


def cut(mesh, points):
    """Cut a mesh's polygons into triangles, counter-clockwise.

    Returns shapes faces, corners (m, 3), polygons (m,).
    """
    count = np.array(mesh.GetFaceVertexCountsAttr().Get() or [], int)
    vertices = np.array(mesh.GetFaceVertexIndicesAttr().Get() or [], int)
    name = mesh.GetPrim().GetName()
    if len(count) and (count.min() < 0 or count.sum() > len(vertices)):
        raise RuntimeError(f"mesh {name} lacks corners of its faces")
    if len(vertices) and (vertices.min() < 0 or vertices.max() >= len(points)):
        raise RuntimeError(f'mesh "{name}": a face uses a vertex out of its {len(points)}')
    corners, polygons = cut_polygons(points, vertices, count)
    if mesh.GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded:
        corners = corners[:, ::-1]
    return vertices[corners], corners, polygons


def unbound(bind):
    """Return the inverse of a bind matrix; zeros, which the reader replaces, if it has none."""
    try:
        return np.linalg.inv(bind)
    except np.linalg.LinAlgError:
        return np.zeros((4, 4))


def influences(target, query, first, count):
    """Return what a mesh follows."""
    order = query.GetJointOrder()
    own = target.GetJointOrder() or order
    binds = query.GetJointWorldBindTransforms()
    place = matrix(target.GetGeomBindTransform())
    at = {joint: k for k, joint in enumerate(order)}
    joints = [at[joint] for joint in own if joint in at]
    stored = target.ComputeVaryingJointInfluences(count)
    if stored is None or len(joints) != len(own) or len(binds) != len(order):
        raise RuntimeError(f"{target.GetPrim().GetName()} is bound to joints that are not there")
    numbers, weights = (np.array(values).reshape(count, -1) for values in stored)
    if numbers.size and (numbers.min() < 0 or numbers.max() >= len(joints)):
        raise RuntimeError(f"{target.GetPrim().GetName()} is weighted to joints out of range")
    inverse = [unbound(matrix(binds[k])) @ place for k in joints]
    is_weighted = weights != 0
    return {
        "joints": np.array([first + k for k in joints]),
        "inverse": np.array(inverse),
        "rows": np.nonzero(is_weighted)[0],
        "columns": numbers[is_weighted].astype(int),
        "values": weights[is_weighted].astype(float),
    }
