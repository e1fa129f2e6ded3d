"""Row of one sensor in the list, with its present state. It is dragged, selected, and asks where the sensor is worn."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from PySide6.QtCore import QPoint, QRect, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QAction,
    QActionGroup,
    QColor,
    QFocusEvent,
    QKeyEvent,
    QPainter,
    QResizeEvent,
)
from PySide6.QtWidgets import QMenu, QSizePolicy, QWidget

from app.theme.current import current_theme, px, scaled
from app.theme.icons import Icon, paint_icon
from app.theme.leg_chip import paint_chip
from app.theme.theme import CHIP_RADIUS, CONTROL_RADIUS
from app.widgets.battery import HEIGHT as CELL_HEIGHT
from app.widgets.battery import LOW, paint_battery
from app.widgets.battery import WIDTH as CELL_WIDTH
from app.widgets.painted_button import PaintedButton
from app.widgets.painted_text import PaintedText
from app.widgets.sensor_tile import quiet_words
from app.widgets.text import MEDIUM, REGULAR, SEMIBOLD
from app.wizard.sensors.sensor_drag import DraggedButton
from app.wizard.sensors.sensor_places import number_of
from app.wizard.sensors.sensor_trace import Trace
from app.wording.body import name_of, segment_name
from app.wording.translation import capitalised, figure_text, tr
from core.body import LEG_SITES, Site
from devices.quiet import Quiet

ROW, ROW_AT_LEAST = 58, 46  # six of the latter fit into a window 720 high
CHIP = 20
CHEVRON = 14
LOST = 0.01  # of the samples; above it the radio wants a look


@dataclass(frozen=True, slots=True)
class SensorRow:
    """One sensor as it is now. `battery` 0 to 1, None: it gives none; `silent_s` 0 while it sends.

    `quiet`: why it is to send nothing; not `is_loss_seen`: nobody can see what is lost of it. `has_memory`: walks can
    be recorded in it.
    """

    name: str
    model: str = ""
    rate_hz: float | None = None
    battery: float | None = None
    site: Site | None = None
    silent_s: float = 0.0
    lost_share: float = 0.0
    can_identify: bool = False
    quiet: Quiet | None = None
    is_loss_seen: bool = True
    has_memory: bool = False

    @property
    def is_low(self) -> bool:
        return self.battery is not None and self.battery < LOW

    @property
    def is_lossy(self) -> bool:
        return self.lost_share > LOST and self.quiet is None

    @property
    def wants_look(self) -> bool:
        return self.silent_s > 0 or self.is_low or self.is_lossy

    @property
    def second_line(self) -> str:
        """What is the matter with it, or else its model."""
        if self.silent_s > 0:
            return tr("no signal")
        if self.is_low:
            return tr("charge soon")
        if self.is_lossy:
            return tr("{share} % lost").format(share=figure_text(100 * self.lost_share, ".1f"))
        if self.quiet is not None:
            return quiet_words(self.quiet)
        return tr(self.model) if self.is_loss_seen else tr("data loss unknown")

    @property
    def rate(self) -> str:
        return tr("{rate} Hz").format(rate=round(self.rate_hz or 0)) if self.silent_s <= 0 else tr("0 Hz")

    @property
    def charge(self) -> str:
        if self.battery is None or self.silent_s > 0:
            return tr("unknown")
        return tr("{percent} %").format(percent=round(100 * self.battery))


class SensorRowView(DraggedButton):
    """One sensor. It can be dragged onto the figure; Space asks where it is worn, Up and Down go on.

    Enter goes past it, to the primary button.

    Parameters
    ----------
    columns
        Where the columns of all rows lie, for a width.
    second_line
        What is stated under a sensor's name.

    Signals
    -------
    selected, identify_pressed, reconnect_pressed
        The sensor's name.
    stepped
        Its name, and -1 or 1 for the row above or below.
    assigned
        Its name and the site it is worn at; None: nowhere.
    """

    selected = Signal(str)
    stepped = Signal(str, int)
    assigned = Signal(str, object)
    identify_pressed = Signal(str)
    reconnect_pressed = Signal(str)

    def __init__(
        self,
        name: str,
        columns: Callable[[int], Mapping[str, QRect]],
        second_line: Callable[[SensorRow], str],
    ) -> None:
        super().__init__()
        self._columns, self._second_line = columns, second_line
        self._is_selected = False
        self._places_offered: tuple[Site, ...] = ()
        self.name = self.dragged = name
        self.sensor = SensorRow(name)
        self.trace = Trace()
        self.trace.setParent(self)
        self.worn = _WornOn(self)
        self.identify = _Identify(self)
        self.worn.clicked.connect(self.ask)
        self.identify.clicked.connect(self._on_identify_clicked)
        self.clicked.connect(self._on_clicked)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Maximum)
        scaled(self.setMinimumHeight, ROW_AT_LEAST)
        self.offer(LEG_SITES)

    def offer(self, places: tuple[Site, ...]) -> None:
        """Let it be worn at these places."""
        if places == self._places_offered:
            return
        self._places_offered = places
        described = tr("Keys 1 to {count} set the position, Space opens a list of positions")
        self.setAccessibleDescription(described.format(count=len(places)))

    def takes_other_room(self, sensor: SensorRow) -> bool:
        """Whether a column may have to be wider for `sensor` as it is now."""
        one, other = self._second_line(sensor), self._second_line(self.sensor)
        return not self.accessibleName() or len(one) > len(other)

    def show_sensor(self, sensor: SensorRow) -> None:
        if sensor == self.sensor and self.accessibleName():
            return
        self.sensor = sensor
        worn = tr("position: {site}").format(site=name_of(sensor.site)) if sensor.site else tr("no position")
        battery = tr("battery {charge}").format(charge=sensor.charge)
        self.setAccessibleName(", ".join([sensor.name, sensor.second_line, sensor.rate, battery, worn]))
        self.trace.show_silence(sensor.silent_s)
        self.worn.show_site(sensor.site)
        self.worn.setAccessibleName(", ".join([sensor.name, worn]))
        self.identify.show_sensor(sensor)
        self.trace.show_ground(self._ground)
        self.update()

    @property
    def _ground(self) -> QColor:
        """What the row is filled with, the thin layer under the mouse included."""
        theme = current_theme()
        ground = QColor(theme.colours.caution if self.sensor.wants_look else theme.colours.surface)
        if not (self.underMouse() or self.isDown()):
            return ground
        veil = theme.veil(self.isDown())
        share = veil.alphaF()
        mixed = [
            round((1 - share) * under + share * over)
            for under, over in zip(ground.getRgb()[:3], veil.getRgb()[:3], strict=True)  # type: ignore[index]  # Qt gives four numbers; its stubs say object
        ]
        return QColor(*mixed)

    def set_selected(self, is_selected: bool) -> None:
        """Frame it and let the tabulator reach it, with what can be pressed in it; or neither."""
        self._is_selected = is_selected
        self.update()
        policy = Qt.FocusPolicy.StrongFocus if is_selected else Qt.FocusPolicy.ClickFocus
        for one in (self, self.worn, self.identify):
            one.setFocusPolicy(policy)

    def ask(self) -> None:
        """Open the list of places under the button that names the present one."""
        self.selected.emit(self.name)
        menu = _PlaceMenu(self.sensor.site, self._places_offered, self)
        menu.chosen.connect(self._on_place_chosen)
        menu.popup(self.worn.mapToGlobal(QPoint(0, self.worn.height())))

    def arrange(self) -> None:
        places = self._places()
        inset = px(8)
        self.trace.setGeometry(places["trace"].adjusted(0, inset, 0, -inset))
        height = px(44)
        for child, key in ((self.worn, "worn"), (self.identify, "identify")):
            child.setGeometry(QRect(places[key].x(), (self.height() - height) // 2, places[key].width(), height))
        self.update()

    def sizeHint(self) -> QSize:
        return QSize(0, px(ROW))

    def _places(self) -> dict[str, QRect]:
        """Where the columns lie, as high as the row."""
        columns = self._columns(self.width()).items()
        return {key: QRect(box.x(), 0, box.width(), self.height()) for key, box in columns}

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.arrange()

    def focusInEvent(self, event: QFocusEvent) -> None:
        super().focusInEvent(event)
        self.selected.emit(self.name)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        has_alt = bool(event.modifiers() & Qt.KeyboardModifier.AltModifier)
        match event.key():
            case Qt.Key.Key_Return | Qt.Key.Key_Enter:
                event.ignore()
            case Qt.Key.Key_Space:
                self.ask()
            case Qt.Key.Key_Down if has_alt:
                self.ask()
            case Qt.Key.Key_Up:
                self.stepped.emit(self.name, -1)
            case Qt.Key.Key_Down:
                self.stepped.emit(self.name, 1)
            case _:
                super().keyPressEvent(event)

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        c, px = theme.colours, theme.px
        sensor = self.sensor
        is_caution, is_selected = sensor.wants_look, self._is_selected
        ink, second = (c.caution_ink, c.caution_ink) if is_caution else (c.ink, c.ink2)
        edge = c.caution_edge if is_caution else c.control if is_selected else c.line
        painter.setPen(theme.pen(edge, 1.75 if is_selected else 1.25))
        ground = self._ground
        self.trace.show_ground(ground)
        painter.setBrush(ground)
        radius = CONTROL_RADIUS * theme.scale
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(1, 1, -1, -1), radius, radius)
        places = self._places()
        grip = px(20)
        middle = QRectF((places["name"].x() - grip) / 2, (self.height() - grip) / 2, grip, grip)
        paint_icon(painter, Icon.GRIP, middle, second)
        if places["battery"].width() and sensor.battery is not None and sensor.silent_s <= 0:
            x, y = places["battery"].x(), (self.height() - px(CELL_HEIGHT)) / 2
            paint_battery(painter, QRectF(x, y, px(CELL_WIDTH), px(CELL_HEIGHT)), sensor.battery, theme, ink)

    def painted_texts(self) -> list[PaintedText]:
        theme, sensor = current_theme(), self.sensor
        px = theme.px
        places = self._places()
        name, is_caution = places["name"], sensor.wants_look
        top = (self.height() - px(40)) / 2
        tone, second = ("caution_ink", "caution_ink") if is_caution else ("ink", "ink2")
        small = theme.font(12, MEDIUM if is_caution else REGULAR)
        texts = [
            PaintedText(
                sensor.name,
                QRectF(name.x(), top, name.width(), px(22)),
                theme.font(16, SEMIBOLD, is_code=True),
                tone,
            ),
            PaintedText(self._second_line(sensor), QRectF(name.x(), top + px(22), name.width(), px(18)), small, second),
        ]
        if places["rate"].width():
            font, battery = theme.font(14, MEDIUM), QRectF(places["battery"])
            if sensor.battery is not None and sensor.silent_s <= 0:
                battery.setLeft(battery.left() + px(CELL_WIDTH + 6))
            texts.append(PaintedText(sensor.rate, QRectF(places["rate"]), font, tone))
            texts.append(PaintedText(sensor.charge, battery, font, tone))
        return texts

    def _on_clicked(self) -> None:
        self.selected.emit(self.name)
        self.setFocus(Qt.FocusReason.MouseFocusReason)

    def _on_identify_clicked(self) -> None:
        if self.sensor.silent_s > 0:
            self.reconnect_pressed.emit(self.name)
        else:
            self.identify_pressed.emit(self.name)

    def _on_place_chosen(self, site: Site | None) -> None:
        self.assigned.emit(self.name, site)


class _WornOn(PaintedButton):
    """Names the place, and opens the list of places."""

    pressing_keys = (*PaintedButton.pressing_keys, Qt.Key.Key_Down)

    def __init__(self, row: SensorRowView) -> None:
        super().__init__(row)
        self._row = row
        self._site: Site | None = None

    def show_site(self, site: Site | None) -> None:
        self._site = site
        self.update()

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        c, px = theme.colours, theme.px
        self.paint_veil(painter, QRectF(self.rect()), CHIP_RADIUS)
        if self._site is not None and self._site.side is not None:
            chip = px(CHIP)
            paint_chip(painter, QRectF(0, (self.height() - chip) / 2, chip, chip), self._site.side, theme)
        (word,) = self.painted_texts()
        side, end = px(CHEVRON), word.needed.right() + px(6)
        middle = QRectF(end, (self.height() - side) / 2 + 1, side, side)
        paint_icon(painter, Icon.CHEVRON, middle, getattr(c, word.tone))

    def painted_texts(self) -> list[PaintedText]:
        theme = current_theme()
        px = theme.px
        left = px(CHIP + 6) if self._site is not None and self._site.side is not None else 0
        return [
            PaintedText(
                segment_name(self._site.segment) if self._site is not None else tr("none"),
                QRectF(left, 0, self.width() - left - px(CHEVRON + 6), self.height()),
                theme.font(14, MEDIUM if self._site is not None else REGULAR),
                "caution_ink" if self._row.sensor.wants_look else "ink",
            )
        ]


class _Identify(PaintedButton):
    """Lights the sensor's LED; where the sensor is silent, looks for it again."""

    def __init__(self, row: SensorRowView) -> None:
        super().__init__(row)
        self._row = row

    def show_sensor(self, sensor: SensorRow) -> None:
        is_silent = sensor.silent_s > 0
        name = tr("Reconnect {sensor}") if is_silent else tr("Light the LED of {sensor}")
        self.setAccessibleName(name.format(sensor=sensor.name))
        self.setToolTip(self.accessibleName())
        self.setVisible(is_silent or sensor.can_identify)
        self.update()

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        c, px = theme.colours, theme.px
        self.paint_veil(painter, QRectF(self.rect()), CHIP_RADIUS)
        sensor = self._row.sensor
        side = px(22)
        box = QRectF(self.width() - px(10) - side, (self.height() - side) / 2, side, side)
        icon = Icon.REPEAT if sensor.silent_s > 0 else Icon.LIGHT
        paint_icon(painter, icon, box, c.caution_ink if sensor.wants_look else c.ink)


class _PlaceMenu(QMenu):
    """The places and nowhere; the present one is checked, and their numbers are keys."""

    chosen = Signal(object)

    def __init__(self, site: Site | None, places: tuple[Site, ...], parent: QWidget) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setAccessibleName(tr("Position"))
        self.setFont(current_theme().font(16, SEMIBOLD))  # what the width is reckoned from
        group = QActionGroup(self)
        for one in (*places, None):
            words = tr("None") if one is None else f"&{number_of(one)}  {capitalised(name_of(one))}"
            action = QAction(words, self)
            action.setCheckable(True)
            action.setChecked(one is site)
            action.setData(None if one is None else one.value)
            group.addAction(action)
            self.addAction(action)
            if one is site:
                self.setActiveAction(action)
        self.triggered.connect(self._on_triggered)

    def _on_triggered(self, action: QAction) -> None:
        self.chosen.emit(None if action.data() is None else Site(action.data()))
