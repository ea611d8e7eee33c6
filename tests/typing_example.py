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
    assert_type(binding.stretch, cutcell.Stretch)
    cutcell.save(path, rig.with_weights(binding.weights))
    assert_type(cutcell.show(rig, binding), cutcell.Page)
    error = cutcell_lab.metrics.weight_l1(binding.weights, binding.weights)
    assert_type(error, float)
    return binding.weights


def as_networks_call_it(rig: cutcell.Rig) -> dict[str, NDArray[np.floating]]:
    skin = cutcell.priors.voxel_skin(
        joints=rig.skeleton.joints, vertices=rig.mesh.vertices, faces=rig.mesh.faces
    )
    assert_type(skin, NDArray[np.floating])
    return cutcell.priors.VertexGroupVoxelSkin.parse(mode="exp").get_vertex_group(rig)


def stage_by_stage(rig: cutcell.Rig, method: cutcell.Method) -> NDArray[np.float64]:
    graph = cutcell.build_graph(rig.mesh, method=method)
    assert_type(graph, cutcell.CutCellGraph)
    distances = cutcell.bone_distances(graph, rig.skeleton, method=method)
    assert_type(distances, cutcell.BoneDistances)
    weights = cutcell.skinning_weights(distances, method=method, max_influences=8)
    return cutcell.refine_weights(rig, weights, method=method, smoothing=2)


def dressed(rig: cutcell.Rig, coat: cutcell.TriangleMesh) -> list[cutcell.Transfer]:
    one = cutcell.transfer(rig, coat, flipped=True)
    assert_type(one, cutcell.Transfer)
    return cutcell.transfer(rig, [coat, one.rig], distance=0.1)


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
    hat = cutcell.JointEdit(added=True, position=(0, 2, 0), parent="head")
    edits = cutcell.Edits(joints={"hat": hat}, removed=["toe.L"])
    return cutcell.edited_rig(cutcell.Rig(mesh, skeleton), edits)


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
    result = cutcell.explain(rig, 7, method="paper", connectivity="any")
    assert_type(result, cutcell.Explanation)
    shares: tuple[cutcell.JointShare, ...] = result.joints
    return {share.name: share.steps["normalise"] for share in shares}


def put_right(rig: cutcell.Rig) -> cutcell.Binding:
    edits = cutcell.Edits(
        joints={"Root": cutcell.JointEdit(deform=False, position=(0.0, 1.0, 0.0))},
        base="file",
        layers=[
            cutcell.Layer(cutcell.Filled({"Head": 1.0}), cutcell.Mask(part=7)),
            cutcell.Layer(cutcell.Painted([3], ["Head", "Neck"], [[0.5, 0.5]]), opacity=0.5),
            cutcell.Layer(cutcell.Computed({"resolution": 96}), cutcell.Mask(vertices=[1, 2])),
            cutcell.Layer(cutcell.FromFile()),
            cutcell.Layer(cutcell.Attached(), cutcell.Mask(part=7)),
            cutcell.Layer(cutcell.Smoothed(2, through=True)),
            cutcell.Layer(cutcell.Mirrored("left")),
            cutcell.Layer(cutcell.Remapped({"Head": "Neck", "Neck": "Head"})),
            cutcell.Layer(cutcell.Locked(["Head"])),
        ],
        poses={"nod": cutcell.SavedPose({"Head": (30.0, 0.0, 0.0)})},
    )
    again = cutcell.editing.edits.Edits.from_json(edits.to_json())
    assert_type(cutcell.edited_rig(rig, again), cutcell.Rig)
    return cutcell.bind(rig, edits=again)


def move(rig: cutcell.Rig, weights: NDArray[np.float64]) -> NDArray[np.float64]:
    turns = np.tile(cutcell.pose.axis_rotation("x", 30.0), (len(rig.skeleton.joints), 1, 1))
    transforms = cutcell.forward_kinematics(rig.skeleton, turns)
    bent = cutcell.dual_quaternion_skinning(rig.mesh.vertices, weights, transforms)
    return bent - cutcell.linear_blend_skinning(rig.mesh.vertices, weights, transforms)


def compared(rig: cutcell.Rig) -> str:
    result = cutcell_lab.baselines.METHODS["bone_heat"](rig)
    assert_type(result, cutcell_lab.baselines.BaselineBinding)
    swept = cutcell_lab.sweep(rig, "alpha", [0.2, 0.8], method="paper", resolution=32)
    assert_type(swept, cutcell_lab.Sweep)
    assert_type(swept.points[0], cutcell_lab.SweepPoint)
    comparison = cutcell_lab.compare([rig], ["cutcell_rig", "euclidean"])
    return comparison_markdown(comparison)


def evaluated(folder: Path) -> float | None:
    evaluation = cutcell_lab.evaluate(folder / "predicted", folder / "reference")
    return evaluation.statistic("rignet", "precision")["median"]


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
    cutcell.binding,
    cutcell.diagnosis,
    cutcell.errors,
    cutcell.graph,
    cutcell.io,
    cutcell.rig,
    cutcell.weights,
    cutcell.editing,
)
