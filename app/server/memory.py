"""Memory that ended sessions and finished work held, given back to the system soon after."""

import ctypes
import gc
import sys
import threading

import panel as pn

AFTER = 2.0
"""Seconds after a session or its work ends; what ends meanwhile is tidied up along with it."""

_LOCK = threading.Lock()
_WAITING: list[threading.Timer] = []


def detach_from_panel(page: object) -> None:
    """Take a page out of Panel's own state, which outlives it.

    The page would tell the browser twice with every choice whether Panel is busy, before anything
    that the choice changes; this one shows by itself what goes on.
    """
    state = pn.state
    for watchers in list(state.param.watchers.values()):
        for watcher in [one for kind in watchers.values() for one in kind]:
            if getattr(getattr(watcher.fn, "__self__", None), "self", None) is page:
                state.param.unwatch(watcher)


def settle() -> None:
    """Exclude objects that live as long as the server from collections, which stop all threads."""
    gc.collect()
    gc.freeze()


def collect_later() -> None:
    """Collect unused objects soon, on another thread."""
    with _LOCK:
        while _WAITING:
            _WAITING.pop().cancel()
        timer = threading.Timer(AFTER, tidy)
        timer.daemon = True
        _WAITING.append(timer)
        timer.start()


def tidy() -> None:
    """Collect what is no longer used, and give its memory back to the system."""
    # A page is full of cycles: its document, models, callbacks and session know each other.
    gc.collect()
    if sys.platform == "linux":
        try:
            ctypes.CDLL(None).malloc_trim(0)
        except AttributeError:
            return  # another C library than glibc, which has its own ways
