"""The pairs of an audit: step through them, see them side by side, say what they are."""

from functools import partial
from typing import Any

from cutcell.runtime.display import shown_name
from cutcell_lab.dataset.audit.duplicates import DIFFERENT, DUPLICATE

from ...document.state import State
from ...widgets import controls as ui
from . import results as actions

NONE_OPEN = (
    "Compare near-duplicates of a data set. Run cutcell dataset audit FOLDER, then cutcell app "
    "--pairs audit."
)
VERDICTS = {"As found": "", "Duplicates": DUPLICATE, "Different": DIFFERENT}
LIKENESSES = {
    "copy": "A copy: the same surface with as many faces",
    "remeshed": "Remeshed: the same surface with other faces",
    "mirrored": "Mirrored",
    "clothes": "The same skeleton in other clothes",
    "pose": "The same skeleton in another pose",
    "similar": "Similar characters",
}


def summary(state: State) -> str:
    """Say which pair is looked at, of how many, or how to make an audit."""
    if state.opened is None:
        return NONE_OPEN
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
    """Describe the chosen pair."""
    pair = state.chosen_pair
    if pair is None:
        return ""
    alike = pair.likeness
    sentences = [LIKENESSES[alike.kind]]
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
    if state.opened is None:
        return ""
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


def _place(state: State) -> str:
    return "" if state.opened is None else f"{state.opened.folder / 'audit.json'} lists it."


def _verdict(state: State) -> str:
    pair = state.chosen_pair
    return "" if pair is None else state.opened.audit.verdict(pair)


def _step(label: str, icon: str, count: int) -> Any:
    return ui.button(
        label,
        partial(actions.step, count=count),
        icon=icon,
        margin=ui.BESIDE if count < 0 else ui.GAP,
        disabled=lambda state: not _ahead(state, count),
    )


CONTROLS = ui.column(
    ui.intro(summary),
    ui.column(
        ui.section(
            "",
            ui.select("tier", "Step through", act=actions.choose_tier),
            ui.row(_step("Previous", "arrow_back", -1), _step("Next", "arrow_forward", 1)),
            ui.caption(facts),
            top=4,
        ),
        ui.section(
            "What they are", ui.choice("", options=VERDICTS, value=_verdict, act=actions.overrule)
        ),
        ui.section("What is kept", ui.caption(threshold_text), ui.caption(_place)),
        visible=lambda state: state.opened is not None,
    ),
)
