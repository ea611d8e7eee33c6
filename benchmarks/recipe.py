"""The recipe that everyone would write: libraries for each step, numpy in between.

All hits of the rays by Embree (or Open3D), libigl's fast winding number at the midpoint of
every segment, the graph as numpy arrays, scipy's Dijkstra, the paper's falloff. Nothing
here is slow on purpose: every step is vectorised, each library is called once for all.
Where a choice was open, the faster one was taken: only segments between the first and
last hit of a ray are asked about, so that what an open mesh holds beyond them is lost.
"""

from __future__ import annotations

from dataclasses import dataclass

import igl
import numpy as np
from embreex.mesh_construction import TriangleMesh as EmbreeMesh
from embreex.rtcore_scene import EmbreeScene
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from cutcell import Rig, TriangleMesh
from cutcell.geodesics import bone_segments

PLANE = ((1, 2), (0, 2), (0, 1))
STEP = 1e-6
BONES_AT_ONCE = 8
"""Bones that scipy works on in one call: its result holds every node for each of them."""


@dataclass
class RecipeGraph:
    """The graph of the recipe: nodes (N, 3) in the unit cube, edges (E, 2), lengths (E,)."""

    nodes: np.ndarray
    edges: np.ndarray
    lengths: np.ndarray
    vertex_node: np.ndarray
    diagonal: float
    offset: np.ndarray
    size: float

    def matrix(self) -> csr_array:
        """Return the graph as a symmetric sparse matrix."""
        a, b = self.edges.T
        ends = np.concatenate([a, b]), np.concatenate([b, a])
        count = len(self.nodes)
        return csr_array((np.tile(self.lengths, 2), ends), shape=(count, count))


def fit(mesh: TriangleMesh):
    """Scale into the unit cube and merge equal vertices."""
    low, high = mesh.bounds
    size = (high - low).max()
    offset = 0.5 - (low + high) / (2 * size)
    points, index = np.unique(mesh.vertices / size + offset, axis=0, return_inverse=True)
    return points, index.ravel().astype(np.int32), offset, float(size)


def ray_origins(resolution: int, axis: int) -> np.ndarray:
    """Start the R x R rays of one axis outside the cube, shape (R * R, 3)."""
    u, v = PLANE[axis]
    lattice = (np.arange(resolution) + 0.5) / resolution
    origins = np.full((resolution**2, 3), -0.25)
    origins[:, u] = np.repeat(lattice, resolution)
    origins[:, v] = np.tile(lattice, resolution)
    return origins


def hits_embree(vertices: np.ndarray, faces: np.ndarray, resolution: int, axis: int):
    """Find all hits along one axis by restarting behind each: rays, triangles, positions."""
    scene = EmbreeScene()
    EmbreeMesh(scene, vertices.astype(np.float32), faces)
    corner = vertices[faces[:, 0]]
    normal = np.cross(vertices[faces[:, 1]] - corner, vertices[faces[:, 2]] - corner)
    origins = ray_origins(resolution, axis).astype(np.float32)
    directions = np.zeros_like(origins)
    directions[:, axis] = 1
    live, last = np.arange(len(origins)), np.full(len(origins), -1)
    step = np.full(len(origins), STEP)
    rays, triangles, positions = [], [], []
    while len(live):
        hit = scene.run(origins[live], directions[live])
        live, hit = live[hit >= 0], hit[hit >= 0]
        start = origins[live].astype(np.float64)
        toward = ((corner[hit] - start) * normal[hit]).sum(axis=1)
        slope = normal[hit, axis]
        ahead = np.divide(toward, slope, out=np.zeros(len(hit)), where=slope != 0)
        position = start[:, axis] + np.maximum(ahead, 0)
        fresh = last[live] != hit
        rays.append(live[fresh])
        triangles.append(hit[fresh])
        positions.append(position[fresh])
        step[live] = np.where(fresh, STEP, 2 * step[live])
        origins[live, axis] = position + step[live]
        last[live] = hit
    return tuple(np.concatenate(x) if x else np.empty(0) for x in (rays, triangles, positions))


