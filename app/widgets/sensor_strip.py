"""Are all six sensors heard? A tile for each round a pair of legs, or one sentence where tiles have no room."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum, auto

from PySide6.QtCore import QElapsedTimer, QRect, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QFont, QFontMetrics, QKeyEvent, QPainter, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import QAbstractButton, QSizePolicy, QWidget

from app.theme import CONTROL_RADIUS, Look
from app.widgets.battery import LOW, paint_battery
from app.widgets.battery import WIDTH as BATTERY_WIDTH
from app.widgets.body_figure import SensorMark, paint_legs
from app.widgets.chip import CHIP, LETTERS, paint_chip
from app.widgets.grid import LEAST, side_margin
from app.widgets.icons import Icon, paint_icon
from app.widgets.painted_text import CENTRE, PaintedText, height_for
from app.widgets.text import MEDIUM, SEMIBOLD
from app.wording import name_of, tr
from core.body import Segment, Side, Site

HEIGHT = 72
TILE = 56
COMPACT_TILE = 44
GAP = 8
LEGS = 66  # with the letters at both sides
BETWEEN = 22  # of the sides, where the legs are left away
PADDING = 10
MARKS = BATTERY_WIDTH + 4 + 18  # battery and movement
EVERY_MS = 250  # faster changes cannot be read

LOST_SHARE = 0.01
SILENT_FROM_S = 1.0  # shorter is the radio's hiccup, and counts as loss


class TileState(Enum):
    FINE = auto()
    LOW_BATTERY = auto()
    LOSS = auto()
    SILENT = auto()
    NOT_WORN = auto()


@dataclass(frozen=True, slots=True)
class SensorTile:
    """What is known of the sensor at one site. `name` is the sensor's own; `battery` and `lost_share` 0 to 1.

    `is_awaited`: none is known to be worn here, and the free motion is still to tell.
    """

    site: Site
    name: str
    battery: float | None
    rate_hz: float
    lost_share: float
    silent_s: float
    is_moving: bool
    is_worn: bool
    is_awaited: bool = False

    @property
    def state(self) -> TileState:
        """The gravest thing that is true of it."""
        if not self.is_worn:
            return TileState.NOT_WORN
        if self.silent_s >= SILENT_FROM_S:
            return TileState.SILENT
        if self.lost_share > LOST_SHARE:
            return TileState.LOSS
        if self.battery is not None and self.battery < LOW:
            return TileState.LOW_BATTERY
        return TileState.FINE

    @property
    def is_bad(self) -> bool:
        return self.state not in (TileState.FINE, TileState.NOT_WORN)

    @property
    def words(self) -> str:
        """What its tile says under the name."""
        match self.state:
            case TileState.NOT_WORN:
                return tr("found later") if self.is_awaited else tr("not used")
            case TileState.SILENT:
                return tr("silent {seconds} s").format(seconds=int(self.silent_s))
            case TileState.LOSS:
                return _loss(self.lost_share)
            case TileState.LOW_BATTERY:
                return tr("charge soon · {percent} %").format(percent=round((self.battery or 0.0) * 100))
            case _:
                return _rate_and_loss(self.rate_hz, self.lost_share)


def sentence(tiles: Mapping[Site, SensorTile]) -> str:
    """Say in one sentence how the sensors are: what is wrong with the first bad one, or that all are heard."""
    worn = [tile for tile in tiles.values() if tile.is_worn]
    bad = [tile for tile in worn if tile.is_bad]
    if len(bad) == 1:
        return tr("{site}: {words}").format(site=name_of(bad[0].site), words=bad[0].words)
    if bad:
        return tr("{bad} of {count} sensors want a look").format(bad=len(bad), count=len(worn))
    if not worn:
        return tr("No sensors yet")
    return tr("{count} sensors, all heard").format(count=len(worn))


def marks(tiles: Mapping[Site, SensorTile]) -> dict[Site, SensorMark]:
    """Give how the sensors look on the legs."""
    found = {}
    for site, tile in tiles.items():
        if tile.is_worn:
            look = SensorMark.LOOK if tile.is_bad else SensorMark.WORN
            found[site] = SensorMark.SILENT if tile.state is TileState.SILENT else look
    return found


class SensorStrip(QWidget):
    """One stop for Tab; the arrows go from tile to tile."""

    turned_bad = Signal()
    tiles_changed = Signal()

    def __init__(self, look: Look) -> None:
        super().__init__()
        self._look, self._is_compact, self._is_from_behind = look, False, False
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setAccessibleName(tr("Sensors"))
        self._tiles: dict[Site, SensorTile] = {}
        self._waiting: dict[Site, SensorTile] | None = None
        self._since = QElapsedTimer()
        self._later = QTimer(self)
        self._later.setSingleShot(True)
        self._later.timeout.connect(self._on_later)
        self.widgets = {site: TileWidget(look, site, self) for site in _order(is_from_behind=False)}
        for widget in self.widgets.values():
            widget.moved.connect(self._on_moved)
        self._legs = QRect()
        self._set_tab_stop(next(iter(self.widgets.values())))
        look.changed.connect(self._on_look_changed)
        self._arrange()

    @property
    def tiles(self) -> Mapping[Site, SensorTile]:
        return self._tiles

    @property
    def is_bad(self) -> bool:
        return any(tile.is_bad for tile in self._tiles.values())

    def show_tiles(self, tiles: Mapping[Site, SensorTile]) -> None:
        """Show how the sensors are; what comes too soon after the last is shown a little later."""
        rest_ms = EVERY_MS - self._since.elapsed() if self._since.isValid() else 0
        if rest_ms > 0:
            self._waiting = dict(tiles)
            if not self._later.isActive():
                self._later.start(rest_ms)
        else:
            self._show(dict(tiles))

    def set_compact(self, is_compact: bool) -> None:
        if is_compact != self._is_compact:
            self._is_compact = is_compact
            for widget in self.widgets.values():
                widget.set_compact(is_compact)
            self._arrange()

    def set_from_behind(self, is_from_behind: bool) -> None:
        """Turn the tiles with the figure: from behind, the patient's left stands at the left."""
        self._is_from_behind = is_from_behind
        self._arrange()
        self.update()

    def focus(self) -> None:
        stop = next(widget for widget in self.widgets.values() if widget.focusPolicy() is Qt.FocusPolicy.StrongFocus)
        stop.setFocus(Qt.FocusReason.OtherFocusReason)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        if event.size().width() != event.oldSize().width():
            self._arrange()

    def painted_texts(self) -> list[PaintedText]:
        """Give what is painted between the tiles, each in its box."""
        if self._legs.isEmpty():
            return []
        theme = self._look.theme
        font, width, height = theme.font(12, SEMIBOLD), theme.px(16), theme.px(18)
        at = {Side.LEFT: self._legs.right() - width, Side.RIGHT: self._legs.left()}
        if self._is_from_behind:
            at = {Side.LEFT: self._legs.left(), Side.RIGHT: self._legs.right() - width}
        return [
            PaintedText(LETTERS[side], QRectF(x, self._legs.top(), width, height), font, f"{side}_text", CENTRE)
            for side, x in at.items()
        ]

    def paintEvent(self, event: QPaintEvent) -> None:
        theme = self._look.theme
        painter = QPainter(self)
        painter.fillRect(event.rect(), QColor(theme.colours.surface))
        painter.setPen(theme.pen(theme.colours.line, 1))
        painter.drawLine(self.rect().bottomLeft(), self.rect().bottomRight())
        if not self._legs.isEmpty() and event.rect().intersects(self._legs):
            inset = theme.px(15)
            room = QRectF(self._legs).adjusted(inset, 0, -inset, 0)
            paint_legs(painter, room, theme, None, marks(self._tiles), self._is_from_behind)
            for text in self.painted_texts():
                text.paint(painter, theme.colours)

    def _show(self, tiles: dict[Site, SensorTile]) -> None:
        before = self._tiles
        self._tiles, self._waiting = tiles, None
        self._since.restart()
        for site, widget in self.widgets.items():
            if site in tiles:
                widget.show_tile(tiles[site])
        if marks(before) != marks(tiles):
            self.update(self._legs)
        self.tiles_changed.emit()
        turned = (tile for site, tile in tiles.items() if tile.is_bad and not _is_bad(before.get(site)))
        if next(turned, None) is not None:
            self.turned_bad.emit()

    def _arrange(self) -> None:
        """Put the tiles in one row about the legs, or in two or three where they would be too narrow."""
        px = self._look.theme.px
        margin = side_margin(self.width(), self._look.theme)
        gap, height = px(GAP), px(COMPACT_TILE if self._is_compact else TILE)
        room = max(self.width(), px(LEAST)) - 2 * margin
        between = px(BETWEEN) if self._is_compact else px(LEGS) + 2 * gap
        in_one_row = (room - between - 5 * gap + gap) // 6
        is_tight = not self._is_compact and in_one_row < self._needed(is_tight=False)
        needed = self._needed(is_tight)
        order = [self.widgets[site] for site in _order(self._is_from_behind)]
        columns = 6 if in_one_row >= needed else 3 if (room - 2 * gap) // 3 >= self._needed(is_tight=False) else 2
        if columns == 2:
            order = [order[k] for k in (0, 3, 1, 4, 2, 5)]  # one row for each segment, the sides side by side
        free = room - (columns - 1) * gap - (between - gap if columns == 6 else 0)
        width = max(free // columns, 1)
        top = px(4 if self._is_compact else 8)
        is_tight = is_tight and columns == 6
        for k, widget in enumerate(order):
            widget.set_tight(is_tight)
            row, column = divmod(k, columns)
            x = margin + column * (width + gap)
            if columns == 6 and column >= 3:
                x = margin + room - (6 - column) * width - (5 - column) * gap
            widget.setGeometry(x, top + row * (height + gap), width, height)
        rows = 6 // columns
        self.setFixedHeight(2 * top + rows * height + (rows - 1) * gap)
        left = margin + 3 * width + 2 * gap
        is_shown = columns == 6 and not self._is_compact
        between = room - 6 * width - 4 * gap
        self._legs = QRect(left + (between - px(LEGS)) // 2, top, px(LEGS), height) if is_shown else QRect()
        self.update()

    def _needed(self, is_tight: bool) -> int:
        return max(widget.needed_width(is_tight) for widget in self.widgets.values())

    def _set_tab_stop(self, stop: "TileWidget") -> None:
        for widget in self.widgets.values():
            widget.setFocusPolicy(Qt.FocusPolicy.StrongFocus if widget is stop else Qt.FocusPolicy.ClickFocus)

    def _on_moved(self, steps: int) -> None:
        order = [self.widgets[site] for site in _order(self._is_from_behind)]
        at = next(k for k, widget in enumerate(order) if widget is self.sender())
        goal = order[min(max(at + steps, 0), len(order) - 1)]
        self._set_tab_stop(goal)
        goal.setFocus(Qt.FocusReason.OtherFocusReason)

    def _on_later(self) -> None:
        if self._waiting is not None:
            self._show(self._waiting)

    def _on_look_changed(self) -> None:
        self._arrange()
        self.update()


class TileWidget(QWidget):
    """One tile. It paints itself anew only when what it says is another."""

    moved = Signal(int)  # by so many tiles, with the arrows

    def __init__(self, look: Look, site: Site, parent: QWidget) -> None:
        super().__init__(parent)
        self._look, self._is_compact, self._is_tight = look, False, False
        self._tile = SensorTile(site, "", None, 0.0, 0.0, 0.0, is_moving=False, is_worn=False)
        self._name()

    def show_tile(self, tile: SensorTile) -> None:
        before, self._tile = self._tile, tile
        if _seen(before) != _seen(tile):
            self._name()
            self.update()

    def set_compact(self, is_compact: bool) -> None:
        self._is_compact = is_compact
        self.update()

    def set_tight(self, is_tight: bool) -> None:
        """Let the name have its line for itself: its marks move to the second, where no loss is not told then."""
        if is_tight != self._is_tight:
            self._is_tight = is_tight
            self.update()

    def needed_width(self, is_tight: bool) -> int:
        """The width below which its words are cut, whatever it may come to say."""
        px = self._look.theme.px
        name = QFontMetrics(self._name_font()).horizontalAdvance(self._segment())
        bold = QFontMetrics(self._words_font(is_bold=True))
        if self._is_compact:
            words = bold.horizontalAdvance(tr("silent {seconds} s").format(seconds=88))
            return px(CHIP + 6 + 2 * 8) + max(name + px(4 + 18), words) + px(2)
        longest = max((tr("charge soon · {percent} %").format(percent=88)).split(), key=len)
        words = 2 * px(PADDING) + bold.horizontalAdvance(longest)
        if is_tight:
            return max(px(8 + CHIP + 6 + 8) + name, words, px(120))
        fine = QFontMetrics(self._words_font(is_bold=False)).horizontalAdvance(_rate_and_loss(100.0, 0.001))
        return max(px(8 + CHIP + 6 + 4 + MARKS + 9) + name, words, 2 * px(PADDING) + fine)

    def painted_texts(self) -> list[PaintedText]:
        """Give what is painted now, each in its box."""
        px = self._look.theme.px
        state = self._tile.state
        is_bold = self._tile.is_bad
        tone = "caution_ink" if is_bold else "ink2"
        name_tone = "caution_ink" if is_bold else "ink2" if state is TileState.NOT_WORN else "ink"
        chip = self._chip()
        left = chip.right() + px(6)
        if self._is_compact:
            room = self.width() - px(8) - left
            if state is TileState.FINE:
                box = QRectF(left, 0, room - px(18 + 4), self.height())
                return [PaintedText(self._segment(), box, self._name_font(), name_tone)]
            name = QRectF(left, px(5), room, px(18))
            words = QRectF(left, px(23), room, px(16))
            return [
                PaintedText(self._segment(), name, self._name_font(), name_tone),
                PaintedText(self._short_words(room), words, self._words_font(is_bold), tone),
            ]
        pad = px(PADDING)
        name_right = self.width() - px(8) if self._is_tight else self._marks_left() - px(4)
        name = QRectF(left, chip.top() - px(2), name_right - left, chip.height() + px(4))
        is_short = self._is_tight and state is TileState.FINE
        said = f"{self._tile.rate_hz:.0f} Hz" if is_short else self._tile.words
        font = self._words_font(is_bold)
        room = self.width() - 2 * pad
        height = max(height_for(said, font, room), px(18))
        words = QRectF(pad, min(px(31), self.height() - px(4) - height), room, height)
        return [
            PaintedText(self._segment(), name, self._name_font(), name_tone),
            PaintedText(said, words, font, tone, wraps=True),
        ]

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = self._look.theme
        c = theme.colours
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._paint_frame(painter)
        paint_chip(painter, self._chip(), self._tile.site.side, theme)
        self._paint_marks(painter, QColor(c.caution_ink if self._tile.is_bad else c.ink2))
        for text in self.painted_texts():
            text.paint(painter, c)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        steps = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1, Qt.Key.Key_Home: -9, Qt.Key.Key_End: 9}
        if event.key() in steps:
            self.moved.emit(steps[Qt.Key(event.key())])
        else:
            super().keyPressEvent(event)

    def _paint_frame(self, painter: QPainter) -> None:
        theme = self._look.theme
        c = theme.colours
        pen = theme.pen(c.line, 1)
        painter.setBrush(QColor(c.ground))
        if self._tile.is_bad:
            pen = theme.pen(c.caution_edge, 1.75)
            painter.setBrush(QColor(c.caution))
        elif self._tile.state is TileState.NOT_WORN:
            pen = theme.pen(c.control, 1.25)
            pen.setDashPattern([0.1, 2.6])  # round ends: dots
            painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(pen)
        radius = CONTROL_RADIUS * theme.scale
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(1, 1, -1, -1), radius, radius)
        painter.setBrush(Qt.BrushStyle.NoBrush)

    def _paint_marks(self, painter: QPainter, ink: QColor) -> None:
        """Draw battery and movement at the right of the name, or what takes their place."""
        px = self._look.theme.px
        state = self._tile.state
        icon = Icon.WAVE if self._tile.is_moving else Icon.STILL
        if state is TileState.SILENT:
            icon = Icon.SILENT
        if state is TileState.NOT_WORN or (self._is_compact and state is not TileState.FINE):
            return
        middle = self.height() / 2 if self._is_compact else self._chip().center().y()
        if self._is_tight and not self._is_compact:
            if self._tile.is_bad:  # its words need the line
                return
            middle = px(40)
        side = px(18)
        paint_icon(painter, icon, QRectF(self.width() - px(9) - side, middle - side / 2, side, side), ink)
        if not self._is_compact and state is not TileState.SILENT and self._tile.battery is not None:
            cell = QRectF(self._marks_left(), middle - px(7), px(BATTERY_WIDTH), px(14))
            paint_battery(painter, cell, self._tile.battery, self._look.theme, ink)

    def _chip(self) -> QRectF:
        px = self._look.theme.px
        chip = px(CHIP)
        if self._is_compact:
            return QRectF(px(8), (self.height() - chip) / 2, chip, chip)
        is_two_lines = self._tile.is_bad and height_for(
            self._tile.words, self._words_font(is_bold=True), self.width() - 2 * px(PADDING)
        ) > px(20)
        return QRectF(px(8), px(3 if is_two_lines else 8), chip, chip)

    def _marks_left(self) -> float:
        """Give where the battery begins, also where there is none: the name keeps its place."""
        px = self._look.theme.px
        return self.width() - px(9 + MARKS)

    def _segment(self) -> str:
        words = {Segment.THIGH: tr("Thigh"), Segment.SHANK: tr("Shank"), Segment.FOOT: tr("Foot")}
        return words[self._tile.site.segment]

    def _short_words(self, room: float) -> str:
        """Give what is wrong in as many words as there is room for."""
        words = self._tile.words
        if QFontMetrics(self._words_font(is_bold=True)).horizontalAdvance(words) <= room:
            return words
        if self._tile.state is TileState.LOW_BATTERY and self._tile.battery is not None:
            return f"{self._tile.battery * 100:.0f} %"
        return words

    def _name_font(self) -> QFont:
        return self._look.theme.font(13 if self._is_compact else 14, SEMIBOLD)

    def _words_font(self, is_bold: bool) -> QFont:
        return self._look.theme.font(12, SEMIBOLD if is_bold else MEDIUM)

    def _name(self) -> None:
        tile = self._tile
        moving = tr("moving") if tile.is_moving else tr("still")
        is_heard = tile.state not in (TileState.NOT_WORN, TileState.SILENT)
        self.setAccessibleName(", ".join(filter(None, [name_of(tile.site), tile.words, moving if is_heard else ""])))
        battery = (
            tr("battery {percent} %").format(percent=round(tile.battery * 100)) if tile.battery is not None else ""
        )
        sensor = tr("sensor {name}").format(name=tile.name) if tile.name else ""
        self.setAccessibleDescription(", ".join(filter(None, [sensor, battery])))
        self.setToolTip(self.accessibleDescription())


