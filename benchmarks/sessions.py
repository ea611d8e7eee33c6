"""How much memory the page's server takes for its sessions, and whether it gives it back.

python -m benchmarks.sessions [--sessions 20] [--rounds 3] [--markdown FILE]
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path

from .tables import Table
from .visitors import BOUND, Server, Visitor, served

GIVEN_BACK = 30.0
"""Seconds in which the server must have let go of what visitors left."""


def visit(server: Server, count: int) -> list[Visitor]:
    """Open that many sessions at once, and wait until all have their weights."""
    visitors = [Visitor(server.address) for _ in range(count)]
    for visitor in visitors:
        visitor.wait_for(BOUND)
    return visitors


def leave(server: Server, visitors: list[Visitor], wait: float = GIVEN_BACK) -> float:
    """Close sessions; return the server's memory when it has let go of them, in MB."""
    for visitor in visitors:
        visitor.close()
    time.sleep(wait)
    return server.megabytes()


def sessions_table(options: argparse.Namespace) -> Table:
    """Open and close groups of sessions, and weigh the server."""
    count = options.sessions
    table = Table(
        "Memory of sessions",
        ["", "server, MB", "a session, MB"],
        f"{count} sessions open at once, each with the first demo bound; then they leave, and as "
        "many others come. Memory that the server's process has to itself.",
    )
    with served() as server:
        before = leave(server, visit(server, 1))
        table.add("one session came and left", f"{before:.0f}", "-")
        for turn in range(options.rounds):
            visitors = visit(server, count)
            held = server.megabytes()
            each = (held - before) / count
            table.add(f"{count} sessions, round {turn + 1}", f"{held:.0f}", f"{each:.1f}")
            table.add("they left", f"{leave(server, visitors):.0f}", "-")
    return table


def arguments(given: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.sessions", description=__doc__)
    parser.add_argument("--sessions", type=int, default=20)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--markdown", type=Path)
    return parser.parse_args(given)


def main(given: Sequence[str] | None = None) -> None:
    """Print the table."""
    options = arguments(given)
    text = sessions_table(options).markdown() + "\n"
    print(text, end="")
    if options.markdown:
        options.markdown.write_text(text)


if __name__ == "__main__":
    main()
