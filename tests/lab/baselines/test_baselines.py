"""Each method against a closed form, another library, or a slow loop."""

from itertools import product

import igl
import numpy as np
import pytest
import trimesh
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

import cutcell
from cutcell import ParameterError, Rig, Skeleton, TriangleMesh
from cutcell.geometry.laplacian import cotangent_laplacian, vertex_areas, vertex_normals
from cutcell_lab.baselines import METHODS
from cutcell_lab.baselines.body import Body
from cutcell_lab.baselines.methods import accepted_options
from cutcell_lab.baselines.visibility import Blockers
from cutcell_lab.baselines.volumes.voxel_binding import path_lengths
from cutcell_lab.baselines.volumes.voxels import PAD, mark_triangles, voxelize
from cutcell_lab.metrics import vertex_shares, weight_l1
from tests import meshes
from tests.bars import bar, check_weights, grid_box
from tests.conftest import SHARED_RIGS


def open_tube(radius=0.05, along=160, around=24):
    turn = 2 * np.pi * np.arange(around) / around
    ring = radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    x = np.linspace(0, 1, along + 1)
    vertices = [[xi, *p] for xi in x for p in ring]
    faces = []
    for i, k in product(range(along), range(around)):
        a, b = i * around + k, i * around + (k + 1) % around
        faces += [[a, b, b + around], [a, b + around, a + around]]
    return np.array(vertices), np.array(faces)


# All of them


def test_options_go_to_methods_that_know_them():
    def plain(rig):
        return rig

    def fine(rig, resolution=64):
        return rig

    def all_of_them(rig, **options):
        return rig

    options = {"resolution": 8, "threshold": 0.1}
    assert accepted_options(plain, **options) == {}
    assert accepted_options(fine, **options) == {"resolution": 8}
    assert accepted_options(all_of_them, **options) == options


@pytest.mark.parametrize("name", sorted(set(METHODS) - {"artist"}))
def test_every_method_binds_a_bar(name):
    rig = bar()
    result = METHODS[name](rig)
    check_weights(rig, result)
    x = rig.mesh.vertices[:, 0]
    assert result.warnings == ()
    assert (result.weights[x < 0.2].argmax(axis=1) == 0).all()
    assert (result.weights[x > 0.8].argmax(axis=1) == 1).all()
    few = METHODS[name](rig, max_influences=1).weights
    np.testing.assert_array_equal((few > 0).sum(axis=1), 1)


VOLUME = {"bbw", "biharmonic", "quasi_harmonic"}


@pytest.mark.parametrize("name", sorted(set(METHODS) - {"artist"} - VOLUME))
@pytest.mark.parametrize("make", [meshes.ball_with_holes, meshes.grid_soup, meshes.non_manifold])
def test_robust_methods_bind_anything(name, make):
    vertices, faces = make()
    vertices = np.concatenate([vertices, [[3, 3, 3]]])  # that no face uses
    joints = [[0.2, 0.5, 0.5], [0.5, 0.5, 0.5], [0.8, 0.5, 0.5], [0.8, 0.6, 0.5]]
    skeleton = Skeleton(joints, [-1, 0, 1, 1], deform=[True, True, False, True])
    rig = Rig(TriangleMesh(vertices, faces), skeleton)
    coarse = {"resolution": 32} if name == "voxel_unirig" else {}  # its own is 196
    check_weights(rig, METHODS[name](rig, **coarse))


@pytest.mark.parametrize("name", sorted(set(METHODS) - {"artist", "cutcell"}))
def test_weights_that_a_file_cannot_store_are_not_given(name):
    rig = bar()
    allowed = np.ones((len(rig.mesh.vertices), 3), bool)
    allowed[:5, 0] = False
    allowed[5:10, 1] = False
    rig = Rig(rig.mesh, rig.skeleton, allowed=allowed)
    result = METHODS[name](rig)
    check_weights(rig, result)
    assert not result.weights[~allowed].any()


def test_the_artists_weights_are_the_files():
    rig = bar()
    assert METHODS["artist"](rig).failed == "the file has no weights"
    weights = np.tile([1.0, 0, 0], (len(rig.mesh.vertices), 1))
    np.testing.assert_array_equal(METHODS["artist"](rig.with_weights(weights)).weights, weights)


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("euclidean", {"alpha": 2}),
        ("euclidean", {"leaf": "?"}),
        ("euclidean", {"max_influences": 0}),
        ("euclidean", {"threshold": -1}),
        ("voxel", {"resolution": 1}),
        ("voxel", {"alpha": "x"}),
        ("voxel_unirig", {"alpha": -1}),
        ("bone_heat", {"heat": 0}),
        ("bbw", {"iterations": 0}),
        ("bbw", {"limit": -1}),
        ("biharmonic", {"limit": "soon"}),
        ("quasi_harmonic", {"iterations": -1}),
    ],
)
def test_parameters_out_of_range_are_refused(name, options):
    with pytest.raises(ParameterError, match=next(iter(options))):
        METHODS[name](bar(4), **options)