class StripButton(QAbstractButton):
    """The strip in one sentence, where the page has no need of it; pressing it unfolds the strip."""

    resized = Signal()  # its words have another length

    def __init__(self, look: Look) -> None:
        super().__init__()
        self._look, self._is_compact = look, False
        self._tiles: dict[Site, SensorTile] = {}
        self.setCheckable(True)  # checked: the strip is unfolded
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)
        self.show_tiles({})
        look.changed.connect(self._on_look_changed)

    def show_tiles(self, tiles: Mapping[Site, SensorTile]) -> None:
        words = sentence(tiles)
        if words != self.text() or marks(tiles) != marks(self._tiles):
            self._tiles = dict(tiles)
            self.setText(words)
            self.setAccessibleName(words)
            self._on_look_changed()
            self.resized.emit()

    def set_compact(self, is_compact: bool) -> None:
        self._is_compact = is_compact
        self._on_look_changed()

    def sizeHint(self) -> QSize:
        theme = self._look.theme
        words = QFontMetrics(self._font()).horizontalAdvance(self.text())
        return QSize(self._text_left() + words + theme.px(16), theme.px(44 if not self._is_compact else 40))

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def painted_texts(self) -> list[PaintedText]:
        """Give the sentence in its box."""
        box = QRectF(self.rect()).adjusted(self._text_left(), 0, -self._look.theme.px(14), 0)
        return [PaintedText(self.text(), box, self._font(), "caution_ink" if self._is_bad() else "ink")]

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = self._look.theme
        c, px = theme.colours, theme.px
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        pen = theme.pen(c.caution_edge, 1.75) if self._is_bad() else theme.pen(c.control, 1.25)
        painter.setPen(theme.pen(c.ink, 1.75) if self.isChecked() else pen)
        painter.setBrush(QColor(c.caution if self._is_bad() else c.ground))
        radius = CONTROL_RADIUS * theme.scale
        box = QRectF(self.rect()).adjusted(1, 1, -1, -1)
        painter.drawRoundedRect(box, radius, radius)
        if self.underMouse() or self.isDown():
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(theme.veil(self.isDown()))
            painter.drawRoundedRect(box, radius, radius)
        legs = QRectF(px(12), px(5), px(24), self.height() - 2 * px(5))
        paint_legs(painter, legs, theme, None, marks(self._tiles))
        for text in self.painted_texts():
            text.paint(painter, c)

    def _is_bad(self) -> bool:
        return any(tile.is_bad for tile in self._tiles.values())

    def _font(self) -> QFont:
        return self._look.theme.font(14, SEMIBOLD)

    def _text_left(self) -> int:
        return self._look.theme.px(44)

    def _on_look_changed(self) -> None:
        self.updateGeometry()
        self.update()


def _order(is_from_behind: bool) -> list[Site]:
    """Give the sites from left to right: the patient faces you, so the right leg stands at the left."""
    first, second = (Side.LEFT, Side.RIGHT) if is_from_behind else (Side.RIGHT, Side.LEFT)
    return [Site(f"{side}_{segment}") for side in (first, second) for segment in Segment]


def _loss(share: float) -> str:
    return tr("{percent:.1f} % lost").format(percent=share * 100)


def _rate_and_loss(rate_hz: float, lost_share: float) -> str:
    return f"{rate_hz:.0f} Hz · {_loss(lost_share)}"


def _is_bad(tile: SensorTile | None) -> bool:
    return tile is not None and tile.is_bad


def _seen(tile: SensorTile) -> tuple[object, ...]:
    """Give all of a tile that can be seen or heard: what does not show in it needs no painting."""
    battery = None if tile.battery is None else round(tile.battery * 100)
    return tile.site, tile.name, battery, tile.words, tile.state, tile.is_moving
