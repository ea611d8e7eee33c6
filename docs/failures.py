"""Twelve characters on which weights fail, or would fail without a repair, each with its cause."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from failing_characters import (
    bone_outside,
    bottle,
    crossing,
    demo,
    far_part,
    fingers,
    flipped_patch,
    other_units,
    ring,
    torn,
)

from cutcell import Rig


@dataclass(frozen=True)
class Failure:
    """A character, and why its weights fail.

    Parameters
    ----------
    id, title : str
    cause : str
        One sentence.
    remedy : str
        One sentence: what cutcell does, or what a person can do.
    make : callable
    finding : str
        Code of the finding by which `cutcell.diagnose` reports the cause; empty for none.
    view, bone : str
        What is shown at first; without a bone, all of them.
    method : dict
        Options of `cutcell.Method`.
    """

    id: str
    title: str
    cause: str
    remedy: str
    make: Callable[[], Rig]
    finding: str
    view: str
    bone: str
    method: dict[str, Any] = field(default_factory=dict)


FAILURES = (
    Failure(
        "cape",
        "A cape",
        "The cape is one sheet of cloth that touches nothing, so no path through the body"
        " reaches it.",
        "Its vertices follow the three nearest bones in a straight line, and a warning says so.",
        demo("biped_cape"),
        "unreachable-vertices",
        "distance",
        "spine2",
    ),
    Failure(
        "ring",
        "A ring",
        "The ring floats around the forearm, and no edge of the graph leads across the gap.",
        "A small loose part follows one bone as a rigid body.",
        ring,
        "unreachable-vertices",
        "weights",
        "left_arm_2",
    ),
    Failure(
        "soup",
        "A triangle soup",
        "Each triangle has its own three corners and some are missing, so paths on the surface end"
        " at every edge.",
        "Corners at one position count as one, and the paths run through the body.",
        demo("biped_soup"),
        "unwelded-vertices",
        "distance",
        "hand.L",
    ),
    Failure(
        "inside-out-arm",
        "An arm inside out",
        "The triangles of the right arm face inward, so the winding number inside is −1 and the arm"
        " counts as empty.",
        "cutcell flips such faces by default, which is switched off on this page.",
        demo("biped_flipped_arm"),
        "inverted-faces",
        "graph",
        "forearm.R",
        {"orient": False},
    ),
    Failure(
        "flipped-patch",
        "A flipped patch",
        "A patch of the belly faces inward, so the winding number behind it falls below one half.",
        "cutcell flips such patches by default, which is switched off on this page.",
        flipped_patch,
        "inverted-faces",
        "graph",
        "spine",
        {"orient": False},
    ),
    Failure(
        "thin-shell",
        "A thin shell",
        "The bottle is a thin wall around a cavity, so its bones are outside the solid and few"
        " lattice points are inside.",
        "cutcell fills such cavities by default, which connectivity 6 on this page leaves empty.",
        bottle,
        "hollow-body",
        "graph",
        "spine_3",
        {"connectivity": 6},
    ),
    Failure(
        "crossing-limbs",
        "Crossing limbs",
        "The hand is inside the thigh at rest, so paths leave the arm where the two volumes"
        " overlap.",
        "Move the arm away from the body in the rest pose, and bind again.",
        crossing,
        "self-intersections",
        "distance",
        "left_arm_3",
    ),
    Failure(
        "torn-mesh",
        "A torn mesh",
        "The faces of the back are missing, and near a hole this large the winding number falls"
        " below one half.",
        "The rest of the body stays connected, and a lower threshold τ fills more of it.",
        torn,
        "rims",
        "graph",
        "spine",
    ),
    Failure(
        "far-part",
        "A part far away",
        "A ball lies five sizes away from the figure, so most cells of the lattice are air and the"
        " rest are too coarse for the limbs.",
        "Delete the ball, or move it to the figure.",
        far_part,
        "stray-vertices",
        "graph",
        "chest",
    ),
    Failure(
        "two-bodies-close",
        "Two fingers that nearly touch",
        "The tips are two thousandths apart, far less than a cell, and a method that fills cells"
        " joins them.",
        "Rays cross both surfaces, so cutcell keeps the tips apart.",
        fingers,
        "",
        "distance",
        "left_3",
    ),
    Failure(
        "bone-outside",
        "A bone outside",
        "The left elbow is in front of the body, so other bones are nearer to all of the skin and"
        " its bone gets no weight.",
        "A warning names the joint: move it back into the arm.",
        bone_outside,
        "joints-outside",
        "weights",
        "left_arm_2",
    ),
    Failure(
        "other-units",
        "A skeleton in other units",
        "The skeleton is in centimetres and the mesh in inches, so the legs' bones are in the"
        " chest.",
        "Scale one of them: the check lists each joint that is outside.",
        other_units,
        "joints-outside",
        "weights",
        "",
    ),
)
"""In the order of the page."""
