"""How much memory the page's server takes for its sessions, and whether it gives it back.

python -m benchmarks.sessions [--sessions 20] [--rounds 2] [--write]
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence

from cutcell_lab.benchmarks.document import PAGE_SPEED, fill
from cutcell_lab.benchmarks.tables import Table

from .report import circumstances
from .visitors import BOUND, Server, Visitor, served

GIVEN_BACK = 45.0
"""Seconds in which the server must have let go of what visitors left.

It looks for sessions that ended every 5 s, and waits 15 s for those who come back; the rest is for
a machine that is busy with other things."""

DOES = {
    "the first demo bound": "",
    "a vertex chosen and three methods compared": "/?panel=compare&vertex=100",
}
"""State of a session when its memory is measured, and the address that brings it there."""

COMPARED = r'(?s)^(?!.*(?:Computing|Waiting)).*"fixed"'
"""Text of the page when its table of methods is filled."""


def visit(server: Server, count: int, query: str) -> list[Visitor]:
    """Open that many sessions at once, and wait until all have done what they should."""
    visitors = [Visitor(server.address, query) for _ in range(count)]
    for visitor in visitors:
        visitor.wait_for(BOUND)
        if "compare" in query:
            visitor.wait_for(COMPARED)
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
        f"{count} sessions open at once; then they leave, and as many others come. Memory that "
        "the server's process has to itself.",
    )
    for does, query in DOES.items():
        with served() as server:
            before = leave(server, visit(server, 1, query))
            table.add(f"each with {does}: one came and left", f"{before:.0f}", "-")
            for turn in range(options.rounds):
                visitors = visit(server, count, query)
                bytes_held = server.megabytes()
                each = (bytes_held - before) / count
                table.add(f"{count} sessions, round {turn + 1}", f"{bytes_held:.0f}", f"{each:.1f}")
                table.add("they left", f"{leave(server, visitors):.0f}", "-")
    return table


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.sessions", description=__doc__)
    parser.add_argument("--sessions", type=int, default=20)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--write", action="store_true", help="into docs/page-speed.md")
    return parser.parse_args(argv)


def main(argv: Sequence[str] | None = None) -> None:
    """Print the table."""
    options = arguments(argv)
    text = f"{circumstances()}\n\n{sessions_table(options).markdown()}\n"
    print(text, end="")
    if options.write:
        fill(PAGE_SPEED, {"sessions": text})


if __name__ == "__main__":
    main()
