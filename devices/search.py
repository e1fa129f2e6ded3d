"""Search for sensors at ports, by Bluetooth LE, where x-IMU3s announce themselves, and in streams asked for."""

import json
import socket
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType

from devices.catalogue import DRIVERS, Driver
from devices.dot.samples import DRIVER as MOVELLA_DOT
from devices.dot.sensor import DotSensor, is_dot
from devices.dot.source import DotGroup, DotSource
from devices.drivers.csv_serial import DRIVER as CSV
from devices.drivers.csv_serial import Columns, CsvSerial
from devices.drivers.lines import LinesAt, columns_in
from devices.drivers.lsl import DRIVER as LSL
from devices.drivers.lsl import LslSource, OtherStreamError, announced_sensors, find_streams
from devices.drivers.witmotion_ble import DRIVER as WITMOTION_BLE
from devices.drivers.witmotion_ble import WitBleSource, is_wit, wit_name
from devices.drivers.ximu3 import DRIVER as XIMU3
from devices.drivers.ximu3 import Ximu3
from devices.live import LiveSource, SourceLostError, SourceRefusedError
from devices.other_drivers import BrokenDriverError, other_source
from devices.source import SourceInfo
from devices.stream import ByteSource, Framer
from devices.transport.bluetooth import Radio
from devices.transport.channels import Channel, TcpChannel, UdpChannel
from devices.transport.ports import PortInfo, SerialPort, list_ports

LISTEN_S = 0.4  # ten samples of the slowest rate that is of use, and a sensor's whole burst
LEAST = 3  # messages
ANSWER_S, MOST_ANSWER = 0.5, 4096  # what sends more is something else
ANNOUNCED_AT = 10000  # the port where x-IMU3s report once a second that they are there
ANNOUNCED_S = 1.3
MOST_DATAGRAM = 2048
BLUETOOTH = "Bluetooth"  # the place of what is received through it
NO_COLUMNS: Mapping[str, Columns] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class FoundSensor:
    """A sensor that was found, or `count` of them in one stream.

    `make` gives a source of it; nothing is open until that is opened. `rssi_dbm`: how strongly it was received by air.
    """

    driver: str
    name: str
    place: str
    make: Callable[[], LiveSource]
    is_simulated: bool = False
    count: int = 1
    rssi_dbm: int | None = None


@dataclass(frozen=True, slots=True)
class Passed:
    """A port at which no sensor was found, and what to do about it."""

    port: PortInfo
    refusal: SourceRefusedError


@dataclass(frozen=True, slots=True)
class SearchResult:
    """What one search found: sensors, ports that were passed over and why, ports that send lines of numbers.

    `deaf`: why nothing was received by Bluetooth LE, where it should have been. `others`: the drivers of other packages
    that took part, `broken`: which of them failed meanwhile, each once.
    """

    sensors: tuple[FoundSensor, ...] = ()
    passed: tuple[Passed, ...] = ()
    lines: tuple[LinesAt, ...] = ()
    deaf: SourceRefusedError | None = None
    others: tuple[Driver, ...] = ()
    broken: tuple[BrokenDriverError, ...] = ()

    def of(self, driver: str) -> tuple[FoundSensor, ...]:
        return tuple(sensor for sensor in self.sensors if sensor.driver == driver)


def search(
    ports: Sequence[PortInfo] | None = None,
    announced_at: int = ANNOUNCED_AT,
    columns: Mapping[str, Columns] = NO_COLUMNS,  # of lines of numbers, by the `key` of their port
    radio: Radio | None = None,  # None: no Bluetooth LE
    others: Sequence[Driver] = (),  # of other packages, as `load_drivers` gives them
) -> SearchResult:
    """Listen to ports and the network for 1 to 4 s, each sensor named once; nothing is sent but to ports.

    Ports with nothing plugged in are left alone, and those of Bluetooth, unless bound or a sensor's by their name.
    """
    looked_at = [port for port in (list_ports() if ports is None else ports) if port.is_likely]
    received: list[FoundSensor | Passed | LinesAt] = []
    broken: list[BrokenDriverError] = []
    works = [
        threading.Thread(target=lambda port=port: received.append(_at_port(port, columns, others, broken)), daemon=True)
        for port in looked_at
    ]
    on_network: list[FoundSensor] = []
    works.append(threading.Thread(target=lambda: on_network.extend(_announced(announced_at)), daemon=True))
    by_radio: list[FoundSensor | SourceRefusedError] = []
    if radio is not None:
        works.append(threading.Thread(target=lambda: by_radio.extend(_by_radio(radio)), daemon=True))
    for work in works:
        work.start()
    for work in works:
        work.join()
    by_name: dict[tuple[str, str], FoundSensor] = {}
    at_ports = sorted((one for one in received if isinstance(one, FoundSensor)), key=lambda one: one.place)
    lines = sorted((one for one in received if isinstance(one, LinesAt)), key=lambda one: one.port.device)
    at_ports += [_of_lines(one) for one in lines if one.columns is not None]
    in_air = [one for one in by_radio if isinstance(one, FoundSensor)]
    for one in [*at_ports, *on_network, *in_air]:  # by cable rather than by radio
        by_name.setdefault((one.driver, one.name), one)
    passed = sorted((one for one in received if isinstance(one, Passed)), key=lambda one: one.port.device)
    deaf = next((one for one in by_radio if isinstance(one, SourceRefusedError)), None)
    failed = {str(one): one for one in broken}
    return SearchResult(
        tuple(by_name.values()), tuple(passed), tuple(lines), deaf, tuple(others), tuple(failed.values())
    )


