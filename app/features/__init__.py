"""The features of the page, a folder each.

`choices.py` has the class `Choices`, a part of the state, and for a panel its record `PANEL`;
`scene.py` has `scene(state, memo)`, and `controls.py` has `CONTROLS`.
"""

FEATURES = (
    "graph",
    "distance",
    "weights",
    "correct",
    "brush",
    "select",
    "pose",
    "symmetry",
    "compare",
    "disagreement",
    "lab",
    "check",
    "learn",
    "flat",
    "pairs",
)
"""In the order in which panels are offered."""
