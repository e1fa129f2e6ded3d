"""Tests that drivers of other packages are off until somebody allows them, by name and version."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from app.home.home import Home
from app.home.settings.drivers_card import DriversCard
from app.system import kept_json
from app.system.allowed_drivers import DriverPackage, allow_drivers, driver_packages, other_drivers
from app.widgets.toggle import Toggle
from app.wizard.sensors.sources import Sources
from devices.live import SourceRefusedError
from devices.other_drivers import BrokenDriverError
from devices.other_packages import SENSORS
from devices.search import FoundSensor, SearchResult
from tests.other_authors import site_of_others, write_package

STRANGER = """
from gaitwright.devices import Driver, SourceRefusedError
class Protocol:
    version = "1"
OFFER = Driver("stranger", "Stranger", "By nothing at all.", None, Protocol, (115200,))
"""


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    file = tmp_path / "settings" / "drivers.json"
    monkeypatch.setattr(kept_json, "place_of", file.with_name)
    return file


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    for folder in site_of_others(tmp_path, monkeypatch):
        write_package(folder, "strange", SENSORS, {"stranger": STRANGER})
        write_package(folder, "broken", SENSORS, {"broken": "raise RuntimeError"})
        yield folder


def test_a_driver_is_off_until_its_package_is_allowed_in_its_version(site: Path) -> None:
    assert driver_packages() == [
        DriverPackage("broken", "1.0", ("broken",), is_allowed=False),
        DriverPackage("strange", "1.0", ("stranger",), is_allowed=False),
    ]
    assert other_drivers().drivers == ()
    assert "strange_0" not in sys.modules
    allow_drivers("strange", "0.9", is_allowed=True)
    assert other_drivers().drivers == ()
    allow_drivers("strange", "1.0", is_allowed=True)
    allow_drivers("broken", "1.0", is_allowed=True)
    found = other_drivers()
    assert [driver.key for driver in found.drivers] == ["stranger"]
    assert [(one.offer.package, one.why) for one in found.left_out] == [
        ("broken", "it cannot be loaded (RuntimeError)")
    ]
    allow_drivers("strange", "1.0", is_allowed=False)
    assert [one.is_allowed for one in driver_packages()] == [True, False]


@pytest.mark.parametrize("kept", ["", "{}", "5", '[["strange"]]', '[["strange", 1.0]]', "\x00"])
def test_what_is_kept_and_damaged_allows_nothing(kept: str, site: Path, place: Path) -> None:
    place.parent.mkdir()
    place.write_text(kept, encoding="utf-8")
    assert other_drivers().drivers == ()
    allow_drivers("strange", "1.0", is_allowed=True)
    assert [driver.key for driver in other_drivers().drivers] == ["stranger"]


def toggle_of(card: DriversCard, at: int) -> Toggle:
    toggle = card.toggles[at]
    assert isinstance(toggle, Toggle)
    return toggle


def test_the_card_lists_name_and_version_and_what_is_pressed_is_sent_on(qtbot: QtBot) -> None:
    around = QWidget()
    qtbot.addWidget(around)
    card = DriversCard()
    card.setParent(around)
    card.show_packages([])
    assert not card.isVisibleTo(around)
    card.show_packages([DriverPackage("a", "1", ("x", "y"), is_allowed=True), DriverPackage("b", "2.0", ("z",), False)])
    assert card.isVisibleTo(around)
    assert [toggle_of(card, at).isChecked() for at in range(2)] == [True, False]
    assert toggle_of(card, 1).accessibleName() == "Allow, b, version 2.0"
    with qtbot.waitSignal(card.allowed) as sent:
        toggle_of(card, 1).click()
    assert sent.args == ["b", "2.0", True]
    with qtbot.waitSignal(card.allowed) as sent:
        toggle_of(card, 0).click()
    assert sent.args == ["a", "1", False]


def failure() -> BrokenDriverError:
    return BrokenDriverError("The driver {driver} stopped", "Install {driver}", driver="stranger")


def test_a_driver_that_failed_is_named_where_no_sensor_was_found() -> None:
    sources = Sources(lambda: SearchResult(broken=(failure(),)))
    search = next(choice for choice in sources if choice.key == "search")
    with pytest.raises(SourceRefusedError, match=r"The driver stranger stopped\. Install stranger\."):
        search.make()


def test_sensors_of_another_package_are_a_source_with_its_name(site: Path) -> None:
    allow_drivers("strange", "1.0", is_allowed=True)
    (driver,) = other_drivers().drivers

    def no_source() -> None:
        raise AssertionError

    sensor = FoundSensor("stranger", "one", "port", no_source)  # type: ignore[arg-type]  # it is opened by nobody here
    sources = Sources(lambda: SearchResult((sensor,), others=(driver,)))
    sources.look()
    sources.wait()
    assert "Stranger, 1 sensor" in [choice.name for choice in sources]


def test_what_is_pressed_in_the_settings_is_kept_or_it_is_stated_why_not(
    qtbot: QtBot, home: Home, site: Path, place: Path
) -> None:
    home.show_settings()
    card = home.settings.page.drivers
    assert [toggle_of(card, at).isChecked() for at in range(2)] == [False, False]
    toggle_of(card, 1).click()
    assert [one.is_allowed for one in driver_packages()] == [False, True]
    place.unlink()
    place.parent.rmdir()
    place.parent.write_text("a file where the folder should be", encoding="utf-8")
    toggle_of(card, 0).click()
    assert "This setting was not saved" in home.banner.text
    assert [toggle_of(card, at).isChecked() for at in range(2)] == [False, False]
