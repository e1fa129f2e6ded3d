"""Tests that drivers of other packages come in when they are allowed, and that a faulty one harms nobody but itself."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from syrupy.assertion import SnapshotAssertion

from devices import search as search_module
from devices.catalogue import DRIVERS, Driver
from devices.emulators.ximu3 import Ximu3Voice
from devices.live import SourceRefusedError
from devices.other_drivers import BrokenDriverError, load_drivers, offered_drivers, other_source
from devices.other_packages import SENSORS, offers
from devices.search import _recognised
from devices.source import SourceInfo
from devices.stream import Received
from devices.transport.ports import PortInfo
from tests.devices.scripted import ScriptedChannel
from tests.examples.new_sensor import FRAME
from tests.other_authors import install_plugin, site_of_others, write_package

GOOD = """
from gaitwright.devices import Driver, Received, SensorDetails, SourceInfo

class Framer:
    def __init__(self):
        self.received = Received()
    def feed(self, data, host_s):
        {feed}
    def flush(self):
        pass

class Protocol:
    driver, version = "{key}", "1"
    def __init__(self):
        {made}
    def framer(self, info):
        {framer}
    def greet(self, channel):
        {greet}
    def identifying(self):
        return b""

OFFER = Driver("{key}", "Stranger", "By nothing at all.", None, Protocol, (115200,))
"""
GREETS = 'return SourceInfo("{key}", "1", sensors=("one",)), SensorDetails()'


def source_of(
    key: str, feed: str = "pass", framer: str = "return Framer()", greet: str = GREETS, made: str = "pass"
) -> str:
    return GOOD.format(key=key, feed=feed, framer=framer, greet=greet.format(key=key), made=made)


def frames(count: int) -> bytes:
    made = []
    for number in range(count):
        body = FRAME.pack(0xA5, number % 256, number, -5, 0, 0, 0, 981, 0, 0)[:-2]
        made.append(body + bytes([sum(body) % 256, 0x5A]))
    return b"".join(made)


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    yield from site_of_others(tmp_path, monkeypatch)


def loaded(package: str = "strange") -> tuple[Driver, ...]:
    return load_drivers({(package, "1.0")}).drivers


def reasons(package: str = "strange") -> dict[str, str]:
    return {one.offer.name: one.why for one in load_drivers({(package, "1.0")}).left_out}


@pytest.mark.endurance
def test_the_example_package_is_installed_by_pip_and_its_sensor_is_understood(site: Path, tmp_path: Path) -> None:
    install_plugin(site, tmp_path)
    (offer,) = offered_drivers()
    assert (offer.name, offer.package, offer.version) == ("sum-sensor", "gaitwright-sum-sensor", "1.0")
    assert "gaitwright_sum_sensor" not in sys.modules
    (driver,) = loaded("gaitwright-sum-sensor")
    assert driver.protocol is not None
    channel = ScriptedChannel([frames(10)[:37], frames(10)[37:]])
    source = other_source(driver.protocol(), channel)
    source.open()
    kept: list[bytes] = []
    blocks = [block for _ in range(2) for block in source.read(kept.append)]
    assert sum(map(len, blocks)) == 10
    assert blocks[-1].gyr_rad_s[-1] == pytest.approx([0.09, -0.05, 0.0])
    assert (source.info.driver, source.info.sensors) == ("sum-sensor", ("script",))
    assert not source.has_bytes  # a recording can be read without the package
    assert kept == []


def test_nothing_is_imported_before_its_package_is_allowed_in_that_version(site: Path) -> None:
    write_package(site, "strange", SENSORS, {"stranger": source_of("stranger")})
    for allowed in (set(), {("strange", "0.9")}, {("another", "1.0")}):
        assert load_drivers(allowed).drivers == ()
    assert "strange_0" not in sys.modules
    assert [driver.key for driver in loaded()] == ["stranger"]


def test_a_package_that_takes_a_name_of_ours_or_of_another_loses(site: Path) -> None:
    write_package(site, "strange", SENSORS, {"ximu3": source_of("ximu3"), "shared": source_of("shared")})
    write_package(site, "another", SENSORS, {"shared": source_of("shared")})
    assert {(one.name, one.package): one.taken_by for one in offered_drivers()} == {
        ("ximu3", "strange"): "gaitwright",
        ("shared", "another"): "",
        ("shared", "strange"): "another",
    }
    assert reasons() == {
        "ximu3": "the name ximu3 is already used by gaitwright",
        "shared": "the name shared is already used by another",
    }
    assert "strange_0" not in sys.modules
    assert [driver.key for driver in loaded("another")] == ["shared"]


BROKEN = {
    "raises": ("raise RuntimeError('no')", "it cannot be loaded (RuntimeError)"),
    "ends": ("import sys\nsys.exit(3)", "it cannot be loaded (SystemExit)"),
    "lacks": ("import a_module_that_is_not_there", "it cannot be loaded (ModuleNotFoundError)"),
    "empty": ("", "it cannot be loaded (AttributeError)"),
    "kind": ("OFFER = 5", "it is no Driver"),
    "key": (source_of("other"), "its key is another one, or it has no protocol or no baud rate"),
    "mute": (
        source_of("mute").replace("None, Protocol", "None, None"),
        "its key is another one, or it has no protocol or no baud rate",
    ),
    "baud": (source_of("baud").replace("(115200,)", "('fast',)"), "not as a Driver has it: bauds"),
    "name": (source_of("name").replace('"Stranger"', "5"), "not as a Driver has it: name"),
    "knock": (
        source_of("knock").replace("(115200,)", "(115200,), knock=b'x'"),
        "it has a knock without an answer, or an answer without a knock",
    ),
}


def test_a_driver_that_cannot_be_used_is_named_and_the_others_stay(site: Path) -> None:
    write_package(site, "strange", SENSORS, {name: source for name, (source, _) in BROKEN.items()})
    write_package(site, "another", SENSORS, {"good": source_of("good")})
    found = load_drivers({("strange", "1.0"), ("another", "1.0")})
    assert {one.offer.name: one.why for one in found.left_out} == {name: why for name, (_, why) in BROKEN.items()}
    assert [driver.key for driver in found.drivers] == ["good"]


def test_a_package_whose_description_is_damaged_offers_nothing(site: Path) -> None:
    write_package(site, "strange", SENSORS, {"stranger": source_of("stranger")})
    write_package(site, "another", SENSORS, {"good": source_of("good")})
    (site / "strange-1.0.dist-info" / "METADATA").write_bytes(b"\xff\xfe\x00")
    assert [offer.name for offer in offers(SENSORS, ())] == ["good"]
    (site / "strange-1.0.dist-info" / "METADATA").write_text("Name: a\nVersion: 1\n" + "x", encoding="utf-8")
    assert {offer.name for offer in offers(SENSORS, ())} >= {"good"}


REFUSES = "from gaitwright.devices import SourceRefusedError; raise SourceRefusedError('Asleep', 'Shake it')"
ROW = "self.received.rows.append({})"
FAULTS = {
    "raises": {"feed": "raise ZeroDivisionError"},
    "short": {"feed": ROW.format("(1.0, 2.0)")},
    "words": {"feed": ROW.format("(0.0, 'a', 0.0, 0.0, 0.0, 0.0, 0.0)")},
    "endless": {"feed": ROW.format("(float('inf'),) + 6 * (0.0,)")},
    "gone": {"feed": "self.received = None"},
    "counts": {"feed": "self.received.damaged = 'many'"},
    "battery": {"feed": "self.received.battery = 80.0"},
    "framer": {"framer": "raise KeyError('x')"},
    "file": {"framer": "raise OSError('x')"},
    "refuses": {"framer": REFUSES},
    "made": {"made": "raise FileNotFoundError('settings')"},
    "unmade": {"made": REFUSES},
}


def test_drivers_that_fail_while_sensors_are_looked_for_are_left_out_and_ours_go_on(
    site: Path, monkeypatch: pytest.MonkeyPatch, snapshot: SnapshotAssertion
) -> None:
    monkeypatch.setattr(search_module, "LISTEN_S", 0.05)
    write_package(site, "strange", SENSORS, {fault: source_of(fault, **how) for fault, how in FAULTS.items()})
    broken: list[BrokenDriverError] = []
    voice = Ximu3Voice("0000000A", lambda number: (number % 100, 0.0, 0.0, 0.0, 0.0, 1.0))
    channel = ScriptedChannel([voice_bytes(voice)])
    driver, is_sure, _ = _recognised(channel, PortInfo("script"), (*DRIVERS, *loaded()), broken)
    assert driver is not None
    assert (driver.key, is_sure) == ("ximu3", True)
    assert sorted(map(str, broken)) == snapshot
    assert len(broken) == len(FAULTS)


def voice_bytes(voice: Ximu3Voice) -> bytes:
    stated = b""
    while len(stated) < 2000:
        stated += voice.say()
    return stated


def test_a_driver_that_understands_everything_takes_no_sensor_of_ours(
    site: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(search_module, "LISTEN_S", 0.05)
    greedy = "self.received.rows += [(float(k), 0.0, 0.0, 0.0, 0.0, 0.0, 9.8) for k in range(1000)]"
    write_package(site, "strange", SENSORS, {"greedy": source_of("greedy", feed=greedy)})
    drivers = (*DRIVERS, *loaded())
    voice = Ximu3Voice("0000000A", lambda number: (number % 100, 0.0, 0.0, 0.0, 0.0, 1.0))
    for stated, key in ((voice_bytes(voice), "ximu3"), (b"nobody knows this" * 9, "greedy")):
        driver, _, _ = _recognised(ScriptedChannel([stated]), PortInfo("script"), drivers, [])
        assert driver is not None
        assert driver.key == key


GREETINGS = {
    "raises": "raise ValueError('x')",
    "file": "raise OSError('x')",
    "nothing": "return None",
    "nameless": 'return SourceInfo("{key}", "1"), SensorDetails()',
    "number": 'return SourceInfo("{key}", "1", sensors=(5,)), SensorDetails()',
    "details": 'return SourceInfo("{key}", "1", sensors=("one",)), {{}}',
}


def test_a_driver_whose_greeting_fails_is_named(site: Path, snapshot: SnapshotAssertion) -> None:
    write_package(site, "strange", SENSORS, {fault: source_of(fault, greet=how) for fault, how in GREETINGS.items()})
    found = []
    for stranger in loaded():
        assert stranger.protocol is not None
        with pytest.raises(BrokenDriverError) as broken:
            stranger.protocol().greet(ScriptedChannel())
        found.append(str(broken.value))
    assert found == snapshot
    assert len(found) == len(GREETINGS)


def test_what_a_driver_refuses_itself_keeps_its_words_and_its_key_is_ours_to_give(site: Path) -> None:
    pretends = 'return SourceInfo("ximu3", "9", sensors=("one",)), SensorDetails()'
    write_package(
        site,
        "strange",
        SENSORS,
        {"asleep": source_of("asleep", greet=REFUSES), "false": source_of("false", greet=pretends)},
    )
    asleep, false = (one.protocol for one in loaded())
    assert asleep is not None
    assert false is not None
    with pytest.raises(SourceRefusedError, match=r"Asleep\. Shake it") as refused:
        asleep().greet(ScriptedChannel())
    assert not isinstance(refused.value, BrokenDriverError)
    info, _ = false().greet(ScriptedChannel())
    assert (info.driver, info.version) == ("false", "1")


def test_a_driver_that_fails_while_it_records_loses_its_own_source(site: Path) -> None:
    fails: dict[str, Any] = {"feed": "raise ZeroDivisionError"}
    write_package(site, "strange", SENSORS, {"fails": source_of("fails", **fails)})
    (stranger,) = loaded()
    assert stranger.protocol is not None
    source = other_source(stranger.protocol(), ScriptedChannel([b"x"]))
    source.open()
    with pytest.raises(BrokenDriverError, match="ZeroDivisionError"):
        source.read(lambda data: None)
    assert stranger.protocol().framer(SourceInfo("fails", "1")).received == Received()
