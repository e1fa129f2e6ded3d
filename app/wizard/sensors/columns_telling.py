"""Meaning of the columns of sensors that send lines of numbers: asked within the sensors' step, and remembered."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, Signal

from app.system.known_columns import keep_columns
from app.wizard.sensors.columns_form import AXES, ColumnsReported, Meaning
from app.wording.translation import figure_text, tr
from core.samples import G_M_S2, FloatArray
from devices.drivers.csv_serial import FORCE_UNITS, RATE_UNITS, Columns
from devices.drivers.lines import STILL, LinePreview, guessed, table_of
from devices.transport.ports import SerialPort

if TYPE_CHECKING:
    from app.wizard.sensors.columns_form import ColumnsForm
    from devices.drivers.lines import LinesAt

TICKS_HZ = {"s": 1.0, "ms": 1e3, "us": 1e6}
SLOWEST_HZ, FASTEST_HZ = 20.0, 2000.0
ENOUGH_LINES = 15  # to guess by
FASTEST_RAD_S = 40.0  # nobody's leg turns so fast


class ColumnsTelling(QObject):
    """One port is listened to; what is stated of it holds for all ports that send as many columns."""

    changed = Signal()

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._form: ColumnsForm | None = None
        self._lines: Sequence[LinesAt] = ()
        self._preview: LinePreview | None = None
        self._separator, self._is_shown = "comma", False

    @property
    def is_on(self) -> bool:
        return self._preview is not None

    @property
    def columns(self) -> Columns | None:
        """What is entered; None while something is missing."""
        reported = self._form.reported if self._form is not None and self._is_shown else None
        if reported is None or not reported.is_whole:
            return None
        places = {meaning: number for number, meaning in enumerate(reported.meanings) if meaning}
        axes = [places[meaning] for meaning in AXES]
        return Columns(
            time=places[Meaning.TIME],
            rate=tuple(axes[:3]),
            force=tuple(axes[3:]),
            tick_hz=TICKS_HZ[reported.time_unit],
            wraps_bits=reported.wraps_bits,
            rate_unit=reported.rate_unit,
            force_unit=reported.force_unit,
            separator=self._separator,
            signs=tuple(-1 if number in reported.turned else 1 for number in axes),
            count=len(reported.meanings),
        )

    def begin(self, form: "ColumnsForm", lines: "Sequence[LinesAt]") -> None:
        """Listen to the first of these ports, and ask what it sends."""
        self.end()
        if self._form is None:
            self._form = form
            form.changed.connect(self.changed)
        first = lines[0]
        self._lines = [one for one in lines if one.count == first.count]
        self._is_shown = False
        form.show_places([one.port.device for one in self._lines])
        form.show_message("")
        self._preview = LinePreview(SerialPort(first.port, first.baud))
        self._preview.start()

    def tick(self) -> None:
        """Show what comes, and whether it can be what it is stated to be."""
        if self._preview is None or self._form is None:
            return
        lines = self._preview.lines
        table, separator = table_of(lines)
        if len(table) < ENOUGH_LINES:
            return
        if not self._is_shown or table.shape[1] != len(self._form.reported.meanings):
            known = self._lines[0].columns or guessed(lines)
            self._form.show_reported(_reported_of(known, table.shape[1]))
            self._is_shown = True
            self.changed.emit()
            self._form.focus()
        self._separator = separator
        self._form.show_values([figure_text(value, "g") for value in table[-1]])
        columns = self.columns
        self._form.show_message(*(_missing() if columns is None else _stated_of(columns, table)))

    def keep(self) -> None:
        """Store what is entered and release the port; raises OSError where it cannot be written."""
        columns = self.columns
        if columns is not None:
            keep_columns([one.port.key for one in self._lines], columns)
        self.end()

    def end(self) -> None:
        """Listen no longer."""
        preview, self._preview = self._preview, None
        if preview is not None:
            preview.close()


def _reported_of(columns: Columns | None, count: int) -> ColumnsReported:
    """As the form shows it; nothing is stated about the columns of something unknown."""
    meanings = [Meaning.UNUSED] * count
    if columns is None:
        return ColumnsReported(tuple(meanings))
    axes = (*columns.rate, *columns.force)
    for place, meaning in zip((columns.time, *axes), (Meaning.TIME, *AXES), strict=True):
        meanings[place] = meaning
    turned = frozenset(place for place, sign in zip(axes, columns.signs, strict=True) if sign < 0)
    unit = next((name for name, hz in TICKS_HZ.items() if hz == columns.tick_hz), "ms")
    return ColumnsReported(tuple(meanings), turned, unit, columns.wraps_bits, columns.rate_unit, columns.force_unit)


def _missing() -> tuple[str, str, bool]:
    what = tr("Assign time, three angular rates and three accelerations, each once.")
    return what, tr("Set all other columns to “not needed”."), False


def _stated_of(columns: Columns, table: FloatArray) -> tuple[str, str, bool]:
    """Whether numbers (n, columns) can be what they are stated to be, by their size."""
    step_s = float(np.median(np.diff(table[:, columns.time]))) / columns.tick_hz if len(table) > 1 else 0.0
    rate_hz = 1.0 / step_s if step_s > 0 else 0.0
    rates = table[:, columns.rate] * RATE_UNITS[columns.rate_unit]
    force = float(np.median(np.linalg.norm(table[:, columns.force] * FORCE_UNITS[columns.force_unit], axis=1)))
    if not SLOWEST_HZ <= rate_hz <= FASTEST_HZ:
        what = tr("This time column gives {rate} samples per second.").format(rate=figure_text(rate_hz, ".3g"))
        return what, tr("Choose another column or unit for the time."), False
    if not STILL[0] * G_M_S2 < force < STILL[1] * G_M_S2:
        what = tr("The acceleration is {force} m/s²; at rest it must be 9.8.")
        what = what.format(force=figure_text(force, ".3g"))
        return what, tr("Hold the sensor still, or choose other columns or another unit."), False
    if float(np.abs(rates).max()) > FASTEST_RAD_S:
        return tr("The angular rate is too high for a leg."), tr("Choose other columns or another unit."), False
    what = tr("{rate} samples per second, {force} m/s²: plausible.").format(
        rate=figure_text(rate_hz, ".3g"), force=figure_text(force, ".2g")
    )
    return what, tr("Turn the sensor by hand: the three angular rates must follow, and be near 0 at rest."), True
