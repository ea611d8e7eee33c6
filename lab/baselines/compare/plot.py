"""A comparison as a figure: how the errors of each method spread over the rigs."""

from __future__ import annotations

from importlib import import_module
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from cutcell.errors import FileError, MissingLibraryError, ParameterError
from cutcell.runtime.writing import check_place, write_all

from .scores import Comparison

OURS, PEER, INK, FAINT = "#d9660a", "#3f6fa3", "#22262d", "#d9dde3"
WIDTH, ROW, EDGES = 9.0, 0.34, 1.55
"""Inches: of the figure, of a method, of what is above and below them."""
ENDINGS = (".png", ".svg", ".pdf")
LEAST = 0.05
"""cm²: smaller deformation errors are drawn here, the axis being logarithmic."""


def plot_comparison(comparison: Comparison, path: str | Path) -> None:
    """Draw, for each method, its deformation error and L1 on every rig, and their medians."""
    path = check_plot(path)
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import NullLocator

    methods = _sorted(comparison)
    if not methods:
        raise ParameterError("there is nothing to plot: no method has a result")
    figure = Figure(figsize=(WIDTH, EDGES + ROW * len(methods)), facecolor="white")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2, sharey=True, gridspec_kw={"width_ratios": [3, 2]})
    _panel(left, comparison, methods, "deformation")
    _panel(right, comparison, methods, "l1")
    left.set_xscale("log")
    left.set_xlim(LEAST * 0.8)
    left.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    left.set_title("Deformation error, cm²", **_heading())
    right.set_title("L1 of the weights", **_heading())
    right.set_xlim(0)
    left.xaxis.set_minor_locator(NullLocator())
    left.set_yticks(range(len(methods)), [_label(comparison, name) for name in methods])
    left.set_ylim(len(methods) - 0.4, -0.6)
    for tick, name in zip(left.get_yticklabels(), methods, strict=True):
        tick.set_color(_color(name))
    figure.text(
        0.012,
        0.018,
        f"{len(comparison.rigs)} rigs, one dot each; bar: median, diamond: mean. "
        "Farther left is nearer to the artist's weights.",
        fontsize=8.5,
        color="#5b6470",
    )
    figure.tight_layout(rect=(0, 0.045, 1, 1), w_pad=1.5)
    # In memory first: on a full disk Matplotlib fails in ways that do not tell why.
    drawn = BytesIO()
    figure.savefig(drawn, format=path.suffix[1:].lower(), dpi=160, facecolor="white")
    write_all({path: drawn.getvalue()})


def check_plot(path: str | Path) -> Path:
    """Fail early if a plot could not be drawn or saved."""
    path = Path(path)
    if path.suffix.lower() not in ENDINGS:
        raise FileError(f'{path.name}: a plot cannot be "{path.suffix}"; end in .png, .svg or .pdf')
    check_place(path)
    try:
        import_module("matplotlib")
    except ModuleNotFoundError:
        raise MissingLibraryError("a plot needs Matplotlib: pip install 'cutcell[plot]'") from None
    return path


def _sorted(comparison: Comparison) -> list[str]:
    """List the methods that have a result, the artist's left out, least deformation first."""
    medians = {
        name: comparison.statistic(name, "deformation").median
        for name in comparison.methods
        if name != "artist"
    }
    finite = {name: value for name, value in medians.items() if value is not None}
    return sorted(finite, key=lambda name: finite[name])


def _panel(axes: Any, comparison: Comparison, methods: list[str], metric: str) -> None:
    # Dots are moved up and down a little, always the same way, so that none hides another.
    shake = np.linspace(-0.22, 0.22, max(len(comparison.rigs), 2))
    shake = np.random.default_rng(0).permutation(shake)
    for row, name in enumerate(methods):
        index = comparison.methods.index(name)
        values = [rig.scores[index].values.get(metric) for rig in comparison.rigs]
        scored = {k: value for k, value in enumerate(values) if value is not None}
        least = LEAST if metric == "deformation" else 0
        x, y = [max(value, least) for value in scored.values()], row + shake[[*scored]]
        color, statistic = _color(name), comparison.statistic(name, metric)
        axes.plot(x, y, "o", color=color, alpha=0.45, markersize=4.5, markeredgewidth=0)
        axes.plot([statistic.median] * 2, [row - 0.33, row + 0.33], color=color, linewidth=2.6)
        axes.plot(
            statistic.mean, row, "D", color="white", markersize=4.8, markeredgecolor=color, zorder=3
        )
    axes.grid(axis="x", color=FAINT, linewidth=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(length=0, labelsize=9, colors=INK)
    for side in axes.spines.values():
        side.set_visible(False)


def _label(comparison: Comparison, method: str) -> str:
    count, all_ = comparison.statistic(method, "l1").count, len(comparison.rigs)
    return method if count == all_ else f"{method} ({count} of {all_})"


def _color(method: str) -> str:
    return OURS if method.startswith("cutcell") else PEER


def _heading() -> dict[str, Any]:
    return {"loc": "left", "fontsize": 10.5, "color": INK, "fontweight": "bold", "pad": 8}
