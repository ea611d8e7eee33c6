"""Step through the pairs of an audit, and overrule them."""

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

from cutcell.errors import CutcellError
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress, silent
from cutcell_lab.dataset import save_verdicts
from cutcell_lab.dataset.audit.audit_files import read_verdicts
from cutcell_lab.dataset.read.sources import read_source

from ...derive.derived import Derived
from ...derive.jobs import DESCRIBING
from ...document.session import Session
from ...document.state import State
from .choices import Beside, OpenedAudit


def watch(session: Session) -> None:
    """Read the verdicts of an audit when its pairs are first looked at."""
    session.state.param.watch(lambda event: _read_verdicts(session, event), "opened")


def _read_verdicts(session: Session, event: Any) -> None:
    """Add all that was said of the pairs since the server was started."""
    opened = event.new
    if event.old is not None or opened is None:
        return
    try:
        verdicts = read_verdicts(opened.folder)
    except CutcellError as error:
        session.fail(error)
        return
    if verdicts != opened.audit.verdicts:  # else what follows from them is known
        audit = replace(opened.audit, verdicts=verdicts)
        session.state.opened = OpenedAudit(opened.folder, audit)


def _inputs(state: State) -> tuple[Any, ...] | None:
    pair = state.chosen_pair
    if pair is None:
        return None
    audit = state.opened.audit
    return state.pair, audit.sources[pair.a], audit.other_sources[pair.b]


def _beside(place: int, *sources: Any, progress: Progress) -> Beside:
    """Read both characters of a pair."""
    rigs: list[Rig] = []
    for source in sources:
        with tempfile.TemporaryDirectory() as folder:
            rigs.append(read_source(source, Path(folder)))
    return Beside(place, (rigs[0], rigs[1]))


RESULTS = (
    Derived(
        "beside",
        _inputs,
        _beside,
        wanted=lambda state: state.panel == "pairs",
        slots=lambda state: DESCRIBING,
    ),
)


def step(session: Session, count: int) -> None:
    """Go to the next pair of the chosen tier, or to the one before."""
    state = session.state
    ahead = [k for k in state.stepped if (k > state.pair if count > 0 else k < state.pair)]
    if ahead:
        state.pair = ahead[0] if count > 0 else ahead[-1]


def choose_tier(session: Session, tier: str) -> None:
    """Step through the pairs of a tier, from its first."""
    state = session.state
    state.tier = tier
    if state.stepped and state.pair not in state.stepped:
        state.pair = state.stepped[0]


def overrule(session: Session, verdict: str) -> None:
    """Set the verdict on the chosen pair; an empty one leaves it to the figures."""
    state = session.state
    opened, pair = state.opened, state.chosen_pair
    if pair is None or opened.audit.verdict(pair) == verdict:
        return

    def work(progress: Progress) -> OpenedAudit:
        # Others may step through the same audit.
        audit = replace(opened.audit, verdicts=read_verdicts(opened.folder))
        audit = audit.overrule(pair, verdict)
        save_verdicts(audit, opened.folder)
        return OpenedAudit(opened.folder, audit)

    def done(now: OpenedAudit) -> None:
        state.opened = now

    session.work.start("verdict", work, done, report=silent)