def hits_open3d(vertices: np.ndarray, faces: np.ndarray, resolution: int, axis: int):
    """Find all hits along one axis by list_intersections: rays, triangles, positions."""
    import open3d as o3d

    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(
        o3d.core.Tensor(vertices.astype(np.float32)), o3d.core.Tensor(faces.astype(np.uint32))
    )
    rays = np.zeros((resolution**2, 6), np.float32)
    rays[:, :3] = ray_origins(resolution, axis)
    rays[:, 3 + axis] = 1
    hits = scene.list_intersections(o3d.core.Tensor(rays))
    names = ("ray_ids", "primitive_ids", "t_hit")
    ray, triangle, travel = (hits[name].numpy() for name in names)
    return ray.astype(np.int64), triangle.astype(np.int64), travel.astype(np.float64) - 0.25


def segments(rays: np.ndarray, positions: np.ndarray, resolution: int, first_hit: int):
    """Dice the rays of one axis between their first and last hit.

    Returns the keys of both ends of each segment, shape (s, 2), the ray of each, and the
    middle. A lattice point's key is ray * R + place, a hit's its number from `first_hit`.
    """
    lowest, highest = np.full(resolution**2, np.inf), np.full(resolution**2, -np.inf)
    np.minimum.at(lowest, rays, positions)
    np.maximum.at(highest, rays, positions)
    begin = np.ceil(np.clip(lowest, 0, 2) * resolution - 0.5).astype(np.int64)
    end = np.floor(np.clip(highest, -1, 1) * resolution - 0.5).astype(np.int64)
    count = np.maximum(end - begin + 1, 0)
    point_ray = np.repeat(np.arange(resolution**2), count)
    place = np.arange(len(point_ray)) - np.repeat(np.cumsum(count) - count, count)
    place += begin[point_ray]

    ray = np.concatenate([rays, point_ray])
    where = np.concatenate([positions, (place + 0.5) / resolution])
    key = np.concatenate([first_hit + np.arange(len(rays)), point_ray * resolution + place])
    order = np.lexsort([where, ray])
    ray, where, key = ray[order], where[order], key[order]
    same = ray[1:] == ray[:-1]
    ends = np.stack([key[:-1], key[1:]], axis=1)[same]
    return ends, ray[1:][same], ((where[1:] + where[:-1]) / 2)[same]