# Straight and voxel distances


def test_euclidean_weights_by_hand():
    rig = bar()
    diagonal = np.linalg.norm([1, 0.2, 0.2])
    near = rig.mesh.vertices - [0, 0.1, 0.1]
    inverse = []
    for low, high in ((0.05, 0.5), (0.5, 0.95)):
        away = near - np.clip(near[:, 0], low, high)[:, None] * [1, 0, 0]
        d = np.linalg.norm(away, axis=1) / diagonal
        inverse.append((0.5 * d + 0.5 * d**2) ** -2)
    expected = np.array(inverse) / np.sum(inverse, axis=0)
    np.testing.assert_allclose(METHODS["euclidean"](rig).weights[:, :2], expected.T, atol=1e-12)


@pytest.mark.parametrize("make", [meshes.ball, meshes.grid_soup, meshes.random_soup, meshes.torus])
def test_no_voxel_that_the_surface_touches_is_missed(make):
    vertices, faces = make()
    rig = Rig(TriangleMesh(vertices, faces), Skeleton([[0.5, 0.5, 0.5]], [-1]))
    body = Body.of(rig, resolution=16)
    voxels = voxelize(body)
    rng = np.random.default_rng(0)
    spots = rng.dirichlet(np.ones(3), 2000)
    points = np.einsum("sc,mcx->msx", spots, body.points[body.faces]).reshape(-1, 3)
    assert (voxels.at(points) >= 0).all()
    assert (voxels.at(body.points[np.unique(body.faces)]) >= 0).all()
    # What is solid is near the surface or inside.
    surface = cKDTree(points).query(voxels.centres)[0] <= np.sqrt(3) / 2 / 16 + 0.01
    inside = cutcell.winding_number(TriangleMesh(body.points, body.faces), voxels.centres[~surface])
    if make in (meshes.ball, meshes.torus):
        np.testing.assert_allclose(inside, 1, atol=1e-6)


def test_a_box_is_filled_and_a_hollow_stays_outside():
    vertices, faces = meshes.box(0, 1)
    rig = Rig(TriangleMesh(vertices * 0.9, faces), Skeleton([[0.5, 0.5, 0.5]], [-1]))
    voxels = voxelize(Body.of(rig, resolution=8))
    assert voxels.solid[PAD:-PAD, PAD:-PAD, PAD:-PAD].all()
    ring = Rig(TriangleMesh(*meshes.torus()), rig.skeleton)
    assert voxelize(Body.of(ring, resolution=32)).at(np.array([[0.5, 0.5, 0.5]]))[0] == -1


def test_paths_lead_from_the_nearest_source_of_a_set_both_ways_along_links():
    links = np.array([[1, 0], [1, 2], [2, 3], [0, 3], [4, 3]])
    lengths = np.array([0.0, 1.0, 2.0, 5.0, 1.0])  # a vertex in the middle of its voxel
    lengths_from = path_lengths(6, links, lengths, [np.array([0]), np.array([2, 4])])
    np.testing.assert_allclose(lengths_from[0], [0, 0, 1, 3, 4, np.inf])
    np.testing.assert_allclose(lengths_from[1], [1, 1, 0, 1, 0, np.inf])


def test_voxel_paths_on_a_bar_are_as_long_as_the_bar():
    """One joint point at each end: along the axis voxel paths are straight."""
    rig = bar()
    ends = Skeleton([[0.0, 0.1, 0.1], [1.0, 0.1, 0.1]], [-1, -1])
    x = rig.mesh.vertices[:, 0]
    result = METHODS["voxel"](Rig(rig.mesh, ends), 60, alpha=0).weights
    # alpha = 0: the ratio of the weights is that of the squared distances.
    middle = (x > 0.3) & (x < 0.7)
    ratio = np.sqrt(result[middle, 1] / result[middle, 0])
    np.testing.assert_allclose(ratio, x[middle] / (1 - x[middle]), rtol=0.25)
    centre = np.isclose(x, 0.5)
    np.testing.assert_allclose(result[centre], 0.5, atol=0.02)


def test_voxels_leak_across_gaps_narrower_than_themselves():
    """Two bars side by side, a gap of 0.01: at R = 16 they are one to voxels, not to us."""
    vertices, faces = grid_box(20, size=(1.0, 0.2, 0.2))
    other = vertices + np.array([0, 0.21, 0])
    mesh = TriangleMesh(
        np.concatenate([vertices, other]), np.concatenate([faces, faces + len(vertices)])
    )
    skeleton = Skeleton([[0.5, 0.1, 0.1], [0.5, 0.31, 0.1]], [-1, -1])
    rig = Rig(mesh, skeleton)
    lower = np.arange(len(mesh.vertices)) < len(vertices)
    # Side by side every voxel path crosses freely: weights bleed over.
    leaked = METHODS["voxel"](rig, 16).weights[lower, 1].mean()
    assert leaked > 0.1
    assert METHODS["cutcell"](rig, 16).weights[lower, 1].max() == 0


