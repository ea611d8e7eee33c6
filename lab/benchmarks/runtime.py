"""Time by stage, over R (the paper's Figure "runtime").

python -m cutcell_lab.benchmarks.runtime [RIG...] [--resolutions 16 32 64 128] [--plot FILE]
"""

from __future__ import annotations

import argparse
import gc
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from cutcell_lab.baselines import METHODS

from .document import fill
from .figures import STAGE_COLORS, save, styled
from .gvb import SIDES
from .quality import warm
from .rigs import Character, load_characters
from .tables import Table, seconds

STAGES = ("graph", "distances", "weights")


def measured(
    characters: Sequence[Character], resolutions: Sequence[int], repeats: int
) -> dict[tuple[str, int], dict[str, float]]:
    """Run methods in turn; of each stage the least time, its mean over the rigs."""
    warm({name: METHODS[name] for name in SIDES})
    seconds_of: dict[tuple[str, int], list[list[float]]] = {}
    for character in characters:
        for resolution in resolutions:
            runs: dict[str, list[list[float]]] = {name: [] for name in SIDES}
            for _ in range(repeats):
                for name in SIDES:
                    gc.collect()
                    spent = METHODS[name](character.rig, resolution=resolution).seconds
                    runs[name].append([spent[stage] for stage in STAGES])
            for name, rows in runs.items():
                least = np.min(rows, axis=0).tolist()
                seconds_of.setdefault((name, resolution), []).append(least)
    return {
        key: dict(zip(STAGES, np.mean(rows, axis=0).tolist(), strict=True))
        for key, rows in seconds_of.items()
    }


def stage_table(seconds_of: dict[tuple[str, int], dict[str, float]], rigs: int) -> Table:
    """Write a row for each method and resolution."""
    note = f"The least of several runs in turn, averaged over {rigs} rigs."
    table = Table("Time by stage, over R", ["method", "R", *STAGES, "all"], note)
    for (name, resolution), spent in sorted(
        seconds_of.items(), key=lambda item: (item[0][1], SIDES.index(item[0][0]))
    ):
        table.add(name, resolution, *map(seconds, spent.values()), seconds(sum(spent.values())))
    return table


def plot(seconds_of: dict[tuple[str, int], dict[str, float]], path: Path) -> None:
    """Draw bars of stages on top of each other."""
    resolutions = sorted({resolution for _, resolution in seconds_of})
    figure, axes = styled(1, len(resolutions), (2.6 * len(resolutions), 3.2))
    for panel, resolution in zip(axes, resolutions, strict=True):
        base = np.zeros(len(SIDES))
        for stage in STAGES:
            height = np.array([seconds_of[name, resolution][stage] for name in SIDES]) * 1e3
            color = STAGE_COLORS[stage]
            panel.bar(range(len(SIDES)), height, 0.66, bottom=base, color=color, label=stage)
            base += height
        names = [name.replace("_", "\n") for name in SIDES]
        panel.set_xticks(range(len(SIDES)), names, fontsize=7.5)
        panel.set_title(f"R = {resolution}, ms", loc="left", fontsize=9.5, fontweight="bold")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="lower center", ncol=3, frameon=False)
    save(figure, path, bottom=0.09)


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(
        prog="python -m cutcell_lab.benchmarks.runtime", description=__doc__
    )
    parser.add_argument("rigs", nargs="*", help="all at hand when left out")
    parser.add_argument("--resolutions", nargs="+", type=int, default=[32, 64, 128])
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--plot", type=Path)
    parser.add_argument("--out", type=Path, help="a document with marks for it")
    options = parser.parse_args(argv)
    characters = load_characters(options.rigs)
    seconds_of = measured(characters, options.resolutions, options.repeats)
    text = stage_table(seconds_of, len(characters)).markdown()
    print(text)
    if options.plot:
        plot(seconds_of, options.plot)
    if options.out:
        fill(options.out, {"runtime": text})


if __name__ == "__main__":
    main()
