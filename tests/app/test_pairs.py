"""Pairs of an audit: stepped through, seen side by side, overruled."""

import numpy as np
import pytest

from cutcell_app.document import loading
from cutcell_app.document.framing import bounds_of
from cutcell_app.features.pairs import results as pairs
from cutcell_app.features.pairs.choices import OpenedAudit
from cutcell_app.features.pairs.controls import CONTROLS, facts, summary, threshold_text
from cutcell_app.features.scenes import resolve
from cutcell_app.shell import status
from cutcell_app.shell.session import keys
from cutcell_app.shell.session.begin import begin
from cutcell_app.widgets.controls import draw
from cutcell_lab.dataset import load_audit
from tests.app.audits import saved_audit
from tests.viewers.arm import arm_rig

pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]


@pytest.fixture(scope="module")
def audited(tmp_path_factory, scheduler):
    return saved_audit(tmp_path_factory.mktemp("audited"), scheduler)


def look(session, folder):
    """Let a session look at an audit."""
    session.state.resolution = 16
    loading.show_rig(session, arm_rig())
    session.state.param.update(opened=OpenedAudit(folder, load_audit(folder)), panel="pairs")


@pytest.fixture
def looking(session, loop, audited):
    (audited / "verdicts.json").unlink(missing_ok=True)
    look(session, audited)
    loop.run_until(lambda: session.state.beside is not None)
    return session


def test_both_stand_side_by_side_as_large_as_each_other(looking):
    state = looking.state
    scene = resolve(state)
    assert scene.views == ("arm", "same")
    bodies = [scene.actors[f"pair of {which}"] for which in "AB"]
    assert [body.view for body in bodies] == [0, 1]
    np.testing.assert_allclose(bodies[0].points, bodies[1].points, atol=1e-6)
    box = np.ptp(bounds_of(state), axis=0).max()
    assert np.ptp(bodies[0].points, axis=0).max() == pytest.approx(box, rel=1e-5)
    assert scene.actors["bones of B"].visible
    state.skeleton = False
    assert not resolve(state).actors["bones of B"].visible
    assert status.summary(state).count("3 joints") == 2


def test_one_steps_through_all_pairs_or_those_of_a_tier(looking, loop):
    state = looking.state
    count = len(state.opened.pairs)
    assert count == 3
    assert summary(state) == "Pair 1 of 3."
    keys.act(looking, "next")
    assert state.beside is None
    loop.run_until(lambda: state.beside is not None)
    assert (state.pair, state.beside.pair) == (1, 1)
    for _ in range(4):
        pairs.step(looking, 1)
    assert state.pair == 2
    pairs.choose_tier(looking, "twin")
    twins = [k for k, pair in enumerate(state.opened.audit.pairs) if pair.tier == "twin"]
    assert state.stepped == twins
    assert state.pair in twins
    pairs.choose_tier(looking, "overruled")
    assert summary(state) == "No such pairs."
    keys.act(looking, "previous")
    assert state.pair in twins


def test_what_is_known_of_a_pair_is_told(looking):
    said = facts(looking.state)
    assert said.startswith("A copy: ")
    assert "of the surfaces" in said
    assert "same tree" in said


def test_a_verdict_changes_what_is_kept_and_stays_in_the_folder(looking, loop, audited):
    state = looking.state
    before = len(state.opened.audit.keep)
    assert f"{before} of 3 characters are kept." in threshold_text(state)
    for place in range(3):
        state.pair = place
        pairs.overrule(looking, "different")
        loop.run_until(lambda now=place + 1: len(state.opened.audit.verdicts) == now)
    assert len(state.opened.audit.keep) == 3
    assert load_audit(audited).keep == state.opened.audit.keep
    pairs.choose_tier(looking, "overruled")
    assert list(state.stepped) == [0, 1, 2]
    pairs.overrule(looking, "")
    loop.run_until(lambda: len(state.opened.audit.verdicts) == 2)
    assert len(load_audit(audited).verdicts) == 2


def test_two_who_look_at_once_lose_nothing_of_each_other(looking, loop, audited):
    other = begin(loop)
    look(other, audited)
    looking.state.pair, other.state.pair = 0, 1
    pairs.overrule(looking, "different")
    loop.run_until(lambda: looking.state.opened.audit.verdicts)
    pairs.overrule(other, "duplicate")
    loop.run_until(lambda: len(other.state.opened.audit.verdicts) == 2)
    assert len(load_audit(audited).verdicts) == 2
    other.close()


def test_a_character_that_is_gone_is_told(looking, loop, audited):
    there = audited.parent / "rigs" / "turned.npz"
    hidden = there.rename(there.with_suffix(".gone"))
    looking.state.pair = 2
    loop.run_until(lambda: looking.state.message is not None)
    assert "turned" in looking.state.message[1]
    assert str(audited.parent) not in looking.state.message[1]
    assert resolve(looking.state).actors == {}
    hidden.rename(there)


def test_without_an_audit_the_panel_says_how_to_make_one(bound):
    bound.state.panel = "pairs"
    assert "body" in resolve(bound.state).actors
    assert "cutcell dataset audit FOLDER" in draw(bound, CONTROLS)[0].object