def _by_radio(radio: Radio) -> Sequence[FoundSensor | SourceRefusedError]:
    """The sensors that announce themselves by Bluetooth LE, DOTs all of one group; or why none could be received."""
    try:
        announced = sorted(radio.run(radio.announced()), key=lambda one: one.address)
    except SourceRefusedError as refusal:
        return [refusal]
    dots = [one for one in announced if is_dot(one)]
    group = DotGroup(radio, [DotSensor(radio, one) for one in dots])
    found = []
    for one, sensor in zip(dots, group.sensors, strict=True):
        make = partial(DotSource, sensor, group)
        found.append(FoundSensor(MOVELLA_DOT, sensor.name, BLUETOOTH, make, rssi_dbm=one.rssi_dbm))
    for one in (one for one in announced if is_wit(one)):
        make_wit = partial(WitBleSource, radio, one)
        found.append(FoundSensor(WITMOTION_BLE, wit_name(one), BLUETOOTH, make_wit, rssi_dbm=one.rssi_dbm))
    return found


def _at_port(
    port: PortInfo, columns: Mapping[str, Columns], others: Sequence[Driver], broken: list[BrokenDriverError]
) -> FoundSensor | Passed | LinesAt:
    drivers = (*DRIVERS, *others)
    bauds = dict.fromkeys(baud for driver in drivers if driver.protocol for baud in driver.bauds)
    for baud in bauds:
        channel = SerialPort(port, baud)
        try:
            channel.open()
            driver, is_sure, stated = _recognised(channel, port, drivers, broken)
            if driver is None and (count := columns_in(stated)):
                return LinesAt(port, baud, count, columns.get(port.key))
            if not is_sure:
                driver = _answering(channel, drivers) or driver
            if driver is not None and driver.protocol is not None:
                info, _ = driver.protocol().greet(channel)
                return FoundSensor(
                    driver.key, info.sensors[0], port.device, _making(driver, port, baud), info.is_simulated
                )
        except SourceRefusedError as refusal:
            broken += [refusal] if isinstance(refusal, BrokenDriverError) else []
            return Passed(port, refusal)
        except SourceLostError:
            break
        finally:
            channel.close()
    return Passed(port, _silence(port.device))


def _silence(place: str) -> SourceRefusedError:
    return SourceRefusedError(
        "No signal from a sensor at {place}",
        "Switch it on, and set it to send angular rates and accelerations",
        place=place,
    )


def _of_lines(lines: LinesAt) -> FoundSensor:
    port, columns, name = lines.port, lines.columns, lines.port.serial or Path(lines.port.device).name

    def make() -> LiveSource:
        return ByteSource(CsvSerial(columns, name), SerialPort(port, lines.baud))

    return FoundSensor(CSV, name, port.device, make)


def _recognised(
    channel: Channel, port: PortInfo, drivers: Sequence[Driver], broken: list[BrokenDriverError]
) -> tuple[Driver | None, bool, bytes]:
    """Whose messages these are, those damaged least, ours first; whether that is sure; and what was received."""
    # messages without a sample among damaged ones are no proof: another sensor's packets may look like them
    stated = b""
    candidates: list[tuple[Driver, Framer]] = []
    for driver in drivers:
        if driver.protocol is not None:
            with _kept_out(broken):
                candidates.append((driver, driver.protocol().framer(SourceInfo(driver.key, ""))))
    until_s = time.monotonic() + LISTEN_S
    while time.monotonic() < until_s:
        data, now_s = channel.read(), time.monotonic()
        stated += data
        understanding = []
        for driver, framer in candidates:
            with _kept_out(broken):
                framer.feed(data, now_s)
                understanding.append((driver, framer))
        candidates = understanding
    # a sensor may send what it is not asked for yet; noise is understood by nobody
    understood = [
        (
            bool(framer.received.rows) or not framer.received.damaged,
            driver in DRIVERS,
            whole - framer.received.damaged,
            driver,
        )
        for driver, framer in candidates
        if (whole := len(framer.received.rows) + framer.received.skipped) >= LEAST and whole > framer.received.damaged
    ]
    if understood:
        is_sure, _, _, found = max(understood, key=lambda one: one[:3])
        return found, is_sure, stated
    return next((one for one in drivers if one.hint and one.hint in port.description), None), False, stated


