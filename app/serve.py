"""The server of the page."""

import errno
import signal
import socket
import sys
import threading
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui  # noqa: F401  its components must be known before a page is served
from bokeh.settings import settings
from bokeh.util.browser import view

from cutcell.cli.console import print_warnings
from cutcell.weights.warm_up import is_compiled, start_process, warm_up
from cutcell_lab.dataset import load_audit
from cutcell_viewers.description import Actor

from .files.upload_cache import UPLOADS
from .jobs.processes import get_ready
from .layout.page import page
from .server.handlers import guard
from .server.log import log_to_terminal
from .server.memory import settle
from .state.pairs import OpenedAudit
from .widgets.modules import STATIC, head

PORTS_TRIED = 20
MAX_MESSAGE = 32 * 1024 * 1024
MAX_BODY = 64 * 1024
"""Bytes of a request's body: nothing is sent that way."""
LOCAL = ("localhost", "127.0.0.1", "::1")

ENDINGS = {
    "check_unused_sessions_milliseconds": 5000,
    "unused_session_lifetime_milliseconds": 15000,
}
"""Sessions whose browser is gone give their memory and files back soon."""

EXPOSED = (
    "the page listens on {address}: everyone who can reach port {port} of this machine can open "
    "it, upload files and let it compute. There is no password, and nothing is encrypted. Without "
    "--address it is served to this machine only."
)


def serve(
    rig: Path | str | None = None,
    port: int = 5006,
    address: str = "localhost",
    show: bool = True,
    pairs: Path | None = None,
    actors: Mapping[str, Actor] | None = None,
) -> None:
    """Serve the page until the process is stopped.

    Parameters
    ----------
    rig : path, optional
        The character to open; a demo when left out.
    port : int
        Where; 0 takes any free one. A port that is taken makes way for the next free one.
    address : str
        What to listen on: "localhost" for this machine only; the address of a network's
        interface, or "0.0.0.0" for all of them, for everyone in that network.
    show : bool
        Whether to open a browser.
    pairs : path, optional
        The folder of an audit whose pairs are looked at.
    actors : mapping of str to Actor, optional
        Meshes to show with every character, in the scene's space, where y is up. Those of a
        PyVista plotter are `cutcell_viewers.describe(plotter).actors`.

    Raises
    ------
    CutcellError
        There is no such audit.
    OSError
        No port is free, or the address is none of this machine's.
    """
    path = None if rig is None else Path(rig)
    opened = None
    if pairs is not None:
        opened = OpenedAudit(pairs, load_audit(pairs))
        print(f"{len(opened.pairs):,} pairs, {len(opened.audit.keep):,} characters to keep")
    chosen = free_port(port, address)
    if port and chosen != port:
        print(f"Port {port} is taken.", flush=True)
    if threading.current_thread() is threading.main_thread():
        # An orderly end, so that what was uploaded is removed.
        signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(0))
    log_to_terminal()
    # Computing in Python gives way to the page's own thread sooner than after 5 ms.
    sys.setswitchinterval(0.001)
    UPLOADS.sweep_by_the_clock()
    threading.Thread(target=get_ready, args=(UPLOADS.storage.make,), daemon=True).start()
    server = begin(path, chosen, address, opened, actors)
    if is_compiled():
        # While the browser starts.
        threading.Thread(target=_warm_up, args=(server,), daemon=True).start()
    else:
        compiling = start_process("warm_up")  # noqa: F841  it ends with this variable
    # It listens from here on; printed earlier, the address might be requested too early.
    host = "localhost" if address in ("0.0.0.0", "::", *LOCAL) else in_brackets(address)
    url = f"http://{host}:{chosen}"
    print(f"The page is at {url} (stop with Ctrl+C)", flush=True)
    if address not in LOCAL:
        print_warnings([EXPOSED.format(address=address, port=chosen)])
    if show:
        server.io_loop.add_callback(view, url)
    server.start()
    server.io_loop.start()


def begin(
    path: Path | None,
    port: int,
    address: str = "localhost",
    opened: OpenedAudit | None = None,
    actors: Mapping[str, Actor] | None = None,
    **more: Any,
) -> Any:
    """Return a server of the page that listens, and whose loop is still to be started.

    Parameters
    ----------
    path : Path, optional
        The character to open; a demo when left out.
    port : int
    address : str
        As in `serve`.
    opened : OpenedAudit, optional
        An audit whose pairs are looked at.
    actors : mapping of str to Actor, optional
        As in `serve`.
    **more
        For `panel.serve`.
    """
    server = pn.serve(
        {"/": lambda: page(path, opened, actors)},
        port=port,
        address="127.0.0.1" if address == "localhost" else address,
        websocket_max_message_size=MAX_MESSAGE,
        http_server_kwargs={"max_body_size": MAX_BODY},
        title="cutcell",
        show=False,
        start=False,
        verbose=False,
        threaded=False,
        **{**ENDINGS, **more},
    )
    text = guard(server._tornado, allowed_hosts(address, port), STATIC, head())
    server.io_loop.add_callback(text.make)
    server.io_loop.add_callback(_settle, server)
    return server


def _warm_up(server: Any) -> None:
    warm_up()
    server.io_loop.add_callback(_settle, server)


def _settle(server: Any) -> None:
    if not server.get_sessions("/"):  # their memory shall be collected
        settle()


def free_port(port: int, address: str = "localhost") -> int:
    """Return the port if it is free, else the next free one after it.

    Raises
    ------
    OSError
        None of the next 20 is free, or the address is none of this machine's.
    """
    host = "127.0.0.1" if address == "localhost" else address
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    for candidate in [port] if port == 0 else range(port, min(port + PORTS_TRIED, 65536)):
        with socket.socket(family, socket.SOCK_STREAM) as trial:
            trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                trial.bind((host, candidate))
            except OSError as error:
                if error.errno not in (errno.EADDRINUSE, errno.EACCES):
                    raise
            else:
                return int(trial.getsockname()[1])
    raise OSError(errno.EADDRINUSE, f"the ports {port} to {port + PORTS_TRIED - 1} are taken")


def allowed_hosts(address: str, port: int) -> list[str]:
    """Return the hosts, with their port, under which a browser may know this server."""
    names = ["localhost", "127.0.0.1", *(["[::1]"] if ":" in address else [])]
    if address not in LOCAL:
        hosts = {in_brackets(address), socket.gethostname(), socket.getfqdn()}
        if address in ("0.0.0.0", "::"):
            hosts |= {in_brackets(str(info[4][0])) for info in _own_addresses()}
        names += sorted(hosts - {*names})
    # Bokeh's own setting, for names that only a person can know: of a proxy, or a tunnel.
    return [*(f"{name}:{port}".lower() for name in names), *settings.allowed_ws_origin()]


def _own_addresses() -> list[Any]:
    with suppress(OSError):  # a machine that does not know its own name
        return socket.getaddrinfo(socket.gethostname(), None)
    return []


def in_brackets(address: str) -> str:
    """Return an address for a URL: IPv6 in brackets, without its zone."""
    return f"[{address.partition('%')[0]}]" if ":" in address else address
