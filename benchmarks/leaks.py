"""Leakage from a hand to the hip beside it: through voxels, through a cage, through ours.

    python -m benchmarks.leaks [--resolution 48] [--picture FILE.png] [--out DOCUMENT]
    python -m benchmarks.leaks --prior docs/pictures/merged.png --out docs/networks.md

The paper's Figures "voxelBinding" and "cage", on the demo biped: the distance from the left
forearm along voxels and in ours, and the weight that harmonic coordinates of a cage, and ours,
give to its hand. With `--prior`, what a network's prior gives to the arm, by voxels as UniRig and
SkinTokens compute them, and by `cutcell.priors`.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import cutcell
from cutcell.rig import Rig
from cutcell_lab.baselines.body import Body
from cutcell_lab.baselines.cages.cage_methods import harmonic
from cutcell_lab.baselines.volumes.voxel_binding import voxel_distances
from cutcell_lab.benchmarks.document import fill
from cutcell_lab.benchmarks.drop_in import cutcell_prior, voxel_prior
from cutcell_lab.benchmarks.rigs import ROOT
from cutcell_lab.benchmarks.tables import Table
from cutcell_viewers.camera import Camera, framing
from cutcell_viewers.description import Description
from cutcell_viewers.distance_scene import distance_scene
from cutcell_viewers.palette import LIGHT
from cutcell_viewers.scene import render_png
from cutcell_viewers.weights_scene import weights_scene

ARM, HIPS = ("forearm.L", "hand.L"), ("thigh.L", "hips")
NEAR = 0.06
"""Largest distance of a vertex beside the arm, relative to the longest side."""
VOXELS, CELLS = 196, 64
"""Resolutions of the priors: SkinTokens' and ours."""
SIZE = (560, 700)


def fields(rig: Rig, resolution: int) -> dict[str, NDArray[np.float64]]:
    """Compute both distances from the arm, and both weights of it; one value for each vertex."""
    arm = [rig.skeleton.names.index(name) for name in ARM]
    body = Body.of(rig, resolution=resolution)
    voxels = body.joint_minimum(voxel_distances(body))[arm].min(axis=0)[body.index]
    binding = cutcell.bind(rig, resolution, max_influences=None)
    caged = harmonic(rig, resolution)
    if caged.weights is None:
        raise SystemExit(caged.failed)
    return {
        "voxel distance": voxels,
        "our distance": binding.distances.joint[arm].min(axis=0),
        "cage weight": caged.weights[:, arm].sum(axis=1),
        "our weight": binding.weights[:, arm].sum(axis=1),
    }


def hip_near_arm(rig: Rig) -> NDArray[np.intp]:
    """Find the vertices of hip and thigh that the arm hangs beside."""
    assert rig.weights is not None
    owner = rig.weights.argmax(axis=1)
    names = rig.skeleton.names
    arm = np.isin(owner, [names.index(name) for name in ARM])
    hip = np.flatnonzero(np.isin(owner, [names.index(name) for name in HIPS]))
    size = float(np.ptp(rig.mesh.vertices, axis=0).max())
    away = cKDTree(rig.mesh.vertices[arm]).query(rig.mesh.vertices[hip])[0]
    return hip[away < NEAR * size]


def leak_table(
    leaks: dict[str, NDArray[np.float64]], at: NDArray[np.intp], resolution: int
) -> Table:
    """Write what the hip beside the arm gets."""
    table = Table(
        "A hand beside a hip",
        ["at the hip, from forearm and hand", "median", "nearest or most"],
        f"The demo biped, R = {resolution}, {len(at)} vertices of thigh and hips within "
        f"{NEAR:.0%} of the longest side of the arm. Distances are parts of the longest side. "
        "The cage's vertices follow their nearest bone; ours is `bind` as it is by default.",
    )
    for name, values in leaks.items():
        least = values[at].min() if "distance" in name else values[at].max()
        table.add(name, f"{np.median(values[at]):.3f}", f"{least:.3f}")
    return table


