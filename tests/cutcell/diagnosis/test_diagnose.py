"""What a diagnosis says beyond the single damages, what it leaves alone, and when it refuses."""

import json
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from igl.copyleft.cgal import remesh_self_intersections

import cutcell
from cutcell import ParameterError, Rig, Skeleton, SkeletonError, TriangleMesh
from cutcell.diagnosis import unreadable
from cutcell.diagnosis.intersections import intersecting_faces
from cutcell_assets import demo_path
from tests import meshes
from tests.cutcell.diagnosis.worm import worm

WORM = worm()

PLANTED = {
    "biped_soup": {"holes", "unwelded-vertices"},
    "biped_flipped_arm": {"inverted-faces"},
    "biped_cape": {"unreachable-vertices", "rims"},
}


@pytest.mark.slow
@pytest.mark.parametrize("demo", PLANTED)
def test_the_planted_faults_of_the_broken_demos_are_named(demo):
    result = cutcell.diagnose(cutcell.load(demo_path(demo)), 32)
    assert {f.code for f in result.findings} >= PLANTED[demo]
    assert not result.of("error")
    assert {f.code for f in result.of("warning")} <= PLANTED[demo]


@pytest.mark.slow
def test_the_flipped_arm_is_found_face_by_face():
    whole, twin = (cutcell.load(demo_path(name)) for name in ("biped", "biped_flipped_arm"))
    flipped = np.flatnonzero((whole.mesh.faces != twin.mesh.faces).any(axis=1))
    finding = cutcell.diagnose(twin, 32)["inverted-faces"]
    assert np.array_equal(finding.faces, flipped)


@pytest.mark.slow
@pytest.mark.parametrize("demo", ["biped", "rabbit", "octopus"])
def test_nothing_is_found_in_the_sound_demos_but_that_32_cells_are_few(demo):
    result = cutcell.diagnose(cutcell.load(demo_path(demo)), 32).findings
    assert {f.code for f in result} <= {"thin-parts"}


def test_findings_come_with_the_gravest_first_and_as_plain_data():
    mesh = TriangleMesh(WORM.mesh.vertices, np.roll(WORM.mesh.faces, 5, axis=0)[20:])
    weights = WORM.weights.copy()
    weights[30:40] = 0
    result = cutcell.diagnose(replace(WORM, mesh=mesh, weights=weights), 16)
    severities = [f.severity for f in result.findings]
    assert severities == sorted(severities, key=["error", "warning", "note"].index)
    assert severities[0] == "error"
    assert "unweighted-vertices" in result
    data = json.loads(json.dumps(result.to_dict()))
    assert data["counts"] == result.counts
    first = data["findings"][0]
    assert first["code"] == "unweighted-vertices"
    assert first["vertices"] == list(range(30, 40))
    assert first["repair"]
    with pytest.raises(KeyError):
        result["no-such-code"]


def test_known_distances_are_used_as_they_are():
    binding = cutcell.bind(WORM, resolution=16)
    stages = []
    result = cutcell.diagnose(
        WORM, distances=binding.distances, progress=lambda stage, _: stages.append(stage)
    )
    assert set(stages) == {"checks"}
    assert result.findings == ()


def test_a_mesh_without_joints_is_diagnosed():
    vertices, faces = meshes.open_box()
    rig = Rig(TriangleMesh(vertices, faces), Skeleton(np.zeros((0, 3)), []))
    assert {f.code for f in cutcell.diagnose(rig, 16).findings} == {"rims"}


def test_a_thin_plate_is_told_with_the_resolution_that_would_do():
    plate = trimesh.creation.box(extents=[0.5, 0.4, 0.012]).subdivide().subdivide().subdivide()
    vertices = np.concatenate([WORM.mesh.vertices, plate.vertices + np.array([0.5, 0.4, 0.001])])
    faces = np.concatenate([WORM.mesh.faces, plate.faces + len(WORM.mesh.vertices)])
    rig = Rig(TriangleMesh(vertices, faces), WORM.skeleton)
    before = cutcell.diagnose(rig, 32)["thin-parts"]
    assert before.vertices.min() >= len(WORM.mesh.vertices)
    needed = int(before.advice.split("resolution of ")[1].split()[0])
    assert 96 <= needed <= 192
    assert "thin-parts" not in cutcell.diagnose(rig, needed)


def test_a_component_without_a_bone_is_told_with_what_it_follows():
    button = trimesh.creation.icosphere(subdivisions=1, radius=0.03)
    vertices = np.concatenate([WORM.mesh.vertices, button.vertices + np.array([0.9, 0.12, 0])])
    faces = np.concatenate([WORM.mesh.faces, button.faces + len(WORM.mesh.vertices)])
    result = cutcell.diagnose(Rig(TriangleMesh(vertices, faces), WORM.skeleton), 32)
    finding = result["boneless-components"]
    assert np.array_equal(finding.vertices, np.arange(len(WORM.mesh.vertices), len(vertices)))
    assert finding.details == (f"{len(button.vertices)} vertices follow head",)


def test_the_two_walls_of_a_sheet_are_no_duplicates_and_no_crack():
    vertices, faces = meshes.tube()
    walls = np.concatenate([faces, faces[:, ::-1]])
    rig = Rig(TriangleMesh(vertices, walls), Skeleton(np.zeros((0, 3)), []))
    codes = {f.code for f in cutcell.diagnose(rig, 16).findings}
    assert not codes & {"duplicate-faces", "cracks"}


@pytest.mark.parametrize("seed", range(4))
def test_self_intersections_agree_with_cgal(seed):
    # No two faces share a vertex: we leave out such pairs, CGAL does not.
    rng = np.random.default_rng(seed)
    vertices = (rng.random((40, 1, 3)) + 0.5 * rng.random((40, 3, 3))).reshape(-1, 3)
    faces = np.arange(120).reshape(40, 3)
    pairs = remesh_self_intersections(vertices, faces, detect_only=True)[2]
    result, is_whole = intersecting_faces(vertices, faces.astype(np.int32))
    assert is_whole
    assert 8 < len(np.unique(pairs)) < 38
    assert np.array_equal(np.flatnonzero(result), np.unique(pairs))


def test_bad_arguments_are_refused():
    with pytest.raises(ParameterError, match="resolution must be a whole number from 2 to 1,024"):
        cutcell.diagnose(WORM, 1)


def test_what_cannot_be_loaded_is_a_finding_too():
    with pytest.raises(SkeletonError) as caught:
        Skeleton([[0, 0, 0], [0, 0, 1]], [1, 0])
    assert unreadable(caught.value).code == "cyclic-joints"
    finding = unreadable(ParameterError("the file is empty"))
    assert (finding.code, finding.severity) == ("unreadable", "error")
