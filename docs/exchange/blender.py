"""Put the weights of a CSV by `cutcell weights` onto a mesh in Blender.

In Blender's text editor:  apply("/tmp/character.body.csv", bpy.data.objects["body"])
Vertices take the weights of the nearest ones in the file. The file's y axis is up, as in glTF.
"""

import csv
from collections import defaultdict

import bpy
from mathutils.kdtree import KDTree


def read(path):
    """Return the weights by joint, and the place with z up, of each vertex."""
    weights, places = defaultdict(dict), {}
    with open(path, encoding="utf-8") as file:
        for row in csv.DictReader(file):
            vertex = int(row["vertex"])
            weights[vertex][row["joint"]] = float(row["weight"])
            places[vertex] = (float(row["x"]), -float(row["z"]), float(row["y"]))
    return weights, places


def apply(path, thing):
    """Set the vertex groups of an object; returns the largest distance of a vertex."""
    weights, places = read(path)
    tree = KDTree(len(places))
    for vertex, place in places.items():
        tree.insert(place, vertex)
    tree.balance()
    groups = {name for row in weights.values() for name in row}
    groups = {
        name: thing.vertex_groups.get(name) or thing.vertex_groups.new(name=name) for name in groups
    }
    farthest = 0.0
    for point in thing.data.vertices:
        _, nearest, distance = tree.find(thing.matrix_world @ point.co)
        farthest = max(farthest, distance)
        for name, group in groups.items():
            group.remove([point.index])
            if name in weights[nearest]:
                group.add([point.index], weights[nearest][name], "REPLACE")
    bpy.context.view_layer.update()
    return farthest
