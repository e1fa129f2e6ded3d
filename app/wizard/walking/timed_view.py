"""A timed test as it goes on, to be read from three metres: the time, the distance, and how far the course is done."""

import math
from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QAccessible, QBrush, QColor, QFontMetrics, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QVBoxLayout, QWidget

from app.theme.current import current_theme, px, scaled
from app.theme.ground import Ground, set_ground
from app.theme.icons import Icon
from app.widgets.card import Card
from app.widgets.digits import Digits
from app.widgets.focus_ring import NO_RING
from app.widgets.icons import IconMark
from app.widgets.lay_out import lay_out
from app.widgets.painted import Painted
from app.widgets.painted_text import CENTRE, LEFT, RIGHT, PaintedText
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording.body import name_of
from app.wording.numbers import clock
from app.wording.timed_tests import end_words, name_of_test, reason_words, start_words
from app.wording.translation import capitalised, figure_text, joined, short_figure, tr, tr_n
from core.body import Side
from core.timed.live import LiveReadout
from core.timed.protocols import DEFINITIONS, TimedProtocol, course_of

TIME, DISTANCE = 240, 160
NO_FIGURE = "\N{EN DASH}"
RUN_IN_M, RUN_OUT_M = 2.0, 2.0
SHOWN_STEPS = 24
BEFORE_STATUS, BEHIND_STATUS = 42, 18  # its dot, and the room round it
LONG_S = 100.0  # more digits with a tenth than there is room for


@dataclass(frozen=True, slots=True)
class TimedViewState:
    """What is shown of a test. `now_s` and `end_s` are on the clock of `readout`, which may lag behind."""

    readout: LiveReadout
    note: str
    now_s: float
    end_s: float

    @property
    def protocol(self) -> TimedProtocol:
        return self.readout.planned.protocol

    @property
    def elapsed_s(self) -> float:
        """What the clock shows; 0 before the start."""
        if not self.readout.has_begun:
            return 0.0
        return max(0.0, (self.end_s if math.isfinite(self.end_s) else self.now_s) - self.readout.start_s)


def time_text(elapsed_s: float) -> str:
    """Seconds with a tenth below `LONG_S`, from then on minutes and seconds."""
    if elapsed_s < LONG_S:
        return figure_text(math.floor(10.0 * elapsed_s + 1e-6) / 10.0, ".1f")
    return clock(elapsed_s)


def status_words(state: TimedViewState) -> str:
    """What the test is doing, in a word."""
    if math.isfinite(state.end_s):
        return tr("Finished")
    if state.readout.has_begun:
        return tr("Clock runs")
    if DEFINITIONS[state.protocol].is_from_chair:
        return tr("Sit still")
    return tr("Ready to walk") if state.readout.is_still else tr("Stand still")


def distance_words(state: TimedViewState) -> tuple[str, str]:
    """The distance and, where it is not known, why."""
    found = state.readout
    if not found.has_begun:
        return figure_text(0.0, ".1f"), ""
    if found.silent:
        return NO_FIGURE, tr("no signal: {sites}").format(sites=joined([name_of(one) for one in found.silent]))
    if not math.isfinite(found.distance_m):
        reasons = [reason_words(one) for one in found.reasons]
        return NO_FIGURE, capitalised(joined(reasons)) if reasons else ""
    metres = found.distance_m
    return (figure_text(metres, ".1f") if metres < 99.95 else f"{metres:.0f}"), ""


