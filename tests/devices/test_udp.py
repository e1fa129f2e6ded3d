"""Sensors that send to one port of this computer are distinguished, and none takes another's datagrams."""

import select
import socket
import threading
from collections.abc import Iterator, Sequence

import numpy as np
import pytest

from devices.drivers.ximu3 import Ximu3
from devices.emulators.transports import Emulation, UdpSender
from devices.emulators.ximu3 import Ximu3Voice
from devices.live import SourceLostError, SourceRefusedError
from devices.stream import ByteSource
from devices.transport.channels import UdpChannel
from tests.devices.scripted import free_port

RATE_HZ, LISTENS = 200, 25


@pytest.fixture
def port() -> int:
    return free_port()


@pytest.fixture
def sources(port: int) -> Iterator[list[ByteSource]]:
    """Three sensors of one address, each with a rate that states which it is."""
    emulations, sources = [], []
    for number in range(3):
        voice = Ximu3Voice(f"S{number}", lambda k, n=number: (100.0 * n, float(k), 0, 0, 0, 1), rate_hz=RATE_HZ)  # type: ignore[misc]  # the default binds the loop's value
        transport = UdpSender(port)
        emulations.append(Emulation(voice, lambda transport=transport: transport))  # type: ignore[misc]  # the default binds it, too
        sources.append(ByteSource(Ximu3(), UdpChannel(transport.address, transport.port, port)))
    yield sources
    for emulation in emulations:
        emulation.close()


def received(source: ByteSource, reads: int, into: list[np.ndarray]) -> None:
    for _ in range(reads):
        into += [block.gyr_rad_s for block in source.read(lambda _data: None)]


def numbers(blocks: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    rates = np.degrees(np.concatenate(blocks)).round().astype(int)
    return rates[:, 0], rates[:, 1]


def test_each_receives_its_own_and_loses_nothing(sources: list[ByteSource]) -> None:
    for source in sources:
        source.open()
    got: list[list[np.ndarray]] = [[] for _ in sources]
    threads = [
        threading.Thread(target=received, args=(source, LISTENS, blocks))
        for source, blocks in zip(sources, got, strict=True)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [source.info.sensors for source in sources] == [("S0",), ("S1",), ("S2",)]
    for number, blocks in enumerate(got):
        who, counted = numbers(blocks)
        assert set(who) == {100 * number}
        assert (np.diff(counted) == 1).all()
    sources[0].close()
    left: list[np.ndarray] = []
    received(sources[1], 5, left)
    assert left, "one that is closed takes none of the others along"
    with pytest.raises(SourceLostError):
        sources[0].read(lambda _data: None)
    for source in sources[1:]:
        source.close()


def test_the_port_is_free_again_and_refused_where_another_program_has_it(port: int) -> None:
    channel = UdpChannel("127.0.0.1", 1, port)
    for _ in range(2):
        channel.open()
        channel.close()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("", port))
        with pytest.raises(SourceRefusedError, match="in use by another program"):
            channel.open()


def test_a_read_hands_on_what_is_there_and_does_not_wait_for_more(port: int, monkeypatch: pytest.MonkeyPatch) -> None:
    waited_s: list[float] = []

    def is_there(sockets: Sequence[socket.socket], _writing: object, _odd: object, wait_s: float) -> object:
        waited_s.append(wait_s)
        return ready(sockets, [], [], 0.0)

    ready = select.select
    monkeypatch.setattr(select, "select", is_there)
    channel = UdpChannel("127.0.0.1", 1, port)
    channel.open()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for datagram in (b"one", b"two"):
            sender.sendto(datagram, ("127.0.0.1", port))
    assert channel.read() == b"onetwo"
    channel.close()
    assert waited_s == [0.0, 0.0]
