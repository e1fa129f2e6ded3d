"""Sensors are found at ports and announced on the network, each once; the other ports say why not."""

import json
import socket
import sys
import threading
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from devices.catalogue import DRIVERS
from devices.drivers.lsl import LslSensor, LslStream, sensors_of
from devices.drivers.shimmer3 import EMULATED as SHIMMER3
from devices.emulators.shimmer3 import Shimmer3Voice
from devices.emulators.transports import Emulation, PseudoTerminal, Voice
from devices.emulators.witmotion import WitVoice
from devices.emulators.ximu3 import Ximu3Voice
from devices.emulators.xsens_mti import MtiVoice
from devices.live import SourceRefusedError
from devices.search import announcement, search, search_streams
from devices.transport import ports as ports_module
from devices.transport.ports import MORE_PORTS, PortInfo, SerialPort, list_ports
from tests.devices.scripted import SilentVoice, free_port


def motion(number: int) -> tuple[float, ...]:
    return (number % 100, 0.0, 0.0, 0.0, 0.0, 1.0)


@pytest.fixture(autouse=True)
def streams(monkeypatch: pytest.MonkeyPatch) -> list[LslStream]:
    """What is streamed; nothing that others stream on this network."""
    there: list[LslStream] = []
    monkeypatch.setattr("devices.search.find_streams", lambda address: tuple(there))
    return there


@pytest.fixture
def emulated(tmp_path: Path) -> Iterator[list[PortInfo]]:
    voices: dict[str, Voice] = {
        "a": Ximu3Voice("0000000A", motion),
        "b": Ximu3Voice("0000000B", motion, is_binary=False),
        "c": WitVoice("000C", motion),
        "d": SilentVoice(),
        "e": Shimmer3Voice(name=f"{SHIMMER3} E"),
        "f": left_in_configuration(),
    }
    emulations = [Emulation(voice, partial(PseudoTerminal, tmp_path / name)) for name, voice in voices.items()]
    yield [PortInfo(emulation.place, is_named=True) for emulation in emulations]
    for emulation in emulations:
        emulation.close()


def left_in_configuration() -> MtiVoice:
    voice = MtiVoice()
    voice.is_measuring = False
    return voice


@pytest.mark.endurance
def test_each_sensor_is_found_by_its_driver(emulated: list[PortInfo], tmp_path: Path) -> None:
    found = search([*emulated, PortInfo(str(tmp_path / "nothing"), is_named=True)], free_port())
    assert {(one.driver, one.name) for one in found.sensors} == {
        ("ximu3", "0000000A"),
        ("ximu3", "0000000B"),
        ("witmotion", "EMULATED000C"),
        ("shimmer3", f"{SHIMMER3} E"),
        ("xsens-mti", "MTi 0280A1B2"),
    }
    assert all(one.is_simulated for one in found.sensors)
    assert [str(one.refusal).partition(". ")[0] for one in found.passed] == [
        f"No signal from a sensor at {tmp_path / 'd'}",
        f"{tmp_path / 'nothing'} was not found",
    ]
    source = found.of("ximu3")[0].make()
    source.open()
    assert source.info.sensors == ("0000000A",)
    source.close()


@pytest.mark.endurance
def test_a_sensor_that_was_left_streaming_is_found_again(tmp_path: Path) -> None:
    """Its packets hold bytes that look like messages of an x-IMU3."""
    voice = Shimmer3Voice(lambda number: (10, 200 + number % 2, 10, 1000, 10, 1000), name=f"{SHIMMER3} E")
    emulation = Emulation(voice, partial(PseudoTerminal, tmp_path / "port"))
    port = PortInfo(emulation.place, is_named=True)
    for _ in range(2):
        found = search([port], free_port())
        assert [one.driver for one in found.sensors] == ["shimmer3"]
        while not voice.is_streaming:
            time.sleep(0.01)
        time.sleep(0.5)
    emulation.close()


def test_a_port_in_use_states_so(emulated: list[PortInfo]) -> None:
    holding = SerialPort(emulated[0])
    holding.open()
    with pytest.raises(SourceRefusedError, match="is in use by another program"):
        SerialPort(emulated[0]).open()
    holding.close()


