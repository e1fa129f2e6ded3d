"""Tests that DOTs that announce themselves are found among the sensors.

Where nobody could be received, the reason is stated.
"""

import builtins
import importlib.util
from collections.abc import Sequence
from typing import Any

import pytest

from devices.dot.sensor import is_dot
from devices.dot.source import DotSource
from devices.live import SourceRefusedError
from devices.search import search
from devices.transport.bluetooth import Announced, BluetoothMissingError, Radio
from tests.devices.scripted import free_port


def in_air(*names: str) -> Radio:
    announced: Sequence[Announced] = [
        Announced(name, f"D4:22:CD:00:00:{number + 1:02X}", (0x0886,)) for number, name in enumerate(names)
    ]
    return Radio(received=lambda: announced)


@pytest.mark.endurance
def test_dots_are_found_by_what_they_announce_and_share_a_group() -> None:
    found = search((), free_port(), radio=in_air("Xsens DOT", "a watch", "Movella DOT"))
    assert [(one.driver, one.name, one.place) for one in found.sensors] == [
        ("movella-dot", "DOT 0001", "Bluetooth"),
        ("movella-dot", "DOT 0003", "Bluetooth"),
    ]
    first, second = (one.make() for one in found.sensors)
    assert isinstance(first, DotSource)
    assert isinstance(second, DotSource)
    assert first.group is second.group
    assert first.info.sensors == ("DOT 0001",)
    assert found.deaf is None


@pytest.mark.parametrize(
    ("name", "companies", "is_one"),
    [
        ("Movella DOT", (0x0886,), True),
        ("Xsens DOT", (), True),
        ("Movella DOT", (0x004C,), False),
        ("Movella", (0x0886,), False),
    ],
)
def test_a_dot_is_reported_by_its_name_and_its_maker(name: str, companies: tuple[int, ...], is_one: bool) -> None:
    assert is_dot(Announced(name, "", companies)) is is_one


@pytest.mark.endurance
def test_nothing_is_sent_by_bluetooth_where_nobody_asks_for_it() -> None:
    assert search((), free_port()).deaf is None


@pytest.mark.endurance
def test_without_the_library_the_other_sensors_are_found_and_it_states_what_to_install(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found, imported = importlib.util.find_spec, builtins.__import__

    def missing(name: str, *arguments: Any, **more: Any) -> Any:
        if name.startswith("bleak"):
            raise ImportError(name)
        return imported(name, *arguments, **more)

    monkeypatch.setattr("devices.transport.bluetooth.find_spec", lambda name: None if name == "bleak" else found(name))
    monkeypatch.setattr(builtins, "__import__", missing)
    result = search((), free_port(), radio=Radio())
    assert result.sensors == ()
    assert isinstance(result.deaf, BluetoothMissingError)
    assert "Install gaitwright[bluetooth]" in str(result.deaf)


@pytest.mark.endurance
def test_where_bluetooth_does_not_answer_it_states_so(monkeypatch: pytest.MonkeyPatch) -> None:
    async def silent(**_settings: Any) -> Any:
        raise FileNotFoundError("no bus")

    monkeypatch.setattr("bleak.BleakScanner.discover", silent)
    result = search((), free_port(), radio=Radio())
    assert isinstance(result.deaf, SourceRefusedError)
    assert not isinstance(result.deaf, BluetoothMissingError)
    assert "Switch it on" in str(result.deaf)
