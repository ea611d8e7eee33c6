"""Origins whose pages may put this page into a frame."""

from collections.abc import Iterable
from urllib.parse import urlsplit

from cutcell.checks import shown
from cutcell.errors import ParameterError

MAX_HOST = 253
"""Characters of a host name, at most."""
CHARACTERS = frozenset("abcdefghijklmnopqrstuvwxyz0123456789-._[]:")
"""Characters of a host with its port; all others could end the header's directive."""


def check_origins(origins: Iterable[str]) -> tuple[str, ...]:
    """Return origins in lower case, without repetitions, in their order.

    An origin is a scheme, a host and perhaps a port, without a path; all else is a
    `ParameterError`.
    """
    return tuple(dict.fromkeys(_checked(origin) for origin in origins))


def _checked(origin: str) -> str:
    try:
        parts = urlsplit(origin.lower())
        has_port = parts.port != 0  # ports beyond 65,535 raise
    except ValueError:
        has_port = False
    if not (
        has_port
        and parts.scheme in ("http", "https")
        and parts.hostname
        and not parts.netloc.endswith(":")
        and len(parts.netloc) <= MAX_HOST
        and CHARACTERS.issuperset(parts.netloc)
        and f"{parts.scheme}://{parts.netloc}" == origin.lower().removesuffix("/")
    ):
        raise ParameterError(
            "--allow-frame takes an origin without a path, such as https://example.org or "
            f"http://localhost:8000, not {shown(origin)}"
        )
    return f"{parts.scheme}://{parts.netloc}"


def headers_of(origins: Iterable[str]) -> dict[str, str]:
    """Return the headers of a page that these origins and its own may put into a frame."""
    allowed = list(origins)
    headers = {"Content-Security-Policy": " ".join(["frame-ancestors 'self'", *allowed])}
    if not allowed:  # it knows no list of origins, and browsers that read the other ignore it
        headers["X-Frame-Options"] = "SAMEORIGIN"
    return headers