def leak_scenes(rig: Rig, leaks: dict[str, NDArray[np.float64]]) -> dict[str, Description]:
    """Make the scenes of the four fields, by their titles."""
    joint = rig.skeleton.names.index(ARM[1])
    longest = max(float(leaks[name].max()) for name in leaks if "distance" in name)
    scenes = []
    for name, values in leaks.items():
        if "distance" in name:
            scene = distance_scene(rig, values, joint, skeleton=False)
            skin = replace(scene.actors["body"], limits=(0.0, longest))  # the same for both
            scenes.append(replace(scene, actors={**scene.actors, "body": skin}))
        else:
            scenes.append(one_weight(rig, values))
    titles = (
        "Along voxels: distance from the arm",
        "Ours: distance from the arm",
        "Harmonic in a cage: weight of the arm",
        "Ours: weight of the arm",
    )
    return dict(zip(titles, scenes, strict=True))


def one_weight(rig: Rig, values: NDArray[np.float64]) -> Description:
    """Make the scene of a weight, one value for each vertex."""
    joint = rig.skeleton.names.index(ARM[1])
    column = np.zeros((len(values), len(rig.skeleton.joints)))
    column[:, joint] = values
    return weights_scene(rig, column, joint, skeleton=False)


def picture(rig: Rig, scenes: dict[str, Description], path: Path) -> None:
    """Draw scenes beside each other, the arm and the hip large."""
    bounds = np.stack([rig.mesh.vertices.min(axis=0), rig.mesh.vertices.max(axis=0)])
    whole = framing(bounds, SIZE[0] / SIZE[1])
    target = np.array(whole.focal_point)
    offset = 0.52 * (np.array(whole.position) - target)
    target[1] = bounds[0, 1] + 0.52 * np.ptp(bounds[:, 1])
    camera = Camera(tuple((target + offset).tolist()), tuple(target.tolist()))
    count = len(scenes)
    figure = Figure(figsize=(2.8 * count, 3.72), facecolor="white")
    FigureCanvasAgg(figure)
    for k, (title, scene) in enumerate(scenes.items()):
        axes = figure.add_axes((k / count + 0.003, 0.0, 0.976 / count, 0.93))
        axes.imshow(render_png(scene, theme=LIGHT, size=SIZE, camera=camera))
        axes.set_axis_off()
        axes.set_title(title, fontsize=9.5, loc="left")
    figure.savefig(path, dpi=110, facecolor="white")


def prior_of_the_arm(rig: Rig) -> dict[str, NDArray[np.float64]]:
    """Compute what both priors, from joints as points, give to the arm from the elbow on."""
    joints, start = rig.skeleton, rig.skeleton.names.index(ARM[0])
    arm = np.zeros(len(joints.joints), bool)
    for joint, parent in enumerate(joints.parents):  # parents come first
        arm[joint] = joint == start or (parent >= 0 and arm[parent])
    priors = {
        f"Voxels, R = {VOXELS}": voxel_prior(rig, VOXELS),
        f"Cut-cell graph, R = {CELLS}": cutcell_prior(rig, CELLS),
    }
    return {
        f"{name}: prior of the arm": prior[:, arm].sum(axis=1) for name, prior in priors.items()
    }


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, measure, print, draw."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.leaks", description=__doc__)
    parser.add_argument("--resolution", type=int, default=48)
    parser.add_argument("--picture", type=Path)
    parser.add_argument("--prior", type=Path, help="a picture of a network's prior instead")
    parser.add_argument("--out", type=Path, help="a document with marks for it")
    options = parser.parse_args(argv)
    rig = cutcell.load(ROOT / "assets" / "biped.glb")
    at = hip_near_arm(rig)
    if options.prior:
        priors = prior_of_the_arm(rig)
        picture(
            rig, {name: one_weight(rig, values) for name, values in priors.items()}, options.prior
        )
        shares = [f"{np.median(values[at]):.2f}" for values in priors.values()]
        text = (
            f"The demo biped: of {len(at)} vertices of thigh and hips beside the arm, the prior "
            f"gives forearm and hand a median of {shares[0]} with voxels at R = {VOXELS}, and "
            f"{shares[1]} with the cut-cell graph at R = {CELLS}. Joints are points in both."
        )
        print(text)
        if options.out:
            fill(options.out, {"merged": text})
        return
    leaks = fields(rig, options.resolution)
    text = leak_table(leaks, at, options.resolution).markdown()
    print(text)
    if options.picture:
        picture(rig, leak_scenes(rig, leaks), options.picture)
    if options.out:
        fill(options.out, {"leaks": text})


if __name__ == "__main__":
    main()
