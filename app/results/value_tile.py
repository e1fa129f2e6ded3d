"""One of the four values over the curves: what it is, what it has changed by, and where it lies on its scale."""

import math
from collections.abc import Sequence

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QAccessible, QColor, QFontMetrics, QPainter, QPolygonF
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QWidget

from app.summary.tiles import Tile, TileValue
from app.theme.current import current_theme, px, scaled
from app.theme.ground import Ground, set_ground
from app.theme.leg_chip import paint_chip
from app.theme.theme import CARD_RADIUS
from app.widgets.lay_out import lay_out
from app.widgets.painted import Painted
from app.widgets.painted_text import LEFT, RIGHT, PaintedText
from app.widgets.text import MEDIUM, REGULAR, SEMIBOLD
from core.body import Side

HEIGHT, BRIEF_HEIGHT = 93, 64
LEAST = 132  # px wide
SIDE = 16
NAME, VALUE, UNIT, SMALL, MISSING = 13, 28, 13, 12, 18
CHIP = 18
BAR, BAR_HEIGHT = 96, 4
LEAST_BAR = 56
NOW, LAST = 10, 7
GOAL = (2, 16)
ARROW = (9, 8)


class TileRow(QWidget):
    """All four beside each other, equally wide."""

    def __init__(self) -> None:
        super().__init__()
        self.tiles = [ValueTile() for _ in range(4)]
        lay_out(QHBoxLayout(self), *((tile, 1) for tile in self.tiles), margins=0, spacing=12)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def show_tiles(self, tiles: Sequence[Tile]) -> None:
        for widget, tile in zip(self.tiles, tiles, strict=True):
            widget.show_tile(tile)

    def set_brief(self, is_brief: bool) -> None:
        for tile in self.tiles:
            tile.set_brief(is_brief)


