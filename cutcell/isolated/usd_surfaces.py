"""Normals, texture coordinates, materials and displayColor of the faces of USD meshes.

The diffuse colour of a UsdPreviewSurface and its image are read.
"""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
from pxr import Usd, UsdGeom, UsdShade, UsdSkel

from ..runtime.colors import srgb
from .scene import upper_left

MAX_IMAGE_BYTES = 2**28
"""Bytes of an image in a package."""
SETS = ("st", "uv", "map")
"""Names of texture coordinates that are pairs of numbers by type begin so, in any case."""
TIME = Usd.TimeCode.EarliestTime()


def surface(prim, faces, corners, polygons, scene, file):
    """Return the arrays of triangles: faces, corners (m, 3), polygons (m,); and what is dropped."""
    primvars, triangles = UsdGeom.PrimvarsAPI(prim), (corners, polygons, faces)
    sets = texture_sets(primvars)
    binding = UsdShade.MaterialBindingAPI(prim)
    material = np.full(len(faces), number(binding, scene, file))
    for subset in binding.GetMaterialBindSubsets():
        members = np.array(subset.GetIndicesAttr().Get() or [], int)
        subset_material = number(UsdShade.MaterialBindingAPI(subset.GetPrim()), scene, file)
        material[np.isin(polygons, members)] = subset_material
    arrays = {"materials": material, "dropped": dropped(prim, primvars, sets)}
    normals = corner_normals(UsdGeom.Mesh(prim), primvars, triangles)
    if normals is not None:
        arrays["normals"] = normals.astype(np.float32)
    colors = at_corners(primvars, "displayColor", 3, *triangles)
    if colors is not None and (material < 0).all():
        arrays["colors"] = srgb(colors)
    uv = at_corners(primvars, sets[0], 2, *triangles) if sets else None
    places = np.zeros((*faces.shape, 2), np.float32) if uv is None else upper_left(uv)
    has_places = uv is not None
    for k in np.unique(material[material >= 0]).tolist():  # those of its image take their place
        rows = material == k
        uv = at_corners(primvars, scene.reader(k), 2, *(one[rows] for one in triangles))
        if uv is not None:
            places[rows], has_places = upper_left(uv), True
    return arrays | ({"places": places} if has_places else {})


def corner_normals(mesh, primvars, triangles):
    """Return normals of corners, shape (m, 3, 3); None for flat faces."""
    normals = at_corners(primvars, "normals", 3, *triangles)
    if normals is None:
        stored = np.array(mesh.GetNormalsAttr().Get(TIME) or [], float)
        normals = spread(stored, 3, mesh.GetNormalsInterpolation(), *triangles)
    if normals is None and mesh.GetSubdivisionSchemeAttr().Get() != UsdGeom.Tokens.none:
        normals = np.zeros((*triangles[2].shape, 3))  # a smooth surface
    return normals


def number(binding, scene, file):
    """Return the number of the bound material, -1 for none that can be shown."""
    material = binding.ComputeBoundMaterial()[0]
    if not material:
        return -1
    return scene.material(material.GetPath(), lambda: describe(material, scene, file))


def describe(material, scene, file):
    """Describe a material for `Scene.material`; its reader is a name of texture coordinates."""
    shader = material.ComputeSurfaceSource()[0]
    if not shader or shader.GetIdAttr().Get() != "UsdPreviewSurface":
        return None
    color, texture = source(shader, "diffuseColor", (0.18, 0.18, 0.18))
    opacity, cut = source(shader, "opacity", 1.0)
    image, reader = -1, ""
    if texture:
        image, reader = add_image(texture.GetInput("file"), scene, file), reader_of(texture)
    name, color = material.GetPrim().GetName(), srgb(tuple(color)) / 255
    return name, color, float(opacity), image, cut is not None, reader


