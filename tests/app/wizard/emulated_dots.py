"""Emulated DOTs as a source of the wizard, in air whose seconds pass faster than ours."""

from pytestqt.qtbot import QtBot

from app.acquisition.acquisition import Acquisition
from app.acquisition.dot_fleet import DotFleet, ReceivedDot
from app.widgets.table import CellTable, TableModel, TableRow
from app.wizard.sensors.step import SensorsStep
from app.wizard.visit import Visit
from app.wizard.worn_sensors import SourceChoice
from core.body import LEG_SITES
from devices.dot.samples import DRIVER
from devices.dot.sensor import DotSensor
from devices.live import SourceRefusedError
from tests.app.wizard.pressing import press
from tests.devices.dot.fast_radio import FastRadio


def dot_choice(radio: FastRadio) -> SourceChoice:
    """What a search that received them offers."""
    received = [ReceivedDot(DotSensor(radio, one), one.rssi_dbm) for one in radio.air.announced()]

    def never() -> Acquisition:
        raise SourceRefusedError("They are to be set up first", "Choose them")

    return SourceChoice(DRIVER, "Movella DOT", never, is_simulated=True, make_fleet=lambda: DotFleet(radio, received))


def rows_of(table: CellTable) -> tuple[TableRow, ...]:
    """What a table shows."""
    model = table.model()
    assert isinstance(model, TableModel)
    return model.rows


def has_asked_all(step: SensorsStep) -> bool:
    return bool(step.setup.dots) and all(dot.sensor.info is not None for dot in step.setup.dots)


def open_dots(qtbot: QtBot, visit: Visit, step: SensorsStep, record_hz: int = 120) -> None:
    """Set them up as the page proposes, but for the walks' rate, and wear them one site after the other."""
    step.page.source_chosen.emit(DRIVER)
    qtbot.waitUntil(lambda: has_asked_all(step))
    step.page.dots.walks.setCurrentIndex(step.page.dots.walks.findData(record_hz))
    with qtbot.waitSignal(visit.sensors.opened):
        press(step)
    assert visit.sensors.acquisition is not None
    visit.sensors.assign_all(dict(zip(visit.sensors.acquisition.sensors, LEG_SITES, strict=False)))
