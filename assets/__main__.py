"""Make all demo characters again: `python -m cutcell_assets`, or only some: `... robot rabbit`."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

from . import DEMOS, demo_path, glb
from .character import Character


def make(id: str) -> Character:
    """Return one demo character, made from nothing."""
    return _makers()[id]()


def main(ids: list[str]) -> int:
    """Write the GLB files of the characters named, or of all; return the exit code."""
    all_ids = [demo.id for demo in DEMOS]
    unknown = [id for id in ids if id not in all_ids]
    if unknown:
        print(f"no demo character is called {unknown[0]!r}; there are {', '.join(all_ids)}")
        return 2
    for id in ids or all_ids:
        start = time.perf_counter()
        glb.save(demo_path(id), make(id))
        size = demo_path(id).stat().st_size / 1e6
        print(f"{id}.glb: {size:.2f} MB in {time.perf_counter() - start:.0f} s")
    return 0


def _makers() -> dict[str, Callable[[], Character]]:
    # Here and not above: these need scikit-image, and take a moment to load.
    from . import make_biped, make_broken, make_octopus, make_rabbit, make_robot

    return {
        "biped": make_biped.make,
        "rabbit": make_rabbit.make,
        "octopus": make_octopus.make,
        "robot": make_robot.make,
        "biped_soup": lambda: make_broken.torn(make_biped.make(detail=make_broken.COARSE)),
        "biped_flipped_arm": lambda: make_broken.flipped_arm(make_biped.make()),
        "biped_cape": lambda: make_broken.caped(make_biped.make()),
    }


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
