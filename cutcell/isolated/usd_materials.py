"""What colours the meshes of a USD: UsdPreviewSurface's diffuse colour and its image, displayColor.

`cutcell.io.materials.surfaces` says what the arrays are.
"""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
from pxr import Usd, UsdGeom, UsdShade

from ..runtime.colors import srgb
from .palette import Palette
from .usd_corners import at_corners, upper_left

LARGEST = 2**28
"""Bytes of an image in a package."""


class UsdPalette(Palette):
    """The materials of a stage, by their paths."""

    def __init__(self, file):
        super().__init__()
        self.file = file
        self.readers: list[str] = []
        self._numbers: dict = {}

    def number(self, material):
        """Return the number of a material, -1 for none that can be shown."""
        path = material.GetPath() if material else None
        if path is None or path in self._numbers:
            return self._numbers.get(path, -1)
        shader = material.ComputeSurfaceSource()[0]
        if not shader or shader.GetIdAttr().Get() != "UsdPreviewSurface":
            self._numbers[path] = -1
            return -1
        color, texture = source(shader, "diffuseColor", (0.18, 0.18, 0.18))
        opacity, cut = source(shader, "opacity", 1.0)
        image, reader = -1, ""
        if texture:
            image = self._image(texture.GetInput("file"))
            reader = reader_of(texture)
        name, color = material.GetPrim().GetName(), srgb(tuple(color)) / 255
        self._numbers[path] = self.add_material(name, color, float(opacity), image, cut is not None)
        self.readers.append(reader)
        return self._numbers[path]

    def _image(self, connected):
        asset = connected.Get() if connected else None
        if not asset or not asset.path:
            return -1
        package, _, inside = asset.resolvedPath.rstrip("]").partition("[")
        content, names = b"", (asset.path, "", "")
        if inside and Path(package).resolve() == self.file:
            content = packed(self.file, inside)
        elif Path(asset.resolvedPath).is_relative_to(self.file.parent):
            beside = Path(asset.resolvedPath).relative_to(self.file.parent)
            names = (beside.as_posix(), asset.path, "")
        return self.add_image(names, content)


def packed(file, name):
    """Return a file of a package; nothing if it is not there, or too large."""
    try:
        with zipfile.ZipFile(file) as package:
            return package.read(name) if package.getinfo(name).file_size <= LARGEST else b""
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
    value = attributes[0].Get(Usd.TimeCode.EarliestTime())
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


def surface(prim, corners, polygons, faces, palette, places):
    """Return what colours the triangles of a mesh.

    Shapes: corners (m, 3), polygons (m,), faces (m, 3), places (m, 3, 2): the first texture
    coordinates, None for none. Those of a material's image take their place.
    """
    binding = UsdShade.MaterialBindingAPI(prim)
    material = np.full(len(faces), palette.number(binding.ComputeBoundMaterial()[0]))
    for subset in binding.GetMaterialBindSubsets():
        own = UsdShade.MaterialBindingAPI(subset.GetPrim()).ComputeBoundMaterial()[0]
        members = np.array(subset.GetIndicesAttr().Get() or [], int)
        material[np.isin(polygons, members)] = palette.number(own)
    arrays: dict[str, np.ndarray] = {"materials": material}
    primvars = UsdGeom.PrimvarsAPI(prim)
    colors = at_corners(primvars, "displayColor", 3, corners, polygons, faces)
    if colors is not None and (material < 0).all():
        arrays["colors"] = srgb(colors)
    places = np.zeros((*faces.shape, 2), np.float32) if places is None else places
    for k in np.unique(material[material >= 0]).tolist():
        rows = np.flatnonzero(material == k)
        uv = at_corners(primvars, palette.readers[k], 2, corners[rows], polygons[rows], faces[rows])
        if palette.readers[k] and uv is not None:
            places[rows] = upper_left(uv)
            arrays["places"] = places
    return arrays
