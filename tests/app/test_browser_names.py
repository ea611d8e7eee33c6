"""Names that a file may hold, on the page: text, whatever they look like."""

import numpy as np
import pytest

import cutcell
from cutcell.rig import Clip, Rig, Skeleton
from tests.viewers.arm import arm_rig

pytestmark = pytest.mark.slow

SCRIPT = '<img src=x onerror="window.owned=1">'
NASTY = (f"{SCRIPT}\x1b[31m", "[x](javascript:window.owned=1)\u202egpj\n**b**", "=1+1 & co")


@pytest.fixture
def nasty(tmp_path):
    """Write a character whose joints, motion and file are called like scripts and markup."""
    arm = arm_rig()
    count = len(arm.skeleton.joints)
    names = (NASTY * count)[:count]
    skeleton = Skeleton(arm.skeleton.joints, arm.skeleton.parents, names, arm.skeleton.deform)
    still = np.broadcast_to(np.eye(4), (2, count, 4, 4))
    clip = Clip(NASTY[0], np.array([0.0, 1.0]), still)
    path = tmp_path / "_a_ `c`.glb"
    rig = Rig(arm.mesh, skeleton, arm.weights, (clip,))
    cutcell.save(path, rig)
    return path


def test_names_are_text(visit, nasty):
    visit.open(nasty)
    visit.expect_text("_a_ `c`")
    for panel in ("Weights", "Distance", "Graph", "Pose", "Compare"):
        visit.panel(panel)
        for _ in NASTY:
            visit.page.mouse.click(700, 690)
            visit.page.keyboard.press("ArrowRight")
            visit.settle()
        if panel == "Pose":
            visit.expect_text("Turn ")
    visit.panel("Weights")
    visit.click_vertex()
    seen = visit.page.evaluate("document.body.innerText")
    assert not {"\x1b", "\u202e"} & {*seen}
    assert visit.page.evaluate("window.owned") is None
    assert not [url for url in visit.requests if url.endswith("/x")]
