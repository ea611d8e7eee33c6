"""The comparison of networks as a figure: each head with each prior, each seed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.ticker import NullLocator

from .figures import FAINT, INK, METHOD_COLORS, save, styled

COLORS = {"none": "#8b939f", **METHOD_COLORS, "bind": METHOD_COLORS["cutcell_rig"]}
BIND = "bind"
CENTIMETRES = (3, 10, 30, 100)
"""Squared: where the logarithmic axis is marked."""

Means = Mapping[tuple[str, str], Sequence[tuple[float, float]]]
"""By head and prior, L1 and cm² of each seed."""


def draw(
    networks: Means,
    alone: Mapping[str, tuple[float, float]],
    paper: Mapping[tuple[str, str], tuple[float, float]],
    path: Path,
) -> None:
    """Draw L1 above and the deformation error below, a column a head.

    Parameters
    ----------
    networks : Means
    alone : mapping of str to (float, float)
        L1 and cm² of each prior without a network.
    paper : mapping of (str, str) to (float, float)
        What the paper has for some heads and priors.
    path : Path
    """
    heads = list(dict.fromkeys(head for head, _ in networks))
    priors = list(dict.fromkeys(prior for _, prior in networks))
    figure, axes = styled(2, len(heads), (3.4 * len(heads), 5.4))
    for panel, axis in enumerate(axes):
        row, head = divmod(panel, len(heads))
        if head:
            axis.sharey(axes[row * len(heads)])
        if BIND in alone:
            axis.axhline(alone[BIND][row], color=COLORS[BIND], linewidth=1, linestyle=(0, (4, 3)))
        for x, prior in enumerate(priors):
            color = COLORS.get(prior, INK)
            points = [seed[row] for seed in networks.get((heads[head], prior), ())]
            if prior in alone:
                axis.plot(x, alone[prior][row], "o", mfc="white", mec=color, ms=7)
            if (heads[head], prior) in paper:
                axis.plot(x, paper[heads[head], prior][row], "x", color=INK, ms=6, mew=1.4)
            if points:
                axis.hlines(np.mean(points), x - 0.3, x + 0.3, color=color, linewidth=2.4)
                axis.plot(np.full(len(points), x), points, ".", color=color, ms=7)
        axis.set_xticks(range(len(priors)), priors, rotation=35, ha="right")
        axis.set_xlim(-0.6, len(priors) - 0.4)
        axis.spines["bottom"].set(visible=True, color=FAINT)
        if row == 0:
            axis.set_title(heads[head], fontsize=10.5, loc="left", color=INK)
            axis.tick_params(labelbottom=False)
        else:
            axis.set_yscale("log")
            axis.set_yticks(CENTIMETRES, map(str, CENTIMETRES))
            axis.yaxis.set_minor_locator(NullLocator())
    axes[0].set_ylim(0)
    for row, name in enumerate(("L1", "deformation error, cm²")):
        axes[row * len(heads)].set_ylabel(name, fontsize=9, color=INK)
    figure.text(
        0.012,
        0.015,
        "Characters by other makers. Dots: networks, one a seed; bar: their mean; ring: the prior "
        "alone; dashed: bind alone; cross: the paper's, of full size on its own data.",
        fontsize=8,
        color="#5b6470",
    )
    save(figure, path, bottom=0.03)
