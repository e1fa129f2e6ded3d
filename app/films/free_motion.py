"""Somebody sits and moves the legs freely: bends the knee, circles the lower leg both ways, circles the foot.

Forward is x, left is y, up is z, metres; seen from the front and a little from above, the left leg nearer.
"""

import math
from collections.abc import Sequence

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPolygonF, QTransform

from app.theme.theme import Theme
from app.widgets.limb import limb_outline
from core.body import Side

Point = tuple[float, float, float]

BEND, CIRCLE, OTHER_WAY, FOOT, OTHER_LEG = range(5)  # the scenes
TURNS = 2.0  # in each scene
LENGTHS_M = (0.42, 0.42, 0.2)
HALF_WIDTHS_M = ((0.085, 0.06), (0.06, 0.04), (0.045, 0.03))
HIP_UP_M, HIPS_APART_M = 0.66, 0.24
HANGING_RAD, BEND_RAD = math.radians(88), math.radians(42)
CONE_RAD, FOOT_CONE_RAD = math.radians(24), math.radians(30)
SENSOR_M = (0.1, 0.065)
AZIMUTH_RAD, ELEVATION_RAD = math.radians(-52), math.radians(20)
SEEN_M = QRectF(-0.52, -1.5, 1.1, 1.6)  # all of it, on the picture's plane
POINTS_OF_TRACE = 48
ARROW_M = 0.04


def paint_seated(painter: QPainter, rect: QRectF, theme: Theme, scene: int, share: float) -> None:
    """Draw the person as a share of a scene has them, and the way that the moving end goes."""
    place = _placing(rect)
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    moved = Side.RIGHT if scene == OTHER_LEG else Side.LEFT
    _paint_seat(painter, place, theme)
    _paint_trunk(painter, place, theme)
    for side in (Side.RIGHT, Side.LEFT):  # the nearer one last
        turn = TURNS * share if side is moved else 0.0
        _paint_leg(painter, place, theme, side, leg_m(side, scene if side is moved else None, turn))
    _paint_trace(painter, place, theme, moved, scene, TURNS * share)
    painter.restore()


def leg_m(side: Side, scene: int | None, turn: float) -> tuple[Point, ...]:
    """Hip, knee, ankle and toes of one leg, metres; `scene` None: it hangs still. `turn`: of how many circles."""
    phase = 2 * math.pi * turn
    hip = (0.0, (0.5 if side is Side.LEFT else -0.5) * HIPS_APART_M, HIP_UP_M)
    knee = _going(hip, (1.0, 0.0, 0.0), LENGTHS_M[0])
    hanging = (math.cos(HANGING_RAD), 0.0, -math.sin(HANGING_RAD))
    shank, foot = hanging, (1.0, 0.0, -0.15)
    if scene in (BEND, OTHER_LEG):
        bend = HANGING_RAD + BEND_RAD * math.sin(phase)
        shank = (math.cos(bend), 0.0, -math.sin(bend))
        foot = (math.sin(bend), 0.0, math.cos(bend))  # the ankle stays as it is
    elif scene in (CIRCLE, OTHER_WAY):
        way = phase if scene == CIRCLE else -phase
        shank = (math.sin(CONE_RAD) * math.sin(way), math.sin(CONE_RAD) * math.cos(way), -math.cos(CONE_RAD))
    elif scene == FOOT:
        # both ways within the scene
        way = phase if turn < TURNS / 2 else -phase
        foot = (
            math.cos(FOOT_CONE_RAD),
            math.sin(FOOT_CONE_RAD) * math.cos(way),
            math.sin(FOOT_CONE_RAD) * math.sin(way),
        )
    ankle = _going(knee, shank, LENGTHS_M[1])
    return hip, knee, ankle, _going(ankle, foot, LENGTHS_M[2])


def _going(start: Point, way: Point, length: float) -> Point:
    size = math.sqrt(sum(part * part for part in way))
    return (
        start[0] + length * way[0] / size,
        start[1] + length * way[1] / size,
        start[2] + length * way[2] / size,
    )


def _seen(point: Point) -> QPointF:
    """On the picture's plane, metres, down positive."""
    x, y, z = point
    across = -x * math.sin(AZIMUTH_RAD) - y * math.cos(AZIMUTH_RAD)
    towards = x * math.cos(AZIMUTH_RAD) - y * math.sin(AZIMUTH_RAD)
    return QPointF(across, -z * math.cos(ELEVATION_RAD) + towards * math.sin(ELEVATION_RAD))


