"""The list of regions where two methods differ, and what to do there."""

from functools import partial
from typing import Any

from cutcell.rig import Rig
from cutcell.runtime.display import count, share
from cutcell_lab.disagreement import REASONS, Region

from ....document.side_by_side import FEWEST_VIEWS, NOW
from ....document.state import State
from ....looks.methods import title_of
from ....widgets import controls as ui
from .results import called, list_all, look_at, pair_of, region_of, settle, take, unsettled

MAX_REGIONS = 12
"""Number of regions that are listed, those that change most."""
ICON = "join_inner"


def _line(text: str, **style: Any) -> Any:
    return ui.caption(text, margin=(0, 0, 4, 6), sx={**ui.QUIET, **style})


def _summary(state: State) -> str:
    if state.binding is None:
        return ""
    if state.disagreement is None:
        return "The regions are listed once both weights are computed."
    if not state.disagreement.regions:
        return "The weights move the surface alike, within 5 mm for 30° turns."
    if not unsettled(state):
        return "All regions are kept."
    first, second = map(called, pair_of(state))
    return (
        f"Where {first} and {second} move the surface differently, "
        "largest part of the error first. Click to show."
    )


def _titles(state: State, without: str = "") -> dict[str, str]:
    return {title_of(name): name for name in state.methods if name != without}


def _select(place: int, label: str) -> Any:
    """Return a menu for one of both methods; the second is never the first."""
    name = ("first_method", "second_method")[place]
    return ui.select(
        "",
        label,
        options=lambda state: _titles(state, pair_of(state)[0] if place else ""),
        value=lambda state: pair_of(state)[place],
        act=lambda session, method: session.state.param.update(**{name: method}),
        visible=lambda state: len(state.methods) > FEWEST_VIEWS,
        margin=(ui.BESIDE, ui.GAP)[place],
    )


def _regions(state: State) -> list[Any]:
    """Return a button and a line for each region."""
    if state.disagreement is None:
        return []
    regions, whole = unsettled(state), state.disagreement.errors.mean
    more = len(regions) - MAX_REGIONS
    rows = [_entry(state.rig, one, one.error / whole) for one in regions[:MAX_REGIONS]]
    rows += [_line(f"and {count(more, 'smaller region')}")] if more > 0 else []
    return rows


def _entry(rig: Rig, region: Region, part: float) -> Any:
    key, names = region.key, [ui.joint_title(rig, j) for j in (region.first, region.second)]
    title = f"{REASONS[region.reason]}: {' and '.join(names)}"
    text = (
        f"{count(len(region.vertices), 'vertex')}, {region.rms:.3g} mm (at most "
        f"{region.largest:.3g} mm), {share(part, 1)} of the error"
    )
    return ui.column(
        ui.button(title, partial(look_at, key=key), icon=ICON, **ui.LINE),
        _line(text),
        ui.listed(partial(_place, key=key)),
        margin=(0, 0, 6, 0),
    )


def _place(state: State, key: str) -> list[Any]:
    """Return the details of a region while it is the chosen one."""
    if state.region != key:
        return []
    return _details(state)


def _details(state: State) -> list[Any]:
    region = region_of(state)
    if region is None:
        return []
    turn = f"{ui.joint_title(state.rig, region.turn.joint)} turned by {region.degrees:g}°"
    others = [name for name in pair_of(state) if name != NOW]
    titles = ["Take this"] if len(others) == 1 else [f"Take {called(name)}" for name in others]
    buttons = [
        ui.button(title, partial(take, name=name), margin=ui.BESIDE)
        for title, name in zip(titles, others, strict=True)
    ]
    buttons.append(ui.button("Keep mine", settle, margin=ui.BESIDE))
    note = "“Keep mine” takes the region off the list."
    if len(others) == 1:
        buttons.append(ui.button("Blend", partial(take, name=others[0], opacity=0.5)))
        note = f"“Take this” uses the weights of {called(others[0])} there. {note}"
    return [
        _line(region.text, color="text.primary"),
        _line(f"Pose: {turn} about {region.turn.axis.upper()}."),
        ui.row(*buttons),
        _line(note),
    ]


DISAGREEMENT = ui.folded(
    "Disagreement",
    ui.caption(_summary),
    ui.row(_select(0, "Between"), _select(1, "And")),
    ui.listed(_regions),
    ui.button("List kept regions again", list_all, visible=lambda state: bool(state.settled)),
    needed=lambda state: bool(state.region),
)