class ValueTile(Painted):
    """Painted; what is cut for want of room is in its tooltip. In brief: no scale, the change at the right."""

    accessible_role = QAccessible.Role.StaticText

    def __init__(self) -> None:
        super().__init__()
        self.tile: Tile | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        set_ground(self, Ground("surface", "line", radius=CARD_RADIUS))
        self.set_brief(is_brief=False)

    def show_tile(self, tile: Tile) -> None:
        self.tile = tile
        self.setAccessibleName(tile.in_words)
        self.setToolTip(tile.in_words)
        self.update()

    def set_brief(self, is_brief: bool) -> None:
        self._is_brief = is_brief
        scaled(self.setMinimumSize, LEAST, BRIEF_HEIGHT if is_brief else HEIGHT)
        self.update()

    def painted_texts(self) -> list[PaintedText]:
        """What is painted, and where."""
        if self.tile is None:
            return []
        return [
            self._name(self.tile),
            *(text for text, _ in self.value_texts(self.tile)),
            *self.change_texts(self.tile),
            *self.goal_texts(self.tile),
        ]

    def draw(self, painter: QPainter) -> None:
        theme, tile = current_theme(), self.tile
        if tile is None:
            return
        for text, side in self.value_texts(tile):
            if side is not None:
                left = text.box.left() + QFontMetrics(text.font).horizontalAdvance(text.text) + theme.px(8)
                size = theme.px(CHIP)
                paint_chip(painter, QRectF(left, text.box.center().y() - size / 2, size, size), side, theme)
        self._paint_arrow(painter, tile)
        if (bar := self.bar_of(tile)) is not None:
            self._paint_bar(painter, tile, bar)

    def _name(self, tile: Tile) -> PaintedText:
        theme = current_theme()
        font = theme.font(NAME - self._is_brief, MEDIUM)
        box = QRectF(px(SIDE), px(7 if self._is_brief else 9), self.width() - 2 * px(SIDE), px(20))
        metrics = QFontMetrics(font)
        name = tile.name if metrics.horizontalAdvance(tile.name) <= box.width() else tile.brief or tile.name
        text = metrics.elidedText(name, Qt.TextElideMode.ElideRight, int(box.width()))
        return PaintedText(text, box, font, "ink2")

    def value_texts(self, tile: Tile) -> list[tuple[PaintedText, Side | None]]:
        """Each value, with the side whose chip follows it; the unit is text of its own."""
        theme = current_theme()
        top, height, left = px(26 if self._is_brief else 31), px(34), float(px(SIDE))
        is_two = len(tile.values) > 1
        size = VALUE - (4 if self._is_brief else 0) - (4 if is_two else 0)
        found: list[tuple[PaintedText, Side | None]] = []
        for one in tile.values:
            is_missing = not math.isfinite(one.value)
            words = tile.why if is_missing and tile.why and not is_two else one.text
            words = words[:1].upper() + words[1:]
            font = theme.font(MISSING if (words == one.text and is_missing) or words != one.text else size, SEMIBOLD)
            width = QFontMetrics(font).horizontalAdvance(words)
            found.append((PaintedText(words, QRectF(left, top, width + 1, height), font), one.side))
            left += width + (px(CHIP) + px(8) if one.side is not None else 0) + px(10)
        if tile.unit and math.isfinite(tile.values[0].value):
            font = theme.font(UNIT)
            width = QFontMetrics(font).horizontalAdvance(tile.unit)
            found.append(
                (PaintedText(tile.unit, QRectF(left - px(4), top + px(3), width + 1, height), font, "ink2"), None)
            )
        return found

    def change_texts(self, tile: Tile) -> list[PaintedText]:
        """What has changed: whole where it fits, else without what its arrow states."""
        theme, px, change = current_theme(), current_theme().px, tile.change
        font = theme.font(SMALL, MEDIUM)
        metrics = QFontMetrics(font)
        arrow = px(ARROW[0]) + px(5) if change.rises is not None else 0
        if self._is_brief:
            values = self.value_texts(tile)
            used = max((text.box.right() for text, _ in values), default=0.0) + px(CHIP if tile.values[0].side else 0)
            room = self.width() - px(SIDE) - used - px(16) - arrow
            shown = next((one for one in (change.brief, change.size) if metrics.horizontalAdvance(one) <= room), "")
            width = metrics.horizontalAdvance(shown)
            box = QRectF(self.width() - px(SIDE) - width - 1, px(26), width + 1, px(34))
            return [PaintedText(shown, box, font, "ink2", RIGHT)] if shown else []
        room = self.width() - 2 * px(SIDE) - arrow
        shown = next(
            (one for one in (change.words, change.brief) if metrics.horizontalAdvance(one) <= room), change.size
        )
        shown = metrics.elidedText(shown, Qt.TextElideMode.ElideRight, room)
        box = QRectF(px(SIDE) + arrow, px(67), room, px(18))
        return [PaintedText(shown, box, font, "ink", LEFT)] if shown else []

    def _paint_arrow(self, painter: QPainter, tile: Tile) -> None:
        """Up or down before the change; filled beyond error, outlined within it."""
        if tile.change.rises is None or not (texts := self.change_texts(tile)):
            return
        theme = current_theme()
        width, height = px(ARROW[0]), px(ARROW[1])
        left = texts[0].box.left() - width - px(5)
        middle = texts[0].box.center().y()
        base, tip = (middle + height / 2, middle - height / 2)
        if not tile.change.rises:
            base, tip = tip, base
        triangle = QPolygonF([QPointF(left, base), QPointF(left + width, base), QPointF(left + width / 2, tip)])
        painter.setPen(theme.pen(theme.colours.ink, 1.25))
        painter.setBrush(QColor(theme.colours.ink) if tile.change.is_beyond_error else Qt.BrushStyle.NoBrush)
        painter.drawPolygon(triangle)

    def bar_of(self, tile: Tile) -> QRectF | None:
        """Where the scale is; None where there is no room, or nothing to show on it."""
        if self._is_brief or not any(math.isfinite(one.value) for one in tile.values):
            return None
        ends = [
            text.box.right() + (px(CHIP) + px(8) if side is not None else 0) for text, side in self.value_texts(tile)
        ]
        right = self.width() - px(SIDE)
        left = max(right - px(BAR), max(ends) + px(14))
        return QRectF(left, px(51), right - left, px(BAR_HEIGHT)) if right - left >= px(LEAST_BAR) else None

    def goal_texts(self, tile: Tile) -> list[PaintedText]:
        """The first goal over its tick, or alone at the right where there is no scale."""
        if not tile.goal or self._is_brief:
            return []
        theme, px, bar = current_theme(), current_theme().px, self.bar_of(tile)
        font = theme.font(SMALL, REGULAR)
        width = QFontMetrics(font).horizontalAdvance(tile.goal) + 1
        right = self.width() - px(SIDE)
        if bar is None:
            if any(math.isfinite(one.value) for one in tile.values):
                return []
            return [PaintedText(tile.goal, QRectF(right - width, px(67), width, px(18)), font, "ink2", RIGHT)]
        middle = self._x(tile, tile.goals[0], bar)
        left = min(max(middle - width / 2, px(SIDE)), right - width)
        return [PaintedText(tile.goal, QRectF(left, px(27), width, px(16)), font, "ink2")]

    def _paint_bar(self, painter: QPainter, tile: Tile, bar: QRectF) -> None:
        theme = current_theme()
        c, middle = theme.colours, bar.center().y()
        theme.paint_box(painter, bar, c.track, radius=2)
        if tile.zone is not None:
            left, right = (self._x(tile, edge, bar) for edge in tile.zone)
            painter.fillRect(QRectF(left, bar.top(), max(right - left, 1.0), bar.height()), QColor(c.band_1sd))
        for value in tile.goals:
            x = self._x(tile, value, bar)
            painter.fillRect(
                QRectF(x - px(GOAL[0]) / 2, middle - px(GOAL[1]) / 2, px(GOAL[0]), px(GOAL[1])), QColor(c.ink)
            )
        for one in tile.values:
            self._paint_value(painter, tile, one, bar)

    def _paint_value(self, painter: QPainter, tile: Tile, one: TileValue, bar: QRectF) -> None:
        """The last visit as a ring, this one as a dot, in the leg's colour where it is of a leg."""
        theme, px, middle = current_theme(), current_theme().px, bar.center().y()
        ink = theme.curve(one.side) if one.side is not None else QColor(theme.colours.ink)
        if math.isfinite(one.last):
            painter.setPen(theme.pen(ink, 1.5))
            painter.setBrush(QColor(theme.colours.surface))
            painter.drawEllipse(QPointF(self._x(tile, one.last, bar), middle), px(LAST) / 2, px(LAST) / 2)
        if math.isfinite(one.value):
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(ink)
            painter.drawEllipse(QPointF(self._x(tile, one.value, bar), middle), px(NOW) / 2, px(NOW) / 2)

    def _x(self, tile: Tile, value: float, bar: QRectF) -> float:
        low, high = tile.scale
        return bar.left() + bar.width() * min(max((value - low) / (high - low), 0.0), 1.0)
