"""Lanes of when which foot was on the floor, while the patient walks.

Each leg has one lane under the live curves, on their time.

The phases look as in the results: loading full, foot flat pale, pre-swing hatched, swing empty on a base line. What a
foot did may be given a moment late, so the end of a lane is drawn again as far back as its phases have changed.
"""

import math
from collections.abc import Mapping

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy

from app.charts.axes import AXIS_WIDTH, RIGHT_MARGIN
from app.plots.phase_lanes import BETWEEN, GAP_PX, LANE, paint_phase
from app.theme.current import current_theme, px
from app.theme.leg_chip import CHIP, paint_chip
from app.theme.theme import CHIP_RADIUS
from app.widgets.text import MEDIUM
from app.wizard.walking.readout import LiveLane, PhaseSpan
from app.wizard.walking.scrolling_picture import Scrolling, ScrollingPicture
from app.wording.translation import tr
from core.body import Side

AXIS_HEIGHT, TICK = 24, 4
BETWEEN_COMPACT, AXIS_HEIGHT_COMPACT = 4, 20
TICK_S = 2.0
LEAST_WIDTH = 320


class LiveLanes(Scrolling):
    """Left above right over a time axis that ends now."""

    def __init__(self) -> None:
        super().__init__()
        self._between, self._axis_height = BETWEEN, AXIS_HEIGHT
        self._lanes: Mapping[Side, LiveLane] = {}
        self._drawn: Mapping[Side, tuple[PhaseSpan, ...]] = {}
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def minimumSizeHint(self) -> QSize:
        return QSize(px(LEAST_WIDTH), 2 * px(LANE) + px(self._between) + px(self._axis_height))

    def set_compact(self, is_compact: bool) -> None:
        self._between = BETWEEN_COMPACT if is_compact else BETWEEN
        self._axis_height = AXIS_HEIGHT_COMPACT if is_compact else AXIS_HEIGHT
        self.updateGeometry()
        self.redraw()

    def show_lanes(self, now_s: float, lanes: Mapping[Side, LiveLane]) -> None:
        """Draw up to `now_s`. A side that is left out has no lane, as on a leg without sensors."""
        if lanes.keys() != self._lanes.keys():
            self._picture = None
        self._now_s, self._lanes = now_s, lanes
        self.update(self._place.toAlignedRect())

    def clear(self) -> None:
        self._lanes = {}
        self.redraw()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        place, ratio = self._place, self.devicePixelRatioF()
        if not place.toAlignedRect().contains(event.rect()):
            self._paint_frame(painter)
        picture = self._up_to_date(place, ratio)
        picture.paint(painter, place, ratio)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for side, lane in self._lanes.items():
            for start_s, end_s in lane.silent_s:
                self._paint_silent(painter, side, picture.x_of(start_s) / ratio, end_s, picture, ratio)

    @property
    def _place(self) -> QRectF:
        """Of the lanes, in px of the widget."""
        width = max(self.width() - px(AXIS_WIDTH) - px(RIGHT_MARGIN), 1)
        return QRectF(px(AXIS_WIDTH), 0, width, 2 * px(LANE) + px(self._between))

    def _top(self, side: Side) -> int:
        return 0 if side is Side.LEFT else px(LANE) + px(self._between)

    def _up_to_date(self, place: QRectF, ratio: float) -> ScrollingPicture:
        columns, rows = round(place.width() * ratio), round(place.height() * ratio)
        picture = self._picture_of(columns, rows)
        from_x = picture.advance(self._now_s)
        first_s = picture.time_at(0)
        for side, lane in self._lanes.items():
            changed_s = _changed_from_s(self._drawn.get(side, ()), lane.spans, first_s)
            if from_x > 0 and changed_s < math.inf:
                from_x = int(min(max(math.floor(picture.x_of(changed_s)) - 1, 0), from_x))
        if from_x < columns:
            painter = QPainter(picture.pixmap)
            painter.setClipRect(QRectF(from_x, 0, columns - from_x, rows))
            painter.fillRect(picture.pixmap.rect(), QColor(current_theme().colours.surface))
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.scale(ratio, ratio)
            for side in self._lanes:
                self._draw_lane(painter, side, picture, from_x, ratio)
            painter.end()
        self._drawn = {side: lane.spans for side, lane in self._lanes.items()}
        return picture

    def _draw_lane(self, painter: QPainter, side: Side, picture: ScrollingPicture, from_x: int, ratio: float) -> None:
        """Draw the phases that reach beyond column `from_x`."""
        theme = current_theme()
        full, pale = theme.curve(side), theme.soft(side)
        gap = GAP_PX * theme.scale / 2
        for span in self._lanes[side].spans:
            right = picture.columns + 2.0 if span.end_s is None else picture.x_of(span.end_s)
            if right >= from_x:
                left = picture.x_of(span.start_s) / ratio
                width = max(right / ratio - left - 2 * gap, 1.0)
                box = QRectF(left + gap, self._top(side), width, theme.px(LANE))
                paint_phase(painter, span.phase, box, full, pale, theme)

    def _paint_silent(
        self, painter: QPainter, side: Side, left: float, end_s: float | None, picture: ScrollingPicture, ratio: float
    ) -> None:
        theme, place = current_theme(), self._place
        c = theme.colours
        right = (picture.columns if end_s is None else picture.x_of(end_s)) / ratio
        left = max(left, 0.0)
        stated = tr("{side} foot: no signal").format(side=side.letter)
        painter.setFont(theme.font(12, MEDIUM))
        required = painter.fontMetrics().horizontalAdvance(stated) + theme.px(16)
        if end_s is None:
            left = min(left, right - required)
        if right <= 0:
            return
        box = QRectF(place.left() + left, self._top(side), right - left, theme.px(LANE))
        painter.setPen(theme.pen(c.caution_edge, 1.25))
        painter.setBrush(QColor(c.caution))
        radius = CHIP_RADIUS * theme.scale
        painter.drawRoundedRect(box.adjusted(0.5, 0.5, -0.5, -0.5), radius, radius)
        if box.width() >= required:
            painter.setPen(QColor(c.caution_ink))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, stated)

    def _paint_frame(self, painter: QPainter) -> None:
        """Chips and time axis, which stand still."""
        theme, place = current_theme(), self._place
        c = theme.colours
        painter.fillRect(self.rect(), QColor(c.surface))
        chip = px(CHIP)
        for side in self._lanes or Side:
            paint_chip(painter, QRectF(0, self._top(side) + (px(LANE) - chip) / 2, chip, chip), side, theme)
        painter.setFont(theme.font(12))
        for ago_s in np.arange(0.0, self._seconds + 0.1, TICK_S).tolist():
            x = place.right() - place.width() * ago_s / self._seconds
            top = place.bottom() + px(4)
            painter.setPen(theme.pen(c.control, 1))
            painter.drawLine(QPointF(x, top), QPointF(x, top + px(TICK)))
            stated = tr("now") if ago_s == 0 else tr("\N{MINUS SIGN}{seconds:.0f} s").format(seconds=ago_s)
            width = painter.fontMetrics().horizontalAdvance(stated) + 2
            left = min(x - width / 2, self.width() - width)
            painter.setPen(QColor(c.ink2))
            label = QRectF(left, top + px(TICK), width, self.height() - top - px(TICK))
            painter.drawText(label, Qt.AlignmentFlag.AlignCenter, stated)


def _changed_from_s(before: tuple[PhaseSpan, ...], now: tuple[PhaseSpan, ...], first_s: float) -> float:
    """Give from where on the spans in sight, which end after `first_s`, differ; infinite where they do not."""
    if now is before:  # as in most frames
        return math.inf
    changed = set(now).symmetric_difference(before)
    return min((one.start_s for one in changed if one.end_s is None or one.end_s > first_s), default=math.inf)
