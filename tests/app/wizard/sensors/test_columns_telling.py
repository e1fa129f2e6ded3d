"""Sensors that send lines of numbers: asked what they mean, shown what comes, remembered."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

from app.system import kept_json
from app.system import known_columns as kept
from app.wizard.sensors.columns_form import ColumnsForm, Meaning
from app.wizard.sensors.sources import COLUMNS, SEARCH
from app.wizard.sensors.step import SensorsStep
from app.wizard.visit import Visit
from app.wizard.worn_sensors import SourceChoice
from devices.drivers.lines import LinesAt
from devices.emulators.csv_lines import COLUMNS as EMULATED
from devices.emulators.csv_lines import LineVoice
from devices.emulators.transports import Emulation, PseudoTerminal
from devices.live import SourceRefusedError
from devices.transport.ports import PortInfo
from tests.app.wizard.begun_visit import shown
from tests.app.wizard.present import present
from tests.app.wizard.pressing import press


def still(number: int) -> tuple[float, ...]:
    return (0.1 * (number % 3), 0.0, 0.0, 0.1, 0.0, 0.99)


@pytest.fixture
def place(tmp_path: Path) -> Iterator[str]:
    emulation = Emulation(LineVoice(still, rate_hz=200.0), partial(PseudoTerminal, tmp_path / "port"))
    yield emulation.place
    emulation.close()


@pytest.fixture
def step(qtbot: QtBot, visit: Visit, place: str) -> Iterator[SensorsStep]:
    def search() -> None:
        raise SourceRefusedError("Searched", "again")

    lines = (LinesAt(PortInfo(place), 115200, 7), LinesAt(PortInfo("/dev/other"), 115200, 7))
    visit.known_choices = (
        SourceChoice(COLUMNS, "Text lines (CSV)", search, lines=lines),  # type: ignore[arg-type]  # it only refuses
        SourceChoice(SEARCH, "Search", search),  # type: ignore[arg-type]  # it only refuses
    )
    yield from shown(qtbot, visit)


def asked(qtbot: QtBot, step: SensorsStep) -> ColumnsForm:
    """Choose the lines, and wait until what comes is shown."""
    step.page.source_chosen.emit(COLUMNS)

    def is_guessed() -> bool:
        step.telling.tick()
        return step.telling.columns is not None

    qtbot.waitUntil(is_guessed)
    return step.page.columns


def test_what_is_guessed_is_shown_with_what_comes_and_is_kept(
    qtbot: QtBot, visit: Visit, step: SensorsStep, place: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(kept_json, "place_of", tmp_path.joinpath)
    form = asked(qtbot, step)
    assert form.isVisible()
    assert step.telling.columns == EMULATED
    assert form.notice.text.startswith("200 samples per second, 9.8 m/s²: plausible.")
    primary = present(step.bar().primary)
    assert (primary.text, primary.is_enabled) == ("Use these columns", True)
    with qtbot.waitSignal(visit.refused) as refused:
        press(step)
    assert refused.args == ["Searched.", "again."]
    assert kept.known_columns() == {place: EMULATED, "/dev/other": EMULATED}
    assert not step.telling.is_on


def test_what_cannot_be_is_stated(qtbot: QtBot, step: SensorsStep) -> None:
    form = asked(qtbot, step)
    form.force.setCurrentIndex(form.force.findData("m/s2"))
    step.telling.tick()
    assert "at rest it must be 9.8" in form.notice.text
    form.force.setCurrentIndex(form.force.findData("g"))
    form.time.setCurrentIndex(form.time.findData("s"))
    step.telling.tick()
    assert "samples per second" in form.notice.text
    form.meanings[3].setCurrentIndex(form.meanings[3].findData(str(Meaning.RATE_X)))
    step.telling.tick()
    assert "each once" in form.notice.text
    assert step.telling.columns is None
    primary = present(step.bar().primary)
    assert not primary.is_enabled


def test_an_axis_can_be_turned_round(qtbot: QtBot, step: SensorsStep) -> None:
    form = asked(qtbot, step)
    form.meanings[2].setCurrentIndex(form.meanings[2].findData(f"-{Meaning.RATE_Y}"))
    columns = present(step.telling.columns)
    assert columns.signs == (1, -1, 1, 1, 1, 1)


def test_other_sources_are_a_step_away(qtbot: QtBot, step: SensorsStep) -> None:
    asked(qtbot, step).back.click()
    assert not step.telling.is_on
    assert step.page.nothing.isVisible()