def build_graph(
    mesh: TriangleMesh, resolution: int, cast=hits_embree, threshold: float = 0.5
) -> RecipeGraph:
    """Build the paper's graph (section 3.1) with the libraries at hand."""
    vertices, vertex_node, offset, size = fit(mesh)
    faces = vertex_node[mesh.faces]
    cube = resolution**3
    lattice = (np.arange(resolution) + 0.5) / resolution
    ends, middles, spots, triangles = [], [], [], []
    first_hit = cube
    for axis in range(3):
        u, v = PLANE[axis]
        ray, triangle, position = cast(vertices, faces, resolution, axis)
        pair, of, middle = segments(ray, position, resolution, first_hit)
        ends.append(_renumbered(pair, axis, resolution))
        first_hit += len(ray)
        for points, r, p in ((middles, of, middle), (spots, ray, position)):
            point = np.empty((len(p), 3))
            point[:, u], point[:, v] = lattice[r // resolution], lattice[r % resolution]
            point[:, axis] = p
            points.append(point)
        triangles.append(triangle)

    number = igl.fast_winding_number(vertices, faces.astype(np.int64), np.concatenate(middles))
    inside_segments = np.concatenate(ends)[number >= threshold]
    keys, inside = np.unique(inside_segments, return_inverse=True)
    inner, outer = keys[keys < cube], keys[keys >= cube] - cube
    points = np.stack(np.unravel_index(inner, (resolution,) * 3), axis=1)
    nodes = np.concatenate([vertices, (points + 0.5) / resolution, np.concatenate(spots)[outer]])
    edges = np.concatenate(
        [
            _mesh_edges(faces),
            inside.reshape(-1, 2) + len(vertices),
            np.stack(
                [
                    np.repeat(np.arange(len(nodes) - len(outer), len(nodes)), 3),
                    faces[np.concatenate(triangles)[outer]].ravel(),
                ],
                axis=1,
            ),
        ]
    ).astype(np.int32)
    lengths = np.linalg.norm(nodes[edges[:, 0]] - nodes[edges[:, 1]], axis=1)
    diagonal = float(np.linalg.norm(np.ptp(vertices[faces], axis=(0, 1))))
    return RecipeGraph(nodes, edges, lengths, vertex_node, diagonal, offset, size)


def _renumbered(keys: np.ndarray, axis: int, resolution: int) -> np.ndarray:
    """Turn (ray, place) keys of lattice points into one numbering for all axes."""
    point = keys < resolution**3
    u, v, along = np.unravel_index(np.where(point, keys, 0), (resolution,) * 3)
    index = [u, v]
    index.insert(axis, along)
    return np.where(point, np.ravel_multi_index(index, (resolution,) * 3), keys)


def _mesh_edges(faces: np.ndarray) -> np.ndarray:
    ends = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges = np.unique(ends, axis=0)
    return edges[edges[:, 0] != edges[:, 1]]


def find_sources(nodes: np.ndarray, start: np.ndarray, end: np.ndarray, samples: int = 5):
    """Find the node nearest to each sample of each bone: bones, nodes, distances to the bone."""
    fraction = np.linspace(0, 1, samples)[:, None]
    points = start[:, None] + fraction * (end - start)[:, None]
    node = cKDTree(nodes).query(points, workers=-1)[1]
    bone = np.repeat(np.arange(len(start)), samples)
    node = node.ravel()
    along = (end - start)[bone]
    squared = np.maximum((along**2).sum(axis=1), 1e-300)
    travel = np.clip(((nodes[node] - start[bone]) * along).sum(axis=1) / squared, 0, 1)
    distance = np.linalg.norm(nodes[node] - start[bone] - travel[:, None] * along, axis=1)
    return bone, node, distance


def with_bones(matrix: csr_array, bone, node, distance, bones: int) -> csr_array:
    """Append a node for each bone, with edges to its sources as long as their distances."""
    count = matrix.shape[0]
    order = np.lexsort([distance, node, bone])
    bone, node, distance = bone[order], node[order], distance[order]
    first = np.ones(len(bone), bool)  # a sparse matrix adds up what is given twice
    first[1:] = (bone[1:] != bone[:-1]) | (node[1:] != node[:-1])
    bone, node, distance = bone[first], node[first], distance[first]
    rows = np.cumsum(np.bincount(bone, minlength=bones)) + matrix.nnz
    return csr_array(
        (
            np.concatenate([matrix.data, distance]),
            np.concatenate([matrix.indices, node]),
            np.concatenate([matrix.indptr, rows]),
        ),
        shape=(count + bones, count + bones),
    )


def scipy_distances(augmented: csr_array, bones: int, targets: np.ndarray) -> np.ndarray:
    """Run scipy's Dijkstra from each bone; return distances at the targets, shape (b, t)."""
    count = augmented.shape[0] - bones
    result = np.empty((bones, len(targets)))
    for first in range(0, bones, BONES_AT_ONCE):
        chosen = np.arange(first, min(first + BONES_AT_ONCE, bones))
        result[chosen] = dijkstra(augmented, indices=count + chosen)[:, targets]
    return result


def bind(rig: Rig, resolution: int = 64, cast=hits_embree) -> np.ndarray:
    """Compute weights (n, j) as the paper does (section 3.2, alpha 1/2), four a vertex."""
    graph = build_graph(rig.mesh, resolution, cast)
    bones = bone_segments(rig.skeleton)
    start, end = (points / graph.size + graph.offset for points in (bones.start, bones.end))
    sources = find_sources(graph.nodes, start, end)
    augmented = with_bones(graph.matrix(), *sources, len(start))
    distance = scipy_distances(augmented, len(start), graph.vertex_node)
    lost = ~np.isfinite(distance).any(axis=0)
    if lost.any():
        distance[:, lost] = _nearest_three(graph.nodes[graph.vertex_node[lost]], start, end)
    joint = np.full((len(rig.skeleton.joints), distance.shape[1]), np.inf)
    np.minimum.at(joint, bones.joint, distance)

    x = np.maximum(joint.T / graph.diagonal, 1e-9)
    weights = (1 / (0.5 * x + 0.5 * x**2)) ** 2
    if weights.shape[1] > 4:
        limit = np.partition(weights, -4, axis=1)[:, -4, None]
        weights = np.where(weights >= limit, weights, 0)
    return weights / weights.sum(axis=1, keepdims=True)


def _nearest_three(points, start, end) -> np.ndarray:
    along = end - start
    squared = np.maximum((along**2).sum(axis=1), 1e-300)
    away = points[None] - start[:, None]
    travel = np.clip((away * along[:, None]).sum(axis=2) / squared[:, None], 0, 1)
    distance = np.linalg.norm(away - travel[..., None] * along[:, None], axis=2)
    if len(distance) > 3:
        limit = np.partition(distance, 2, axis=0)[2]
        distance = np.where(distance <= limit, distance, np.inf)
    return distance
