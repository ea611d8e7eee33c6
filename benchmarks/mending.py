"""Mend damaged characters on the page, by clicks and keys, and compare with the undamaged weights.

python -m benchmarks.mending [--only 'leak;noise'] [--write]

The page begins with the damaged file, and ends with *Export GLB*. A click, a key, a text that is
typed and an option of a menu count as one action each, and the export as well. Ends with exit
code 1 if a character needs more than ten, keeps more than a tenth of its error, or differs in the
bytes of a vertex that was not damaged. `--write` puts the table into docs/page/check.md.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from playwright.sync_api import Browser, Error, sync_playwright

import cutcell
from cutcell import Rig
from cutcell_lab.benchmarks.document import fill
from cutcell_lab.benchmarks.rigs import ROOT
from cutcell_lab.benchmarks.tables import Table
from cutcell_lab.metrics import deformation_error
from scripts.get_chromium import FLAGS, find
from tests.app.browser import Visit, served

from .damage import DAMAGES, Damage, Weights, changed_bytes, write_damaged
from .hands import Hands

DOCUMENT = ROOT / "docs" / "page" / "check.md"
FIRST = ROOT / "assets" / "robot.glb"
ADDRESS = "/?resolution=32&graph_resolution=0"
"""A file opens with its own weights: coarse computed ones are soon there."""
PIXELS = 0.2
"""Pixels of the canvas to one of the page: nothing is done in the scene."""
MAX_ACTIONS = 10
MAX_LEFT = 0.1
"""Part of the error that may be left."""


def _attach_by_finding(hands: Hands, joint: str) -> None:
    """Attach the part that Check finds far from its joint to the nearest joint."""
    hands.panel("Check")
    hands.press("Parts that follow a far joint")
    hands.press(re.compile(f"^Part \\d+: rigid to {joint}"))


def _bind_part(hands: Hands, words: Sequence[str], way: str, joint: str | None = None) -> None:
    """Choose a part of the mesh, and bind it in another way."""
    hands.panel("Weights")
    hands.section("Parts of the mesh")
    hands.part(*words)
    hands.choose("Bind this part", way)
    if joint is not None:
        hands.choose("Joint", joint)


def _change_selection(hands: Hands, bone: str, selection: str, change: str) -> None:
    """Select vertices by a bone, and change their weights."""
    hands.panel("Weights")
    hands.choose("Bone", bone)
    hands.section("Selection")
    hands.menu("Select by", selection)
    hands.menu("Change weights", change)


def _remove_leak(hands: Hands) -> None:
    """Remove the weight of the hand from the thigh; the others share it as before."""
    hands.panel("Weights")
    hands.choose("Bone", "Hand.L")
    hands.section("Selection")
    hands.type("Vertices where", 'weight of "Hand.L" > 0 and weight of "UpperLeg.L" > 0')
    hands.key("Amount", "Home")
    hands.menu("Change weights", "Fill with amount")


def _exchange_by_finding(hands: Hands, title: str) -> None:
    """Exchange the weights that Check finds at other joints."""
    hands.panel("Check")
    hands.press(title)
    hands.press("Exchange these weights")


def _exchange_by_table(hands: Hands, table: str) -> None:
    """Exchange bones by a table of their names."""
    hands.panel("Weights")
    hands.section("Swap and replace bones")
    hands.type("Replace by table", table)


def _transfer(hands: Hands, selection: str) -> None:
    """Give vertices the weights of the rest of the character."""
    hands.panel("Weights")
    hands.section("Selection")
    hands.type("Vertices where", selection)
    hands.menu("Change weights", "Transfer from the rest")


def _mirror_by_mask(hands: Hands, layer: str) -> None:
    """Put a layer of the other side over the noise that Check finds, and grow its mask."""
    hands.panel("Check")
    hands.press("Noisy weights")
    hands.press("Select its vertices")
    hands.panel("Weights")
    hands.section("Layers")
    hands.menu("Add layer", layer)
    hands.menu("Mask", "Grow")


REPAIRS: dict[str, Callable[[Hands], None]] = {
    "leak": _remove_leak,
    "lost island": lambda hands: _attach_by_finding(hands, "toeFBXASC046L"),
    "noise": lambda hands: _change_selection(
        hands, "FrontLowerLeg.L", "Vertices of the bone", "Take the right side"
    ),
    "wrong eye": lambda hands: _attach_by_finding(hands, "Head"),
    "coat": lambda hands: _transfer(hands, "part = 1"),
    "trident": lambda hands: _attach_by_finding(hands, "Prop1"),
    "fingers": lambda hands: _exchange_by_finding(hands, "Exchanged joints"),
    "fingers, by names": lambda hands: _exchange_by_table(hands, "index-* <-> middle-*"),
    "other side": lambda hands: _exchange_by_finding(hands, "Skin that follows the other side"),
    "cape": lambda hands: _bind_part(hands, ["Knight_Cape"], "Rigid, to one joint", "chest"),
    "blade": lambda hands: _bind_part(
        hands, ["Knife", "upperleg.r"], "With the body it touches"
    ),
    "mirrored names": lambda hands: _change_selection(
        hands, "wing_1_L", "All", "Swap left and right"
    ),
    "finger": lambda hands: _change_selection(
        hands, "hand.l", "Bone and its children", "Take the right side"
    ),
    "twist": lambda hands: _change_selection(
        hands, "thigh_twist.l", "Vertices of the bone", "Take the right side"
    ),
    "twist, by mask": lambda hands: _mirror_by_mask(hands, "Right side on both"),
}  # fmt: skip
"""What a person does for each kind of damage, which the name begins with."""


def damage_of(name: str) -> Damage:
    """Return the damage that a repair mends."""
    return DAMAGES[name.partition(",")[0]]


@dataclass(frozen=True)
class Mended:
    """A character that was mended.

    Parameters
    ----------
    name : str
        Of its damage.
    character : str
    damaged : int
        Vertices that were damaged.
    actions : int
    l1, deformation : pair of float
        Mean errors of the damaged vertices to their undamaged weights, before and after: L1, and
        the deformation error in cm², the longest side being 1 m.
    outside : int
        Vertices outside the damage that are stored in other bytes.
    """

    name: str
    character: str
    damaged: int
    actions: int
    l1: tuple[float, float]
    deformation: tuple[float, float]
    outside: int

    @property
    def is_mended(self) -> bool:
        """Whether it took few actions, the error is small, and the rest is the same."""
        few = all(after <= MAX_LEFT * before for before, after in (self.l1, self.deformation))
        return few and self.actions <= MAX_ACTIONS and not self.outside


def mend(browser: Browser, url: str, name: str, folder: Path) -> Mended:
    """Damage a character, mend it on the page, and compare its export with the undamaged one."""
    damage = damage_of(name)
    rig, path, exported = damage.load(), folder / "damaged.glb", folder / "mended.glb"
    which = write_damaged(damage, rig, path)
    visit = Visit(browser, url + ADDRESS, device_scale_factor=PIXELS)
    try:
        visit.open(path)
        hands = Hands(visit)
        REPAIRS[name](hands)
        hands.export(exported)
    except Error:
        visit.page.screenshot(path=Path(tempfile.gettempdir(), "not-mended.png"))
        raise
    finally:
        visit.context.close()
    return compare(name, damage, rig, which, hands.actions, (path, exported))


def compare(
    name: str,
    damage: Damage,
    rig: Rig,
    which: np.ndarray,
    actions: int,
    files: tuple[Path, Path],
) -> Mended:
    """Compare a damaged and a mended file with the undamaged weights."""
    before, after = (cutcell.load(path) for path in files)
    changed = changed_bytes(before, after)
    changed[which] = False
    errors = [_errors(rig, one.weights, which) for one in (before, after)]
    l1, deformation = ((errors[0][k], errors[1][k]) for k in (0, 1))
    return Mended(name, damage.file.stem, len(which), actions, l1, deformation, int(changed.sum()))


def _errors(rig: Rig, weights: Weights | None, which: np.ndarray) -> tuple[float, float]:
    """Return L1 and deformation error to a rig's weights, over some vertices."""
    assert weights is not None
    assert rig.weights is not None
    l1 = np.abs(weights - rig.weights)[which].sum(axis=1).mean()
    vertex = deformation_error(rig, weights, rig.weights, joints="all").vertex
    return float(l1), float(vertex[which].mean())


