"""Where the page is served."""

import socket
import subprocess
import sys

import pytest

from cutcell_app.serve import allowed_hosts, free_port
from tests.signals import reset_signals

pytestmark = pytest.mark.slow

STOPPED_IN_A_FINALISER = """
import os, signal, weakref
from cutcell_app import serve

class Thing:
    pass

def stop():
    thing = Thing()
    reference = weakref.ref(thing, lambda _: os.kill(os.getpid(), signal.SIGTERM) or sum(range(9)))
    del thing

def begin(*arguments, begin=serve.begin, **options):
    server = begin(*arguments, **options)
    server.io_loop.add_callback(stop)
    return server

serve.begin = begin
serve.serve(None, port=0, show=False)
"""


@pytest.fixture
def taken():
    with socket.socket() as held:
        held.bind(("127.0.0.1", 0))
        held.listen()
        yield held.getsockname()[1]


def test_a_taken_port_makes_way_for_another(taken):
    assert taken < free_port(taken) < taken + 20


def test_any_free_port():
    assert free_port(0) > 0


def test_an_address_of_another_machine_is_an_error():
    with pytest.raises(OSError):
        free_port(0, "192.0.2.1")


def test_when_all_ports_are_taken(monkeypatch, taken):
    monkeypatch.setattr("cutcell_app.serve.PORTS_TRIED", 1)
    with pytest.raises(OSError, match="taken"):
        free_port(taken)


def test_under_which_names_browsers_know_it(monkeypatch):
    assert allowed_hosts("localhost", 1) == ["localhost:1", "127.0.0.1:1"]
    assert "[::1]:1" in allowed_hosts("::1", 1)
    assert f"{socket.gethostname().lower()}:1" in allowed_hosts("0.0.0.0", 1)
    assert "10.1.2.3:1" in allowed_hosts("10.1.2.3", 1)
    assert "[fe80::1]:1" in allowed_hosts("fe80::1%eth0", 1)
    monkeypatch.setenv("BOKEH_ALLOW_WS_ORIGIN", "rigs.example:443")
    assert "rigs.example:443" in allowed_hosts("localhost", 1)


def test_a_machine_that_does_not_know_its_own_name_serves_all_the_same(monkeypatch):
    def unknown(*args, **kwargs):
        raise socket.gaierror("no such name")

    monkeypatch.setattr(socket, "getaddrinfo", unknown)
    assert "localhost:1" in allowed_hosts("0.0.0.0", 1)


def test_a_signal_within_a_finaliser_ends_the_server():
    program = [sys.executable, "-c", STOPPED_IN_A_FINALISER]
    subprocess.run(program, check=True, timeout=240, preexec_fn=reset_signals)