def test_spans_fill_what_lies_between_surface_along_two_axes():
    """A slow loop; what a pipe encloses is filled though its ends are open, a flood runs in."""
    vertices, faces = open_tube(0.2, 20)
    rig = Rig(TriangleMesh(vertices, faces), Skeleton([[0.5, 0, 0]], [-1]))
    body = Body.of(rig, resolution=12)
    surface = np.zeros((16,) * 3, bool)
    mark_triangles(body.points[body.faces] * 12 + PAD, surface)
    expected = surface.copy()
    for cell in product(range(16), repeat=3):
        within = 0
        for axis in range(3):
            line = [*cell]
            line[axis] = slice(None)
            hit = np.flatnonzero(surface[tuple(line)])
            within += len(hit) > 0 and hit[0] <= cell[axis] <= hit[-1]
        expected[cell] |= within >= 2
    result = voxelize(body, fill="spans").solid
    assert np.array_equal(result, expected)
    middle = tuple(np.floor(np.array([0.5, 0.5, 0.5]) * 12).astype(int) + PAD)
    assert result[middle]
    assert not voxelize(body, fill="flood").solid[middle]


def test_six_neighbours_are_those_one_voxel_away():
    rig = Rig(TriangleMesh(*meshes.torus()), Skeleton([[0.5, 0.5, 0.5]], [-1]))
    voxels = voxelize(Body.of(rig, resolution=12))
    links, lengths = voxels.links(connectivity=6)
    pairs = cKDTree(voxels.centres).query_pairs(1.001 / 12, output_type="ndarray")
    assert set(map(frozenset, links.tolist())) == set(map(frozenset, pairs.tolist()))
    assert len(links) == len(pairs)
    np.testing.assert_allclose(lengths, 1 / 12)


def test_unirigs_binding_equals_its_description():
    """By queries of nearest neighbours and scipy's Dijkstra, in its cube from -1 to 1."""
    rng = np.random.default_rng(5)
    vertices, faces = meshes.torus()
    vertices = vertices + 1e-3 * rng.standard_normal(vertices.shape)  # no two voxels equally near
    joints = vertices[[3, 30, 60]] + 0.01
    rig = Rig(TriangleMesh(vertices, faces), Skeleton(joints, [-1, 0, 1]))
    grid, body = 24, Body.of(rig, resolution=24)
    points = 2 * body.points - 1
    centres = 2 * voxelize(body, fill="spans").centres - 1
    tree, count = cKDTree(centres), len(points)
    links, lengths = [], []

    def link(start, end, length):
        links.append(np.stack([start, end], axis=1))
        lengths.append(length)

    away, near = tree.query(centres, 7)
    source = np.broadcast_to(np.arange(len(centres))[:, None], near.shape)
    kept = (away > 0) & (away < 2 / grid * 1.001)
    link(source[kept] + count, near[kept] + count, 3 * away[kept])
    away, near = tree.query(points, 1)
    kept = away < 2 / grid * 1.001
    link(np.flatnonzero(kept), near[kept] + count, away[kept])
    for a, b in ((0, 1), (1, 2), (2, 0)):
        start, end = body.faces[:, a], body.faces[:, b]
        link(start, end, np.linalg.norm(points[start] - points[end], axis=1))
    ends, length = np.concatenate(links), np.concatenate(lengths)
    ends, first = np.unique(np.sort(ends, axis=1), axis=0, return_index=True)
    nodes = np.concatenate([points, centres])
    matrix = csr_array((length[first], ends.T), shape=(len(nodes),) * 2)
    at = cKDTree(nodes).query(2 * body.lattice.to_unit(joints) - 1)[1]
    distance = np.maximum(dijkstra(matrix, directed=False, indices=at)[:, :count], 1e-6)
    assert np.isfinite(distance).all()
    weights = (1 / (0.5 * distance + 0.5 * distance**2)) ** 2
    expected = (weights / weights.sum(axis=0)).T[body.index]
    np.testing.assert_allclose(METHODS["voxel_unirig"](rig, grid).weights, expected, atol=1e-9)


# Bone heat


@pytest.mark.parametrize("make", [meshes.ball, meshes.torus, meshes.ball_with_holes])
def test_laplacian_and_areas_equal_libigls(make):
    vertices, faces = make()
    laplacian = cotangent_laplacian(vertices, faces)
    expected = -igl.cotmatrix(vertices, faces.astype(np.int64)).toarray()
    np.testing.assert_allclose(laplacian.toarray(), expected, atol=1e-9)
    kind = igl.MASSMATRIX_TYPE_VORONOI
    mass = igl.massmatrix(vertices, faces.astype(np.int64), kind).diagonal()
    np.testing.assert_allclose(vertex_areas(vertices, faces), mass, atol=1e-12)


