"""The outline of a limb's segment as it is drawn from the side."""

import math

from PySide6.QtCore import QPointF
from PySide6.QtGui import QPolygonF


def limb_outline(first: QPointF, last: QPointF, wide: float, narrow: float) -> QPolygonF:
    """The outline of a segment: round at both ends, as wide as its halves."""
    way = math.atan2(last.y() - first.y(), last.x() - first.x())
    outline = []
    for centre, radius, begin in ((first, wide, way + math.pi / 2), (last, narrow, way - math.pi / 2)):
        for k in range(13):
            turn = begin + math.pi * k / 12
            outline.append(QPointF(centre.x() + radius * math.cos(turn), centre.y() + radius * math.sin(turn)))
    return QPolygonF(outline)
