"""Demo characters, each with a skeleton, reference weights and a short clip.

The GLB files beside this one are made by `python -m cutcell_assets`; importing this module only
names them.
"""

from dataclasses import dataclass
from pathlib import Path

_FOLDER = Path(__file__).parent


@dataclass(frozen=True)
class Demo:
    """A character to show.

    Parameters
    ----------
    id : str
        Short name; the file is `<id>.glb`.
    title : str
        What a menu shows.
    lesson : str
        One line: what to look at, and why this character is here.
    """

    id: str
    title: str
    lesson: str

    @property
    def path(self) -> Path:
        """Where its GLB file lies."""
        return _FOLDER / f"{self.id}.glb"


DEMOS: tuple[Demo, ...] = (
    Demo(
        "biped",
        "Walker",
        "Hands hang a finger's breadth from the hips: near in space, far through the body.",
    ),
    Demo(
        "rabbit",
        "Rabbit",
        "Long ears lie along the back without touching it; its weights must not leak across.",
    ),
    Demo(
        "octopus",
        "Octopus",
        "Eight curling arms come close to each other, and distance has to follow the curls.",
    ),
    Demo(
        "robot",
        "Robot",
        "Separate rigid plates that overlap or float beside each other, and a ring around them.",
    ),
    Demo(
        "biped_soup",
        "Walker, unwelded and torn",
        "The walker as a poor export leaves it; the volume is still there.",
    ),
    Demo(
        "biped_flipped_arm",
        "Walker, one arm inside out",
        "The walker as a careless export leaves it; it binds all the same.",
    ),
    Demo(
        "biped_cape",
        "Walker in a cape",
        "A thin sheet hangs behind the walker, and has to move with it.",
    ),
)
"""All demo characters in the order to show them; the first one greets the user."""


def demo_path(id: str) -> Path:
    """Return the GLB file of one demo character.

    Parameters
    ----------
    id : str
        The `Demo.id` of one of `DEMOS`.

    Raises
    ------
    KeyError
        No demo has that name.
    """
    for demo in DEMOS:
        if demo.id == id:
            return demo.path
    names = ", ".join(demo.id for demo in DEMOS)
    raise KeyError(f"no demo character is called {id!r}; there are {names}")
