"""The pairs of an audit: step through them, see them side by side, say what they are."""

from functools import partial
from typing import Any

import panel_material_ui as pmui

from cutcell.runtime.display import shown_name
from cutcell_lab.dataset.audit.duplicates import DIFFERENT, DUPLICATE

from ..commands import pairs as actions
from ..commands.session import Session
from ..state import State
from .controls import (
    BESIDE,
    BUTTONS,
    GAP,
    button,
    caption,
    column,
    intro,
    row,
    section,
    select_box,
    when,
)

NONE_OPEN = (
    "Compare near-duplicates of a data set. Run cutcell dataset audit FOLDER, then cutcell app "
    "--pairs audit."
)
TIERS = {
    "All": "all",
    "Twins": "twin",
    "Variants": "variant",
    "Near": "near",
    "In another pose": "posed",
    "Overruled": "overruled",
}
VERDICTS = {"As found": "", "Duplicates": DUPLICATE, "Different": DIFFERENT}
FOUND = {
    "copy": "A copy: the same surface with as many faces",
    "remeshed": "Remeshed: the same surface with other faces",
    "mirrored": "Mirrored",
    "clothes": "The same skeleton in other clothes",
    "pose": "The same skeleton in another pose",
    "similar": "Similar characters",
}


def pairs(session: Session) -> pmui.Column:
    """Return the controls of the panel Pairs."""
    state = session.state
    if state.opened is None:
        return column(intro(NONE_OPEN))
    watched = (state.param.opened, state.param.pair, state.param.tier)

    def to(label: str, icon: str, count: int) -> Any:
        ended = when(lambda *_: not _ahead(state, count), *watched)
        margin = BESIDE if count < 0 else GAP
        act = partial(actions.step, session, count)
        return button(label, act, icon=icon, margin=margin, disabled=ended)

    steps = row(to("Previous", "arrow_back", -1), to("Next", "arrow_forward", 1))
    return column(
        intro(when(lambda *_: summary(state), *watched)),
        section(
            "",
            _tiers(session),
            steps,
            caption(when(lambda *_: facts(state), *watched)),
            margin=(4, 20, 4, 20),
        ),
        section("What they are", _verdict(session)),
        section(
            "What is kept",
            caption(when(lambda *_: threshold_text(state), *watched)),
            caption(when(lambda opened: f"{opened.folder / 'audit.json'} lists it.", watched[0])),
        ),
    )


def summary(state: State) -> str:
    """Say which pair is looked at, of how many."""
    count, stepped = len(state.opened.pairs), state.stepped
    if not count:
        return "The audit found no near-duplicates."
    if not stepped:
        return "No such pairs."
    if state.pair not in stepped:
        return f"{len(stepped):,} of {count:,} pairs."
    of = f" of {count:,} in all" if len(stepped) < count else ""
    return f"Pair {stepped.index(state.pair) + 1:,} of {len(stepped):,}{of}."


def facts(state: State) -> str:
    """Return what is known of the pair that is looked at."""
    pair = state.chosen_pair
    if pair is None:
        return ""
    alike = pair.likeness
    sentences = [FOUND[alike.kind]]
    if pair.surface < float("inf"):
        sentences += [
            f"Chamfer distance of the surfaces {pair.surface:.2g} ({pair.tier}), of the joints "
            f"{pair.joints:.2g}",
            f"One surface reaches {alike.reach:.1%} of the longest side beyond the other",
        ]
    if alike.degrees is None or alike.bones is None:
        sentences.append("The joints form different trees")
    else:
        sentences.append(
            f"The joints form the same tree; bones differ by {alike.bones:.0%} in length and "
            f"{alike.degrees:.0f}° in direction"
        )
    sentences.append(f"The smaller mesh has {alike.faces:.0%} of the other's faces")
    return ". ".join(sentences) + "."


def threshold_text(state: State) -> str:
    """Say how many characters are kept, and whether those of the pair are."""
    audit, pair = state.opened.audit, state.chosen_pair
    counts = f"{len(audit.keep):,} of {len(audit.names):,} characters are kept."
    if pair is None:
        return counts
    ends = [audit.names[pair.a], *([] if audit.crossed else [audit.others[pair.b]])]
    whole = set(audit.keep)
    sentences = [
        f"{shown_name(name)} is {'kept' if name in whole else 'left out'}" for name in ends
    ]
    return f"{counts} {'; '.join(sentences)}."


def _ahead(state: State, count: int) -> bool:
    return any(k > state.pair if count > 0 else k < state.pair for k in state.stepped)


def _tiers(session: Session) -> pmui.Select:
    state = session.state
    select = select_box("Step through", TIERS)

    def update(*events: Any) -> None:
        select.value = state.tier

    def chosen(event: Any) -> None:
        if event.new is not None and event.new != state.tier:
            actions.choose_tier(session, event.new)

    state.param.watch(update, "tier")
    select.param.watch(chosen, "value")
    update()
    return select


def _verdict(session: Session) -> pmui.RadioButtonGroup:
    state = session.state
    row = pmui.RadioButtonGroup(options=VERDICTS, value="", **BUTTONS)

    def update(*events: Any) -> None:
        pair = state.chosen_pair
        row.value = "" if pair is None else state.opened.audit.verdict(pair)

    def chosen(event: Any) -> None:
        if event.new is not None:
            actions.overrule(session, event.new)

    state.param.watch(update, ["opened", "pair"])
    row.param.watch(chosen, "value")
    update()
    return row
