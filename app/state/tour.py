"""The guided tour: what each step says, and what the page shows meanwhile."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

Angles = tuple[float, float, float]


@dataclass(frozen=True)
class Look:
    """What the page shows during a step.

    Parameters
    ----------
    panel : str
    bone : str
    focus : str
        The joint that the camera looks at; the whole character without one.
    near : float
        How near: 1 sees the whole, 0.3 a third of it.
    angles : tuple of float
        Degrees: around the character, and from above.
    turns : dict
        Degrees about x, y and z by which joints are turned.
    clicked : str
        A vertex is clicked: the one nearest to the bone, of those that follow this joint.
    demo : str
    choices : dict
        What else is chosen, beside what one begins with.
    """

    panel: str
    bone: str
    focus: str = ""
    near: float = 1.0
    angles: tuple[float, float] = (22.0, 9.0)
    turns: dict[str, Angles] = field(default_factory=dict)
    clicked: str = ""
    demo: str = "biped"
    choices: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Offer:
    """A button on a step's card.

    Parameters
    ----------
    label : str
    choices : dict
        What it chooses.
    """

    label: str
    choices: dict[str, Any]


@dataclass(frozen=True)
class Step:
    """One step of the tour.

    Parameters
    ----------
    title : str
    text : str
        Two or three short paragraphs, parted by empty lines.
    formula : str
        In TeX; empty for none.
    task : str
        What to look at, or to try, in one sentence.
    look : Look
    offers : tuple of Offer
        What the card itself changes, so that nobody is sent to look for a control.
    """

    title: str
    text: str
    formula: str
    task: str
    look: Look
    offers: tuple[Offer, ...] = ()


CUT = {"cut_axis": "z", "cut_position": 0.5, "skeleton": False}
"""Through the middle of the body, seen from its front, with no bones before it."""


TOUR = (
    Step(
        "A skin on bones",
        "A character on a screen is a skin of triangles. To move it, one puts a skeleton inside: "
        "bones that meet in joints. An animator turns the joints, never the thousands of points "
        "of the skin.\n\n"
        "So every point of the skin must know which bones it goes along with, and how much. These "
        "shares are its weights. They add up to one, and the point goes where the bones take it, "
        "each by its share.",
        r"v' = \sum_j w_j\, T_j\, v \qquad \sum_j w_j = 1",
        "The walk moves the bones; the weights that were just computed move the skin.",
        Look("pose", bone="upper_arm.L", choices={"moving": True, "playing": True}),
    ),
    Step(
        "One bone's share",
        "Here are the weights of one bone, the left upper arm. Where the skin glows it follows "
        "this bone alone; where it is grey it does not care.\n\n"
        "What matters lies between: around the elbow and the shoulder two bones share the skin, "
        "and it bends smoothly. Where nothing is shared it would break like a hinge; where too "
        "much is shared it turns to rubber.",
        r"0 \le w_j(v) \le 1",
        "Press → to go from bone to bone.",
        Look(
            "weights",
            bone="upper_arm.L",
            focus="upper_arm.L",
            near=0.42,
            choices={"weights_shown": "bone"},
        ),
    ),
    Step(
        "Near is not the same as together",
        "The simplest thought: a point belongs to the bones that are near. But look at the hand. "
        "It hangs a finger's breadth from the hip; in a straight line the thigh is about as near "
        "to the hand's bone as the hand's own fingertips.\n\n"
        "Now the arm is lifted. With straight distances the hand pulls the trousers along: its "
        "weights have leaked across the gap of air.",
        r"\|v - b\|_2 \;\text{ sees no air}",
        "On the left by straight distance, on the right through the body, as the next step tells. "
        "The colours are the hand's weights: they should end at the wrist.",
        Look(
            "compare",
            bone="hand.L",
            focus="forearm.L",
            turns={"upper_arm.L": (0, 0, 45)},
            choices={"methods": ["euclidean", "now"], "skeleton": False},
        ),
    ),
    Step(
        "Through the body",
        "So we measure the way an ant would have to go that may walk inside the body but not "
        "through the air: from the hand up the arm, over the shoulder, down to the hip. That is "
        "the geodesic distance.\n\n"
        "In a straight line the thigh is 4 cm from the hand's bone, when the character is one "
        "metre tall. Through the body it is 37 cm. Lines of equal distance are "
        "drawn; where the colour jumps from the hand to the hip, air lies between.",
        r"d(v, b) = \min_{\gamma: b \to v,\ \gamma \subset \text{body}} \text{length}(\gamma)",
        "Follow the red line: it is the shortest way from the thigh to the hand. Click any other "
        "place to see its way.",
        Look(
            "geodesics",
            bone="hand.L",
            focus="forearm.L",
            near=0.5,
            angles=(6.0, 6.0),
            clicked="thigh.L",
            choices={**CUT, "cut_position": 0.52},
        ),
    ),
    Step(
        "A graph to walk on",
        "A computer needs a map of the ways. We shoot rays through the body, along three axes, a "
        "lattice of them. Each ray is cut by the skin into pieces, some inside and some outside. "
        "The pieces inside become streets of the map.\n\n"
        "Where a ray meets the skin, the crossing is tied to the corners of the triangle it hit. "
        "So every point of the skin is on the map: blue streets follow the skin, orange ones run "
        "inside, green ones tie both together.",
        r"G = \underbrace{E_{\text{mesh}}}_{\text{blue}} \cup "
        r"\underbrace{E_{\text{inside}}}_{\text{orange}} \cup "
        r"\underbrace{E_{\text{surface}}}_{\text{green}}",
        "Go through the body, from its back to its front.",
        Look(
            "graph",
            bone="chest",
            focus="upper_arm.L",
            near=0.24,
            angles=(14.0, 10.0),
            choices={**CUT, "mesh_edges": True, "surface_edges": True, "resolution": 40},
        ),
        tuple(
            Offer(label, {"cut_axis": "z", "cut_position": at})
            for label, at in (("Back", 0.35), ("Middle", 0.5), ("Front", 0.65))
        ),
    ),
    Step(
        "How fine a map",
        "R says how many cells of the lattice lie along the longest side. With few cells the map "
        "is quick to draw, but thin parts have no street inside: at R = 20 a cell is as wide as "
        "three fingers, and fingers are left to the streets on their skin.\n\n"
        "Twice as many cells show twice as fine details, and there are eight times as many of "
        "them. R = 64 does for most characters.",
        r"h = \frac{\text{longest side}}{R} \qquad \text{cells} \propto R^3",
        "Not one orange street leads into the fingers. Choose more cells, and watch them fill.",
        Look(
            "graph",
            bone="hand.L",
            focus="hand.L",
            near=0.26,
            angles=(10.0, 4.0),
            choices={"resolution": 20, "skeleton": False, "mesh_edges": True},
        ),
        tuple(Offer(f"R = {cells}", {"resolution": cells}) for cells in (20, 64, 128)),
    ),
    Step(
        "Diamonds and circles",
        "Who may walk along the axes alone goes round corners, as in a city of blocks: one step "
        "right and one up are two, where the crow flies 1.41. Places equally far from a bone "
        "then form diamonds, and that does not get better with more streets.\n\n"
        "So the default lets the way run straight as far as it can see, at any angle. Equal "
        "distances become round, as they are in truth.",
        r"\|x\|_1 = |x_1| + |x_2| + |x_3| \;\ge\; \|x\|_2",
        "Here only axes are allowed. Allow any angle, and see the diamonds become round.",
        Look(
            "geodesics",
            bone="spine2",
            focus="spine2",
            near=0.36,
            angles=(0.0, 4.0),
            choices={**CUT, "connectivity": 6},
        ),
        (
            Offer("Axes only", {"connectivity": 6}),
            Offer("Diagonals", {"connectivity": 26}),
            Offer("Any angle", {"connectivity": "any"}),
        ),
    ),
    Step(
        "From distance to weight",
        "Near bones shall count much, far ones little. The paper turns the distance d, measured "
        "by the body's diagonal D, into a weight by this formula, and divides by the sum over all "
        "bones.\n\n"
        "α says how steep it falls: at 0 like 1/d², at 1 like 1/d⁴. Steep is stiff, each bone "
        "keeps to its own; flat is soft, and far bones have a say.",
        r"w = \left(\frac{1}{(1-\alpha)\,\frac{d}{D} + \alpha\,(\frac{d}{D})^2}\right)^{2}",
        "Even the far head is tinged. Choose another α: no distance is measured again.",
        Look(
            "weights",
            bone="chest",
            focus="chest",
            near=0.6,
            choices={"weights_shown": "bone", "falloff": "paper", "alpha": 0.5},
        ),
        tuple(
            Offer(f"α = {alpha:g}", {"falloff": "paper", "alpha": alpha})
            for alpha in (0.0, 0.5, 1.0)
        ),
    ),
    Step(
        "Why this one failed: inside out",
        "How does a ray know that it is inside? It asks for the winding number: how often the "
        "skin wraps around a point, counted with a sign. It is 1 inside and 0 outside; what has "
        "at least τ = ½ is kept.\n\n"
        "On this twin the triangles of the right arm face inwards. The skin wraps the other way "
        "round and the number is −1: for the map the arm is hollow. It has no orange streets, "
        "and its distances creep along the skin. So faces whose back is what one sees from outside "
        "are turned round first; here they are not.",
        r"w(p) = \frac{1}{4\pi}\sum_{t} \Omega_t(p) \;\ge\; \tau",
        "Compare the two arms in the cut. Then turn the inverted faces round: the arm fills.",
        Look(
            "graph",
            bone="forearm.R",
            focus="spine2",
            near=0.5,
            angles=(4.0, 6.0),
            demo="biped_flipped_arm",
            choices={**CUT, "orient": False},
        ),
        (
            Offer("As they are", {"orient": False}),
            Offer("Turn them round", {"orient": True}),
        ),
    ),
    Step(
        "Why this one fails: no way in",
        "The cape is a single sheet of cloth that touches nothing. It has no inside, and no "
        "street leads to it: its distance from every bone is infinite.\n\n"
        "The page says so instead of guessing in silence, and lets these points follow the three "
        "bones that are nearest in a straight line. For a cape on a back that looks fair; for a "
        "coat between two legs it would leak again.",
        r"d(v, b) = \infty \;\Rightarrow\; \|v - b\|_2 \text{ of 3 bones}",
        "Turn the character, and see from which bones the cape takes its colours.",
        Look("weights", bone="spine2", angles=(152.0, 12.0), demo="biped_cape"),
    ),
    Step(
        "Torn, and still whole",
        "This twin has a vertex of its own for every corner, and holes: no triangle knows its "
        "neighbour. Methods that walk on the skin cannot take a step here, and those that fill "
        "it with tetrahedra refuse.\n\n"
        "The map does not mind. Corners at one place count as one, and the winding number only "
        "sinks a little near a hole: just inside it is still more than ½. The body is there, so "
        "the weights are.",
        r"w(p) \approx 1 - \frac{\Omega_{\text{hole}}(p)}{4\pi} \;>\; \tfrac12",
        "That was the tour. Drop a character of your own, and see what it says.",
        Look("weights", bone="spine2", focus="chest", near=0.6, demo="biped_soup"),
    ),
)
"""In the order in which they are told."""
