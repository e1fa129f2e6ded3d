"""Figure that shows which sensor is where on the patient.

It is a drawn person who faces you, like an X-ray: right is at the left.
"""

import math
from collections.abc import Mapping
from enum import Enum, auto

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QAccessible, QColor, QFontMetrics, QPainter, QPainterPath, QPolygonF, QTransform
from PySide6.QtWidgets import QSizePolicy

from app.theme.current import current_theme, px
from app.theme.theme import Theme
from app.widgets.body_shapes import BARE_LEGS, LEGS, WHOLE, body_shapes
from app.widgets.painted import Painted
from app.widgets.text import SEMIBOLD
from app.wording.body import name_of
from app.wording.translation import tr
from core.body import LEG_JOINTS, LEG_SITES, Joint, Side, Site

MIDDLE = WHOLE.center().x()
SENSOR = (20.0, 13.0)  # at most, px: a sensor's box does not grow with the figure
SENSOR_UNITS = 32.0  # of the drawing, where the figure is small
SMALL_BELOW = 100  # px high: lines thin, no pelvis, no joints
SENTENCE_ROOM = 32
LETTER_AT = QPointF(108, 36)  # from the middle and the top, units of the drawing
LEG_LETTER_AT = QPointF(74, 214)
ABOVE_TILES = 196  # from the top, where something is beside the legs: a tile that is high begins at the pelvis
WORDS_FROM = 0.8  # px to a unit of the drawing; a smaller person has no room for words at the shoulders
SWAPPED_FREE = 22  # px from the middle of a sensor to the tip of an arrow
HEAD = 13  # px
SEGMENT_SLACK = 6  # units of the drawing: a finger hits beside the outline


class SensorMark(Enum):
    """How a place looks. Without a mark it is left bare, for it is not used."""

    WORN = auto()
    LOOK = auto()  # it sends, but something about it needs a look: battery, loss
    SILENT = auto()
    SWAPPED = auto()  # it moves like the sensor of another place
    GAP = auto()  # a sensor is still to come here


def mark_words(mark: SensorMark) -> str:
    """Say a mark as a reader of screens does."""
    return {
        SensorMark.WORN: tr("worn"),
        SensorMark.LOOK: tr("needs checking"),
        SensorMark.SILENT: tr("no signal"),
        SensorMark.SWAPPED: tr("looks swapped"),
        SensorMark.GAP: tr("no sensor yet"),
    }[mark]


def paint_legs(
    painter: QPainter,
    rect: QRectF,
    theme: Theme,
    emphasised: Site | None,
    worn: Mapping[Site, SensorMark],
    is_from_behind: bool = False,
) -> None:
    """Draw both legs with their sensors as large as `rect` allows; with pelvis and joints where it is large."""
    is_small = rect.height() < SMALL_BELOW * theme.scale
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    place = _placing(BARE_LEGS if is_small else LEGS, rect, is_from_behind)
    if not is_small:
        _paint_plain(painter, theme, place, "pelvis", is_emphasised=emphasised is Site.PELVIS)
    _paint_segments(painter, theme, place, emphasised, is_small)
    if not is_small:
        _paint_joints(painter, theme, place)
    _paint_sensors(painter, theme, place, worn)
    painter.restore()


def placing_of_legs(rect: QRectF) -> QTransform:
    """From the drawing to the screen, as `paint_legs` draws the legs into `rect` where there is room for the pelvis."""
    return _placing(LEGS, rect, is_from_behind=False)


