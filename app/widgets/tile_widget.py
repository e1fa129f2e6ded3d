"""One sensor's tile: whose it is, how it is, and whether it moves."""

from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import QAccessible, QColor, QFont, QFontMetrics, QKeyEvent, QPainter
from PySide6.QtWidgets import QWidget

from app.theme.current import current_theme, px
from app.theme.icons import Icon, paint_icon
from app.theme.leg_chip import CHIP, paint_chip
from app.theme.theme import CONTROL_RADIUS
from app.widgets.battery import WIDTH as BATTERY_WIDTH
from app.widgets.battery import paint_battery
from app.widgets.painted import Painted
from app.widgets.painted_text import PaintedText, height_for
from app.widgets.sensor_tile import SensorTile, TileState, rate_and_loss
from app.widgets.text import MEDIUM, SEMIBOLD
from app.wording.body import name_of, segment_name
from app.wording.translation import capitalised, tr
from core.body import Site

PADDING = 10
MARKS = BATTERY_WIDTH + 4 + 18  # battery and movement


class TileWidget(Painted):
    """One tile. It paints itself again only when what it shows has changed."""

    accessible_role = QAccessible.Role.ListItem

    moved = Signal(int)  # by so many tiles, with the arrows

    def __init__(self, site: Site, parent: QWidget) -> None:
        super().__init__(parent)
        self._is_compact, self._is_tight = False, False
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
        """Let the name have its line for itself: its marks move to the second, where a loss of 0 is left out."""
        if is_tight != self._is_tight:
            self._is_tight = is_tight
            self.update()

    def needed_width(self, is_tight: bool) -> int:
        """The width below which its words are cut, whatever it may come to say."""
        name = QFontMetrics(self._name_font()).horizontalAdvance(self._segment())
        bold = QFontMetrics(self._words_font(is_bold=True))
        if self._is_compact:
            words = bold.horizontalAdvance(tr("no signal {seconds} s").format(seconds=88))
            return px(self._chip_room + 2 * 8) + max(name + px(4 + 18), words) + px(2)
        longest = max((tr("charge soon · {percent} %").format(percent=88)).split(), key=len)
        words = 2 * px(PADDING) + bold.horizontalAdvance(longest)
        if is_tight:
            return max(px(8 + self._chip_room + 8) + name, words, px(120))
        fine = QFontMetrics(self._words_font(is_bold=False)).horizontalAdvance(rate_and_loss(100.0, 0.001))
        return max(px(8 + self._chip_room + 4 + MARKS + 9) + name, words, 2 * px(PADDING) + fine)

    def painted_texts(self) -> list[PaintedText]:
        """Give what is painted now, each in its box."""
        state = self._tile.state
        is_bold = self._tile.is_bad
        tone = "caution_ink" if is_bold else "ink2"
        name_tone = "caution_ink" if is_bold else "ink2" if state is TileState.NOT_WORN else "ink"
        chip = self._chip()
        left = chip.left() + px(self._chip_room)
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
        stated = f"{self._tile.rate_hz:.0f} Hz" if is_short else self._tile.words
        font = self._words_font(is_bold)
        room = self.width() - 2 * pad
        height = max(height_for(stated, font, room), px(18))
        words = QRectF(pad, min(px(31), self.height() - px(4) - height), room, height)
        return [
            PaintedText(self._segment(), name, self._name_font(), name_tone),
            PaintedText(stated, words, font, tone, wraps=True),
        ]

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        c = theme.colours
        self._paint_frame(painter)
        if (side := self._tile.site.side) is not None:
            paint_chip(painter, self._chip(), side, theme)
        self._paint_marks(painter, QColor(c.caution_ink if self._tile.is_bad else c.ink2))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        steps = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1, Qt.Key.Key_Home: -9, Qt.Key.Key_End: 9}
        if event.key() in steps:
            self.moved.emit(steps[Qt.Key(event.key())])
        else:
            super().keyPressEvent(event)

    def _paint_frame(self, painter: QPainter) -> None:
        theme = current_theme()
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
        state = self._tile.state
        icon = Icon.WAVE if self._tile.is_moving else Icon.STILL
        if state is TileState.SILENT:
            icon = Icon.SILENT
        elif state is TileState.MISPLACED:
            icon = Icon.SWAP
        if state is TileState.NOT_WORN or (self._is_compact and state is not TileState.FINE):
            return
        middle = self.height() / 2 if self._is_compact else self._chip().center().y()
        if self._is_tight and not self._is_compact:
            if self._tile.is_bad:  # its words need the line
                return
            middle = px(40)
        side = px(18)
        if state is not TileState.QUIET:
            paint_icon(painter, icon, QRectF(self.width() - px(9) - side, middle - side / 2, side, side), ink)
        if (
            not self._is_compact
            and state not in (TileState.SILENT, TileState.MISPLACED)
            and self._tile.battery is not None
        ):
            cell = QRectF(self._marks_left(), middle - px(7), px(BATTERY_WIDTH), px(14))
            paint_battery(painter, cell, self._tile.battery, current_theme(), ink)

    @property
    def _chip_room(self) -> int:
        """What the chip takes of the line before the name; the pelvis has no side."""
        return CHIP + 6 if self._tile.site.side is not None else 0

    def _chip(self) -> QRectF:
        chip = px(CHIP)
        if self._is_compact:
            return QRectF(px(8), (self.height() - chip) / 2, chip, chip)
        is_two_lines = self._tile.is_bad and height_for(
            self._tile.words, self._words_font(is_bold=True), self.width() - 2 * px(PADDING)
        ) > px(20)
        return QRectF(px(8), px(3 if is_two_lines else 8), chip, chip)

    def _marks_left(self) -> float:
        """Give where the battery begins, also where there is none: the name keeps its place."""
        return self.width() - px(9 + MARKS)

    def _segment(self) -> str:
        return segment_name(self._tile.site.segment)

    def _short_words(self, room: float) -> str:
        """Give what is wrong in as many words as there is room for."""
        words = self._tile.words
        if QFontMetrics(self._words_font(is_bold=True)).horizontalAdvance(words) <= room:
            return words
        if self._tile.state is TileState.LOW_BATTERY and self._tile.battery is not None:
            return f"{self._tile.battery * 100:.0f} %"
        if self._tile.moves_like is not None:
            return name_of(self._tile.moves_like)
        return words

    def _name_font(self) -> QFont:
        return current_theme().font(13 if self._is_compact else 14, SEMIBOLD)

    def _words_font(self, is_bold: bool) -> QFont:
        return current_theme().font(12, SEMIBOLD if is_bold else MEDIUM)

    def _name(self) -> None:
        tile = self._tile
        moving = tr("moving") if tile.is_moving else tr("still")
        is_received = tile.state not in (TileState.NOT_WORN, TileState.SILENT, TileState.QUIET)
        site = capitalised(name_of(tile.site))
        self.setAccessibleName(", ".join(filter(None, [site, tile.words, moving if is_received else ""])))
        battery = (
            tr("battery {percent} %").format(percent=round(tile.battery * 100)) if tile.battery is not None else ""
        )
        sensor = tr("sensor {name}").format(name=tile.name) if tile.name else ""
        self.setAccessibleDescription(", ".join(filter(None, [sensor, battery])))
        self.setToolTip(self.accessibleDescription())


def _seen(tile: SensorTile) -> tuple[object, ...]:
    """Give all of a tile that can be seen or read out: what does not show in it needs no painting."""
    battery = None if tile.battery is None else round(tile.battery * 100)
    return tile.site, tile.name, battery, tile.words, tile.state, tile.is_moving
