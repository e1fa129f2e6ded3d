"""List of the sensors that are received and how they are. Each has a row with its movement, rate, battery and place."""

from collections.abc import Mapping, Sequence

from PySide6.QtCore import QRect, QRectF, Qt, Signal
from PySide6.QtGui import QAccessible, QFont, QFontMetrics
from PySide6.QtWidgets import QVBoxLayout, QWidget

from app.theme.current import current_theme, on_theme, px, scaled
from app.widgets.battery import WIDTH as CELL_WIDTH
from app.widgets.painted import Painted
from app.widgets.painted_text import LEFT, RIGHT, PaintedText
from app.widgets.text import MEDIUM, SEMIBOLD
from app.wizard.sensors.sensor_row import CHEVRON, CHIP, ROW, SensorRow, SensorRowView
from app.wording.body import segment_name
from app.wording.translation import figure_text, tr
from core.body import LEG_SITES, Site
from core.samples import FloatArray

HEADING, SPACING = 18, 8
GRIP, NARROW_GRIP = 30, 24
COLUMN_GAP, NARROW_GAP = 12, 8
IDENTIFY = 44
TRACE_AT_LEAST = 48


class SensorList(QWidget):
    """A row for each sensor, with its state and where it is worn."""

    accessible_role = QAccessible.Role.List

    assigned = Signal(str, object)  # a sensor's name and the site it is worn at; None: nowhere
    selected = Signal(str)  # the name of the sensor that keys mean from now on
    identify_pressed = Signal(str)
    reconnect_pressed = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self._is_narrow = False
        self.selection = ""
        self._places = LEG_SITES
        self._columns: tuple[int, dict[str, QRect]] | None = None  # measuring words takes longer than painting them
        self.rows: dict[str, SensorRowView] = {}
        self._heading = _Heading(self)
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.addWidget(self._heading)
        self._column.addStretch(1)
        self.setAccessibleName(tr("Sensors"))
        scaled(self._column.setSpacing, SPACING)
        on_theme(self._arrange)

    def show_sensors(self, sensors: Sequence[SensorRow], places: tuple[Site, ...] = LEG_SITES) -> None:
        """Show these in this order, to be worn at these places; a row that stays keeps its focus."""
        for name in self.rows.keys() - {sensor.name for sensor in sensors}:
            row = self.rows.pop(name)
            row.setParent(None)
            row.deleteLater()
        is_other = len(sensors) != len(self.rows) or places != self._places
        self._places = places
        for place, sensor in enumerate(sensors, start=1):  # the heading is the first
            if sensor.name not in self.rows:
                self._add_row(sensor.name)
            row = self.rows[sensor.name]
            if self._column.indexOf(row) != place:
                self._column.insertWidget(place, row)
            is_other |= row.takes_other_room(sensor)
            row.show_sensor(sensor)
            row.offer(places)
        if is_other:
            self._arrange()
        self._heading.setVisible(bool(sensors))
        if self.selection not in self.rows:
            self.select(next(iter(self.rows), ""))
        self._mark_selected()

    def show_traces(self, traces: Mapping[str, FloatArray]) -> None:
        """Draw how each sensor turned in the last 5 s, deg/s, oldest first; only the traces are drawn again."""
        for name, values in traces.items():
            if name in self.rows:
                self.rows[name].trace.show_values(values)

    def select(self, name: str) -> None:
        """Let keys mean this sensor."""
        if name != self.selection:
            self.selection = name
            self._mark_selected()
            self.selected.emit(name)

    def set_narrow(self, is_narrow: bool) -> None:
        """Show rate and battery in the second line, where there is no room for columns."""
        if is_narrow != self._is_narrow:
            self._is_narrow = is_narrow
            self._arrange()

    def step(self, name: str, by: int) -> None:
        """Go on to the row above or below the one of `name`."""
        rows = list(self.rows.values())
        at = list(self.rows).index(name) + by
        if 0 <= at < len(rows):
            self.select(rows[at].name)
            rows[at].setFocus(Qt.FocusReason.TabFocusReason)

    def columns(self, width: int) -> dict[str, QRect]:
        """Where the columns lie in a row of `width`; the trace takes what is left."""
        if self._columns is None or self._columns[0] != width:
            self._columns = width, self._measured(width)
        return self._columns[1]

    def _measured(self, width: int) -> dict[str, QRect]:
        theme = current_theme()
        px = theme.px

        def widest(font: QFont, words: list[str]) -> int:
            return max((QFontMetrics(font).horizontalAdvance(word) for word in words), default=0)

        shown = [row.sensor for row in self.rows.values()]
        small, text = theme.font(12, MEDIUM), theme.font(14, MEDIUM)
        names = max(
            widest(theme.font(16, SEMIBOLD, is_code=True), [one.name for one in shown]),
            widest(small, [self.second_line(one) for one in shown] + self._longest_second_lines()),
        )
        required = {
            "name": max(names, px(64)),
            "rate": max(widest(text, [tr("{rate} Hz").format(rate=100)]), widest(theme.font(12), [tr("Rate")])),
            "battery": max(
                px(CELL_WIDTH + 6) + widest(text, [tr("{percent} %").format(percent=100)]),
                widest(text, [tr("unknown")]),
                widest(theme.font(12), [tr("Battery")]),
            ),
            "worn": px(CHIP + 6 + CHEVRON + 6)
            + max(widest(text, [tr("none"), *(segment_name(site.segment) for site in self._places)]), px(50)),
            "identify": max(px(IDENTIFY), widest(theme.font(12), [tr("Identify")])),
        }
        if self._is_narrow:
            required["rate"] = required["battery"] = 0
        grip = px(NARROW_GRIP if self._is_narrow else GRIP)
        gap, right = px(NARROW_GAP if self._is_narrow else COLUMN_GAP), px(6)
        rest = width - grip - right - sum(required.values()) - gap * sum(1 for one in required.values() if one)
        places: dict[str, QRect] = {}
        x = grip
        for key in ("name", "trace", "rate", "battery", "worn", "identify"):
            taken = max(rest, 0) if key == "trace" else required[key]
            places[key] = QRect(x, 0, taken, px(ROW))
            x += taken + (gap if taken else 0)
        return places

    def _longest_second_lines(self) -> list[str]:
        """What may be stated about any sensor: there is room for it from the first, so that no column moves later."""
        figures = [tr("{rate} Hz").format(rate=100), tr("{percent} %").format(percent=100)] if self._is_narrow else []
        lost = tr("{share} % lost").format(share=figure_text(10.0, ".1f"))
        return [tr("charge soon"), tr("no signal"), lost, " · ".join(figures)]

    def second_line(self, sensor: SensorRow) -> str:
        """Under the name: what is the matter, or the model; in a narrow list rate and battery as well."""
        if not self._is_narrow or sensor.silent_s > 0:
            return sensor.second_line
        what = sensor.second_line if sensor.is_lossy and not sensor.is_low else ""
        charge = sensor.charge if sensor.battery is not None else ""
        return " · ".join(filter(None, [what or sensor.rate, charge]))

    def _least_width(self) -> int:
        heading = QFontMetrics(current_theme().font(12)).horizontalAdvance(tr("Last 5 s")) + 1
        trace = max(px(TRACE_AT_LEAST), heading)
        gap = px(NARROW_GAP if self._is_narrow else COLUMN_GAP)
        return self._measured(0)["identify"].right() + px(6) + gap + trace

    def _add_row(self, name: str) -> None:
        row = self.rows[name] = SensorRowView(name, self.columns, self.second_line)
        row.selected.connect(self.select)
        row.stepped.connect(self.step)
        row.assigned.connect(self.assigned)
        row.identify_pressed.connect(self.identify_pressed)
        row.reconnect_pressed.connect(self.reconnect_pressed)
        row.setParent(self)
        row.show()

    def _mark_selected(self) -> None:
        for name, row in self.rows.items():
            row.set_selected(name == self.selection)

    def _arrange(self) -> None:
        self._columns = None
        self._heading.update()
        for row in self.rows.values():
            row.arrange()
        self.setMinimumWidth(self._least_width())


class _Heading(Painted):
    """The names of the columns."""

    def __init__(self, sensors: SensorList) -> None:
        super().__init__(sensors)
        self._list = sensors
        scaled(self.setFixedHeight, HEADING)

    def painted_texts(self) -> list[PaintedText]:
        font = current_theme().font(12)
        places = {**self._list.columns(self.width())}
        places["name"] = QRect(0, 0, places["name"].right(), 0)
        movement = tr("Movement, last 5 s")
        has_room = QFontMetrics(font).horizontalAdvance(movement) <= places["trace"].width()
        words = {
            "name": tr("Sensor"),
            "trace": movement if has_room else tr("Last 5 s"),
            "rate": tr("Rate"),
            "battery": tr("Battery"),
            "worn": tr("Position"),
            "identify": tr("Identify"),
        }
        return [
            PaintedText(
                words[key],
                QRectF(place.x(), 0, place.width(), self.height()),
                font,
                "ink2",
                RIGHT if key == "identify" else LEFT,
            )
            for key, place in places.items()
            if place.width()
        ]
