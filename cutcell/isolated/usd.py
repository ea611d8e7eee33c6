"""USD with UsdSkel: read by usd-core, handed on as the arrays of a scene.

Matrices of USD multiply from the right.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from pxr import Gf, Tf, Usd, UsdGeom, UsdSkel

from ..geometry.polygons import cut_polygons
from ..runtime.display import listed
from .scene import Scene
from .usd_surfaces import TIME, surface

EVERYTHING = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)


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
        real = Path(layer.realPath or file).resolve()
        if real != file and file.parent not in real.parents:
            raise RuntimeError(f"it refers to a file outside of its folder ({real.name})")
    reader = Stage(stage, file)
    reader.add_skeletons()
    reader.add_meshes()
    note = f"meshes for the purposes proxy and guide are left out ({listed(reader.left_out)})"
    return reader.scene.arrays() | {"notes": np.array([note] if reader.left_out else [], np.str_)}


def matrix(value):
    """Return a Gf matrix as an array that multiplies from the left."""
    return np.array(value, float).reshape(4, 4).T


def parts(value):
    """Return a Gf matrix as translation, rotation (x, y, z, w) and scale, shape (10,)."""
    transform = Gf.Transform(Gf.Matrix4d(value))
    turn = transform.GetRotation().GetQuat()
    rotation = [*turn.GetImaginary(), turn.GetReal()]
    return [*transform.GetTranslation(), *rotation, *transform.GetScale()]


class Stage:
    """Reads a stage at rest, and its joints' motion, into a scene."""

    def __init__(self, stage, file):
        self.stage, self.file, self.scene = stage, file, Scene()
        scale = UsdGeom.GetStageMetersPerUnit(stage)
        turn = [0, 0, 0, 1.0]
        if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z:
            turn = [-np.sqrt(0.5), 0, 0, np.sqrt(0.5)]
        self.scene.add_node("", -1, [0, 0, 0, *turn, *[scale] * 3], False, False)
        self.bound, self.stands, self.left_out = {}, None, []
        self.cache = UsdSkel.Cache()
        self.places = UsdGeom.XformCache(TIME)
        self.prims = list(stage.Traverse(EVERYTHING))
        stage.SetEditTarget(stage.GetSessionLayer())
        for prim in self.prims:  # files of 2019 lack the schema that USD now requires of bindings
            if not prim.IsInstanceProxy() and any("skel:" in n for n in prim.GetPropertyNames()):
                UsdSkel.BindingAPI.Apply(prim)

    def add_skeletons(self):
        """Make nodes of all joints, and remember which meshes follow them."""
        bindings = []
        for prim in self.prims:
            if prim.IsA(UsdSkel.Root):
                root = UsdSkel.Root(prim)
                self.cache.Populate(root, EVERYTHING)
                bindings += self.cache.ComputeSkelBindings(root, EVERYTHING)
        for binding in bindings:
            query = self.cache.GetSkelQuery(binding.GetSkeleton())
            first = self.add_joints(query)
            for target in binding.GetSkinningTargets():
                self.bound[target.GetPrim().GetPath()] = (target, query, first)
        for prim in self.prims if not bindings else ():  # no mesh follows a skeleton
            skeleton = UsdSkel.Skeleton(prim)
            if skeleton and (query := self.cache.GetSkelQuery(skeleton)):
                self.add_joints(query)

    def add_joints(self, query):
        """Add a skeleton's joints; return the number of the first node."""
        skeleton = query.GetPrim()
        stands = self.stands = self.places.GetLocalToWorldTransform(skeleton)
        first = self.scene.add_node(skeleton.GetName(), 0, parts(stands), False, False) + 1
        order, topology = query.GetJointOrder(), query.GetTopology()
        rest = query.GetSkeleton().GetRestTransformsAttr().Get()
        if rest is None or len(rest) != len(order):
            rest = query.ComputeJointLocalTransforms(TIME)
        for k, (joint, local) in enumerate(zip(order, rest, strict=True)):
            above = topology.GetParent(k)
            parent = first + above if above >= 0 else first - 1
            self.scene.add_node(joint.rsplit("/", 1)[-1], parent, parts(local), False, True)
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
                    self.scene.add_track(at[joint], path, seconds, values[:, k])
        self.scene.end_clip(motion.GetPrim().GetName())

    def add_meshes(self):
        """Add all meshes, each on a node of its own."""
        for prim in self.prims:
            mesh = UsdGeom.Mesh(prim)
            points = mesh.GetPointsAttr().Get(TIME) if prim.IsA(UsdGeom.Mesh) else None
            if not points:
                continue
            if mesh.ComputePurpose() in (UsdGeom.Tokens.proxy, UsdGeom.Tokens.guide):
                self.left_out.append(prim.GetName())
                continue
            hidden = mesh.ComputeVisibility(TIME) == UsdGeom.Tokens.invisible
            at = [0, 0, 0, 0, 0, 0, 1, 1, 1, 1]
            node = self.scene.add_node(prim.GetName(), 0, at, hidden, False)
            place = matrix(self.places.GetLocalToWorldTransform(prim))
            vertices = np.array(points, float)
            faces, corners, polygons = cut(mesh, vertices)
            arrays = {"vertices": vertices, "faces": faces}
            arrays |= surface(prim, faces, corners, polygons, self.scene, self.file)
            if prim.GetPath() in self.bound:
                target, query, first = self.bound[prim.GetPath()]
                # Joints were bound in their skeleton's own space, and the mesh goes there.
                stands = self.places.GetLocalToWorldTransform(query.GetPrim())
                place = matrix(stands) @ matrix(target.GetGeomBindTransform())
                arrays |= influences(target, query, first, len(points))
            elif not self.bound and self.stands is not None:
                bind = UsdSkel.BindingAPI(prim).GetGeomBindTransformAttr().Get()
                place = place if bind is None else matrix(self.stands) @ matrix(bind)
            self.scene.add_mesh(prim.GetName(), node, arrays | {"place": place})


def cut(mesh, points):
    """Cut polygons into triangles: faces, corners (m, 3), polygons (m,), counter-clockwise."""
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
    mesh_joints = target.GetJointOrder() or order
    binds = query.GetJointWorldBindTransforms()
    place = matrix(target.GetGeomBindTransform())
    at = {joint: k for k, joint in enumerate(order)}
    joints = [at[joint] for joint in mesh_joints if joint in at]
    stored = target.ComputeVaryingJointInfluences(count)
    if stored is None or len(joints) != len(mesh_joints) or len(binds) != len(order):
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
