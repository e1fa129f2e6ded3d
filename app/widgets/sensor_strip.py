"""Strip that shows whether all sensors are received.

Each has a tile, round a pair of legs, or round the pelvis's tile where one is worn there.
"""

from collections.abc import Collection, Mapping

from PySide6.QtCore import QElapsedTimer, QRect, QRectF, Qt, QTimer, Signal
from PySide6.QtGui import QAccessible, QColor, QPainter, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.theme.current import current_theme, on_theme, px
from app.widgets.body_figure import paint_legs
from app.widgets.grid import LEAST, side_margin
from app.widgets.painted_text import CENTRE, PaintedText
from app.widgets.sensor_tile import SensorTile, marks
from app.widgets.text import SEMIBOLD
from app.widgets.tile_widget import TileWidget
from app.wording.translation import tr
from core.body import LEG_SEGMENTS, LEG_SITES, Side, Site

TILE = 56
COMPACT_TILE = 44
GAP = 8
LEGS = 66  # with the letters at both sides
BETWEEN = 22  # of the sides, where the legs are left away
EVERY_MS = 250  # faster changes cannot be read


class SensorStrip(QWidget):
    """One stop for Tab; the arrows go from tile to tile."""

    accessible_role = QAccessible.Role.List

    turned_bad = Signal()
    tiles_changed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._is_compact, self._is_from_behind = False, False
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setAccessibleName(tr("Sensors"))
        self._tiles: dict[Site, SensorTile] = {}
        self._waiting: dict[Site, SensorTile] | None = None
        self._since = QElapsedTimer()
        self._later = QTimer(self)
        self._later.setSingleShot(True)
        self._later.timeout.connect(self._on_later)
        self.widgets: dict[Site, TileWidget] = {}
        for site in _order(LEG_SITES, is_from_behind=False):
            self._add(site)
        self._legs = QRect()
        self._set_tab_stop(next(iter(self.widgets.values())))
        on_theme(self._arrange)

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
            self.show_at_once(dict(tiles))

    def set_compact(self, is_compact: bool) -> None:
        if is_compact != self._is_compact:
            self._is_compact = is_compact
            for widget in self.widgets.values():
                widget.set_compact(is_compact)
            self._arrange()

    def set_from_behind(self, is_from_behind: bool) -> None:
        """Turn the tiles with the figure: from behind, the patient's left is at the left."""
        self._is_from_behind = is_from_behind
        self._arrange()

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
        theme = current_theme()
        font, width, height = theme.font(12, SEMIBOLD), theme.px(16), theme.px(18)
        at = {Side.LEFT: self._legs.right() - width, Side.RIGHT: self._legs.left()}
        if self._is_from_behind:
            at = {Side.LEFT: self._legs.left(), Side.RIGHT: self._legs.right() - width}
        return [
            PaintedText(side.letter, QRectF(x, self._legs.top(), width, height), font, f"{side}_text", CENTRE)
            for side, x in at.items()
        ]

    def paintEvent(self, event: QPaintEvent) -> None:
        theme = current_theme()
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

    def show_at_once(self, tiles: dict[Site, SensorTile]) -> None:
        before = self._tiles
        self._tiles, self._waiting = tiles, None
        self._since.restart()
        self._show_pelvis(Site.PELVIS in tiles)
        for site, widget in self.widgets.items():
            if site in tiles:
                widget.show_tile(tiles[site])
        if marks(before) != marks(tiles):
            self.update(self._legs)
        self.tiles_changed.emit()
        turned = (tile for site, tile in tiles.items() if tile.is_bad and not _is_bad(before.get(site)))
        if next(turned, None) is not None:
            self.turned_bad.emit()

    def _add(self, site: Site) -> None:
        widget = self.widgets[site] = TileWidget(site, self)
        widget.moved.connect(self._on_moved)
        widget.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        widget.set_compact(self._is_compact)
        widget.show()

    def _show_pelvis(self, is_shown: bool) -> None:
        """Have a seventh tile, or none."""
        if is_shown is (Site.PELVIS in self.widgets):
            return
        if is_shown:
            self._add(Site.PELVIS)
        else:
            widget = self.widgets.pop(Site.PELVIS)
            if widget.focusPolicy() is Qt.FocusPolicy.StrongFocus:
                self._set_tab_stop(next(iter(self.widgets.values())))
            widget.setParent(None)
            widget.deleteLater()
        self._arrange()

    def _arrange(self) -> None:
        """Put the tiles in one row about the legs, or in some where they would be too narrow."""
        if Site.PELVIS in self.widgets:
            self._arrange_seven()
        else:
            self._arrange_six()

    def _arrange_seven(self) -> None:
        """In one row about the pelvis; in two with the pelvis at the end of the first; else the sides side by side."""
        margin = side_margin(self.width(), current_theme())
        gap, height = px(GAP), px(COMPACT_TILE if self._is_compact else TILE)
        room = max(self.width(), px(LEAST)) - 2 * margin
        order = [self.widgets[site] for site in _order(self.widgets, self._is_from_behind)]
        in_one_row = (room - 6 * gap) // 7
        is_tight = not self._is_compact and in_one_row < self._needed(is_tight=False)
        columns = 4 if (room - 3 * gap) // 4 >= self._needed(is_tight=False) else 2
        if in_one_row >= self._needed(is_tight):
            columns = 7
        elif columns == 2:
            order = [order[k] for k in (0, 4, 1, 5, 2, 6, 3)]
        width = max((room - (columns - 1) * gap) // columns, 1)
        top = px(4 if self._is_compact else 8)
        for k, widget in enumerate(order):
            widget.set_tight(is_tight and columns == 7)
            row, column = divmod(k, columns)
            widget.setGeometry(margin + column * (width + gap), top + row * (height + gap), width, height)
        rows = -(-7 // columns)
        self.setFixedHeight(2 * top + rows * height + (rows - 1) * gap)
        self._legs = QRect()
        self.update()

    def _arrange_six(self) -> None:
        margin = side_margin(self.width(), current_theme())
        gap, height = px(GAP), px(COMPACT_TILE if self._is_compact else TILE)
        room = max(self.width(), px(LEAST)) - 2 * margin
        between = px(BETWEEN) if self._is_compact else px(LEGS) + 2 * gap
        in_one_row = (room - between - 5 * gap + gap) // 6
        is_tight = not self._is_compact and in_one_row < self._needed(is_tight=False)
        needed = self._needed(is_tight)
        order = [self.widgets[site] for site in _order(self.widgets, self._is_from_behind)]
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
        order = [self.widgets[site] for site in _order(self.widgets, self._is_from_behind)]
        at = next(k for k, widget in enumerate(order) if widget is self.sender())
        goal = order[min(max(at + steps, 0), len(order) - 1)]
        self._set_tab_stop(goal)
        goal.setFocus(Qt.FocusReason.OtherFocusReason)

    def _on_later(self) -> None:
        if self._waiting is not None:
            self.show_at_once(self._waiting)


def _order(sites: Collection[Site], is_from_behind: bool) -> list[Site]:
    """Give the sites from left to right: the patient faces you, so the right leg is at the left."""
    sides = (Side.LEFT, Side.RIGHT) if is_from_behind else (Side.RIGHT, Side.LEFT)
    first, second = ([Site(f"{side}_{segment}") for segment in LEG_SEGMENTS] for side in sides)
    return [*first, *([Site.PELVIS] if Site.PELVIS in sites else []), *second]


def _is_bad(tile: SensorTile | None) -> bool:
    return tile is not None and tile.is_bad
