"""The panels of the page: what each is called, and what can be done on it."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Panel:
    """A panel; its scene is `ID` of `scenes/ID.py`, its controls are `ID` of `panels/ID.py`.

    Parameters
    ----------
    id : str
        Its name in the state, in the address and on the command line.
    title : str
        One word.
    icon : str
        Content of an SVG of 24 by 24 units; it is drawn as lines, in the text's colour.
    poses : bool
        Whether the character moves here; on all others it rests.
    cuts : bool
        Whether the character can be cut.
    paints : bool
        Whether the brush works here.
    works_without_skeleton : bool
    is_rendered : bool
        Whether `cutcell render` draws it.
    needs_audit : bool
        Whether it is offered for an audit alone.
    """

    id: str
    title: str
    icon: str
    poses: bool = False
    cuts: bool = False
    paints: bool = False
    works_without_skeleton: bool = False
    is_rendered: bool = True
    needs_audit: bool = False


_PANELS = (
    Panel(
        "graph",
        "Graph",
        '<path d="M12 3l8 4.5v9L12 21l-8-4.5v-9z"/><path d="M4 7.5l8 4.5 8-4.5M12 12v9"/>',
        cuts=True,
        works_without_skeleton=True,
    ),
    Panel(
        "distance",
        "Distance",
        '<circle cx="5" cy="19" r="1.6"/><path d="M5 13a6 6 0 0 1 6 6M5 8.5A10.5 10.5 0 0 1 '
        '15.5 19M5 4a15 15 0 0 1 15 15"/>',
        cuts=True,
    ),
    Panel(
        "weights",
        "Weights",
        '<circle cx="12" cy="12" r="8.5"/><path d="M12 3.5v17M12 7.5h7M12 12h8.5M12 16.5h7"/>',
        paints=True,
    ),
    Panel(
        "pose",
        "Pose",
        '<circle cx="13" cy="4.5" r="2"/><path d="M13 7.5l-2 6 3.5 2.5 1 5M11 13.5L8 21M5 11.5l'
        '3.5-3L13 8l3 3.5 3.5.5"/>',
        poses=True,
        paints=True,
    ),
    Panel(
        "compare",
        "Compare",
        '<path d="M4 5h6v14H4zM14 5h6v14h-6zM12 2.5v19"/>',
        poses=True,
    ),
    Panel(
        "check",
        "Check",
        '<path d="M2.5 12.5h4l2.5-6 4 12 3-9 1.5 3h4"/>',
        works_without_skeleton=True,
    ),
    Panel(
        "learn",
        "Learn",
        '<path d="M2.5 9.5L12 5l9.5 4.5L12 14z"/>'
        '<path d="M6.5 11.5v5c3 2.6 8 2.6 11 0v-5M21.5 9.5v6"/>',
        works_without_skeleton=True,
        is_rendered=False,
    ),
    Panel(
        "pairs",
        "Pairs",
        '<circle cx="7.5" cy="6" r="2.2"/><path d="M7.5 9v6M4 12h7M7.5 15l-2.5 5M7.5 15l2.5 5"/>'
        '<circle cx="16.5" cy="6" r="2.2"/><path d="M16.5 9v6M13 12h7M16.5 15l-2.5 5M16.5 15l2.5 '
        '5"/>',
        is_rendered=False,
        needs_audit=True,
    ),
)
"""In the order in which they are offered."""

PANELS = {panel.id: panel for panel in _PANELS}
