"""Small pictures of characters for reports, drawn without a screen or a graphics library."""

from __future__ import annotations

import base64
import colorsys
import io

import numpy as np
from numpy.typing import NDArray

from cutcell.errors import MissingLibraryError

SIZE = 220
LARGER = 2
"""Factor of supersampling, which smooths the edges."""
TURN, TILT = np.radians(-30.0), np.radians(12.0)
MAX_FACES = 40_000
GREY = np.array([0.72, 0.75, 0.8])
HUE_STEP = 0.61803


def picture(vertices: NDArray, faces: NDArray, weights: NDArray | None = None) -> str:
    """Draw a mesh, each part in the colour of the joint that it follows most.

    Shapes: vertices (n, 3), faces (m, 3), weights (n, j).
    """
    try:
        from PIL import Image, ImageDraw
    except ImportError:
        raise MissingLibraryError(
            "reports are drawn by pillow, which is not installed; try: pip install "
            "'cutcell[dataset]'"
        ) from None
    if len(faces) > MAX_FACES:
        faces = faces[:: -(-len(faces) // MAX_FACES)]
    turned = _turned(np.asarray(vertices, float))
    used = turned[np.unique(faces)]
    low, high = used.min(axis=0), used.max(axis=0)
    scale = (SIZE * LARGER - 12) / max(float((high - low)[:2].max()), 1e-30)
    flat = (turned - (low + high) / 2) * scale
    across = np.cross(flat[faces[:, 1]] - flat[faces[:, 0]], flat[faces[:, 2]] - flat[faces[:, 0]])
    length = np.maximum(np.linalg.norm(across, axis=1), 1e-30)
    shade = 0.35 + 0.65 * np.abs(across @ np.array([0.3, 0.5, 0.81])) / length
    colours = np.clip(_base(faces, weights) * shade[:, None] * 255, 0, 255).astype(int)
    middle = SIZE * LARGER / 2
    corners = np.stack([middle + flat[faces, 0], middle - flat[faces, 1]], axis=2)
    image = Image.new("RGB", (SIZE * LARGER, SIZE * LARGER), "white")
    draw = ImageDraw.Draw(image)
    for face in np.argsort(flat[faces, 2].mean(axis=1)).tolist():
        points = [(float(x), float(y)) for x, y in corners[face]]
        draw.polygon(points, fill=tuple(colours[face].tolist()))
    packed = io.BytesIO()
    image.resize((SIZE, SIZE), Image.Resampling.LANCZOS).save(packed, "PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(packed.getvalue()).decode()


def _turned(points: NDArray) -> NDArray:
    """Look a little from the left and from above; z comes towards the viewer."""
    c, s = np.cos(TURN), np.sin(TURN)
    turned = points @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]).T
    c, s = np.cos(TILT), np.sin(TILT)
    return turned @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]).T


def _base(faces: NDArray, weights: NDArray | None) -> NDArray:
    if weights is None or not weights.size:
        return np.tile(GREY, (len(faces), 1))
    table = [colorsys.hsv_to_rgb(k * HUE_STEP % 1, 0.45, 1.0) for k in range(weights.shape[1])]
    return np.array(table)[weights[faces[:, 0]].argmax(axis=1)]
