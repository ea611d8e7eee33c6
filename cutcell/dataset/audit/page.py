"""Reports as one HTML file, which opens anywhere and needs nothing beside it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from ...errors import CutcellError
from ...runtime.display import printable
from ...runtime.writing import write_all
from ..bind.binding import BindReport
from ..read.store import METRICS, STAGES, read_entry
from .pictures import picture

WORST = 5
"""Assets that are shown for each metric."""
MAX_FAILURES = 500
LOW_IS_BAD = ("precision", "recall")

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 75rem; color: #222;
  padding: 0 1rem }
table { border-collapse: collapse; margin: 1rem 0 } td, th { padding: .25rem .8rem .25rem 0;
  text-align: left; vertical-align: top; border-bottom: 1px solid #ddd }
figure { display: inline-block; margin: 0 .8rem 1rem 0; width: 13.8rem; vertical-align: top }
figcaption { font-size: 13px; overflow-wrap: anywhere } img { width: 100%; height: auto;
  border: 1px solid #ddd } section { margin: 2rem 0 } h2 { margin: 2rem 0 .5rem }
"""


def write_bind_report(report: BindReport, path: Path) -> None:
    """Write what `bind_all` did as a page: counts, times, failures, the worst by each metric."""
    good = [row for row in report.rows if not row["error"]]
    parts = [
        table(bind_counts(report).items()),
        "<h2>Seconds by stage</h2>",
        table(
            [
                (stage, f"{sum(row[f'seconds_{stage}'] or 0 for row in good):,.1f}")
                for stage in STAGES
            ]
        ),
        _failures(report),
    ]
    for metric in METRICS:
        parts += _worst(report.store, good, metric)
    write_page(path, f"Binding of {len(report.rows):,} assets", parts)


def bind_counts(report: BindReport) -> dict[str, str]:
    """Return the figures of a binding, in words."""
    good = [row for row in report.rows if not row["error"]]
    return {
        "assets": f"{len(report.rows):,}",
        "bound now": f"{report.bound:,}",
        "in the store before": f"{report.known:,}",
        "failed": f"{report.failed:,}",
        "seconds": f"{report.seconds:,.1f}",
        "bytes": f"{sum(row['bytes'] or 0 for row in good):,}",
    }


def _failures(report: BindReport) -> str:
    failures = list(report.failures.items())
    if not failures:
        return "<h2>Failures</h2><p>None.</p>"
    rest = len(failures) - MAX_FAILURES
    more = f"<p>and {rest:,} more; the manifest lists all.</p>" if rest > 0 else ""
    return f"<h2>Failures</h2>{table(failures[:MAX_FAILURES])}{more}"


def _worst(store: Path, rows: Sequence[Mapping[str, Any]], metric: str) -> list[str]:
    """Show the assets that are worst by a metric."""
    measured = [row for row in rows if row[metric] is not None]
    measured.sort(key=lambda row: row[metric], reverse=metric not in LOW_IS_BAD)
    if not measured:
        return []
    figures = []
    for row in measured[:WORST]:
        try:
            entry = read_entry(store / row["path"])
        except CutcellError as error:
            figures.append(f"<p>{escape(str(error))}</p>")
            continue
        shown = picture(entry.vertices, entry.faces, entry.weights)
        figures.append(figure(shown, [row["name"], f"{metric} {row[metric]:.4g}"]))
    return [f"<h2>Worst by {metric}</h2>", *figures]


def figure(image: str, lines: Sequence[str]) -> str:
    """Return a picture with lines below it."""
    words = "<br>".join(escape(printable(line)) for line in lines)
    return f'<figure><img src="{image}" alt=""><figcaption>{words}</figcaption></figure>'


def table(rows: Any) -> str:
    """Return pairs of texts as a table."""
    lines = "".join(
        f"<tr><td>{escape(printable(str(a)))}</td><td>{escape(printable(str(b)))}</td></tr>"
        for a, b in rows
    )
    return f"<table>{lines}</table>"


def write_page(path: Path, title: str, parts: Sequence[str]) -> None:
    """Write a page."""
    head = f"<title>{escape(title)}</title><style>{STYLE}</style>"
    body = f"<h1>{escape(title)}</h1>{''.join(parts)}"
    text = f'<!doctype html><html lang="en"><meta charset="utf-8">{head}<body>{body}</body></html>'
    write_all({path: text.encode("utf-8", "replace")})
