"""The server's log; visitors cannot send control sequences to its terminal."""

import logging

from cutcell.runtime.display import printable

LINE = 4000


class Printable(logging.Formatter):
    """Formats requests, names and tracebacks without control sequences."""

    def format(self, record: logging.LogRecord) -> str:
        """Return a record as text."""
        return "\n".join(printable(line, LINE) for line in super().format(record).split("\n"))


def log_to_terminal() -> None:
    """Write warnings and errors to standard error."""
    handler = logging.StreamHandler()
    handler.setFormatter(Printable())
    logging.basicConfig(level=logging.WARNING, handlers=[handler])
    logging.captureWarnings(True)
