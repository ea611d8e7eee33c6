"""Release of memory after sessions and work have ended."""

import ctypes
import gc
import sys
import threading

import panel as pn

AFTER = 2.0
"""Seconds after the end of a session or its work."""

_LOCK = threading.Lock()
_WAITING: list[threading.Timer] = []


def detach_from_panel(page: object) -> None:
    """Remove a page's watchers from Panel's global state, which outlives the page.

    With them each choice sends Panel's busy state to the browser twice; the page shows its own.
    """
    state = pn.state
    for watchers in list(state.param.watchers.values()):
        for watcher in [one for kind in watchers.values() for one in kind]:
            if getattr(getattr(watcher.fn, "__self__", None), "self", None) is page:
                state.param.unwatch(watcher)


def freeze() -> None:
    """Exclude all current objects from garbage collections, which stop all threads."""
    gc.collect()
    gc.freeze()


def collect_later() -> None:
    """Collect unused objects soon, on another thread."""
    with _LOCK:
        while _WAITING:
            _WAITING.pop().cancel()
        timer = threading.Timer(AFTER, collect)
        timer.daemon = True
        _WAITING.append(timer)
        timer.start()


def collect() -> None:
    """Collect unused objects, and return their memory to the system."""
    # A page is full of cycles: its document, models, callbacks and session refer to each other.
    gc.collect()
    if sys.platform == "linux":
        try:
            ctypes.CDLL(None).malloc_trim(0)
        except AttributeError:
            return  # another C library than glibc