def test_normals_of_a_ball_point_away_from_its_middle():
    vertices, faces = meshes.ball(3)
    away = (vertices - 0.5) / 0.45
    assert ((vertex_normals(vertices, faces) * away).sum(axis=1) > 0.99).all()


def test_what_blocks_the_view_equals_a_slow_loop():
    vertices, faces = meshes.torus()
    rng = np.random.default_rng(0)
    vertex, target = rng.integers(0, len(vertices), 300), rng.uniform(0, 1, (300, 3))
    result = Blockers(vertices, faces).blocked(vertex, target)
    for q in range(300):
        start, way, slow = vertices[vertex[q]], target[q] - vertices[vertex[q]], False
        for face in faces:
            if vertex[q] in face:
                continue
            a, b, c = vertices[face]
            matrix = np.stack([b - a, c - a, -way], axis=1)
            if abs(np.linalg.det(matrix)) < 1e-15:
                continue
            u, v, t = np.linalg.solve(matrix, start - a)
            slow |= u >= 0 and v >= 0 and u + v <= 1 and 1e-9 < t < 1 - 1e-9
        assert result[q] == slow
    assert 0.1 < result.mean() < 0.9


@pytest.mark.parametrize("heat", [0.2, 1.0])
def test_heat_along_a_tube_falls_off_as_it_should(heat):
    """In one dimension: -w'' + h w = h p, so w = 1 - cosh(k x) / (2 cosh(k L / 2))."""
    radius = 0.05
    rig = Rig(
        TriangleMesh(*open_tube(radius)),
        Skeleton([[0, 0, 0], [0.5, 0, 0], [1, 0, 0]], [-1, 0, 1], deform=[True, True, False]),
    )
    result = METHODS["bone_heat"](rig, heat=heat)
    check_weights(rig, result)
    x = rig.mesh.vertices[:, 0]
    k = np.sqrt(heat) / radius
    left = 1 - np.cosh(k * x) / (2 * np.cosh(k / 2))
    mixed = (x < 0.499) & (left < 0.94)  # beyond it the smaller weight fades out
    assert mixed.sum() > 100
    np.testing.assert_allclose(result.weights[mixed, 0], left[mixed], atol=0.02)
    assert (result.weights[(x < 0.5) & (left > 0.98), 0] == 1).all()


def test_components_that_no_bone_sees_get_weights_too():
    rig = bar()
    inner, faces = meshes.ball(1)
    shell = trimesh.creation.box(extents=(0.5, 0.5, 0.5))  # neither sees into the bar
    vertices = np.concatenate(
        [
            rig.mesh.vertices,
            inner * 0.2 + [0.2, 1.0, 0.0],
            shell.vertices + np.array([0.3, 1.1, 0.1]),
        ]
    )
    n, m = len(rig.mesh.vertices), len(inner)
    mesh = TriangleMesh(vertices, np.concatenate([rig.mesh.faces, faces + n, shell.faces + n + m]))
    hidden = Rig(mesh, rig.skeleton)
    result = METHODS["bone_heat"](hidden)
    check_weights(hidden, result)
    said = f"{m + 8} of {len(vertices)} welded vertices lie on components that no bone sees"
    assert said in result.warnings[0]


@pytest.mark.parametrize(
    ("name", "limit"),
    [("khronos_CesiumMan", 0.35), ("khronos_Fox", 0.45), ("makehuman_clothed_mixamo", 0.4)],
)
def test_bone_heat_is_near_to_blenders(name, limit):
    """Not equal: Blender's bones have one end each, which its importer guesses."""
    path = SHARED_RIGS.parent / "bone_heat" / f"{name}.npz"
    if not path.exists():
        pytest.skip(f"there is no {path}; it is not part of the project")
    rig = cutcell.load(SHARED_RIGS / f"{name}.glb")
    data = np.load(path)
    away, row = cKDTree(data["vertices"]).query(rig.mesh.vertices)
    assert away.max() < 1e-6
    column = [list(data["joint_names"]).index(joint) for joint in rig.skeleton.names]
    reference = data["weights"][row][:, column].astype(float)
    held = reference.sum(axis=1) > 0
    reference = reference[held] / reference[held].sum(axis=1, keepdims=True)
    share = vertex_shares(rig.mesh)[held]
    computed = METHODS["bone_heat"](rig).weights[held]
    assert weight_l1(computed, reference, share) < limit
    assert weight_l1(METHODS["euclidean"](rig).weights[held], reference, share) > 2 * limit
