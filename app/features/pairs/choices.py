"""Choices of the panel Pairs: the pair of an audit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import param

from cutcell.rig import Rig
from cutcell_lab.dataset import Audit, Pair

from ...document.state import Panel

TIERS = {
    "All": "all",
    "Twins": "twin",
    "Variants": "variant",
    "Near": "near",
    "In another pose": "posed",
    "Overruled": "overruled",
}


@dataclass(frozen=True, eq=False)
class OpenedAudit:
    """An audit, and the folder that it was read from."""

    folder: Path
    audit: Audit

    @cached_property
    def pairs(self) -> list[Pair]:
        """All pairs: near-duplicates, nearest first, then one skeleton in other poses."""
        return [*self.audit.pairs, *self.audit.posed]


@dataclass(frozen=True, eq=False)
class Beside:
    """The two characters of a pair, by its place among all."""

    pair: int
    rigs: tuple[Rig, Rig]


PANEL = Panel(
    "Pairs",
    '<circle cx="7.5" cy="6" r="2.2"/><path d="M7.5 9v6M4 12h7M7.5 15l-2.5 5M7.5 15l2.5 5"/>'
    '<circle cx="16.5" cy="6" r="2.2"/><path d="M16.5 9v6M13 12h7M16.5 15l-2.5 5M16.5 15l2.5 '
    '5"/>',
    is_rendered=False,
    needs_audit=True,
)


class Choices(param.Parameterized):
    """The audit, and which of its pairs is looked at."""

    opened: Any = param.Parameter(None, doc="An `OpenedAudit`, or None.")
    pair = param.Integer(0, bounds=(0, None), doc="Its place among all pairs.")
    tier: param.Selector[str] = param.Selector(
        default="all", objects=TIERS, doc="Which are stepped through."
    )
    beside: Any = param.Parameter(None, doc="`Beside`: the characters of the pair, once read.")

    @property
    def chosen_pair(self) -> Pair | None:
        """The pair that is looked at; None where there is no audit, or it found none."""
        if self.opened is None:
            return None
        pairs = self.opened.pairs
        return pairs[min(self.pair, len(pairs) - 1)] if pairs else None

    @property
    def stepped(self) -> Sequence[int]:
        """The places of the pairs of the chosen tier."""
        if self.opened is None:
            return []
        audit = self.opened.audit
        near, count = len(audit.pairs), len(self.opened.pairs)
        if self.tier == "posed":
            return range(near, count)
        if self.tier in ("twin", "variant", "near"):
            return [k for k, pair in enumerate(audit.pairs) if pair.tier == self.tier]
        if self.tier == "overruled":
            return [k for k, pair in enumerate(self.opened.pairs) if audit.verdict(pair)]
        return range(count)
