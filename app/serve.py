"""The server of the page."""

import errno
import secrets
import signal
import socket
import sys
import threading
from collections.abc import Collection, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui  # noqa: F401  registers its components before a page is served
from bokeh.settings import settings
from bokeh.util.browser import view
from tornado.httpserver import HTTPServer

from cutcell.cli.console import print_warnings
from cutcell.weights.warm_up import is_compiled, start_process, warm_up
from cutcell_viewers.description import Actor

from .derive.processes import get_ready
from .features.opened import open_audit, read_checked
from .files.upload_cache import UPLOADS
from .server.connections import LimitedServer
from .server.frames import check_origins
from .server.handlers import guard
from .server.log import log_to_terminal
from .server.memory import freeze
from .server.writes import patch_panel_dispatch
from .shell.page import page
from .shell.session.reload import PAGES
from .widgets.modules import STATIC, head

PORTS_TRIED = 20
MAX_MESSAGE = 32 * 1024 * 1024
MAX_BODY = 64 * 1024
"""Bytes of a request's body; uploads use the websocket."""
TIMEOUTS = {"idle_connection_timeout": 75, "body_timeout": 30}
"""Seconds for the headers of a request, or until the next one, and for its body. Proxies reuse a
connection for 60 s, as a rule."""
LOCAL = ("localhost", "127.0.0.1", "::1")

ENDINGS = {
    "check_unused_sessions_milliseconds": 5000,
    "unused_session_lifetime_milliseconds": 15000,
}
"""Sessions whose browser is gone end soon, with their memory and files."""

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
    frames: Collection[str] = (),
    lesson: Path | None = None,
) -> None:
    """Serve the page until the process is stopped.

    Parameters
    ----------
    rig : path, optional
        The character to open; a demo when left out.
    port : int
        The next free port is used if this one is taken, and any free one if it is 0.
    address : str
        "localhost" for this machine only; the address of a network's interface, or "0.0.0.0" for
        all of them, for everyone in that network.
    show : bool
        Whether to open a browser.
    pairs : path, optional
        The folder of an audit whose pairs are reviewed.
    actors : mapping of str to Actor, optional
        Meshes to show with every character, in the scene's space, where y is up. Those of a
        PyVista plotter are `cutcell_viewers.describe(plotter).actors`.
    frames : collection of str
        Origins whose pages may put this page into a frame, such as "https://example.org".
    lesson : path, optional
        The folder or the file of a lesson that takes the place of the one that comes with the page.

    Raises
    ------
    CutcellError
        There is no such audit, one of `frames` is no origin, or a step of the lesson is wrong.
    OSError
        No port is free, or the address does not belong to this machine.
    """
    path, frames = None if rig is None else Path(rig), check_origins(frames)
    choices: dict[str, Any] = {"actors": dict(actors or {})}
    if pairs is not None:
        opened = choices["opened"] = open_audit(pairs)
        print(f"{len(opened.pairs):,} pairs, {len(opened.audit.keep):,} characters to keep")
    if lesson is not None:
        choices["lesson"] = read_checked(lesson)
    chosen = free_port(port, address)
    if port and chosen != port:
        print(f"Port {port} is taken.", flush=True)
    log_to_terminal()
    # Computations in Python yield to the page's own thread earlier than after 5 ms.
    sys.setswitchinterval(0.001)
    UPLOADS.sweep_by_the_clock(PAGES.sweep)
    threading.Thread(target=get_ready, args=(UPLOADS.storage.make,), daemon=True).start()
    server = begin(path, chosen, address, choices, frames)
    if threading.current_thread() is threading.main_thread():
        # An orderly end removes uploaded files. Python ignores an exit within a finaliser, where
        # the signal may arrive, so the server's loop ends the process.
        end = server.io_loop.asyncio_loop.call_soon_threadsafe
        signal.signal(signal.SIGTERM, lambda *_: end(sys.exit))
    if is_compiled():
        # While the browser starts.
        threading.Thread(target=_warm_up, args=(server,), daemon=True).start()
    else:
        compiling = start_process()  # noqa: F841  it ends with this variable
    # Printed earlier, the address could be requested before the server listens.
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
    choices: Mapping[str, Any] | None = None,
    frames: Collection[str] = (),
    **more: Any,
) -> Any:
    """Return a listening server of the page, whose loop is not started yet; see `serve`.

    `choices` are parameters of each page's state. Further arguments are those of `panel.serve`.
    """
    patch_panel_dispatch()
    HTTPServer.configure(LimitedServer)
    server = pn.serve(
        {"/": lambda: page(path, choices or {})},
        port=port,
        address="127.0.0.1" if address == "localhost" else address,
        websocket_max_message_size=MAX_MESSAGE,
        http_server_kwargs={"max_body_size": MAX_BODY, **TIMEOUTS},
        sign_sessions=True,
        secret_key=secrets.token_bytes(32),
        title="cutcell",
        show=False,
        start=False,
        verbose=False,
        threaded=False,
        **{**ENDINGS, **more},
    )
    HTTPServer.configure(None)  # of other servers in this process
    text = guard(server._tornado, allowed_hosts(address, port), STATIC, head(), frames)
    server.io_loop.add_callback(lambda: text.text)
    server.io_loop.add_callback(_freeze_when_unused, server)
    return server


def _warm_up(server: Any) -> None:
    warm_up()
    server.io_loop.add_callback(_freeze_when_unused, server)


def _freeze_when_unused(server: Any) -> None:
    if not server.get_sessions("/"):  # memory of sessions must stay collectable
        freeze()


def free_port(port: int, address: str = "localhost") -> int:
    """Return the port if it is free, else one of the next 20; raise an OSError if none is."""
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
    """Return the hosts, with their port, that browsers may use for this server."""
    names = ["localhost", "127.0.0.1", *(["[::1]"] if ":" in address else [])]
    if address not in LOCAL:
        hosts = {in_brackets(address), socket.gethostname(), socket.getfqdn()}
        if address in ("0.0.0.0", "::"):
            hosts |= {in_brackets(str(info[4][0])) for info in _own_addresses()}
        names += sorted(hosts - {*names})
    # Bokeh's own setting, for names of a proxy or a tunnel.
    return [*(f"{name}:{port}".lower() for name in names), *settings.allowed_ws_origin()]


def _own_addresses() -> list[Any]:
    with suppress(OSError):  # a machine that cannot resolve its own name
        return socket.getaddrinfo(socket.gethostname(), None)
    return []


def in_brackets(address: str) -> str:
    """Return an address for a URL: IPv6 in brackets, without its zone."""
    return f"[{address.partition('%')[0]}]" if ":" in address else address
