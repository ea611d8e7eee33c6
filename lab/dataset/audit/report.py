"""Reports of bindings and audits as self-contained HTML files."""

from __future__ import annotations

import tempfile
from collections import defaultdict
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from cutcell.errors import CutcellError
from cutcell.runtime.display import printable
from cutcell.runtime.writing import write_all

from ..bind.binding import BindReport
from ..read.entry import read_entry
from ..read.sources import Source, read_source
from ..read.store import METRICS, STAGES
from .duplicates import Audit, Pair
from .pictures import picture

WORST = 5
"""Assets that are shown for each metric."""
MAX_LISTED = 500
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
        _stretched(report),
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
        "stretched": f"{len(report.stretched):,}",
        "seconds": f"{report.seconds:,.1f}",
        "bytes": f"{sum(row['bytes'] or 0 for row in good):,}",
    }


def _failures(report: BindReport) -> str:
    return _listed("Failures", list(report.failures.items()))


def _stretched(report: BindReport) -> str:
    """List the assets of which much of the surface stretches as joints turn."""
    shares = [(name, f"{share:.1%} of the surface") for name, share in report.stretched.items()]
    return _listed("Stretched surfaces", shares)


def _listed(title: str, rows: Sequence[tuple[str, str]]) -> str:
    if not rows:
        return f"<h2>{title}</h2><p>None.</p>"
    rest = len(rows) - MAX_LISTED
    more = f"<p>and {rest:,} more; the manifest lists all.</p>" if rest > 0 else ""
    return f"<h2>{title}</h2>{table(rows[:MAX_LISTED])}{more}"


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
        image = picture(entry.vertices, entry.faces, entry.weights)
        figures.append(figure(image, [row["name"], f"{metric} {row[metric]:.4g}"]))
    return [f"<h2>Worst by {metric}</h2>", *figures]


def figure(image: str, lines: Sequence[str]) -> str:
    """Return a picture with lines below it."""
    text = "<br>".join(escape(printable(line)) for line in lines)
    return f'<figure><img src="{image}" alt=""><figcaption>{text}</figcaption></figure>'


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


MAX_ROWS = 60
MAX_MATCHES = 5


def write_audit_report(audit: Audit, path: Path) -> None:
    """Write an audit as a page.

    Each row has a character and its nearest matches, with their vertices, faces and distance;
    those with the nearest match come first.
    """
    document = audit.to_dict()
    counts = {
        "assets": f"{document['assets']:,}",
        "pairs that stage 1 kept": f"{audit.candidates:,}",
        "near-duplicates": f"{len(audit.pairs):,}",
        **{f"of them {k}": f"{v:,}" for k, v in document["tiers"].items() if k != "posed"},
        "one skeleton in other poses": f"{len(audit.posed):,}",
        **{f"kind: {k}": f"{v:,}" for k, v in document["kinds"].items()},
        "clusters": f"{len(document['clusters']):,}",
        "to keep": f"{len(document['keep']):,}",
        "overruled by a person": f"{len(audit.verdicts):,}",
        "could not be read": f"{len(audit.failed):,}",
    }
    parts = [table(counts.items())]
    matches: dict[int, list[Pair]] = defaultdict(list)
    for pair in [*audit.pairs, *audit.posed]:
        matches[pair.a].append(pair)
    pictures = _Pictures()
    rows = list(matches.items())
    for k, pairs in rows[:MAX_ROWS]:
        figures = [figure(*pictures.of(audit.sources[k], []))]
        for pair in pairs[:MAX_MATCHES]:
            far = "" if pair in audit.posed else f"D {pair.surface:.2g}, {pair.tier}"
            answer = audit.verdict(pair)
            verdict = f"a person said: {answer}" if answer else ""
            lines = [line for line in (far, _measures(pair), verdict) if line]
            figures.append(figure(*pictures.of(audit.other_sources[pair.b], lines)))
        parts.append(f"<section>{''.join(figures)}</section>")
    if len(rows) > MAX_ROWS:
        parts.append(f"<p>and {len(rows) - MAX_ROWS:,} more; pairs.parquet lists all.</p>")
    if audit.failed:
        parts.append(f"<h2>Could not be read</h2>{table(list(audit.failed.items())[:500])}")
    write_page(path, f"Audit of {document['assets']:,} assets", parts)


def _measures(pair: Pair) -> str:
    alike = pair.likeness
    measures = [alike.kind]
    if alike.reach == alike.reach:
        measures.append(f"reach {alike.reach:.3f}")
    if alike.degrees is not None:
        measures.append(f"bones {alike.degrees:.0f}° apart")
    return ", ".join(measures)


class _Pictures:
    """Pictures of characters, each drawn once."""

    def __init__(self) -> None:
        self._drawn: dict[str, tuple[str, str]] = {}

    def of(self, source: Source, lines: list[str]) -> tuple[str, list[str]]:
        """Return a picture and the lines below it."""
        key = f"{source.path}:{source.sample}"
        if key not in self._drawn:
            try:
                with tempfile.TemporaryDirectory() as folder:
                    rig = read_source(source, Path(folder))
            except CutcellError as error:
                return "data:,", [source.name, str(error)]
            counts = f"V {len(rig.mesh.vertices):,}, F {len(rig.mesh.faces):,}"
            self._drawn[key] = picture(rig.mesh.vertices, rig.mesh.faces, rig.weights), counts
        image, counts = self._drawn[key]
        return image, [source.name, counts, *lines]
