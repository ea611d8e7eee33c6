"""What corners of the faces of a USD mesh have: normals and texture coordinates."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom, UsdSkel

SETS = ("st", "uv", "map")
"""Names of texture coordinates that are pairs of numbers by type begin so, in any case."""


def corner_arrays(prim, faces, corners, polygons):
    """Return the arrays of corners, and what of the mesh is not read.

    Shapes: faces, corners (m, 3), polygons (m,).
    """
    mesh, primvars = UsdGeom.Mesh(prim), UsdGeom.PrimvarsAPI(prim)
    triangles = corners, polygons, faces
    normals = at_corners(primvars, "normals", 3, *triangles)
    if normals is None:
        stored = np.array(mesh.GetNormalsAttr().Get(Usd.TimeCode.EarliestTime()) or [], float)
        normals = spread(stored, 3, mesh.GetNormalsInterpolation(), *triangles)
    if normals is None and mesh.GetSubdivisionSchemeAttr().Get() != UsdGeom.Tokens.none:
        normals = np.zeros((*faces.shape, 3))  # a smooth surface
    sets = texture_sets(primvars)
    places = at_corners(primvars, sets[0], 2, *triangles) if sets else None
    arrays = {"dropped": dropped(prim, primvars, sets)}
    if normals is not None:
        arrays["normals"] = normals.astype(np.float32)
    if places is not None:
        arrays["places"] = upper_left(places)
    return arrays


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
    targets = UsdSkel.BindingAPI(prim).GetBlendShapeTargetsRel()
    parts = {
        "blend shapes": bool(targets and targets.GetTargets()),
        "texture coordinates after the first set": len(sets) > 1,
        "tangents": bool(primvars.FindPrimvarWithInheritance("tangents")),
    }
    return np.array([part for part, exists in parts.items() if exists], np.str_)


def at_corners(primvars, name, width, corners, polygons, faces):
    """Return a primvar at corners, shape (m, 3, width); None where it has none that fits."""
    primvar = primvars.FindPrimvarWithInheritance(name) if name else None
    if not primvar:
        return None
    values = np.array(primvar.ComputeFlattened(Usd.TimeCode.EarliestTime()) or [], float)
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


def upper_left(uv):
    """Return texture coordinates from the upper left corner of an image, shape (..., 2)."""
    return np.stack([uv[..., 0], 1 - uv[..., 1]], axis=-1).astype(np.float32)
