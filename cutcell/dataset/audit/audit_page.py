"""The report of an audit: each character beside its matches, nearest first, as in the paper."""

from __future__ import annotations

import tempfile
from collections import defaultdict
from pathlib import Path

from ...errors import CutcellError
from ..read.sources import Source, read_source
from .duplicates import Audit, Pair
from .page import figure, table, write_page
from .pictures import picture

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
            said = audit.verdict(pair)
            verdict = f"a person said: {said}" if said else ""
            lines = [line for line in (far, _told(pair), verdict) if line]
            figures.append(figure(*pictures.of(audit.other_sources[pair.b], lines)))
        parts.append(f"<section>{''.join(figures)}</section>")
    if len(rows) > MAX_ROWS:
        parts.append(f"<p>and {len(rows) - MAX_ROWS:,} more; pairs.parquet lists all.</p>")
    if audit.failed:
        parts.append(f"<h2>Could not be read</h2>{table(list(audit.failed.items())[:500])}")
    write_page(path, f"Audit of {document['assets']:,} assets", parts)


def _told(pair: Pair) -> str:
    alike = pair.likeness
    told = [alike.kind]
    if alike.reach == alike.reach:
        told.append(f"reach {alike.reach:.3f}")
    if alike.degrees is not None:
        told.append(f"bones {alike.degrees:.0f}° apart")
    return ", ".join(told)


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
