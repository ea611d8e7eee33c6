"""Signals of the processes that tests start."""

import signal


def reset_signals() -> None:
    """Let a process, before it begins, heed all signals: `preexec_fn` of its start.

    It inherits which are ignored, as SIGINT is in the background of a shell, and which are blocked.
    """
    for number in ("SIGHUP", "SIGINT", "SIGQUIT", "SIGTERM", "SIGALRM", "SIGXCPU"):
        signal.signal(getattr(signal, number), signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_SETMASK, ())