class BodyFigure(Painted):
    """The whole person with large R and L, or the legs alone with their joints marked."""

    accessible_role = QAccessible.Role.Graphic

    def __init__(self, legs_only: bool = False) -> None:
        super().__init__()
        self._is_legs_only = legs_only
        self._is_from_behind = False
        self._beside = 0
        self._worn: dict[Site, SensorMark] = {}
        self._moves_to: dict[Site, Site] = {}
        self._emphasised: Site | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self._name()

    @property
    def is_from_behind(self) -> bool:
        return self._is_from_behind

    def show_worn(self, worn: Mapping[Site, SensorMark]) -> None:
        """Mark the places of the sensors; a site that is not in `worn` stays bare."""
        if dict(worn) != self._worn:
            self._worn = dict(worn)
            self._name()
            self.update()

    def show_moves(self, moves_to: Mapping[Site, Site]) -> None:
        """Lead an arrow from each place to the one whose sensor its own moves like."""
        if dict(moves_to) != self._moves_to:
            self._moves_to = dict(moves_to)
            self.update()

    def emphasise(self, site: Site | None) -> None:
        """Darken one segment: the one to move, or the place that is next."""
        if site != self._emphasised:
            self._emphasised = site
            self._name()
            self.update()

    def set_from_behind(self, is_from_behind: bool) -> None:
        """Turn the figure's back to you: the patient's right is then at the right."""
        self._is_from_behind = is_from_behind
        self._name()
        self._refresh()

    def set_legs_only(self, is_legs_only: bool) -> None:
        self._is_legs_only = is_legs_only
        self._refresh()

    def keep_beside(self, width: int) -> None:
        """Leave `width` px on either side of the legs for what is shown there; the figure is as much smaller."""
        self._beside = width
        self.update()

    def site_at(self, point: QPointF) -> Site | None:
        """Which segment lies under `point` of the widget; just beside its outline counts as well."""
        to_drawing, _ = self._placed().inverted()
        spot = to_drawing.map(point)
        near = QRectF(0, 0, 2 * SEGMENT_SLACK, 2 * SEGMENT_SLACK)
        near.moveCenter(spot)
        outlines = body_shapes().outlines
        hit = [site for site in Site if outlines[site].contains(spot)]  # a thigh before the pelvis behind it
        hit += [site for site in LEG_SITES if outlines[site].intersects(near)]
        return hit[0] if hit else None

    def anchor(self, site: Site) -> QPointF:
        """Where the sensor of `site` sits, in the widget."""
        return self._placed().map(body_shapes().points[f"{site}_sensor"])

    def joint_anchor(self, joint: Joint) -> QPointF:
        """Where `joint` lies, in the widget."""
        return self._placed().map(body_shapes().points[joint])

    def sizeHint(self) -> QSize:
        return QSize(px(200), px(440)) if self._is_legs_only else QSize(px(300), px(520))

    def minimumSizeHint(self) -> QSize:
        theme = current_theme()
        sentence = QFontMetrics(theme.font(14)).horizontalAdvance(self._sentence())
        if self._is_legs_only:
            return QSize(max(sentence, theme.px(170)), theme.px(180))
        return QSize(max(sentence, theme.px(250)), theme.px(300))

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        place = self._placed()
        if self._is_legs_only:
            paint_legs(painter, self._room(), theme, self._emphasised, self._worn, self._is_from_behind)
        else:
            for name in ("right_arm", "left_arm", "body", "head"):
                _paint_plain(painter, theme, place, name)
            if not self._is_from_behind:
                _paint_eyes(painter, theme, place)
            if self._emphasised is Site.PELVIS:
                _paint_plain(painter, theme, place, "pelvis", is_emphasised=True)
            _paint_segments(painter, theme, place, self._emphasised, is_small=False)
            _paint_sensors(painter, theme, place, self._worn)
        _paint_moves(painter, theme, place, self._moves_to)
        self._paint_letters(painter, place)
        painter.setPen(QColor(theme.colours.ink2))
        painter.setFont(theme.font(14))
        foot = QRectF(0, self.height() - theme.px(SENTENCE_ROOM), self.width(), theme.px(SENTENCE_ROOM))
        painter.drawText(foot, Qt.AlignmentFlag.AlignCenter, self._sentence())

    def _room(self) -> QRectF:
        room = QRectF(0, px(4), self.width(), self.height() - px(4 + SENTENCE_ROOM))
        if self._beside:
            part = LEGS if self._is_legs_only else WHOLE
            largest = max(self.width() - 2 * self._beside, 1) / BARE_LEGS.width()
            height = min(room.height(), largest * part.height())
            room.adjust(0, (room.height() - height) / 2, 0, -(room.height() - height) / 2)
        return room

    def _placed(self) -> QTransform:
        return _placing(LEGS if self._is_legs_only else WHOLE, self._room(), self._is_from_behind)

    def _sentence(self) -> str:
        return tr("Seen from behind") if self._is_from_behind else tr("The patient faces you")

    def _paint_letters(self, painter: QPainter, place: QTransform) -> None:
        """R and L beside the person they belong to, as large as the room is; inside the widget whatever its width."""
        theme = current_theme()
        at = LEG_LETTER_AT if self._is_legs_only else LETTER_AT
        if self._is_legs_only and self._beside:
            at = QPointF(at.x(), ABOVE_TILES)
        is_small = self._is_legs_only or place.m22() < WORDS_FROM * theme.scale
        letter, note = theme.font(28 if is_small else 40, SEMIBOLD), theme.font(14)
        words = {Side.LEFT: tr("patient's left"), Side.RIGHT: tr("patient's right")}
        for side in Side:
            sign = 1 if side is Side.LEFT else -1
            middle = place.map(QPointF(MIDDLE + sign * at.x(), at.y()))
            half = max(QFontMetrics(note).horizontalAdvance(words[side]) if not is_small else 0, theme.px(24))
            x = min(max(middle.x(), half / 2), self.width() - half / 2)
            painter.setPen(theme.text(side))
            painter.setFont(letter)
            box = QRectF(x - half / 2, max(middle.y() - theme.px(24), 0), half, theme.px(48))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, side.letter)
            if not is_small:
                painter.setPen(QColor(theme.colours.ink2))
                painter.setFont(note)
                painter.drawText(
                    box.translated(0, theme.px(42)).adjusted(0, 0, 0, -theme.px(24)),
                    Qt.AlignmentFlag.AlignCenter,
                    words[side],
                )

    def _name(self) -> None:
        self.setAccessibleName(self._sentence())
        places = [
            tr("{site}: {state}").format(site=name_of(site), state=mark_words(self._worn[site]))
            for site in Site
            if site in self._worn
        ]
        if self._emphasised is not None:
            places.append(tr("marked: {site}").format(site=name_of(self._emphasised)))
        self.setAccessibleDescription("; ".join(places))

    def _refresh(self) -> None:
        self.updateGeometry()
        self.update()


