"""Tables as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from cutcell.runtime.writing import write_all


@dataclass
class Table:
    """Rows under a title and a sentence that says what was measured.

    Parameters
    ----------
    title : str
    columns : sequence of str
        The first names the row.
    note : str
        What one must know to read it.
    rows : list of sequences of str
    """

    title: str
    columns: Sequence[str]
    note: str = ""
    rows: list[Sequence[str]] = field(default_factory=list)

    def add(self, *cells: object) -> None:
        """Append a row."""
        if len(cells) != len(self.columns):
            raise ValueError(f"{self.title}: {len(cells)} cells for {len(self.columns)} columns")
        self.rows.append([str(cell) for cell in cells])

    def markdown(self) -> str:
        """Format as Markdown, columns aligned so that it also reads well as text."""
        lines = [list(self.columns), *self.rows]
        widths = [max(len(line[k]) for line in lines) for k in range(len(self.columns))]
        rule = ["-" * widths[0], *("-" * (width - 1) + ":" for width in widths[1:])]
        body = [
            "| "
            + " | ".join(
                cell.ljust(width) if k == 0 else cell.rjust(width)
                for k, (cell, width) in enumerate(zip(line, widths, strict=True))
            )
            + " |"
            for line in [lines[0], rule, *lines[1:]]
        ]
        return "\n".join([f"### {self.title}", "", *([self.note, ""] if self.note else []), *body])


def publish(tables: Iterable[Table], out: Path | None) -> None:
    """Print tables, and write them too if a file is named."""
    text = "\n\n".join(table.markdown() for table in tables)
    print(text)
    if out:
        write_all({out: (text + "\n").encode()})


def seconds(value: float) -> str:
    """Format a time with three significant digits."""
    if value < 1e-3:
        return f"{value * 1e6:.0f} us"
    if value < 1:
        return f"{value * 1e3:.3g} ms"
    return f"{value:.3g} s"


def ratio(value: float) -> str:
    """Format how many times faster something is."""
    return f"{value:.1f}x" if value < 10 else f"{value:.0f}x"


def percent(value: float) -> str:
    """Format a relative error."""
    return f"{100 * value:.2f} %"
