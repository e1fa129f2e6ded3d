"""The live output is switched on in the settings, which say what came of it."""

import random
import socket
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from PySide6.QtCore import QSettings
from pytestqt.qtbot import QtBot

from app.home.settings.live_output_card import LiveOutputCard
from app.home.settings.live_output_control import LiveOutputControl
from app.live_output.output import live_output
from app.live_output.status import OutputSettings
from app.system.settings import LIVE_PORT, Settings


@pytest.fixture
def settings(tmp_path: Path) -> Iterator[Settings]:
    """Applied to the live output as the window does."""
    settings = Settings(QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat))
    settings.changed.connect(
        lambda: live_output.set_up(
            OutputSettings(settings.has_live_lsl, settings.has_live_websocket, settings.live_port)
        )
    )
    yield settings
    live_output.stop()


@pytest.fixture
def card(qtbot: QtBot, settings: Settings) -> LiveOutputCard:
    card = LiveOutputCard()
    qtbot.addWidget(card)
    LiveOutputControl(settings, card)
    card.show()
    return card


def free_port() -> int:
    """One of those that the system gives nobody who asks for any."""
    while True:
        with suppress(OSError), socket.create_server(("127.0.0.1", random.randrange(20_000, 30_000))) as one:
            return int(one.getsockname()[1])


def enter_port(card: LiveOutputCard, text: str) -> None:
    card.port.set_text(text)
    card.port.committed.emit()


def test_it_is_off_at_first(card: LiveOutputCard, settings: Settings) -> None:
    assert not card.lsl.isChecked()
    assert not card.websocket.isChecked()
    assert card.port.text == str(LIVE_PORT)
    assert not card.websocket_stated.isVisible()
    assert not live_output.is_on


def test_what_is_switched_on_is_kept_and_stated(card: LiveOutputCard, settings: Settings) -> None:
    port = free_port()
    enter_port(card, str(port))
    card.websocket.click()
    assert settings.has_live_websocket
    assert card.websocket_stated.text() == f"On at ws://127.0.0.1:{port}."
    card.websocket.click()
    assert not card.websocket.isChecked()
    assert not card.websocket_stated.isVisible()
    assert not live_output.is_on


def test_a_port_that_is_taken_is_stated_and_another_one_helps(card: LiveOutputCard) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        enter_port(card, str(port))
        card.websocket.click()
        assert card.websocket_stated.text() == f"Another program uses port {port}. Enter another port."
        other = free_port()
        enter_port(card, str(other))
        assert card.websocket_stated.text() == f"On at ws://127.0.0.1:{other}."


@pytest.mark.parametrize("text", ["", "80", "65536", "x", "-1", "8765.0", "\u0661\u0662\u0663\u0664"])
def test_what_is_no_port_is_not_kept(card: LiveOutputCard, settings: Settings, text: str) -> None:
    enter_port(card, text)
    assert card.port.wrong == "Enter a number from 1024 to 65535."
    assert settings.live_port == LIVE_PORT


@pytest.mark.parametrize("kept", ["", "x", "0", "70000", "9" * 5000, "-5"])
def test_a_damaged_port_counts_as_none(tmp_path: Path, kept: str) -> None:
    file = QSettings(str(tmp_path / "damaged.ini"), QSettings.Format.IniFormat)
    file.setValue("live_port", kept)
    assert Settings(file).live_port == LIVE_PORT


def test_where_libraries_are_missing_what_to_install_is_stated(
    qtbot: QtBot, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.home.settings.live_output_control.find_spec", lambda _name: None)
    card = LiveOutputCard()
    qtbot.addWidget(card)
    LiveOutputControl(settings, card)
    assert card.lsl_stated.text() == "Not installed on this computer. Install gaitwright[lsl]."
    assert card.websocket_stated.text() == "Not installed on this computer. Install gaitwright[live]."
    assert not card.lsl.isEnabled()
    assert not card.websocket.isEnabled()


def test_a_library_that_was_removed_is_stated_and_the_switch_still_turns_off(
    card: LiveOutputCard, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pylsl", None)
    monkeypatch.setitem(sys.modules, "pylsl.util", None)
    monkeypatch.setattr("app.home.settings.live_output_control.find_spec", lambda _name: None)
    settings.has_live_lsl = True
    if live_output.trouble["lsl"].other:
        pytest.skip("Lab Streaming Layer searches another network here")
    assert "gaitwright[lsl]" in card.lsl_stated.text()
    assert card.lsl.isEnabled()
    card.lsl.click()
    assert not settings.has_live_lsl
