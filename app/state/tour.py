"""The guided tour: the text of each step, and the scene that it sets."""

from dataclasses import dataclass, field
from typing import Any

Angles = tuple[float, float, float]


@dataclass(frozen=True)
class Look:
    """The scene of a step.

    Parameters
    ----------
    panel : str
    bone : str
    focus : str
        The joint at the centre of the view; empty for the whole character.
    near : float
        Distance of the camera: 1 fits the whole character, 0.3 a third of it.
    angles : tuple of float
        Degrees: around the character, and from above.
    turns : dict
        Degrees about x, y and z by which joints are turned.
    clicked : str
        Joint of the clicked vertex: the vertex nearest to the bone that follows this joint.
    demo : str
    choices : dict
        Parameters of the state that differ from their defaults.
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
        Parameters of the state that it sets.
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
        Two short paragraphs, separated by an empty line.
    formula : str
        In TeX; empty for none.
    task : str
        What to look at or to try.
    look : Look
    offers : tuple of Offer
        Buttons on the card, so that the step needs no control of the sidebar.
    """

    title: str
    text: str
    formula: str
    task: str
    look: Look
    offers: tuple[Offer, ...] = ()


CUT = {"cut_axis": "z", "cut_position": 0.5, "skeleton": False}
"""Through the middle of the body, seen from its front, without bones in front of it."""


EDGES = {"slicing": False, "mesh_edges": False, "interior_edges": False, "surface_edges": False}
INTERIOR = {**EDGES, "interior_edges": True, "nodes": False}

