"""Where the page is served."""

import socket

import pytest

from app.serve import allowed_origins, free_port


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
    monkeypatch.setattr("app.serve.PORTS_TRIED", 1)
    with pytest.raises(OSError, match="taken"):
        free_port(taken)


def test_who_may_connect():
    assert allowed_origins("localhost", 1) == ["localhost:1", "127.0.0.1:1"]
    assert f"{socket.gethostname()}:1" in allowed_origins("0.0.0.0", 1)
    assert "10.1.2.3:1" in allowed_origins("10.1.2.3", 1)
