"""Record of a panel: its title, and what can be done on it."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Panel:
    """A panel of the page, registered by the name of its folder in `features/__init__.py`.

    Parameters
    ----------
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

    title: str
    icon: str
    poses: bool = False
    cuts: bool = False
    paints: bool = False
    works_without_skeleton: bool = False
    is_rendered: bool = True
    needs_audit: bool = False
