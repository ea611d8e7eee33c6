"""Draco, whose decoder takes minutes or gigabytes over some damaged data."""

from __future__ import annotations

import DracoPy


def decode(data, ends):
    """Decode meshes.

    Parameters
    ----------
    data : array, shape (b,), uint8
        Compressed meshes, one after the other.
    ends : array, shape (k,), int
        Where each ends.

    Returns
    -------
    dict
        `faces_K` (m, 3) uint32 of mesh K, and `values_K_ID` (n, width) for each attribute's
        unique ID.

    Raises
    ------
    RuntimeError
        A mesh cannot be decoded; it is named by its number.
    """
    found, start = {}, 0
    for k, end in enumerate(ends.tolist()):
        try:
            mesh = DracoPy.decode(data[start:end].tobytes())
            found[f"faces_{k}"] = mesh.faces
            for attribute in mesh.attributes:
                found[f"values_{k}_{attribute['unique_id']}"] = attribute["data"]
        except MemoryError:
            raise RuntimeError(f"mesh {k} takes more memory than it may") from None
        except Exception as error:  # its own errors have no common class
            raise RuntimeError(f"mesh {k} is damaged: {error}") from None
        start = end
    return found
