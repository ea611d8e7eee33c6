"""A figure of 40 vertices, and `cutcell app` with it among its demo characters.

`python -m tests.app.small FOLDER app ...` runs the command; the figure's file is in the folder.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import cutcell_assets
from cutcell.pose import rotate_joint
from cutcell.rig import Clip, Rig, Skeleton
from cutcell_assets import Demo
from tests.bars import surface_of

RESOLUTION = 16
SMALL = f"/?rig=small&resolution={RESOLUTION}&graph_resolution=0"
"""The address of a page that shows the figure."""

FINE = f"?rig=small&resolution={RESOLUTION}&panel=graph"
"""The address that shows a finer graph than that of the weights."""

JOINTS = {
    "hips": (None, (0, 0.2, 0)),
    "chest": ("hips", (0, 0.9, 0)),
    "head": ("chest", (0, 1.25, 0)),
    "upper_arm.L": ("chest", (0.35, 0.9, 0)),
    "forearm.L": ("upper_arm.L", (0.85, 0.9, 0)),
    "hand.L": ("forearm.L", (1.3, 0.9, 0)),
    "upper_arm.R": ("chest", (-0.35, 0.9, 0)),
    "forearm.R": ("upper_arm.R", (-0.85, 0.9, 0)),
    "hand.R": ("forearm.R", (-1.3, 0.9, 0)),
}
TICKS = [
    np.array([-1.4, -0.85, -0.3, 0.3, 0.85, 1.4]),
    np.array([0, 0.7, 1.1, 1.6, 1.95, 2.15]),
    np.array([-0.25, 0.25]),
]


def small_rig() -> Rig:
    """Make a symmetric figure with arms, weights, a motion, and a box that no bone reaches."""
    solid = np.zeros([5, 5, 1], bool)
    solid[2, :3] = solid[:, 1] = True  # trunk and head; arms
    solid[2, 4] = True  # above the head
    mesh = surface_of(TICKS, solid)
    names = tuple(JOINTS)
    parents = [-1 if parent is None else names.index(parent) for parent, _ in JOINTS.values()]
    skeleton = Skeleton([point for _, point in JOINTS.values()], parents, names)
    away = np.linalg.norm(mesh.vertices[:, None] - skeleton.joints, axis=2)
    weights = np.eye(len(names))[away.argmin(axis=1)]
    still = np.tile(np.eye(4), (len(names), 1, 1))
    raised = rotate_joint(skeleton, names.index("upper_arm.L"), "z", 50)
    clip = Clip("Wave", np.array([0.0, 1.0, 2.0]), np.stack([still, raised, still]))
    return Rig(mesh, skeleton, weights, (clip,), name="small")


@dataclass(frozen=True)
class Small(Demo):
    """The figure as a demo character.

    Parameters
    ----------
    folder : Path
        Where its file lies.
    """

    folder: Path = Path()

    @property
    def path(self) -> Path:
        """Its GLB file."""
        return self.folder / f"{self.id}.glb"


def main() -> None:
    """Run a command of `cutcell` that knows the figure."""
    folder = Path(sys.argv.pop(1))
    small = Small("small", "Small", "", folder)
    cutcell_assets.DEMOS = (*cutcell_assets.DEMOS, small)
    from cutcell.cli.app import main

    main()


if __name__ == "__main__":
    main()
