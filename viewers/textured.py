"""Surfaces in a file's materials, as VTK draws them: a piece for each image."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from cutcell.io.materials.face_colors import BLENDED, CLAMP, MIRROR, REPEAT, FaceColors

from .vtk_internals import ALPHA, replace_in_shader

# Members of `pyvista.Texture.WrapType`. By name: the class brings matplotlib, 60 MB of memory,
# and the page's server imports this long before anybody wants a picture.
WRAPPING = {REPEAT: "REPEAT", CLAMP: "CLAMP_TO_EDGE", MIRROR: "MIRRORED_REPEAT"}
OPAQUE = 255


def pieces(
    points: NDArray[np.float32],
    normals: NDArray[np.float32] | None,
    faces: NDArray[np.int32],
    colors: FaceColors,
) -> Iterator[tuple[pv.PolyData, tuple[int, int]]]:
    """Divide a surface by its images.

    Parameters
    ----------
    points, normals : array, shape (n, 3)
    faces : array, shape (m, 3)
    colors : FaceColors
        Of these faces.

    Yields
    ------
    data : pyvista.PolyData
        Corners, each with its tint ("colors"), and its position in the image.
    kind : (int, int)
        The layer, -1 for none, and how the image continues; see `FaceColors`.
    """
    kinds = colors.corners[:, 0, 2:].astype(int)
    for layer, wrap in np.unique(kinds, axis=0).tolist():
        rows = np.flatnonzero((kinds == (layer, wrap)).all(axis=1))
        corners = faces[rows].ravel()
        cells = np.arange(len(corners)).reshape(-1, 3)
        data: Any = pv.PolyData(points[corners], np.insert(cells, 0, 3, axis=1).ravel())
        if normals is not None:
            data.point_data.active_normals = normals[corners]
        tints = colors.tints[rows].reshape(-1, 3)
        if wrap >= BLENDED:
            tints = np.column_stack([tints, colors.opacity[rows].reshape(-1)])
        data.point_data["colors"] = tints
        if layer >= 0:
            across, down = colors.corners[rows, :, :2].reshape(-1, 2).T
            # VTK counts from the lower left corner.
            data.active_texture_coordinates = np.stack([across, 1 - down], axis=1)
        yield data, (layer, wrap)


def cut_out(drawn: pv.Actor, wrap: int) -> None:
    """Draw a piece opaquely, without the transparent pixels of its image."""
    drawn.ForceOpaqueOn()
    code = DITHERED if wrap >= BLENDED else CUT_OUT
    replace_in_shader(drawn, "Fragment", ALPHA, code, early=False)


def texture(image: NDArray[np.uint8], wrap: int) -> pv.Texture:
    """Return a layer (s, s, 4) as a texture; VTK wraps both ways alike, as it does across."""
    opaque = (image[..., 3] == OPAQUE).all()
    made: Any = pv.Texture(np.ascontiguousarray(image[..., :3] if opaque else image))
    made.interpolate = made.mipmap = True
    made.SetWrap(pv.Texture.WrapType[WRAPPING[wrap % BLENDED // 3]])
    return made


CUT_OUT = """//VTK::DepthPeeling::Impl
  if (gl_FragData[0].a < 0.5) { discard; }
  gl_FragData[0].a = 1.0;
"""
"""Draws nothing where alpha is below a half."""

DITHERED = """//VTK::DepthPeeling::Impl
  vec2 fine = floor(gl_FragCoord.xy);
  vec2 coarse = floor(0.5 * gl_FragCoord.xy);
  float least = fract(0.5 * fine.x + 0.75 * fine.y * fine.y) + 0.03125;
  least += 0.25 * fract(0.5 * coarse.x + 0.75 * coarse.y * coarse.y);
  if (gl_FragData[0].a < least) { discard; }
  gl_FragData[0].a = 1.0;
"""
"""Draws the share of pixels that alpha gives, as the page does (frontend/engine/materials.js)."""
