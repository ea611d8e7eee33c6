"""Put the weights of a CSV by `cutcell weights` onto a skinned mesh in Maya.

In Maya's script editor:  apply("C:/temp/character.body.csv", "body")
The mesh has a skin cluster with the joints of the file. Its vertices are in the file's order.
"""

import csv
from collections import defaultdict

from maya import cmds


def read(path):
    """Return the weights of each vertex by joint."""
    weights = defaultdict(dict)
    with open(path, encoding="utf-8") as file:
        for row in csv.DictReader(file):
            weights[int(row["vertex"])][row["joint"]] = float(row["weight"])
    return weights


def apply(path, mesh):
    """Set the weights of a mesh; returns how many vertices got some."""
    history = cmds.listHistory(mesh, pruneDagObjects=True) or []
    clusters = cmds.ls(history, type="skinCluster")
    if not clusters:
        raise RuntimeError(f"{mesh} has no skin cluster; bind it to its joints first")
    influences = cmds.skinCluster(clusters[0], query=True, influence=True)
    short = {name.split("|")[-1]: name for name in influences}
    weights = read(path)
    missing = {joint for row in weights.values() for joint in row} - set(short)
    if missing:
        raise RuntimeError(f"the skin cluster lacks {', '.join(sorted(missing))}; add them first")
    for vertex, row in weights.items():
        values = [(name, row.get(joint, 0.0)) for joint, name in short.items()]
        point = f"{mesh}.vtx[{vertex}]"
        cmds.skinPercent(clusters[0], point, transformValue=values, normalize=False)
    return len(weights)
