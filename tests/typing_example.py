"""Uses every public name of cutcell, for a type checker alone: nobody runs it."""

from __future__ import annotations

from pathlib import Path
from typing import assert_type

import numpy as np
from numpy.typing import NDArray

import cutcell
import cutcell_lab
from cutcell_lab.baselines.compare import comparison_markdown


def how() -> list[cutcell.Method]:
    method = cutcell.PAPER.with_options(alpha=0.25, resolution=128)
    assert_type(method, cutcell.Method)
    assert_type(method.leaf, cutcell.method.Leaf)
    return [method, cutcell.ANIMATION, cutcell.Method(connectivity=26, max_influences=None)]


def whole_way(path: Path) -> NDArray[np.float64]:
    rig = cutcell.load(path)
    assert_type(rig, cutcell.Rig)
    binding = cutcell.bind(rig, 128, method="paper", alpha=0.3, connectivity="any")
    assert_type(binding, cutcell.Binding)
    cutcell.save(path, rig.with_weights(binding.weights))
    assert_type(cutcell.show(rig, binding), cutcell.Page)
    error = cutcell_lab.metrics.weight_l1(binding.weights, binding.weights)
    assert_type(error, float)
    return binding.weights


def stage_by_stage(rig: cutcell.Rig, method: cutcell.Method) -> NDArray[np.float64]:
    graph = cutcell.build_graph(rig.mesh, method=method)
    assert_type(graph, cutcell.CutCellGraph)
    distances = cutcell.bone_distances(graph, rig.skeleton, method=method)
    assert_type(distances, cutcell.BoneDistances)
    weights = cutcell.skinning_weights(distances, method=method, max_influences=8)
    return cutcell.refine_weights(rig, weights, method=method, smoothing=2)


def of_arrays(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int64],
    joints: NDArray[np.float64],
    parents: NDArray[np.int64],
) -> cutcell.Binding:
    mesh = cutcell.TriangleMesh(vertices, faces)
    skeleton = cutcell.Skeleton(joints, parents)
    inside = cutcell.winding_number(mesh, vertices) > 0.5
    assert_type(cutcell.rig.inputs.as_mesh((vertices, faces)), cutcell.TriangleMesh)
    bones = cutcell.bone_segments(skeleton, "extend")
    assert_type(bones, cutcell.geodesics.Bones)
    assert inside.any()
    cutcell.bind((mesh, skeleton), progress=cutcell.runtime.progress.silent)
    return cutcell.bind((vertices, faces, joints, parents), leaf="extend", falloff="rig")


def of_a_bare_mesh(mesh: cutcell.TriangleMesh) -> cutcell.Rig:
    skeleton = cutcell.fit_skeleton(mesh, "biped")
    assert_type(skeleton, cutcell.Skeleton)
    assert_type(cutcell.templates.TEMPLATES, tuple[cutcell.templates.Template, ...])
    hat = cutcell.JointCorrection(added=True, position=(0, 2, 0), parent="head")
    corrections = cutcell.Corrections(joints={"hat": hat}, removed=["toe.L"])
    return cutcell.corrected_rig(cutcell.Rig(mesh, skeleton), corrections)


def look(rig: cutcell.Rig) -> list[str]:
    cleaned = cutcell.clean(rig)
    assert_type(cleaned, cutcell.Cleaned)
    assert_type(cleaned.losses, tuple[cutcell.JointLoss, ...])
    diagnosis = cutcell.diagnose(rig)
    assert_type(diagnosis, cutcell.Diagnosis)
    findings: tuple[cutcell.Finding, ...] = diagnosis.findings
    deforming = cutcell.deform_joints(rig.mesh, rig.skeleton)
    assert_type(deforming, cutcell.DeformJoints)
    chosen = cutcell.choose_deform(rig, (), ("*_IK",))
    parts: tuple[cutcell.Part, ...] = chosen.parts
    left_out: tuple[cutcell.LeftOut, ...] = chosen.left_out
    attached: tuple[cutcell.Attachment, ...] = chosen.attachments
    clips: tuple[cutcell.Clip, ...] = chosen.clips
    names = [thing.name for things in (parts, left_out, attached, clips) for thing in things]
    return [*names, *(finding.message for finding in findings)]


def why(rig: cutcell.Rig) -> dict[str, float]:
    found = cutcell.explain(rig, 7, method="paper", connectivity="any")
    assert_type(found, cutcell.Explanation)
    shares: tuple[cutcell.JointShare, ...] = found.joints
    return {share.name: share.steps["normalise"] for share in shares}


def put_right(rig: cutcell.Rig) -> cutcell.Binding:
    corrections = cutcell.Corrections(
        joints={"Root": cutcell.JointCorrection(deform=False, position=(0.0, 1.0, 0.0))},
        parts={7: cutcell.PartCorrection("glued", "Head")},
        vertices={3: {"Head": 0.5, "Neck": 0.5}},
    )
    again = cutcell.editing.corrections.Corrections.from_json(corrections.to_json())
    assert_type(cutcell.corrected_rig(rig, again), cutcell.Rig)
    return cutcell.bind(rig, corrections=again)


def move(rig: cutcell.Rig, weights: NDArray[np.float64]) -> NDArray[np.float64]:
    turns = np.tile(cutcell.pose.axis_rotation("x", 30.0), (len(rig.skeleton.joints), 1, 1))
    transforms = cutcell.forward_kinematics(rig.skeleton, turns)
    return cutcell.linear_blend_skinning(rig.mesh.vertices, weights, transforms)


def compared(rig: cutcell.Rig) -> str:
    found = cutcell_lab.baselines.METHODS["bone_heat"](rig)
    assert_type(found, cutcell_lab.baselines.BaselineBinding)
    comparison = cutcell_lab.compare([rig], ["cutcell_rig", "euclidean"])
    return comparison_markdown(comparison)


def careful(path: Path) -> str:
    try:
        whole_way(path)
    except (cutcell.FileError, cutcell.MissingLibraryError, cutcell.TooLargeError) as error:
        return f"the file: {error}"
    except (cutcell.MeshError, cutcell.SkeletonError, cutcell.WeightsError) as error:
        return f"the rig: {error}"
    except cutcell.ParameterError as error:
        return f"an option: {error}"
    except cutcell.CutcellError as error:
        return str(error)
    except cutcell.Cancelled:
        return "stopped"
    return ""


MODULES = (
    cutcell_lab.dataset,
    cutcell.diagnosis,
    cutcell.errors,
    cutcell.graph,
    cutcell.io,
    cutcell.rig,
    cutcell.weights,
    cutcell.editing,
)