@contextmanager
def _kept_out(broken: list[BrokenDriverError]) -> Iterator[None]:
    """What another package's driver does wrong leaves that driver out."""
    try:
        yield
    except BrokenDriverError as problem:
        broken.append(problem)


def _answering(channel: SerialPort, drivers: Sequence[Driver]) -> Driver | None:
    """Who answers a question that only one maker's sensors understand."""
    for driver in drivers:
        if not driver.knock or channel.baud not in driver.bauds:
            continue
        stated, until_s = b"", time.monotonic() + ANSWER_S
        channel.write(driver.knock)
        while time.monotonic() < until_s and len(stated) < MOST_ANSWER:
            stated += channel.read()
            if driver.knocked in stated:
                return driver
    return None


def _making(driver: Driver, port: PortInfo, baud: int) -> Callable[[], LiveSource]:
    def make() -> LiveSource:
        assert driver.protocol is not None
        of_whom = ByteSource if driver in DRIVERS else other_source
        return of_whom(driver.protocol(), SerialPort(port, baud))

    return make


def _announced(at_port: int) -> list[FoundSensor]:
    """The x-IMU3s that announce themselves within a second or so."""
    if not _has_network():
        return []
    found: dict[str, FoundSensor] = {}
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listening:
        try:
            listening.bind(("", at_port))
        except OSError:  # the maker's program is listening
            return []
        until_s = time.monotonic() + ANNOUNCED_S
        while (left_s := until_s - time.monotonic()) > 0:
            listening.settimeout(left_s)
            try:
                datagram, (address, _) = listening.recvfrom(MOST_DATAGRAM)
            except OSError:
                continue
            if (one := announcement(datagram, address)) is not None:
                found[one.name] = one
    return list(found.values())


def search_streams(address: str) -> SearchResult:
    """Ask for sensors among the streams (`devices.drivers.lsl.ask_in`); raises SourceRefusedError."""
    found: list[FoundSensor] = []
    passed: list[Passed] = []
    for stream in find_streams(address):
        place = f"Lab Streaming Layer, {stream.name}"
        try:
            names = [sensor.name for sensor in announced_sensors(stream)]
            found.append(FoundSensor(LSL, ", ".join(names), place, partial(LslSource, stream), count=len(names)))
        except OtherStreamError:  # of a heart or a brain
            continue
        except SourceRefusedError as refusal:
            passed.append(Passed(PortInfo(place), refusal))
    return SearchResult(tuple(found), tuple(passed))


def _has_network() -> bool:
    """Whether data of any other machine could arrive; where none could, no port is opened for it."""
    try:
        devices = Path("/proc/net/dev").read_text(encoding="ascii").splitlines()[2:]
    except OSError:  # not Linux
        return True
    return any(line.partition(":")[0].strip() != "lo" for line in devices)


def announcement(datagram: bytes, address: str) -> FoundSensor | None:
    """What an x-IMU3 reports about itself on the network; None where it is something else."""
    try:
        details = json.loads(datagram)
    except (ValueError, RecursionError):
        return None
    if not isinstance(details, dict) or not isinstance(serial := details.get("sn"), str) or not serial:
        return None
    tcp, send, receive = (_port(details.get(key)) for key in ("port", "send", "receive"))
    # the address that the sensor gives is not believed: a datagram is no reason to speak with somebody else
    channel: Callable[[], Channel]
    if tcp:
        channel, place = lambda: TcpChannel(address, tcp), f"TCP {address}:{tcp}"
    elif send and receive:
        channel, place = lambda: UdpChannel(address, receive, send), f"UDP {address}:{send}"
    else:
        return None
    return FoundSensor(XIMU3, serial, place, lambda: ByteSource(Ximu3(), channel()))


def _port(details: object) -> int:
    return details if isinstance(details, int) and 0 < details < 65536 else 0