class TimedView(QWidget):
    """Everything of one test; nothing in it is pressed: Space and the bar do that."""

    accessible_role = QAccessible.Role.Grouping

    def __init__(self) -> None:
        super().__init__()
        self._stated_s = -1
        self._title = Text(size=24, weight=SEMIBOLD)
        self._note = Text(size=16, tone="ink2")
        self.status = _Status()
        self.time = Digits(TIME, "88.8", "s")
        self.distance = Digits(DISTANCE, "88.8", "m")
        self.why = Text(size=16, weight=MEDIUM, wraps=True)
        self.course = _Course()
        self._tiles = [_ByItself(Icon.CHECK), _ByItself(Icon.STOP), _ByItself(Icon.SOUND)]
        self._build()
        self.set_compact(is_compact=False)

    def show_state(self, state: TimedViewState) -> None:
        protocol, has_distance = state.protocol, state.protocol is not TimedProtocol.SIT_TO_STAND
        self._title.setText(name_of_test(protocol))
        self._note.setText(state.note)
        self.status.show_words(status_words(state), is_on=state.readout.has_begun and not math.isfinite(state.end_s))
        elapsed_s = state.elapsed_s
        is_long = elapsed_s >= LONG_S
        self.time.show_text(time_text(elapsed_s), "" if is_long else "s", "8:88" if is_long else "88.8")
        self._distance_card.setVisible(has_distance)
        metres, why = distance_words(state)
        self.distance.show_text(metres, "" if metres == NO_FIGURE else "m")
        self.why.setText(why)
        self.why.setVisible(bool(why))
        self.course.show_state(state)
        words = (
            (tr("Automatic start"), start_words(protocol)),
            (tr("Automatic end"), end_words(state.readout.planned)),
            (tr("Tones mark start and end"), tr("rising, then falling")),
        )
        for tile, (first, then) in zip(self._tiles, words, strict=True):
            tile.show_words(first, then)
        self._say(state, metres, why)

    def _say(self, state: TimedViewState, metres: str, why: str) -> None:
        """Notify screen readers, once a second and with the last figure."""
        elapsed_s = state.elapsed_s
        whole = time_text(elapsed_s) if math.isfinite(state.end_s) else str(int(elapsed_s))
        if not math.isfinite(state.end_s) or elapsed_s < LONG_S:
            whole = f"{whole} s"
        distance = "" if state.protocol is TimedProtocol.SIT_TO_STAND or metres == NO_FIGURE else f"{metres} m."
        stated = " ".join(filter(None, [f"{status_words(state)}.", f"{whole}.", distance, why]))
        if int(elapsed_s) != self._stated_s or math.isfinite(state.end_s):
            self._stated_s = int(elapsed_s)
            if stated != self.accessibleDescription():
                self.setAccessibleDescription(stated)

    def set_compact(self, is_compact: bool) -> None:
        for layout in self._spaced:
            scaled(layout.setSpacing, 8 if is_compact else 16)
        for tile in self._tiles:
            tile.setVisible(not is_compact)

    def _build(self) -> None:
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setProperty(NO_RING, True)
        self.setAccessibleName(tr("Timed test"))
        named = ((one, 0, Qt.AlignmentFlag.AlignBottom) for one in (self._title, self._note))
        head = lay_out(QHBoxLayout(), *named, 1, self.status)
        time, self._distance_card, course = Card(), Card(), Card()
        distance = self._distance_card
        for card, title, figure in ((time, tr("Time"), self.time), (distance, tr("Distance"), self.distance)):
            lay_out(card.column, Text(title, size=20, weight=MEDIUM, tone="ink2"), (figure, 1))
        distance.column.addWidget(self.why)
        course.column.addWidget(self.course)
        figures = lay_out(QHBoxLayout(), (time, 604), (distance, 396))
        row = lay_out(QHBoxLayout(), *((tile, 1) for tile in self._tiles))
        column = lay_out(QVBoxLayout(self), head, (figures, 1), course, row, margins=0)
        self._spaced = (figures, row, column)


class _Status(Painted):
    """A word on an inverse ground, with a dot that is full while the clock runs."""

    def __init__(self) -> None:
        super().__init__()
        self._words, self._is_on = "", False
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        set_ground(self, Ground("inv", "inv"))

    def show_words(self, words: str, *, is_on: bool) -> None:
        if (words, is_on) != (self._words, self._is_on):
            self._words, self._is_on = words, is_on
            self.setAccessibleName(words)
            self.updateGeometry()
            self.update()

    def minimumSizeHint(self) -> QSize:
        theme = current_theme()
        words = QFontMetrics(theme.font(18, SEMIBOLD)).horizontalAdvance(self._words)
        return QSize(max(theme.px(176), words + theme.px(BEFORE_STATUS + BEHIND_STATUS)), theme.px(48))

    def draw(self, painter: QPainter) -> None:
        c = current_theme().colours
        dot = QRectF(px(20), 0.5 * (self.height() - px(12)), px(12), px(12))
        painter.setPen(QPen(QColor(c.inv_ink), 2))
        painter.setBrush(QColor(c.inv_ink) if self._is_on else Qt.BrushStyle.NoBrush)
        painter.drawEllipse(dot)

    def painted_texts(self) -> list[PaintedText]:
        box = QRectF(px(BEFORE_STATUS), 0, self.width() - px(BEFORE_STATUS + BEHIND_STATUS), self.height())
        return [PaintedText(self._words, box, current_theme().font(18, SEMIBOLD), "inv_ink")]


class _ByItself(Card):
    """What happens by itself, in two lines."""

    def __init__(self, icon: Icon) -> None:
        super().__init__()
        self._first, self._then = Text(weight=SEMIBOLD, wraps=True), Text(size=13, tone="ink2", wraps=True)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        words = lay_out(QVBoxLayout(), self._first, self._then, spacing=0)
        self.column.addLayout(lay_out(QHBoxLayout(), IconMark(icon, size=20), (words, 1)))

    def show_words(self, first: str, then: str) -> None:
        self._first.setText(first)
        self._then.setText(capitalised(then))


