"""How time and memory grow with the resolution, with faces and with bones.

python -m benchmarks.growth [--rig RIG] [--resolutions 16 ... 512] [--markdown OUT]

Every measurement runs in a subprocess, so that peak memory is measured separately.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter

import numpy as np

from cutcell_lab.benchmarks.tables import Table, publish, seconds

ROOT = Path(__file__).resolve().parent.parent
RIG = ROOT / "assets" / "biped.glb"
STAGES = ("graph", "distances", "weights")


def measure(case: dict) -> dict:
    """Bind one case, warm; return seconds, sizes and the peak of memory in MB."""
    import cutcell
    from cutcell_lab.benchmarks import shapes

    rig = shapes.make(case)
    cutcell.bind(shapes.small(), 8, connectivity=case["connectivity"])  # load what is compiled
    before = peak_memory()
    begin = perf_counter()
    binding = cutcell.bind(rig, case["resolution"], connectivity=case["connectivity"])
    return {
        "seconds": perf_counter() - begin,
        **binding.seconds,
        "nodes": len(binding.graph.nodes),
        "kinds": np.bincount(binding.graph.node_kind, minlength=3).tolist(),
        "faces": len(rig.mesh.faces),
        "bones": len(binding.distances.bones.joint),
        "peak": peak_memory(),
        "before": before,
    }


def peak_memory() -> float:
    """Return the most memory that this process has held, in MB.

    `ru_maxrss` starts from what the parent process held; Linux also has that of the process.
    """
    status = Path("/proc/self/status")
    if status.exists():
        for line in status.read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) / 1024
    unit = 1024**2 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


def run(case: dict, options: argparse.Namespace) -> dict | str:
    """Measure one case in a subprocess; return the outcome, or the reason of a failure."""
    command = [sys.executable, "-W", "ignore", "-m", "benchmarks.growth", "--one", json.dumps(case)]
    try:
        done = subprocess.run(
            command, cwd=ROOT, capture_output=True, text=True, timeout=options.limit
        )
    except subprocess.TimeoutExpired:
        return f"over {options.limit:g} s"
    if done.returncode < 0:
        return f"killed (signal {-done.returncode})"
    if done.returncode:
        return (done.stderr.strip().splitlines() or ["failed"])[-1]
    return json.loads(done.stdout.strip().splitlines()[-1])


def slope(sizes: Sequence[float], values: Sequence[float]) -> float:
    """Fit s in value ~ size^s over the larger half of the sizes, at least three of them."""
    if len(sizes) < 2:
        return float("nan")
    count = max(3, len(sizes) - len(sizes) // 2)
    x, y = np.log(sizes[-count:]), np.log(np.maximum(values[-count:], 1e-9))
    return float(np.polyfit(x, y, 1)[0])


def growth_table(title: str, key: str, cases: list[dict], note: str, options) -> Table:
    """Measure cases that grow in one respect, and the slopes."""
    columns = [key, "nodes", *STAGES, "all", "peak memory", "of it above start"]
    table = Table(
        title,
        columns,
        note + " Slope s: value ~ size^s, fitted on a log-log scale over the larger half.",
    )
    results = []
    for case in cases:
        outcome = run(case, options)
        print(f"{title}: {case}", file=sys.stderr, flush=True)
        if isinstance(outcome, str):
            table.add(case[key], outcome, *["-"] * (len(columns) - 2))
            continue
        results.append(outcome | {"resolution": case["resolution"]})
        above = outcome["peak"] - outcome["before"]
        times = [seconds(outcome[name]) for name in (*STAGES, "seconds")]
        size = f"{results[-1][key]:,}"
        table.add(
            size,
            f"{outcome['nodes']:,}",
            *times,
            f"{outcome['peak']:,.0f} MB",
            f"{above:,.0f} MB",
        )
    if len(results) > 1:
        sizes = [outcome[key] for outcome in results]
        grown = [
            [outcome[name] for outcome in results] for name in ("nodes", *STAGES, "seconds", "peak")
        ]
        above = [max(outcome["peak"] - outcome["before"], 1) for outcome in results]
        table.add("**slope**", *(f"{slope(sizes, values):.2f}" for values in [*grown, above]))
    return table


def tables(options: argparse.Namespace) -> list[Table]:
    """Measure growth in all three respects."""
    base = {"rig": str(options.rig), "connectivity": options.connectivity, "resolution": 64}
    kind = f"`bind`, warm, connectivity {options.connectivity!r}"
    return [
        growth_table(
            "Growth with the resolution",
            "resolution",
            [base | {"resolution": r} for r in options.resolutions],
            f"{kind}, {options.rig.stem}, lattice of R^3 cells.",
            options,
        ),
        growth_table(
            "Growth with the faces",
            "faces",
            [base | {"faces": f} for f in options.faces],
            f"{kind}, R=64, a bumpy ball with 20 bones, its triangles quartered again and again.",
            options,
        ),
        growth_table(
            "Growth with the bones",
            "bones",
            [base | {"bones": b} for b in options.bones],
            f"{kind}, R=64, {options.rig.stem} with a chain of bones through its body.",
            options,
        ),
    ]


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.growth", description=__doc__)
    parser.add_argument("--rig", type=Path, default=RIG)
    sizes = [16, 32, 64, 128, 256, 512]
    parser.add_argument("--resolutions", type=int, nargs="+", default=sizes, metavar="R")
    triangles = [1280 * 4**k for k in range(6)]
    parser.add_argument("--faces", type=int, nargs="+", default=triangles, metavar="M")
    parser.add_argument("--bones", type=int, nargs="+", default=[1, 4, 16, 64, 256], metavar="B")
    parser.add_argument("--connectivity", default="6", choices=["6", "26", "any"])
    parser.add_argument("--limit", type=float, default=300, help="seconds for one case")
    parser.add_argument("--markdown", type=Path, metavar="OUT")
    parser.add_argument("--one", type=json.loads, help=argparse.SUPPRESS)
    options = parser.parse_args(argv)
    if options.connectivity != "any":
        options.connectivity = int(options.connectivity)
    return options


def main(argv: Sequence[str] | None = None) -> None:
    """Print the tables, and write them too if a file is named."""
    options = arguments(argv)
    if options.one is not None:
        print(json.dumps(measure(options.one)))
        return
    publish(tables(options), options.markdown)


if __name__ == "__main__":
    main()