def _placing(rect: QRectF) -> QTransform:
    scale = min(rect.width() / SEEN_M.width(), rect.height() / SEEN_M.height())
    place = QTransform()
    place.translate(rect.center().x(), rect.center().y())
    place.scale(scale, scale)
    return place.translate(-SEEN_M.center().x(), -SEEN_M.center().y())


def _paint_seat(painter: QPainter, place: QTransform, theme: Theme) -> None:
    painter.setPen(theme.pen(theme.colours.control, 1.5))
    painter.setBrush(QColor(theme.colours.sunken))
    top = [(x, y, HIP_UP_M - 0.09) for x, y in ((-0.2, 0.3), (0.26, 0.3), (0.26, -0.3), (-0.2, -0.3))]
    for corner in top:
        painter.drawLine(place.map(_seen(corner)), place.map(_seen((corner[0], corner[1], 0.0))))
    painter.drawPolygon(place.map(QPolygonF([_seen(corner) for corner in top])))


def _paint_trunk(painter: QPainter, place: QTransform, theme: Theme) -> None:
    painter.setPen(theme.pen(theme.colours.control, 1.5))
    painter.setBrush(QColor(theme.colours.track))
    shoulders, hips = _seen((0.0, 0.0, HIP_UP_M + 0.44)), _seen((0.0, 0.0, HIP_UP_M + 0.02))
    painter.drawPolygon(place.map(limb_outline(shoulders, hips, 0.19, 0.16)))
    head = _seen((0.03, 0.0, HIP_UP_M + 0.74))
    painter.drawEllipse(place.map(head), 0.1 * place.m11(), 0.12 * place.m22())


def _paint_leg(painter: QPainter, place: QTransform, theme: Theme, side: Side, points: Sequence[Point]) -> None:
    seen = [_seen(point) for point in points]
    for k, (wide, narrow) in enumerate(HALF_WIDTHS_M):
        painter.setPen(theme.side_pen(side, 2))
        painter.setBrush(theme.pale(side))
        painter.drawPolygon(place.map(limb_outline(seen[k], seen[k + 1], wide, narrow)))
    for k in range(3):
        along = seen[k + 1] - seen[k]
        middle = seen[k] + along * 0.55
        turned = QTransform().translate(middle.x(), middle.y()).rotate(math.degrees(math.atan2(along.y(), along.x())))
        size = [min(length, 0.5 * math.hypot(along.x(), along.y()) + 0.03) for length in SENSOR_M]
        painter.setPen(theme.pen(theme.colours.surface, 1))
        painter.setBrush(QColor(theme.colours.ink))
        painter.drawPolygon((turned * place).map(QPolygonF(QRectF(-size[0] / 2, -size[1] / 2, size[0], size[1]))))


def _paint_trace(painter: QPainter, place: QTransform, theme: Theme, side: Side, scene: int, turn: float) -> None:
    """The way of the toes over one turn, dotted, and an arrow where they are heading."""
    begin, end = (-0.25, 0.25) if scene in (BEND, OTHER_LEG) else (0.0, 1.0)  # what goes to and fro is drawn once
    turns = [begin + (end - begin) * k / POINTS_OF_TRACE for k in range(POINTS_OF_TRACE + 1)]
    way = [leg_m(side, scene, one)[3] for one in turns]
    pen = theme.pen(theme.curve(side), 2)
    pen.setDashPattern([1.0, 2.4])
    painter.setPen(pen)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawPolyline(place.map(QPolygonF([_seen(point) for point in way])))
    tip, before = (place.map(_seen(leg_m(side, scene, one)[3])) for one in (turn, turn - 0.02))
    along = tip - before
    length = math.hypot(along.x(), along.y())
    if length < 0.5:
        return
    ahead = QTransform().translate(tip.x(), tip.y()).rotate(math.degrees(math.atan2(along.y(), along.x())))
    size = ARROW_M * place.m11()
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(theme.curve(side))
    arrow = QPolygonF([QPointF(2.2 * size, 0), QPointF(0.7 * size, -0.8 * size), QPointF(0.7 * size, 0.8 * size)])
    painter.drawPolygon(ahead.map(arrow))
