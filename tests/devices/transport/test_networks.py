"""Tests that this computer's addresses are found and that nobody is asked for them."""

import ipaddress
import socket
import sys
from pathlib import Path

import pytest

from devices.transport.networks import own_addresses


@pytest.mark.skipif(sys.platform == "win32", reason="there the system's list of names is asked")
def test_they_are_addresses_that_others_know_it_by_and_nothing_is_sent_for_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Mute(socket.socket):
        def connect(self, address: object) -> None:
            pytest.fail(f"{address} was called")

        def sendto(self, *reported: object) -> int:
            pytest.fail(f"{reported} was sent")

    monkeypatch.setattr(socket, "socket", Mute)
    monkeypatch.setattr(socket, "getaddrinfo", None)
    found = [ipaddress.IPv4Address(address) for address in own_addresses()]
    assert not any(address.is_loopback or address.is_multicast or address.is_unspecified for address in found)


@pytest.mark.skipif(sys.platform != "linux", reason="asks Linux for its routes")
def test_every_network_that_the_computer_has_a_route_into_is_among_them() -> None:
    routes = Path("/proc/net/route").read_text(encoding="ascii").splitlines()[1:]
    assert bool(own_addresses()) == bool(routes)
