"""Make the data and the reference pictures of the exercises again.

It needs cutcell[app]; the exercises themselves do not.
"""

import sys
from pathlib import Path

import numpy as np
import pyvista as pv
import trimesh
from scipy.sparse import coo_array
from scipy.spatial import cKDTree
from trimesh.intersections import mesh_plane

import cutcell
from cutcell.pose import axis_rotation
from cutcell_assets import demo_path
from cutcell_viewers.pose_scene import joint_turns

HERE = Path(__file__).resolve().parent
EXERCISES = HERE / "exercises"
FINGERS = ("thumb", "index", "middle", "ring", "pinky")
RESOLUTION = 48
REMOVED = 0.8
"""Part of the faces that is removed: the files are small, and plain Python is fast enough."""
DEPTH = 0.02
"""Height z of the section, through the body and both arms."""


def data() -> dict[str, np.ndarray]:
    """Return the arrays of walker.npz: a coarse walker, whose fingers belong to their hand."""
    rig = cutcell.load(demo_path("biped"))
    skeleton, names = rig.skeleton, rig.skeleton.names
    remain = [j for j, name in enumerate(names) if not name.startswith(FINGERS)]
    hand = {side: remain.index(names.index(f"hand.{side}")) for side in "LR"}
    group = np.array([remain.index(j) if j in remain else hand[names[j][-1]]
                      for j in range(len(names))])  # fmt: skip
    body = pv.PolyData.from_regular_faces(rig.mesh.vertices, rig.mesh.faces)
    coarse = body.clean(tolerance=1e-6).decimate(REMOVED)
    vertices, faces = np.asarray(coarse.points, float), coarse.regular_faces
    artist = grouped(rig.weights[cKDTree(rig.mesh.vertices).query(vertices)[1]].T, group, sum).T
    arm = [j for j, k in enumerate(remain)
           if names[k] in ("upper_arm.L", "forearm.L", "hand.L")]  # fmt: skip
    bones = cutcell.bone_segments(skeleton)
    straight = grouped(
        [to_segment(vertices, a, b) for a, b in zip(bones.start, bones.end, strict=True)],
        group[bones.joint],
        np.minimum.reduce,
    ).T
    graph = cutcell.build_graph(cutcell.TriangleMesh(vertices, faces), resolution=RESOLUTION)
    distances = cutcell.bone_distances(graph, skeleton)
    through = (
        graph.lattice.size * grouped(distances.of_all_joints().joint, group, np.minimum.reduce).T
    )
    poses = [
        {names.index("upper_arm.L"): axis_rotation("z", angle)} for angle in np.linspace(0, 80, 9)
    ]
    motion = [cutcell.forward_kinematics(skeleton, joint_turns(rig, pose)) for pose in poses]
    return {
        "vertices": vertices.astype(np.float32),
        "faces": faces.astype(np.uint16),
        "names": np.array([names[j] for j in remain]),
        "joints": skeleton.joints[remain],
        "artist": artist.astype(np.float32),
        "starts": bones.start,
        "ends": bones.end,
        "bone_joint": group[bones.joint].astype(np.uint8),
        **section_of(vertices, faces, artist[:, arm].sum(axis=1)),
        "edges": graph.edges.astype(np.uint16),
        "lengths": (graph.lengths * graph.lattice.size).astype(np.float32),
        "node_count": np.array(len(graph.nodes)),
        "vertex_node": graph.vertex_node.astype(np.uint16),
        **sources_of(distances, group),
        "straight": straight.astype(np.float32),
        "candidate_A": falloff(straight, 8).astype(np.float16),
        "candidate_B": falloff(through, 3).astype(np.float16),
        "candidate_C": blurred(artist, faces, 44).astype(np.float16),
        "motion": np.array(motion, np.float32)[:, remain],
    }  # fmt: skip


def grouped(rows, group, reduce):
    """Return one row for each group of rows."""
    return np.array([reduce([row for row, g in zip(rows, group, strict=True) if g == k])
                     for k in range(group.max() + 1)])  # fmt: skip


def to_segment(points, start, end):
    """Return the distance of points (n, 3) to a segment."""
    along = end - start
    share = np.clip((points - start) @ along / max(along @ along, 1e-12), 0, 1)
    return np.linalg.norm(points - start - share[:, None] * along, axis=1)


def falloff(distances, power):
    """Return weights (n, j) proportional to 1 / distance ** power."""
    weights = 1 / np.maximum(distances, 1e-3) ** power
    return weights / weights.sum(axis=1, keepdims=True)


def blurred(weights, faces, times):
    """Return weights averaged with those of adjacent vertices, a number of times."""
    edges = np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)), axis=0)
    ends = np.concatenate([edges, edges[:, ::-1]]).T
    adjacent = coo_array((np.ones(len(ends[0])), ends), shape=(len(weights),) * 2).tocsr()
    degree = adjacent.sum(axis=1).reshape(-1, 1)
    for _ in range(times):
        weights = (weights + adjacent @ weights / degree) / 2
    return weights


def sources_of(distances, group):
    """Return for each joint the nodes where its distances begin, and the distances there."""
    sources, size = distances.sources, distances.graph.lattice.size
    joint = group[distances.bones.joint[sources.bone]]
    nodes, starts, first = [], [], [0]
    for j in range(group.max() + 1):
        least: dict[int, float] = {}
        for node, start in zip(sources.node[joint == j], sources.distance[joint == j], strict=True):
            least[int(node)] = min(float(start) * size, least.get(int(node), np.inf))
        nodes += least.keys()
        starts += least.values()
        first.append(len(nodes))
    return {"source_node": np.array(nodes, np.uint16), "source_distance": np.array(starts),
            "source_start": np.array(first)}  # fmt: skip


def section_of(vertices, faces, arm):
    """Return a section's segments, which of them are of an arm, and which are missing when torn."""
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    lines, face = mesh_plane(mesh, (0, 0, 1), (0, 0, DEPTH), return_faces=True)
    segments = lines[:, :, :2]
    along, outward = segments[:, 1] - segments[:, 0], mesh.face_normals[face]
    clockwise = along[:, 1] * outward[:, 0] - along[:, 0] * outward[:, 1] < 0
    segments[clockwise] = segments[clockwise, ::-1]
    middle = segments.mean(axis=1)
    gap = (np.abs(middle[:, 1] - 1.15) < 0.035) | (np.abs(middle[:, 1] - 0.45) < 0.03)
    return {"section": segments, "section_arm": arm[faces[face]].mean(axis=1) > 0.5,
            "section_gap": gap}  # fmt: skip


def main() -> None:
    """Write the data, then the pictures."""
    np.savez_compressed(EXERCISES / "walker.npz", **data())
    sys.path.insert(0, str(EXERCISES))
    from draw import draw

    for folder in sorted(EXERCISES.glob("[1-9]_*")):
        print(folder.name)
        draw(folder.name[0], HERE / "solutions" / f"{folder.name}.py", folder / "reference.png")


if __name__ == "__main__":
    main()
