"""Numbers and names of the glTF 2.0 specification."""

from __future__ import annotations

import numpy as np

FLOAT = 5126
COMPONENTS: dict[int, np.dtype] = {
    5120: np.dtype("<i1"),
    5121: np.dtype("<u1"),
    5122: np.dtype("<i2"),
    5123: np.dtype("<u2"),
    5125: np.dtype("<u4"),
    5126: np.dtype("<f4"),
}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN = 4, 5, 6
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
ROUNDED = "cutcell_rounded"
"""Extra of accessors that Draco rounded: in a saved document they are plain."""
INTERPOLATIONS = LINEAR, STEP, CUBICSPLINE = "LINEAR", "STEP", "CUBICSPLINE"