def _placing(part: QRectF, rect: QRectF, is_from_behind: bool) -> QTransform:
    """From the drawing to the screen: `part` as large as `rect` allows, in its middle; mirrored from behind."""
    scale = min(rect.width() / part.width(), rect.height() / part.height())
    place = QTransform()
    place.translate(rect.center().x(), rect.center().y())
    place.scale(-scale if is_from_behind else scale, scale)
    place.translate(-part.center().x(), -part.center().y())
    return place


def _paint_plain(painter: QPainter, theme: Theme, place: QTransform, name: str, *, is_emphasised: bool = False) -> None:
    painter.setPen(theme.pen(theme.colours.ink, 3.5) if is_emphasised else theme.pen(theme.colours.control, 1.5))
    painter.setBrush(QColor(theme.colours.track))
    painter.drawPath(place.map(body_shapes().outlines[name]))


def _paint_eyes(painter: QPainter, theme: Theme, place: QTransform) -> None:
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(theme.colours.ink2))
    for side in Side:
        painter.drawEllipse(place.map(body_shapes().points[f"{side}_eye"]), 2.2 * theme.scale, 2.2 * theme.scale)


def _paint_segments(
    painter: QPainter, theme: Theme, place: QTransform, emphasised: Site | None, is_small: bool
) -> None:
    for site in LEG_SITES:
        is_emphasised = site is emphasised
        width = (2.0 if is_emphasised else 1.25) if is_small else (3.5 if is_emphasised else 2.0)
        painter.setPen(theme.side_pen(site.leg_side, width))
        painter.setBrush(theme.soft(site.leg_side) if is_emphasised else theme.pale(site.leg_side))
        painter.drawPath(place.map(body_shapes().outlines[site]))


