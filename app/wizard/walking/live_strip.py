"""One kind of joint while the patient walks: the last seconds of both legs, left solid, right dashed, gaps as gaps.

Axes and frame are pyqtgraph's. What moves is a widget of our own over them that keeps its history in a picture: a wide,
smooth line of pyqtgraph's is drawn whole in every frame, for more than ten times as long, and a scene asks all of its
items in every frame where they are.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen, QShowEvent
from PySide6.QtWidgets import QWidget

from app.charts.axes import range_for
from app.plots.angle_chart import FOOT, AngleAxes
from app.theme.current import current_theme, on_theme, px
from app.widgets.text import MEDIUM
from app.wizard.walking.readout import LiveTrace
from app.wizard.walking.scrolling_picture import Scrolling, ScrollingPicture
from app.wording.translation import tr
from core.body import Side
from core.samples import FloatArray

LEAST_SIZE = (320, 40)  # what can just be read; the page gives more where it has more
CURVE_PX, THIN_PX = 2.5, 1.25
KEPT_S = 15.0  # more than any width shows
ROOM = 8192  # rows: twenty seconds at 400 Hz; a faster sensor's take more
DEG_PER_RAD = 180 / np.pi
BREAK_S = 0.1  # without a sample for longer, the line ends; a radio's bursts lie closer
MISSING_S = 0.5  # without a sample for longer, it is shown in words
FIRST_ANGLE_S = 5.0  # the filters may look for the vertical for so long before they give a first angle
LEAST_BETWEEN_TICKS = 18  # figures of 12 px


@dataclass(frozen=True, slots=True)
class MissingSpan:
    """A stretch without angles of one leg; `end_s` None: it still lasts."""

    side: Side
    start_s: float
    end_s: float | None


class LiveStrip(AngleAxes):
    """Axes that stay `fixed_deg`, widened by tens where a walk leaves them, and kept so until the next one.

    `tick_deg` is what two figures of the axis lie apart.
    """

    def __init__(self, fixed_deg: tuple[float, float], tick_deg: float) -> None:
        super().__init__(pg.AxisItem("bottom"), has_mouse=False)
        self._tick_deg = tick_deg
        self._beneath.setStyle(showValues=False)
        self._beneath.setTicks([])  # only its line
        self._history = _History(fixed_deg, self.viewport())
        self.view_box.sigResized.connect(self._on_view_resized)
        self._set_range()
        on_theme(self._apply_theme)

    @property
    def range_deg(self) -> tuple[float, float]:
        return self._history.range_deg

    @property
    def missing(self) -> tuple[MissingSpan, ...]:
        """Where a leg that is shown has had no angle for longer than a moment."""
        return self._history.missing

    def minimumSizeHint(self) -> QSize:
        return QSize(*map(px, LEAST_SIZE))

    def set_seconds(self, seconds: float) -> None:
        """Set how much time is in sight."""
        self._history.set_seconds(seconds)

    def show_traces(self, now_s: float, traces: Mapping[Side, LiveTrace]) -> None:
        """Draw up to `now_s`: of each trace what is newer than what is there. A side that is left out shows nothing."""
        before = self.range_deg
        self._history.take(now_s, traces)
        if self.range_deg != before:
            self._set_range()

    def clear(self) -> None:
        """Begin with an empty strip and the axis as it is for everybody."""
        self._history.clear()
        self._set_range()

    def _on_view_resized(self) -> None:
        self._history.setGeometry(
            self.view_box.mapRectToScene(self.view_box.rect()).toRect()
        )  # a scene's units are our pixels
        self._set_range()

    def _set_range(self) -> None:
        lowest, highest = self.range_deg
        self.view_box.setYRange(lowest, highest, padding=0)
        room = self.view_box.height() / px(LEAST_BETWEEN_TICKS)
        step = self._tick_deg
        while step < highest - lowest and (highest - lowest) / step > room:
            step *= 2
        self._angle_axis.setTickSpacing(levels=[(step, 0)])

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._history.update()

    def _apply_theme(self) -> None:
        super()._apply_theme()
        self._beneath.setHeight(px(FOOT))
        self._set_range()
        self.updateGeometry()


class _Trace:
    """What one leg has shown: rows (n,) with a NaN row where the line breaks, and the gaps that count as missing.

    `length_px` is how long the line is up to each row: it gives where in its pattern a dash begins, so that dashes
    stand still in time. New rows are written behind the last; when there is no room left, those kept move to the front.
    """

    def __init__(self) -> None:
        self._rows = np.zeros((4, ROOM))
        self._count = 0
        self.last_s = -np.inf  # of all rows
        self.received_s = -np.inf  # of the rows with an angle
        self.gaps: tuple[tuple[float, float], ...] = ()
        self._name_columns()

    def append(self, trace: LiveTrace) -> int:
        """Take what is newer than the last row, and give how many rows that makes."""
        first = int(trace.time_s.searchsorted(self.last_s, side="right"))
        if first == len(trace.time_s):
            return 0
        time_s, angle_deg = trace.time_s[first:], trace.angle_rad[first:] * DEG_PER_RAD
        self._note_gaps(time_s[np.isfinite(angle_deg)])
        since_s = time_s.copy()
        since_s[1:] -= time_s[:-1]
        since_s[0] -= self.last_s if self._count else time_s[0]
        breaks = np.flatnonzero(since_s > BREAK_S)
        if len(breaks):
            time_s = np.insert(time_s, breaks, time_s[breaks] - BREAK_S / 2)
            angle_deg = np.insert(angle_deg, breaks, np.nan)
        self.last_s = float(time_s[-1])
        count = len(time_s)
        self._make_room(count)
        new = self._rows[:, self._count : self._count + count]
        new[0], new[1], new[2], new[3] = time_s, angle_deg, trace.is_provisional, 0.0
        self._count += count
        self._name_columns()
        return count

    def _make_room(self, count: int) -> None:
        if self._count + count <= self._rows.shape[1]:
            return
        kept = self._rows[:, int(self.time_s.searchsorted(self.last_s - KEPT_S)) : self._count].copy()
        self._count = kept.shape[1]
        if self._count + count > self._rows.shape[1] // 2:
            self._rows = np.zeros((4, 2 * (self._count + count)))
        self._rows[:, : self._count] = kept

    def _name_columns(self) -> None:
        self.time_s, self.angle_deg, self.is_thin, self.length_px = self._rows[:, : self._count]

    def measure(self, first: int, px_per_s: float, px_per_deg: float) -> None:
        """Measure the line from row `first` on; the rows before keep what they have. A leg may have no row yet."""
        if not self._count:
            return
        begin = max(first - 1, 0)
        time_s, angle_deg = self.time_s[begin:], self.angle_deg[begin:]
        steps = np.hypot((time_s[1:] - time_s[:-1]) * px_per_s, (angle_deg[1:] - angle_deg[:-1]) * px_per_deg)
        steps[np.isnan(steps)] = 0.0
        self.length_px[begin + 1 :] = self.length_px[begin] + steps.cumsum()

    def _note_gaps(self, known_s: FloatArray) -> None:
        """Note where, before or among these new instants with an angle, there was none for long."""
        if not len(known_s):
            return
        if self.received_s > -np.inf and known_s[0] - self.received_s > MISSING_S:
            self.gaps += ((self.received_s, float(known_s[0])),)
        for row in np.flatnonzero(known_s[1:] - known_s[:-1] > MISSING_S).tolist():
            self.gaps += ((float(known_s[row]), float(known_s[row + 1])),)
        self.received_s = float(known_s[-1])
        if self.gaps:
            self.gaps = tuple(gap for gap in self.gaps if gap[1] > self.received_s - KEPT_S)

    def lines_from(self, time_s: float) -> list[tuple[slice, bool]]:
        """Give the pieces of the line from the row before `time_s` on, and whether each is thin."""
        begin = max(int(self.time_s.searchsorted(time_s)) - 1, 0)
        known, thin = np.isfinite(self.angle_deg[begin:]), self.is_thin[begin:]
        borders = 1 + np.flatnonzero((known[1:] != known[:-1]) | (thin[1:] != thin[:-1]))
        pieces = []
        for start, end in pairwise([0, *borders.tolist(), len(known)]):
            if end > start and known[start]:
                joins = end < len(known) and known[end]  # where it grows thick, the pieces meet on one row
                pieces.append((slice(begin + start, begin + end + joins), bool(thin[start])))
        return pieces


class _History(Scrolling):
    """The moving part, over the view of the axes. Nothing is drawn while it is out of sight."""

    def __init__(self, fixed_deg: tuple[float, float], parent: QWidget) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._fixed = self.range_deg = fixed_deg
        self._pens: dict[tuple[Side, bool, float], QPen] = {}
        self._began_s = np.nan
        self._traces: dict[Side, _Trace] = {}
        self._dirty_s = np.inf  # what is later must be drawn again
        self._drawn: tuple[MissingSpan, ...] = ()
        self.missing: tuple[MissingSpan, ...] = ()

    def redraw(self) -> None:
        """Draw everything again from the history, the next time it is in sight."""
        self._pens = {}
        super().redraw()

    def clear(self) -> None:
        self._traces, self._began_s, self.missing = {}, np.nan, ()
        self.range_deg = self._fixed
        self.redraw()

    def take(self, now_s: float, traces: Mapping[Side, LiveTrace]) -> None:
        if now_s < self._now_s or self._traces.keys() - traces.keys():
            self.clear()
        self._now_s = now_s
        if np.isnan(self._began_s):
            self._began_s = now_s
        for side, live in traces.items():
            if side not in self._traces:
                self._traces[side] = _Trace()
            trace = self._traces[side]
            count = trace.append(live)
            if count:
                first = len(trace.time_s) - count
                self._dirty_s = min(self._dirty_s, float(trace.time_s[max(first - 1, 0)]))
                self._widen(trace.angle_deg[first:])
                if self._picture is not None:
                    trace.measure(first, *self._scales(self._picture))
        self.missing = tuple(self._missing())
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        ratio = self.devicePixelRatioF()
        picture = self._up_to_date(ratio)
        painter = QPainter(self)
        picture.paint(painter, QRectF(self.rect()), ratio)
        if self.missing:
            self._paint_words(painter, picture, ratio)
        painter.end()

    def _up_to_date(self, ratio: float) -> ScrollingPicture:
        """Bring the picture to the present: what is new, what changed since, or all of it."""
        columns, rows = (max(1, round(length * ratio)) for length in (self.width(), self.height()))
        before, picture = self._picture, self._picture_of(columns, rows)
        if picture is not before:
            for trace in self._traces.values():
                trace.measure(0, *self._scales(picture))
        from_x = picture.advance(self._now_s)
        dirty_s = self._dirty_s
        if self.missing != self._drawn:
            changed = set(self.missing).symmetric_difference(self._drawn)
            dirty_s = min(dirty_s, *(span.start_s for span in changed))
        reach = CURVE_PX * current_theme().scale * ratio  # a line is half as wide to either side
        if from_x > 0 and dirty_s < np.inf:
            from_x = int(min(max(np.floor(picture.x_of(dirty_s) - reach), 0), from_x))
        if from_x < columns:
            painter = QPainter(picture.pixmap)
            painter.setClipRect(QRectF(from_x, 0, columns - from_x, rows))
            self._draw(painter, picture, from_x - 2 * reach, ratio)
            painter.end()
        self._drawn, self._dirty_s = self.missing, np.inf
        return picture

    def _draw(self, painter: QPainter, picture: ScrollingPicture, from_x: float, ratio: float) -> None:
        """Draw all that lies right of `from_x`, as far as the painter's clip lets through."""
        theme = current_theme()
        painter.fillRect(0, 0, picture.columns, picture.rows, QColor(theme.colours.surface))
        for span in self.missing:
            left, right = self._ends(span, picture)
            painter.fillRect(QRectF(left, 0, right - left, picture.rows), QColor(theme.colours.caution))
        lowest, highest = self.range_deg
        per_deg = picture.rows / (highest - lowest)
        hairline = max(1, round(ratio))
        painter.fillRect(0, round(highest * per_deg), picture.columns, hairline, QColor(theme.colours.line))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for side, trace in self._traces.items():
            for rows, is_thin in trace.lines_from(picture.time_at(from_x)):
                x, y = picture.xs_of(trace.time_s[rows]), (highest - trace.angle_deg[rows]) * per_deg
                painter.setPen(self._pen(side, is_thin, ratio, float(trace.length_px[rows.start])))
                painter.drawPolyline(pg.functions.arrayToQPolygonF(x, y))

    def _paint_words(self, painter: QPainter, picture: ScrollingPicture, ratio: float) -> None:
        """Say in each box who is missing, as far as the words have room; while it lasts they take it."""
        theme = current_theme()
        painter.setFont(theme.font(12, MEDIUM))
        metrics = painter.fontMetrics()
        taken: list[tuple[float, float]] = []
        for span in self.missing:
            left, right = (end / ratio for end in self._ends(span, picture))
            stated = tr("{side} missing").format(side=span.side.letter)
            required = metrics.horizontalAdvance(stated) + px(16)
            left = max(left, 0.0)
            if right - left < required:
                if span.end_s is not None:
                    continue
                left = right - required
            row = sum(begin < right and left < end for begin, end in taken)
            taken.append((left, right))
            plate = QRectF(left, row * px(20), required, px(24))
            painter.fillRect(plate, QColor(theme.colours.caution))
            painter.setPen(QColor(theme.colours.caution_ink))
            painter.drawText(plate, Qt.AlignmentFlag.AlignCenter, stated)

    def _ends(self, span: MissingSpan, picture: ScrollingPicture) -> tuple[float, float]:
        left = picture.x_of(span.start_s)
        return left, picture.columns if span.end_s is None else picture.x_of(span.end_s)

    def _missing(self) -> Iterator[MissingSpan]:
        for side, trace in self._traces.items():
            for start_s, end_s in trace.gaps:
                if end_s > self._now_s - self._seconds:
                    yield MissingSpan(side, start_s, end_s)
            if np.isfinite(trace.received_s) and self._now_s - trace.received_s > MISSING_S:
                yield MissingSpan(side, trace.received_s, None)
            elif np.isinf(trace.received_s) and self._now_s - self._began_s > FIRST_ANGLE_S:
                yield MissingSpan(side, self._began_s, None)

    def _widen(self, angle_deg: FloatArray) -> None:
        lowest, highest = self.range_deg
        if ((angle_deg < lowest) | (angle_deg > highest)).any():
            self.range_deg = range_for(self.range_deg, [angle_deg])
            self.redraw()

    def _pen(self, side: Side, is_thin: bool, ratio: float, length_px: float) -> QPen:
        """Give the pen of a line of which `length_px` are drawn already."""
        key = (side, is_thin, ratio)
        if key not in self._pens:
            self._pens[key] = current_theme().side_pen(side, (THIN_PX if is_thin else CURVE_PX) * ratio)
        pen = QPen(self._pens[key])
        if pen.style() is Qt.PenStyle.CustomDashLine:
            pen.setDashOffset(length_px / pen.widthF())
        return pen

    def _scales(self, picture: ScrollingPicture) -> tuple[float, float]:
        lowest, highest = self.range_deg
        return picture.px_per_s, picture.rows / (highest - lowest)
