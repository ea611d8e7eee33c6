"""Fill a mesh with tetrahedra by another library: run as a script, in a subprocess.

    python benchmarks/mesher.py LIBRARY MESH.npz [EDGE]

Meshers crash or never end on some input, so the benchmark keeps them apart. Needs numpy and
the library, not cutcell: the interpreter may be that of another environment. Prints JSON.
"""

import json
import sys
from time import perf_counter

import numpy as np


def mesh_by_pytetwild(vertices, faces, edge):
    """Mesh by fTetWild with edges of that length; its default is a twentieth of the diagonal."""
    import pytetwild

    begin = perf_counter()
    length = {"edge_length_abs": edge} if edge else {}
    _, cells = pytetwild.tetrahedralize(vertices, faces, quiet=True, **length)[:2]
    return perf_counter() - begin, len(cells)


def mesh_by_tetgen(vertices, faces, edge):
    """Mesh by TetGen, constrained, without quality demands: its fastest way, whatever `edge`."""
    import tetgen

    del edge

    begin = perf_counter()
    mesher = tetgen.TetGen(vertices, faces)
    _, cells = mesher.tetrahedralize(plc=True, quality=False)[:2]
    return perf_counter() - begin, len(cells)


MESHERS = {"pytetwild": mesh_by_pytetwild, "tetgen": mesh_by_tetgen}


def main():
    """Mesh what the arguments name."""
    library, path = sys.argv[1:3]
    edge = float(sys.argv[3]) if len(sys.argv) > 3 else None
    with np.load(path) as arrays:
        vertices, faces = arrays["vertices"], arrays["faces"].astype(np.int32)
    try:
        spent, cells = MESHERS[library](vertices, faces, edge)
    except ModuleNotFoundError:
        print(json.dumps({"missing": library}))
        return
    print(json.dumps({"seconds": spent, "cells": cells}))


if __name__ == "__main__":
    main()
