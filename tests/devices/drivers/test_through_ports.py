"""Sensors that are pulled out of a real port and put in again."""

from collections.abc import Callable
from pathlib import Path

import pytest

from devices.drivers.shimmer3 import Shimmer3
from devices.drivers.xsens_mti import XsensMti
from devices.emulators.shimmer3 import Shimmer3Voice
from devices.emulators.transports import Emulation, PseudoTerminal
from devices.emulators.xsens_mti import MtiVoice
from devices.live import SourceLostError
from devices.stream import ByteSource, SensorProtocol
from devices.transport.ports import PortInfo, SerialPort
from tests.devices.scripted import received_for


@pytest.mark.parametrize(
    ("make_voice", "protocol"),
    [
        pytest.param(Shimmer3Voice, Shimmer3(), marks=pytest.mark.endurance, id="Shimmer3"),
        pytest.param(MtiVoice, XsensMti(), id="MTi"),
    ],
)
def test_a_sensor_that_vanishes_and_returns_goes_on_with_its_name(
    make_voice: Callable[[], Shimmer3Voice | MtiVoice], protocol: SensorProtocol, port: Path
) -> None:
    emulation = Emulation(make_voice(), lambda: PseudoTerminal(port))
    source = ByteSource(protocol, SerialPort(PortInfo(emulation.place)))
    source.open()
    try:
        before, _ = received_for(source, 0.2)
        emulation.vanish()
        with pytest.raises(SourceLostError):
            received_for(source, 1.0)
        source.close()
        emulation.come_back()
        source.open()  # the Shimmer3 was still streaming
        blocks, _ = received_for(source, 0.2)
    finally:
        source.close()
        emulation.close()
    assert {block.sensor for block in blocks} == {block.sensor for block in before} == set(source.info.sensors)
    assert sum(len(block) for block in blocks) > 10
