"""Boxes cut into small squares, and rigs made of them."""

from itertools import product

import numpy as np

from cutcell import Rig, Skeleton, TriangleMesh


def grid_box(nx, ny=2, nz=2, size=(1.0, 0.2, 0.2)):
    """Make a closed box of small squares, from the origin to `size`."""
    number, faces = {}, []

    def at(*key):
        return number.setdefault(key, len(number))

    n = (nx, ny, nz)
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side, i, j in product((0, n[axis]), range(n[u]), range(n[v])):
            corners = []
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                key = [0, 0, 0]
                key[axis], key[u], key[v] = side, i + a, j + b
                corners.append(at(*key))
            if side == 0:
                corners = corners[::-1]
            faces += [[corners[0], *corners[1:3]], [corners[0], *corners[2:4]]]
    return np.array(list(number)) / n * np.array(size), np.array(faces)


def bar(nx=20, joints=3):
    vertices, faces = grid_box(nx)
    x = np.linspace(0.05, 0.95, joints)
    skeleton = Skeleton(
        np.stack([x, 0 * x + 0.1, 0 * x + 0.1], axis=1),
        np.arange(joints) - 1,
        deform=np.arange(joints) < joints - 1,
    )
    return Rig(TriangleMesh(vertices, faces), skeleton)


def side_by_side(alone):
    """Put two of a rig side by side, which share no joint."""
    count, joints = len(alone.mesh.vertices), len(alone.skeleton.joints)
    aside = np.array([1.2 * np.ptp(alone.mesh.vertices, axis=0)[0], 0, 0])
    mesh = TriangleMesh(
        np.vstack([alone.mesh.vertices, alone.mesh.vertices + aside]),
        np.vstack([alone.mesh.faces, alone.mesh.faces + count]),
    )
    parents = alone.skeleton.parents
    skeleton = Skeleton(
        np.vstack([alone.skeleton.joints, alone.skeleton.joints + aside]),
        np.concatenate([parents, np.where(parents < 0, -1, parents + joints)]),
        deform=np.tile(alone.skeleton.deform, 2),
    )
    return Rig(mesh, skeleton, allowed=np.kron(np.eye(2), np.ones((count, joints))) > 0)


def surface_of(ticks, solid):
    """Make the surface of the solid cells of a grid; `ticks` are its planes along each axis."""
    filled = np.pad(solid, 1)
    number, faces = {}, []
    for axis, cell in product(range(3), np.argwhere(solid)):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, 1):
            beside = cell + 1
            beside[axis] += 2 * side - 1
            if filled[tuple(beside)]:
                continue
            corners = []
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                key = cell.copy()
                key[axis] += side
                key[u] += a
                key[v] += b
                corners.append(number.setdefault(tuple(key), len(number)))
            corners = corners if side else corners[::-1]
            faces += [corners[:3], [corners[0], *corners[2:]]]
    points = np.array([[ticks[axis][key[axis]] for axis in range(3)] for key in number])
    return TriangleMesh(points, np.array(faces))


def fork():
    """Make a handle with two prongs, 0.4 long and 0.01 apart, and a bone in each."""
    ticks = [
        np.linspace(0, 1, 11),
        np.array([0, 0.05, 0.1, 0.11, 0.16, 0.21]),
        np.array([0, 0.05, 0.1]),
    ]
    solid = np.ones([len(t) - 1 for t in ticks], bool)
    solid[6:, 2, :] = False
    joints = [[0.1, 0.105, 0.05], [0.55, 0.105, 0.05]]
    joints += [[x, y, 0.05] for y in (0.05, 0.16) for x in (0.65, 0.95)]
    skeleton = Skeleton(joints, [-1, 0, 1, 2, 1, 4], deform=[True, False, True, False, True, False])
    return Rig(surface_of(ticks, solid), skeleton)


def check_weights(rig, found):
    """See that a method did its duty."""
    assert found.failed == ""
    assert found.weights.shape == (len(rig.mesh.vertices), len(rig.skeleton.joints))
    assert (found.weights >= 0).all()
    np.testing.assert_allclose(found.weights.sum(axis=1), 1, atol=1e-9)
    assert not found.weights[:, ~rig.skeleton.deform].any()
    assert all(value >= 0 for value in found.seconds.values())


def legs():
    """Return two legs, mirrored, in each a twist bone and an IK control at one place."""
    vertices, faces = grid_box(8)
    vertices = vertices * [0.4, 1, 1] + [0.3, 0, 0]
    flipped = vertices * [-1, 1, 1]
    mesh = TriangleMesh(
        np.vstack([vertices, flipped]), np.vstack([faces, faces[:, ::-1] + len(vertices)])
    )
    x, middle = 0.5, vertices[:, 1:].mean(axis=0)
    names, joints, parents = ["root"], [[0, *middle]], [-1]
    for side, sign in (("l", 1), ("r", -1)):
        controls = [f"c_thigh_ik.{side}", f"thigh_twist.{side}"]
        names += controls if side == "r" else controls[::-1]
        names += [f"shin.{side}"]
        joints += [[sign * x, *middle], [sign * x, *middle], [sign * (x + 0.1), *middle]]
        parents += [0, 0, names.index(f"thigh_twist.{side}")]
    deform = [not name.startswith("c_") for name in names]
    random = np.random.default_rng(5)
    rows, count = random.dirichlet(np.ones(3), len(vertices)), len(vertices)
    weights = np.zeros((2 * count, len(names)))
    for side, which in (("l", slice(count)), ("r", slice(count, None))):
        for column, name in enumerate(("root", f"thigh_twist.{side}", f"shin.{side}")):
            weights[which, names.index(name)] = rows[:, column]
    return Rig(mesh, Skeleton(np.array(joints), parents, names, deform=deform), weights)