class _Course(Painted):
    """How much of a test is done, as a bar; under it the steps, on the side of the foot that made them."""

    def __init__(self) -> None:
        super().__init__()
        self._state: TimedViewState | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        scaled(self.setMinimumSize, 200, 120)

    def show_state(self, state: TimedViewState) -> None:
        self._state = state
        self.update()

    def _boxes(self, state: TimedViewState) -> tuple[QRectF, QRectF]:
        """All of the course, and what of it is timed."""
        whole = QRectF(px(4), px(36), self.width() - px(8), px(48))
        if DEFINITIONS[state.protocol].tape_m is None:
            return whole, whole
        per_m = whole.width() / (RUN_IN_M + (_length_m(state) or 1.0) + RUN_OUT_M)
        return whole, whole.adjusted(per_m * RUN_IN_M, 0, -per_m * RUN_OUT_M, 0)

    def draw(self, painter: QPainter) -> None:
        if self._state is None:
            return
        c, px, state = current_theme().colours, current_theme().px, self._state
        whole, inner = self._boxes(state)
        is_taped = inner != whole
        if is_taped:
            for box in (
                QRectF(whole.left(), whole.top(), inner.left() - whole.left(), whole.height()),
                QRectF(inner.right(), whole.top(), whole.right() - inner.right(), whole.height()),
            ):
                painter.fillRect(box, QColor(c.sunken))
                painter.fillRect(box, QBrush(QColor(c.line), Qt.BrushStyle.BDiagPattern))
        painter.fillRect(inner, QColor(c.track))
        done = QRectF(inner)
        done.setWidth(inner.width() * _share(state))
        painter.fillRect(done, QColor(c.ink))
        painter.setPen(QPen(QColor(c.ink), px(3)))
        if is_taped:
            for x in (inner.left(), inner.right()):
                painter.drawLine(QPointF(x, whole.top() - px(6)), QPointF(x, whole.bottom() + px(6)))
        if 0.0 < _share(state) < 1.0:
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(c.ink))
            tip = QPointF(done.right(), done.top() - px(1))
            painter.drawPolygon(QPolygonF([tip, tip + QPointF(-px(10), -px(13)), tip + QPointF(px(10), -px(13))]))

    def painted_texts(self) -> list[PaintedText]:
        if self._state is None:
            return []
        theme, px, state = current_theme(), current_theme().px, self._state
        whole, inner = self._boxes(state)
        top = QRectF(whole.left(), 0, whole.width(), px(24))
        under = QRectF(whole.left(), whole.bottom() + px(8), whole.width(), px(28))
        found = [PaintedText(_middle_words(state), top, theme.font(16, SEMIBOLD), align=CENTRE)]
        if DEFINITIONS[state.protocol].tape_m is not None:
            found += [
                PaintedText(tr("run-in"), top, theme.font(15), "ink2", LEFT),
                PaintedText(tr("run-out"), top, theme.font(15), "ink2", RIGHT),
            ]
        steps = state.readout.steps[-SHOWN_STEPS:]
        total_m = _length_m(state)
        for number, (side, at_m) in enumerate(steps):
            share = at_m / total_m if total_m else (number + 0.5) / SHOWN_STEPS
            if share <= 1.0:
                box = QRectF(inner.left() + share * inner.width() - px(12), under.top(), px(24), under.height())
                tone = "left_text" if side is Side.LEFT else "right_text"
                found.append(PaintedText(side.letter, box, theme.font(17, SEMIBOLD), tone, CENTRE))
        return found


def _length_m(state: TimedViewState) -> float | None:
    """Between the tapes; None of a test without them."""
    return None if DEFINITIONS[state.protocol].tape_m is None else course_of(state.readout.planned)


def _share(state: TimedViewState) -> float:
    """How much of the test is done."""
    definition, found = DEFINITIONS[state.protocol], state.readout
    if math.isfinite(state.end_s):
        return 1.0
    if not found.has_begun:
        return 0.0
    if definition.duration_s is not None:
        return min(1.0, state.elapsed_s / definition.duration_s)
    if definition.rises > 1:
        return min(1.0, _rises(state) / definition.rises)
    metres = found.distance_m if math.isfinite(found.distance_m) else 0.0
    required_m = _length_m(state) or (2.0 * (course_of(found.planned) or 0.0) if definition.rises else 0.0)
    return min(0.99, metres / required_m) if required_m else 0.0


def _rises(state: TimedViewState) -> int:
    found = state.readout.found
    return 0 if found is None else len(found.rises)


def _middle_words(state: TimedViewState) -> str:
    """What the bar measures, and laps as they come."""
    definition, turns = DEFINITIONS[state.protocol], state.readout.turns
    if (length_m := _length_m(state)) is not None:
        return tr("{length} m timed").format(length=short_figure(length_m, 2))
    if definition.rises > 1:
        return tr("{count} of {required} rises").format(count=_rises(state), required=definition.rises)
    if definition.rises:
        course = short_figure(course_of(state.readout.planned) or 0.0, 2)
        return tr("{course} m, turn, {course} m back").format(course=course) if not turns else tr("turned")
    laps = tr("Lap {lap}").format(lap=turns + 1)
    if definition.duration_s is None:
        count = len(state.readout.steps)
        return tr_n("{count} step", "{count} steps", count).format(count=count)
    left_s = max(0, math.ceil(definition.duration_s - state.elapsed_s))
    return tr("{lap}, {minutes}:{seconds:02d} to go").format(lap=laps, minutes=left_s // 60, seconds=left_s % 60)
