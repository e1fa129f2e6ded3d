"""Figure of which sensor is worn where.

It has a tile for each place, tied to it by a line; sensors are dropped here.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from PySide6.QtCore import QPoint, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QDragEnterEvent,
    QDragLeaveEvent,
    QDragMoveEvent,
    QDropEvent,
    QFontMetrics,
    QPainter,
    QResizeEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.theme.current import current_theme, on_theme, px, scaled
from app.theme.ground import Ground, set_ground
from app.theme.leg_chip import paint_chip
from app.theme.theme import CARD_RADIUS, CONTROL_RADIUS
from app.widgets.body_figure import SENTENCE_ROOM, BodyFigure, SensorMark
from app.widgets.painted import Painted
from app.widgets.painted_text import RIGHT, PaintedText
from app.widgets.text import MEDIUM, SEMIBOLD
from app.wizard.sensors.sensor_drag import DRAGGED, DraggedButton, sensor_in
from app.wording.body import name_of, segment_name
from app.wording.translation import tr
from core.body import LEG_SEGMENTS, Segment, Side, Site

TILE = (112, 50)
LINE = 17  # more, where name and note need a line each
NARROW_TILE = 92
CHIP = 16
PADDING = 8
EDGE, NARROW_EDGE = 16, 8  # between the tiles and the card's edge
BESIDE_LEGS = 8
LEGS_AT_LEAST = 84
GAP = 8
ELBOW = 10  # the line leaves its tile straight


@dataclass(frozen=True, slots=True)
class PlaceShown:
    """One place as it is now: the sensor there, its state in a word or two, and how it looks."""

    sensor: str = ""
    note: str = ""
    mark: SensorMark | None = None
    is_next: bool = False
    is_flashing: bool = False


class SensorPlaces(QWidget):
    """The body figure with a tile for each site; sensors are dragged onto it and from it."""

    dropped = Signal(str, Site)  # a sensor's name and the site it was let go over
    hovered = Signal(str, object)  # a sensor is being dragged over a site; "" and None: no longer
    pressed = Signal(Site)  # the tile of a site

    def __init__(self) -> None:
        super().__init__()
        self._is_narrow, self._has_pelvis = False, False
        self._hovered: Site | None = None
        self._next: Site | None = None
        self._names: tuple[str, ...] = ()
        self.setAcceptDrops(True)
        set_ground(self, Ground("surface", "line", radius=CARD_RADIUS))
        scaled(self.setMinimumHeight, 300)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.figure = BodyFigure()
        self.figure.setParent(self)
        self._lines = _Lines(self)
        self.tiles = {site: _Tile(site, self) for site in Site}
        self.tiles[Site.PELVIS].hide()
        for tile in self.tiles.values():
            tile.clicked.connect(self._on_tile_clicked)
        on_theme(self._arrange)

    @property
    def has_pelvis(self) -> bool:
        return self._has_pelvis

    def show_places(self, places: Mapping[Site, PlaceShown]) -> None:
        """Show what is worn at each of the six sites of the legs, and on the pelvis where that is among them."""
        if (has_pelvis := Site.PELVIS in places) is not self._has_pelvis:
            self._has_pelvis = has_pelvis
            self.tiles[Site.PELVIS].setVisible(has_pelvis)
            self._arrange()
        self.figure.show_worn({site: place.mark for site, place in places.items() if place.mark is not None})
        self._next = next((site for site, place in places.items() if place.is_next), None)
        self.figure.emphasise(self._hovered or self._next)
        for site, place in places.items():
            self.tiles[site].show_place(place)

    def set_names(self, names: tuple[str, ...]) -> None:
        """Make room on the tiles for these sensors and all that may be stated of them, so that no tile grows later."""
        if names != self._names:
            self._names = names
            self._arrange()

    def set_narrow(self, is_narrow: bool) -> None:
        """Show the legs alone, between smaller tiles."""
        self._is_narrow = is_narrow
        self.figure.set_legs_only(is_narrow)
        self._arrange()

    def set_from_behind(self, is_from_behind: bool) -> None:
        """Turn the figure's back to you; its tiles turn with it."""
        self.figure.set_from_behind(is_from_behind)
        self._arrange()

    @property
    def shown_tiles(self) -> "dict[Site, _Tile]":
        """The tiles that are in sight, left leg first."""
        return {site: tile for site, tile in self.tiles.items() if site is not Site.PELVIS or self._has_pelvis}

    def site_at(self, point: QPoint) -> Site | None:
        """The site whose tile or segment lies under `point`."""
        for site, tile in self.shown_tiles.items():
            if tile.geometry().contains(point):
                return site
        return self.figure.site_at(QPointF(self.figure.mapFrom(self, point)))

    @property
    def least_width(self) -> int:
        return 2 * self._beside_legs() + px(LEGS_AT_LEAST)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._arrange()

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        if event.mimeData().hasFormat(DRAGGED):
            event.acceptProposedAction()

    def dragMoveEvent(self, event: QDragMoveEvent) -> None:
        site = self.site_at(event.position().toPoint())
        self._hover(sensor_in(event.mimeData()), site)
        if site is None:
            event.ignore()
        else:
            event.acceptProposedAction()

    def dragLeaveEvent(self, _event: QDragLeaveEvent) -> None:
        self._hover("", None)

    def dropEvent(self, event: QDropEvent) -> None:
        site, sensor = self.site_at(event.position().toPoint()), sensor_in(event.mimeData())
        self._hover("", None)
        if site is not None and sensor:
            event.acceptProposedAction()
            self.dropped.emit(sensor, site)

    def _hover(self, sensor: str, site: Site | None) -> None:
        if site == self._hovered:
            return
        self._hovered = site
        self.figure.emphasise(site or self._next)
        for one, tile in self.tiles.items():
            tile.set_welcome(one is site)
        self.hovered.emit(sensor, site)

    @property
    def has_notes_below(self) -> bool:
        """Whether the names are so long that what is stated about a sensor goes under its name."""
        metrics = QFontMetrics(current_theme().font(12, SEMIBOLD, is_code=True))
        room = px(TILE[0] - 2 * PADDING - 2)
        return any(metrics.horizontalAdvance(" · ".join((name, _notes()[0]))) > room for name in self._names)

    def _tile_width(self) -> int:
        theme = current_theme()
        least = theme.px(NARROW_TILE if self._is_narrow else TILE[0])
        metrics = QFontMetrics(theme.font(12, SEMIBOLD, is_code=True))
        lines = [tr("no sensor"), tr("shake it now"), tr("detected later"), *self._names]
        if not self.has_notes_below:
            lines += [" · ".join((name, note)) for name in self._names for note in _notes()]
        widest = max(metrics.horizontalAdvance(line) for line in lines) + theme.px(2 * PADDING + 2)
        return max(least, widest, *(tile.first_line_width for tile in self.shown_tiles.values()))

    def _tile_height(self) -> int:
        return px(TILE[1] + (LINE if self.has_notes_below else 0))

    def _edge(self) -> int:
        return px(NARROW_EDGE if self._is_narrow else EDGE)

    def _beside_legs(self) -> int:
        return self._edge() + self._tile_width() + px(BESIDE_LEGS)

    def _arrange(self) -> None:
        """Put the figure in the middle and each tile beside its place, none over another."""
        px = current_theme().px
        self.figure.keep_beside(self._beside_legs())
        self.figure.setGeometry(self.rect().adjusted(1, 1, -1, -1))
        width, height = self._tile_width(), self._tile_height()
        lowest = self.height() - px(SENTENCE_ROOM) + px(4)
        for side in Side:
            is_right = (side is Side.LEFT) != self.figure.is_from_behind
            x = self.width() - self._edge() - width if is_right else self._edge()
            bottom = lowest
            for segment in reversed(LEG_SEGMENTS):
                site = Site(f"{side}_{segment}")
                required = round(self.figure.anchor(site).y()) - (0 if segment is Segment.FOOT else height // 2)
                top = min(required, bottom - height)
                self.tiles[site].setGeometry(x, top, width, height)
                bottom = top - px(GAP)
            if not is_right:  # it has no side; reading begins here
                required = round(self.figure.anchor(Site.PELVIS).y()) - height // 2
                self.tiles[Site.PELVIS].setGeometry(x, min(required, bottom - height), width, height)
        self._lines.setGeometry(self.rect())
        self._lines.update()
        self.updateGeometry()

    def _on_tile_clicked(self) -> None:
        tile = self.sender()
        assert isinstance(tile, _Tile)
        self.pressed.emit(tile.site)


class _Lines(Painted):
    """From each tile to its place on the figure; lies over both and takes no clicks."""

    def __init__(self, places: SensorPlaces) -> None:
        super().__init__(places)
        self._places = places
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        painter.setPen(theme.pen(theme.colours.control, 1))
        figure = self._places.figure
        for site, tile in self._places.shown_tiles.items():
            to = figure.anchor(site) + QPointF(figure.pos())
            is_right = tile.x() > to.x()
            sign = 1 if is_right else -1
            start = QPointF(tile.x() if is_right else tile.geometry().right() + 1, tile.geometry().center().y())
            end = to + QPointF(sign * theme.px(12), 0)
            elbow = start - QPointF(sign * theme.px(ELBOW), 0)
            if (elbow.x() - end.x()) * sign < 0:  # the place lies further out than the elbow
                elbow.setX(end.x())
            painter.drawPolyline([start, elbow, end])


class _Tile(DraggedButton):
    """The place in two lines: which it is, and who is there. A sensor can be dragged away from it."""

    def __init__(self, site: Site, places: SensorPlaces) -> None:
        super().__init__(places)
        self.site, self._places = site, places
        self._place = PlaceShown()
        self._is_welcome = False
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.show_place(PlaceShown())

    def show_place(self, place: PlaceShown) -> None:
        if place == self._place and self.accessibleName():
            return
        self._place, self.dragged = place, place.sensor
        words = [name_of(self.site), place.sensor or tr("no sensor"), place.note]
        name = ", ".join(filter(None, words))
        if name != self.accessibleName():
            self.setAccessibleName(name)
        self.update()

    def set_welcome(self, is_welcome: bool) -> None:
        """Show that what is dragged would land here."""
        if is_welcome != self._is_welcome:
            self._is_welcome = is_welcome
            self.update()

    @property
    def lines(self) -> list[str]:
        """Who is there and how that one is, in one line or two."""
        stated = [part for part in (self._place.sensor, self._place.note) if part] or [tr("no sensor")]
        return stated if self._places.has_notes_below else [" · ".join(stated)]

    @property
    def first_line_width(self) -> int:
        theme = current_theme()
        word = QFontMetrics(theme.font(14, SEMIBOLD)).horizontalAdvance(segment_name(self.site.segment))
        return word + theme.px(self._chip_room + 18 + 2 * PADDING)  # chip before it, the key's figure behind it

    @property
    def _chip_room(self) -> int:
        return CHIP + 6 if self.site.side is not None else 0

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        c, px = theme.colours, theme.px
        place = self._place
        is_caution = place.mark in (SensorMark.LOOK, SensorMark.SILENT)
        fill, ink, edge = (c.caution, c.caution_ink, c.caution_edge) if is_caution else (c.surface, c.ink, c.control)
        if place.is_flashing:
            fill, ink, edge = c.inv, c.inv_ink, c.inv
        is_bold = self._is_welcome or place.is_next
        pen = theme.pen(c.ink if is_bold else edge, 2.5 if self._is_welcome else 1.75 if place.is_next else 1.25)
        if not place.sensor and not is_bold:
            pen.setCapStyle(Qt.PenCapStyle.FlatCap)
            pen.setDashPattern([2.0, 2.0])
        painter.setPen(pen)
        painter.setBrush(QColor(fill))
        radius = CONTROL_RADIUS * theme.scale
        box = QRectF(self.rect()).adjusted(1.25, 1.25, -1.25, -1.25)
        painter.drawRoundedRect(box, radius, radius)
        self.paint_veil(painter, box)
        chip = px(CHIP)
        where = QRectF(px(PADDING), px(16) - chip / 2 + 1, chip, chip)
        side = self.site.side
        if side is not None and place.is_flashing:  # the legs' hues do not stand out on dark; the letter does
            painter.setPen(QColor(ink))
            painter.setFont(theme.font(14, SEMIBOLD))
            painter.drawText(where, Qt.AlignmentFlag.AlignCenter, side.letter)
        elif side is not None:
            paint_chip(painter, where, side, theme)

    def painted_texts(self) -> list[PaintedText]:
        theme, place = current_theme(), self._place
        px = theme.px
        tone = second = "caution_ink"
        if place.mark not in (SensorMark.LOOK, SensorMark.SILENT):
            tone, second = "ink", "ink2"
        if place.is_flashing:
            tone = second = "inv_ink"
        number_font, line_font = theme.font(12), theme.font(12, SEMIBOLD if place.is_next else MEDIUM, is_code=True)
        left, right = px(PADDING), self.width() - px(PADDING)
        digit = px(14)
        chip = px(self._chip_room)
        name = QRectF(left + chip, px(7), right - digit - left - chip, px(18))
        return [
            PaintedText(segment_name(self.site.segment), name, theme.font(14, SEMIBOLD), tone),
            PaintedText(
                str(number_of(self.site)), QRectF(right - digit, px(7), digit, px(18)), number_font, second, RIGHT
            ),
            *(
                PaintedText(line, QRectF(left, px(26 + number * LINE), right - left, px(18)), line_font, second)
                for number, line in enumerate(self.lines)
            ),
        ]


def _notes() -> tuple[str, ...]:
    """What may be stated about a sensor that is worn, the longest first."""
    return tuple(sorted((tr("no signal"), tr("charge"), tr("data loss")), key=len, reverse=True))


def number_of(site: Site) -> int:
    """The key for this place: 1 to 6, left leg first; 7 the pelvis."""
    return list(Site).index(site) + 1