def _paint_joints(painter: QPainter, theme: Theme, place: QTransform) -> None:
    painter.setPen(theme.pen(theme.colours.ink, 2))
    painter.setBrush(QColor(theme.colours.surface))
    for joint in LEG_JOINTS:
        painter.drawEllipse(place.map(body_shapes().points[joint]), 5 * theme.scale, 5 * theme.scale)


def _paint_moves(painter: QPainter, theme: Theme, place: QTransform, moves_to: Mapping[Site, Site]) -> None:
    """Arrows between places; two that change places share one, with a head at either end."""
    points = body_shapes().points
    painter.setPen(theme.pen(theme.colours.ink, 2))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for site, goal in moves_to.items():
        is_exchange = moves_to.get(goal) is site
        if is_exchange and list(Site).index(goal) < list(Site).index(site):
            continue
        start, end = place.map(points[f"{site}_sensor"]), place.map(points[f"{goal}_sensor"])
        way = end - start
        length = math.hypot(way.x(), way.y())
        if length < 1.0:
            continue
        free = min(SWAPPED_FREE * theme.scale, length / 4)  # beside the sensors' boxes
        start, end = start + way * (free / length), end - way * (free / length)
        bow = QPointF(-way.y(), way.x()) * 0.16
        first, second = start + (end - start) * 0.3 + bow, start + (end - start) * 0.7 + bow
        line = QPainterPath(start)
        line.cubicTo(first, second, end)
        painter.drawPath(line)
        _paint_head(painter, theme, second, end)
        if is_exchange:
            _paint_head(painter, theme, first, start)


def _paint_head(painter: QPainter, theme: Theme, before: QPointF, tip: QPointF) -> None:
    """The head of an arrow that comes from `before` and ends at `tip`."""
    towards = math.atan2(before.y() - tip.y(), before.x() - tip.x())
    sides = [QPointF(math.cos(towards + turn), math.sin(towards + turn)) for turn in (-0.5, 0.5)]
    head = [tip + side * (HEAD * theme.scale) for side in sides]
    painter.drawPolyline(QPolygonF([head[0], tip, head[1]]))


def _paint_sensors(painter: QPainter, theme: Theme, place: QTransform, worn: Mapping[Site, SensorMark]) -> None:
    """A dark box where a sensor is worn; yellow where it wants a look, with a bar where it is silent; else a gap."""
    c = theme.colours
    width = min(SENSOR_UNITS * abs(place.m11()), SENSOR[0] * theme.scale)
    is_small = width < SENSOR[0] / 2 * theme.scale
    for site, mark in worn.items():
        box = QRectF(0, 0, width, width * SENSOR[1] / SENSOR[0])
        box.moveCenter(place.map(body_shapes().points[f"{site}_sensor"]))
        radius = width / 8
        if mark is SensorMark.WORN:
            painter.setPen(theme.pen(c.surface, 0.75 if is_small else 1))
            painter.setBrush(QColor(c.ink))
            painter.drawRoundedRect(box, radius, radius)
            continue
        grown = width / 4 if mark is SensorMark.SWAPPED and not is_small else width / 20
        box.adjust(-grown, -grown, grown, grown)
        pen = theme.pen(c.ink if mark is SensorMark.GAP else c.caution_mark_ink, 1 if is_small else 1.5)
        if mark is SensorMark.GAP:
            pen.setCapStyle(Qt.PenCapStyle.FlatCap)
            pen.setDashPattern([2.0, 1.6])
        painter.setPen(pen)
        painter.setBrush(QColor(c.caution if mark is SensorMark.GAP else c.caution_mark))
        painter.drawRoundedRect(box, radius, radius)
        if mark is SensorMark.SILENT:
            painter.drawLine(
                box.bottomLeft() + QPointF(width / 8, -width / 8), box.topRight() + QPointF(-width / 8, width / 8)
            )