def add_image(connected, scene, file):
    """Return the number of an image beside the file or in its package, -1 for none."""
    asset = connected.Get() if connected else None
    if not asset or not asset.path:
        return -1
    package, _, inside = asset.resolvedPath.rstrip("]").partition("[")
    content, names = b"", (asset.path, "", "")
    if inside and Path(package).resolve() == file:
        content = packed(file, inside)
    elif Path(asset.resolvedPath).is_relative_to(file.parent):
        relative = Path(asset.resolvedPath).relative_to(file.parent)
        names = (relative.as_posix(), asset.path, "")
    return scene.add_image(names, content)


def packed(file, name):
    """Return a file of a package; nothing if it is not there, or too large."""
    try:
        with zipfile.ZipFile(file) as package:
            return package.read(name) if package.getinfo(name).file_size <= MAX_IMAGE_BYTES else b""
    except (KeyError, OSError, ValueError, RuntimeError, zipfile.BadZipFile):
        return b""


def source(shader, name, default):
    """Return the value of a shader's input, and the texture that it comes from, if it does."""
    connected = shader.GetInput(name)
    attributes = UsdShade.Utils.GetValueProducingAttributes(connected) if connected else []
    if not attributes:
        return default, None
    producer = UsdShade.Shader(attributes[0].GetPrim())
    if producer and producer.GetIdAttr().Get() == "UsdUVTexture":
        return default if name == "opacity" else (1.0, 1.0, 1.0), producer
    value = attributes[0].Get(TIME)
    return default if value is None else value, None


def reader_of(texture):
    """Return the name of the texture coordinates of a texture."""
    connected = texture.GetInput("st")
    for _ in range(4):  # a transform may stand between
        attributes = UsdShade.Utils.GetValueProducingAttributes(connected) if connected else []
        if not attributes:
            break
        shader = UsdShade.Shader(attributes[0].GetPrim())
        name = shader.GetInput("varname") if shader else None
        if name:
            return str(name.Get() or "st")
        connected = shader.GetInput("in") if shader else None
    return "st"


def texture_sets(primvars):
    """Return the names of the texture coordinates of a mesh, the first set first."""
    names = []
    for primvar in primvars.FindPrimvarsWithInheritance():
        name, kind = primvar.GetPrimvarName(), primvar.GetTypeName()
        pairs = kind.scalarType.type.typeName in ("GfVec2f", "GfVec2d", "GfVec2h")
        if pairs and (kind.role == "TextureCoordinate" or name.lower().startswith(SETS)):
            names.append(name)
    return sorted(names, key=lambda name: name != "st")


def dropped(prim, primvars, sets):
    """Return what of a mesh is not read."""
    skin = UsdSkel.BindingAPI(prim)
    targets = skin.GetBlendShapeTargetsRel()
    parts = {
        "morph targets": bool(targets and targets.GetTargets()),
        "dual-quaternion skinning": skin.GetSkinningMethodAttr().Get() == "dualQuaternion",
        "texture coordinates after the first set": len(sets) > 1,
        "tangents": bool(primvars.FindPrimvarWithInheritance("tangents")),
    }
    return np.array([part for part, exists in parts.items() if exists], np.str_)


def at_corners(primvars, name, width, corners, polygons, faces):
    """Return a primvar at corners, shape (m, 3, width); None where it has none that fits."""
    primvar = primvars.FindPrimvarWithInheritance(name) if name else None
    if not primvar:
        return None
    values = np.array(primvar.ComputeFlattened(TIME) or [], float)
    return spread(values, width, primvar.GetInterpolation(), corners, polygons, faces)


def spread(values, width, how, corners, polygons, faces):
    """Return values at corners, shape (m, 3, width); None if they do not fit."""
    if values.ndim != 2 or values.shape[1] != width:
        return None
    at = {
        UsdGeom.Tokens.constant: np.zeros_like(faces),
        UsdGeom.Tokens.uniform: np.repeat(polygons[:, None], 3, axis=1),
        UsdGeom.Tokens.faceVarying: corners,
    }.get(how, faces)
    return values[at] if at.size and at.max() < len(values) else None