def table_of(results: Sequence[Mended]) -> Table:
    """Return a table of what was mended."""
    table = Table(
        "Damage mended on the page",
        ["damage", "character", "damaged vertices", "actions", "L1", "deformation error",
         "other vertices changed"],
        "Errors to the undamaged weights, before → after, over the damaged vertices. The "
        "deformation error is in cm², the longest side being 1 m. The export counts as an action.",
    )  # fmt: skip
    for one in results:
        errors = (f"{a:.3g} → {b:.2g}" for a, b in (one.l1, one.deformation))
        table.add(one.name, one.character, f"{one.damaged:,}", one.actions, *errors, one.outside)
    return table


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.mending", description=__doc__)
    parser.add_argument("--only", default=";".join(REPAIRS), help="kinds of damage")
    parser.add_argument("--write", action="store_true", help="into docs/page/check.md")
    return parser.parse_args(argv)


def main(argv: Sequence[str] | None = None) -> None:
    """Mend characters and print a table."""
    options = arguments(argv)
    results, chromium = [], find()
    with (
        served(str(FIRST)) as url,
        sync_playwright() as playwright,
        tempfile.TemporaryDirectory() as folder,
    ):
        browser = playwright.chromium.launch(executable_path=chromium, args=list(FLAGS))
        for name in options.only.split(";"):
            results.append(mend(browser, url, name, Path(folder)))
            print(results[-1], flush=True)
        browser.close()
    text = table_of(results).markdown()
    print("", text, sep="\n")
    if options.write:
        fill(DOCUMENT, {"mending": text})
    failed = [one.name for one in results if not one.is_mended]
    if failed:
        sys.exit(f"not mended: {', '.join(failed)}")


if __name__ == "__main__":
    main()
