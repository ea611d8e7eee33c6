"""Put the weights of a CSV by `cutcell weights` onto a skeletal mesh in Unreal 5.

In Unreal's Python console:  apply("C:/temp/character.body.csv", "/Game/Characters/Body")
The mesh was imported from the file that the weights are of: the vertices are in its order.
"""

import csv
from collections import defaultdict

import unreal


def read(path):
    """Return the weights of each vertex by joint."""
    weights = defaultdict(dict)
    with open(path, encoding="utf-8") as file:
        for row in csv.DictReader(file):
            weights[int(row["vertex"])][row["joint"]] = float(row["weight"])
    return weights


def apply(path, asset):
    """Set the weights of a skeletal mesh; returns how many vertices got some."""
    mesh = unreal.load_asset(asset)
    modifier = unreal.SkinWeightModifier()
    if mesh is None or not modifier.set_skeletal_mesh(mesh):
        raise RuntimeError(f"{asset} is no skeletal mesh that can be edited")
    weights, count = read(path), modifier.get_num_vertices()
    if max(weights) >= count:
        raise RuntimeError(f"the file has {max(weights) + 1} vertices, the mesh only {count}")
    bones = {str(name) for name in modifier.get_all_bone_names()}
    missing = {joint for row in weights.values() for joint in row} - bones
    if missing:
        raise RuntimeError(f"the skeleton lacks {', '.join(sorted(missing))}")
    for vertex, row in weights.items():
        modifier.set_vertex_weights(vertex, row, replace_all=True)
    if not modifier.commit_weights_to_skeletal_mesh():
        raise RuntimeError(f"Unreal did not take the weights of {asset}")
    return len(weights)
