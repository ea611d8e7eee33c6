"""Origins whose pages may put this page into a frame."""

import re
from collections.abc import Iterable

from cutcell.checks import shown
from cutcell.errors import ParameterError

MAX_HOST, MAX_PORT = 253, 65_535
"""Characters of a host name, and number of a port, at most."""
ORIGIN = re.compile(
    r"(?P<origin>https?://(?P<host>[a-z0-9._-]+|\[[0-9a-f:.]+\])(:(?P<port>[0-9]{1,5}))?)/?"
)
"""Other characters of a host could end the header's directive."""


def check_origins(origins: Iterable[str]) -> tuple[str, ...]:
    """Return origins in lower case, without repetitions, in their order.

    An origin is a scheme, a host and perhaps a port, without a path; all else is a
    `ParameterError`.
    """
    return tuple(dict.fromkeys(_checked(origin) for origin in origins))


def _checked(origin: str) -> str:
    match = ORIGIN.fullmatch(origin.lower())
    if not match or len(match["host"]) > MAX_HOST or not 0 < int(match["port"] or 1) <= MAX_PORT:
        raise ParameterError(
            "--allow-frame takes an origin without a path, such as https://example.org or "
            f"http://localhost:8000, not {shown(origin)}"
        )
    return match["origin"]


def headers_of(origins: Iterable[str]) -> dict[str, str]:
    """Return the headers of a page that these origins and its own may put into a frame."""
    allowed = list(origins)
    headers = {"Content-Security-Policy": " ".join(["frame-ancestors 'self'", *allowed])}
    if not allowed:  # it knows no list of origins, and browsers that read the other ignore it
        headers["X-Frame-Options"] = "SAMEORIGIN"
    return headers
