"""The server of the page."""

from __future__ import annotations

import errno
import signal
import socket
import sys
import threading
from pathlib import Path

import panel as pn
import panel_material_ui  # noqa: F401  its components must be known before a page is served

from cutcell.skinning import kernels_are_compiled, load_kernels

from .page import page

PORTS_TRIED = 20
MAX_MESSAGE = 32 * 1024 * 1024
LOCAL = ("localhost", "127.0.0.1", "::1")


def serve(
    rig: Path | str | None = None,
    port: int = 5006,
    address: str = "localhost",
    show: bool = True,
) -> None:
    """Serve the page until the process is stopped.

    Parameters
    ----------
    rig : path, optional
        The character to open; a demo when left out.
    port : int
        Where; 0 takes any free one. A port that is taken makes way for the next free one.
    address : str
        Who may connect: "localhost", or "0.0.0.0" for all.
    show : bool
        Whether to open a browser.

    Raises
    ------
    OSError
        No port is free, or the address is none of this machine's.
    """
    path = None if rig is None else Path(rig)
    chosen = free_port(port, address)
    if port and chosen != port:
        print(f"Port {port} is taken.", flush=True)
    if kernels_are_compiled():
        # While the browser starts. The first compile ever is left to the page, which tells of it.
        threading.Thread(target=load_kernels, daemon=True).start()
    if threading.current_thread() is threading.main_thread():
        # An orderly end, so that what was uploaded is removed.
        signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(0))
    server = pn.serve(
        {"/": lambda: page(path)},
        port=chosen,
        address=None if address == "localhost" else address,
        websocket_origin=allowed_origins(address, chosen),
        websocket_max_message_size=MAX_MESSAGE,
        title="cutcell",
        show=show,
        start=False,
        verbose=False,
        threaded=False,
        # Sessions whose browser is gone give their memory and files back soon.
        check_unused_sessions_milliseconds=5000,
        unused_session_lifetime_milliseconds=15000,
    )
    # It listens from here on; told sooner, the address could be asked for too soon.
    host = "localhost" if address in ("0.0.0.0", "::", *LOCAL) else address
    print(f"The page is at http://{host}:{chosen} (stop with Ctrl+C)", flush=True)
    server.start()
    server.io_loop.start()


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


def allowed_origins(address: str, port: int) -> list[str]:
    """Return the hosts, with their port, under which a browser may know this server."""
    if address in LOCAL:
        return [f"localhost:{port}", f"127.0.0.1:{port}"]
    names = {address, "localhost", "127.0.0.1", socket.gethostname(), socket.getfqdn()}
    if address in ("0.0.0.0", "::"):
        for info in socket.getaddrinfo(socket.gethostname(), None):
            names.add(str(info[4][0]))
    return [f"{name}:{port}" for name in sorted(names)]
