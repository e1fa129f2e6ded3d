"""Sensors are strapped to thighs, shanks and feet, then each turns: which way it points does not matter."""

import math

from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QColor, QPainter, QPainterPath, QTransform

from app.theme.theme import Theme
from app.widgets.body_figure import paint_legs, placing_of_legs
from app.widgets.body_shapes import body_shapes
from core.body import LEG_SEGMENTS, LEG_SITES, Side, Site

SENSOR = (25.0, 16.0)  # of the drawing's units
STRAP = 9.0
AWAY = 60.0  # where a sensor comes from, beside the leg
TURNS_DEG = (70.0, -50.0, 115.0, -90.0, 40.0, -125.0)  # each sensor its own


def paint_strapping(painter: QPainter, rect: QRectF, theme: Theme, scene: int, share: float) -> None:
    """Draw the legs, with the sensors of the scenes before and those that come in this one."""
    is_turning = scene >= len(LEG_SEGMENTS)
    segment = None if is_turning else LEG_SEGMENTS[scene]
    now = next((site for site in LEG_SITES if site.segment is segment and site.leg_side is _side_at(share)), None)
    paint_legs(painter, rect, theme, now, {})
    painter.save()
    for number, site in enumerate(LEG_SITES):
        done = LEG_SEGMENTS.index(site.segment) - scene
        progress = 1.0 if done < 0 else 0.0 if done > 0 else _progress(site.leg_side, share)
        if progress > 0.0:
            turn_deg = TURNS_DEG[number] * _eased(2 * share) if is_turning else 0.0
            _paint_sensor(painter, placing_of_legs(rect), theme, site, progress, turn_deg)
    painter.restore()


def _side_at(share: float) -> Side:
    return Side.LEFT if share < 0.5 else Side.RIGHT


def _progress(side: Side, share: float) -> float:
    """The left one in the first half of the scene, the right one in the second."""
    begin = 0.0 if side is Side.LEFT else 0.5
    return min(max((share - begin) / 0.4, 0.0), 1.0)


def _paint_sensor(
    painter: QPainter, place: QTransform, theme: Theme, site: Site, progress: float, turn_deg: float
) -> None:
    """The sensor comes from outside in the first half of `progress`, its strap goes round in the second."""
    shapes, c = body_shapes(), theme.colours
    at = shapes.points[f"{site}_sensor"]
    outward = 1 if site.leg_side is Side.LEFT else -1
    length = _eased(2 * progress - 1)
    if length > 0.0:
        limb = shapes.outlines[site]
        width = limb.boundingRect().width() * length
        left = limb.boundingRect().left() if outward < 0 else limb.boundingRect().right() - width
        strap = QPainterPath()
        strap.addRect(QRectF(left, at.y() - STRAP / 2, width, STRAP))
        painter.setPen(theme.pen(c.surface, 1))
        painter.setBrush(QColor(c.ink2))
        painter.drawPath(place.map(limb.intersected(strap)))
    come = QPointF(at.x() + outward * AWAY * (1 - _eased(2 * progress)), at.y())
    box = QPainterPath()
    box.addRoundedRect(QRectF(-SENSOR[0] / 2, -SENSOR[1] / 2, *SENSOR), 3, 3)
    mark = QPainterPath()
    mark.addEllipse(QPointF(SENSOR[0] / 3, 0), 2.4, 2.4)
    turned = QTransform().translate(come.x(), come.y()).rotate(turn_deg) * place
    painter.setPen(theme.pen(c.surface, 1))
    painter.setBrush(QColor(c.ink))
    painter.drawPath(turned.map(box))
    painter.setBrush(QColor(c.surface))
    painter.drawPath(turned.map(mark))


def _eased(share: float) -> float:
    """From 0 to 1, slow at both ends."""
    held = min(max(share, 0.0), 1.0)
    return 0.5 - 0.5 * math.cos(math.pi * held)