@pytest.mark.endurance
def test_what_is_announced_on_the_network_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("devices.search._has_network", lambda: True)
    at_port = free_port()
    reported = {"name": "x-IMU3", "sn": "655782F7", "ip": "10.0.0.9", "port": 7000, "send": 8000, "receive": 9000}
    ends = threading.Event()

    def announce() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sending:
            while not ends.wait(0.1):
                sending.sendto(json.dumps(reported).encode(), ("127.0.0.1", at_port))

    thread = threading.Thread(target=announce)
    thread.start()
    found = search([], at_port)
    ends.set()
    thread.join()
    (one,) = found.sensors
    assert (one.driver, one.name, one.place) == ("ximu3", "655782F7", "TCP 127.0.0.1:7000")


@pytest.mark.endurance
def test_streams_of_motion_are_found_and_others_say_why_not(
    monkeypatch: pytest.MonkeyPatch, streams: list[LslStream]
) -> None:
    reported = {
        "Consensys": ["gyr_x", "gyr_y", "gyr_z", "acc_x", "acc_y", "acc_z"],
        "heart": ["ECG"],
        "no units": ["gyr_x", "gyr_y", "gyr_z", "acc_x", "acc_y", "acc_z"],
    }
    streams += [LslStream(name, "", name, "here", 100.0) for name in reported]

    def sensors(stream: LslStream) -> tuple[LslSensor, ...]:
        units = ["deg/s"] * 3 + ["g"] * 3 if stream.name != "no units" else []
        return sensors_of(stream.name, reported[stream.name], units)

    monkeypatch.setattr("devices.search.announced_sensors", sensors)
    assert search([], free_port()).sensors == ()  # nobody asked
    found = search_streams("127.0.0.1")
    assert [(one.driver, one.name, one.count) for one in found.sensors] == [("lsl", "Consensys", 1)]
    assert [str(one.refusal).partition(". ")[0] for one in found.passed] == ["The stream no units gives no units"]


def test_where_there_is_no_network_no_port_is_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("devices.search._has_network", lambda: False)
    monkeypatch.setattr("devices.search.socket", None)
    assert search([]).sensors == ()


@pytest.mark.parametrize(
    "datagram", [b"", b"{", b"[]", b"[" * 2000, b'{"sn":5}', b'{"sn":"A"}', b'{"sn":"A","port":99999}', b"\xff\xfe"]
)
def test_another_datagram_is_no_sensor(datagram: bytes) -> None:
    assert announcement(datagram, "127.0.0.1") is None


@pytest.mark.endurance
def test_the_search_takes_a_second_or_two() -> None:
    begin_s = time.monotonic()
    assert search([], free_port()).sensors == ()
    assert time.monotonic() - begin_s < 3.0


def test_a_port_without_permission_names_the_group(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def refuse(*_arguments: object, **_settings: object) -> None:
        raise PermissionError(13, "Permission denied")

    (tmp_path / "port").touch()
    monkeypatch.setattr(ports_module, "Serial", refuse)
    monkeypatch.setattr(sys, "platform", "linux")
    with pytest.raises(SourceRefusedError, match="Only members of the group") as refused:
        SerialPort(PortInfo(str(tmp_path / "port"))).open()
    assert "usermod -aG" in refused.value.remedy


def test_a_port_is_found_again_by_what_is_plugged_in(emulated: list[PortInfo]) -> None:
    before = PortInfo("/nowhere/ttyACM0", serial="S1", usb=(1, 2))
    now = [PortInfo(emulated[1].device, serial="other", usb=(1, 2)), PortInfo(emulated[0].device, "", "S1", (1, 2))]
    port = SerialPort(before, list_all=lambda: now)
    port.open()
    assert port.place == emulated[0].device
    port.close()


def test_ports_are_listed_and_more_can_be_reported(monkeypatch: pytest.MonkeyPatch, emulated: list[PortInfo]) -> None:
    monkeypatch.setenv(MORE_PORTS, f"{emulated[0].device}:/nowhere/at-all")
    assert emulated[0].device in [port.device for port in list_ports()]
    assert "/nowhere/at-all" not in [port.device for port in list_ports()]


def test_every_driver_states_how_it_was_proved() -> None:
    assert len({driver.key for driver in DRIVERS}) == len(DRIVERS)
    assert all(len(driver.proof) > 40 for driver in DRIVERS)