TOUR = (
    Step(
        "Skin follows bones",
        "A character on a screen is a skin of triangles. To move it, we put a skeleton inside: "
        "bones that meet in joints. An animator rotates the joints, never the thousands of points "
        "of the skin.\n\n"
        "So every point of the skin needs to know which bones it follows, and how strongly. "
        "These shares are its weights. They add up to one, and the point moves to the weighted "
        "mean of where the bones would take it.",
        r"v' = \sum_j w_j\, T_j\, v \qquad \sum_j w_j = 1",
        "The walk moves the bones. The weights, computed a moment ago, move the skin.",
        Look("pose", bone="upper_arm.L", choices={"moving": True, "playing": True}),
    ),
    Step(
        "The weights of one bone",
        "These are the weights of the left upper arm. Bright skin follows this bone alone; grey "
        "skin ignores it.\n\n"
        "The transition matters most. Around the elbow and the shoulder two bones share the skin, "
        "and it bends smoothly. With no transition it breaks like a hinge; with too wide a "
        "transition it turns to rubber.",
        r"0 \le w_j(v) \le 1",
        "Click another bone, or press → for the next one.",
        Look(
            "weights",
            bone="upper_arm.L",
            focus="upper_arm.L",
            near=0.42,
            choices={"weights_shown": "bone"},
        ),
    ),
    Step(
        "Close is not connected",
        "The simplest idea: a point follows whichever bones are nearest. But look at the hand. "
        "It almost touches the hip; in a straight line, the thigh is about as close to the hand's "
        "bone as the hand's own fingertips.\n\n"
        "Now the arm is raised. With straight-line distances the hand pulls the trousers along: "
        "its weights have leaked across the gap of air.",
        r"\|v - b\|_2 \;\text{ cuts through the air}",
        "Left: straight-line distance. Right: distance through the body, with the same falloff. "
        "The colours are the hand's weights. They should end at the wrist.",
        Look(
            "compare",
            bone="hand.L",
            focus="forearm.L",
            turns={"upper_arm.L": (0, 0, 45)},
            choices={"methods": ["euclidean", "cutcell_any"], "skeleton": False},
        ),
    ),
    Step(
        "Through the body",
        "So we measure the path of an ant that can burrow through the body but cannot cross the "
        "air: from the hand up the arm, over the shoulder, down to the hip. Its length is the "
        "geodesic distance.\n\n"
        "On a character one metre tall, the thigh is 4 cm from the hand's bone in a straight "
        "line, and 37 cm through the body. The lines mark equal distances. Where the colour jumps "
        "from the hand to the hip, there is air in between.",
        r"d(v, b) = \min_{\gamma: b \to v,\ \gamma \subset \text{body}} \text{length}(\gamma)",
        "Follow the red line, the shortest path from thigh to hand. Click anywhere to see another.",
        Look(
            "distance",
            bone="hand.L",
            focus="forearm.L",
            near=0.5,
            angles=(6.0, 6.0),
            clicked="thigh.L",
            choices={**CUT, "cut_position": 0.52, "starts": True},
        ),
    ),
    Step(
        "Rays find the inside",
        "A computer needs a map of the body. We shoot a lattice of rays through it, along three "
        "axes. The skin cuts each ray into segments, some inside and some outside.\n\n"
        "The winding number decides: it counts how often the skin wraps around a point. A segment "
        "is kept if the number at its midpoint is at least τ = ½.",
        r"s \text{ is inside} \iff w(\text{midpoint of } s) \ge \tau",
        "One slice with its rays. Hover over a ray to read its winding number.",
        Look(
            "graph",
            bone="chest",
            focus="spine2",
            near=0.55,
            angles=(0.0, 2.0),
            choices={"slicing": True, "graph_resolution": 40, "skeleton": False},
        ),
    ),
    Step(
        "A graph of three kinds of edges",
        "The segments inside become the orange edges of a graph. The edges of the mesh are its "
        "blue edges: they follow the skin.\n\n"
        "Where a ray meets the skin, green edges connect the crossing to the three corners of the "
        "triangle. They connect both parts, so every vertex of the skin can be reached from "
        "inside.",
        r"G = \underbrace{E_{\text{mesh}}}_{\text{blue}} \cup "
        r"\underbrace{E_{\text{interior}}}_{\text{orange}} \cup "
        r"\underbrace{E_{\text{surface}}}_{\text{green}}",
        "Show one kind of edge at a time, then all of them.",
        Look(
            "graph",
            bone="chest",
            focus="upper_arm.L",
            near=0.24,
            angles=(14.0, 10.0),
            choices={**CUT, **EDGES, "interior_edges": True},
        ),
        (
            Offer("Mesh", {**EDGES, "mesh_edges": True}),
            Offer("Interior", {**EDGES, "interior_edges": True}),
            Offer("Surface", {**EDGES, "surface_edges": True}),
            Offer(
                "All",
                {**EDGES, "mesh_edges": True, "interior_edges": True, "surface_edges": True},
            ),
        ),
    ),
    Step(
        "How fine should the graph be?",
        "The resolution R is the number of lattice cells along the longest side. With few cells "
        "the graph is small, but thin parts have no edges inside: at R = 20 a cell is as wide as "
        "three fingers.\n\n"
        "Doubling R halves the smallest detail, at eight times the cells. R = 64 is enough for "
        "most characters.",
        r"h = \frac{\text{longest side}}{R} \qquad \text{cells} \propto R^3",
        "No orange edge leads into the fingers. Choose more cells and watch the fingers fill.",
        Look(
            "graph",
            bone="hand.L",
            focus="hand.L",
            near=0.26,
            angles=(10.0, 4.0),
            choices={**INTERIOR, "cut_axis": "off", "graph_resolution": 20, "skeleton": False},
        ),
        tuple(Offer(f"R = {cells}", {"graph_resolution": cells}) for cells in (20, 64, 128)),
    ),
    Step(
        "Sources on the bone",
        "Distances start at the bone. We take five samples along it, and each starts at its "
        "nearest nodes of the graph: the sources.\n\n"
        "A source is not exactly on the bone, so it does not start at zero. It starts at its own "
        "distance from the bone.",
        r"d(s) = \min_{x \in \text{bone}} \|s - x\|_2",
        "The dots on the bone are its samples and sources. Choose another bone in the list.",
        Look(
            "distance",
            bone="forearm.L",
            focus="forearm.L",
            near=0.3,
            angles=(6.0, 6.0),
            choices={**CUT, "cut_position": 0.52, "skeleton": True, "starts": True},
        ),
    ),
    Step(
        "Dijkstra's search",
        "From the sources the search spreads like a wave. It always continues at the node with "
        "the smallest distance so far, and updates the neighbours of that node.\n\n"
        "When a node's turn has come, no shorter path to it exists. One search for each bone gives "
        "the distance to every vertex.",
        r"d(v) \leftarrow \min\bigl(d(v),\ d(u) + \text{length}(u, v)\bigr)",
        "The wave runs from the hand. It passes the shoulder long before it reaches the thigh.",
        Look(
            "distance",
            bone="hand.L",
            focus="chest",
            near=0.8,
            angles=(6.0, 6.0),
            choices={**CUT, "cut_position": 0.52, "wave": True, "front": 0.0, "animating": True},
        ),
    ),
    Step(
        "Diamonds and circles",
        "If you may only walk along the axes, you go round every corner, as in Manhattan: one "
        "block right and one up make two, while a straight line is 1.41. Points at equal distance "
        "from a bone then form diamonds, and more cells do not help.\n\n"
        "So by default a path runs straight, at any angle, for as long as it stays inside. Equal "
        "distances become round, as they should be.",
        r"\|x\|_1 = |x_1| + |x_2| + |x_3| \;\ge\; \|x\|_2",
        "Only the axes are allowed now. Allow any angle and watch the diamonds become round.",
        Look(
            "distance",
            bone="spine2",
            focus="spine2",
            near=0.36,
            angles=(0.0, 4.0),
            choices={**CUT, "connectivity": 6, "starts": True},
        ),
        (
            Offer("Axes only", {"connectivity": 6}),
            Offer("Diagonals", {"connectivity": 26}),
            Offer("Any angle", {"connectivity": "any"}),
        ),
    ),
    Step(
        "From distance to weight",
        "Near bones should count a lot, far ones little. The paper divides the distance d by the "
        "diagonal D of the bounding box, turns it into a weight by this formula, and divides by "
        "the sum over all bones.\n\n"
        "α sets how fast weights fall: like 1/d² at 0, like 1/d⁴ at 1. The paper gives these soft "
        "weights to a network. The animation falloff, which cutcell uses by default, is much "
        "sharper.",
        r"w = \left(\frac{1}{(1-\alpha)\,\frac{d}{D} + \alpha\,(\frac{d}{D})^2}\right)^{2}",
        "Even the head, far away, gets some colour. Choose another α: distances stay the same.",
        Look(
            "weights",
            bone="chest",
            focus="chest",
            near=0.6,
            choices={"weights_shown": "bone", "falloff": "paper", "alpha": 0.5},
        ),
        (
            *(
                Offer(f"α = {alpha:g}", {"falloff": "paper", "alpha": alpha})
                for alpha in (0.0, 0.5, 1.0)
            ),
            Offer("Animation", {"falloff": "rig"}),
        ),
    ),
    Step(
        "When it fails: inside out",
        "The winding number counts how often the skin wraps around a point, with a sign. It is 1 "
        "inside and 0 outside.\n\n"
        "On this character, the triangles of the right arm face inward. The winding number there "
        "is −1, so the arm counts as hollow: it has no orange edges, and distances run along its "
        "skin. By default cutcell flips such faces first. Here that is switched off.",
        r"\begin{gathered} w(p) = \frac{1}{4\pi}\sum_{t} \Omega_t(p) \\ "
        r"\Omega_t: \text{solid angle of triangle } t \end{gathered}",
        "Compare the two arms in the cut. Then flip the inverted faces: the arm fills.",
        Look(
            "graph",
            bone="forearm.R",
            focus="spine2",
            near=0.5,
            angles=(4.0, 6.0),
            demo="biped_flipped_arm",
            choices={**CUT, **INTERIOR, "orient": False},
        ),
        (
            Offer("As in the file", {"orient": False}),
            Offer("Flipped", {"orient": True}),
        ),
    ),
    Step(
        "When it fails: no way in",
        "The cape is a single sheet of cloth that touches nothing. It has no inside, and no edge "
        "leads to it: its distance from every bone is infinite.\n\n"
        "The page reports this, and lets these vertices follow their three nearest bones in a "
        "straight line. That works for a cape on a back. A coat between two legs would leak again.",
        r"d(v, b) = \infty \;\Rightarrow\; \|v - b\|_2 \text{ of 3 bones}",
        "Orbit the character, and see which bones the cape takes its colours from.",
        Look("weights", bone="spine2", angles=(152.0, 12.0), demo="biped_cape"),
    ),
    Step(
        "Torn, but still whole",
        "In this file every triangle has its own corners, and there are holes: no triangle is "
        "connected to its neighbours. Methods that walk on the skin cannot take a step here, and "
        "most tetrahedral meshers fail.\n\n"
        "The graph copes. Corners at the same position count as one, and the winding number drops "
        "only a little near a hole: just inside it is still above ½.",
        r"w(p) \approx 1 - \frac{\Omega_{\text{hole}}(p)}{4\pi} \;>\; \tfrac12",
        "That was the tour. Now drop a character of your own.",
        Look("weights", bone="spine2", focus="chest", near=0.6, demo="biped_soup"),
    ),
)
"""In the order of the tour."""
