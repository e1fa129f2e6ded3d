"""What befell the clocks of a recording: its sensors on one time line, each event in words, and where to split it."""

from collections.abc import Sequence

from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import QAccessible, QColor, QPainter
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QSizePolicy, QVBoxLayout, QWidget

from app.home.importing.import_words import breakable
from app.theme.current import current_theme, px, scaled
from app.widgets.button import Button, ButtonKind
from app.widgets.lay_out import lay_out
from app.widgets.painted import Painted
from app.widgets.text import MEDIUM, Text
from app.wording.clock_events import clock_sentence
from app.wording.translation import figure_text, tr
from core.signal.clock_events import SPLITTABLE, ClockEvent, ClockEventKind, ClockView

LANE, BAR, MARK = 18, 6, 3
MOST_EVENTS = 30  # in words; the others are stated once these are split
MOST_LANES = 7  # of a leg set with the pelvis; the events of others are in words


class ClockPart(QWidget):
    """Shown only where something befell a clock. `names`: of the sensors, as they are called on this page."""

    split_requested = Signal(float)  # at this time of the view

    def __init__(self, view: ClockView, names: Sequence[str]) -> None:
        super().__init__()
        self.buttons: list[Button] = []
        rows = lay_out(QVBoxLayout(), spacing=4)
        events = view.events[:MOST_EVENTS]
        sentences = [clock_sentence(event, names) for event in events]
        for event, stated in zip(events, sentences, strict=True):
            rows.addLayout(self._row(event, stated))
        title = Text(tr("Sensor clocks"), size=12, weight=MEDIUM, tone="ink2")
        lay_out(
            QVBoxLayout(self), title, _lanes(view, names, " ".join(sentences)), rows, margins=(0, 4, 0, 4), spacing=6
        )

    def _row(self, event: ClockEvent, stated: str) -> QHBoxLayout:
        row = lay_out(QHBoxLayout(), (Text(breakable(stated), size=12, wraps=True), 1), spacing=8)
        if event.kind in SPLITTABLE:
            button = Button(tr("Split here"), ButtonKind.SECONDARY, height=36)
            button.setAccessibleDescription(stated)
            button.clicked.connect(lambda _checked=False, at_s=event.at_s: self.split_requested.emit(at_s))
            self.buttons.append(button)
            lay_out(row, (button, 0, Qt.AlignmentFlag.AlignTop))
        return row


def _lanes(view: ClockView, names: Sequence[str], stated: str) -> QGridLayout:
    """The sensors that something befell alone, or one line for all."""
    own = {number for one in view.events if one.kind is not ClockEventKind.PAUSE for number in one.sensors}
    grid = QGridLayout()
    scaled(grid.setHorizontalSpacing, 8)
    grid.setVerticalSpacing(0)
    grid.setColumnStretch(1, 1)
    shown = sorted(own)[:MOST_LANES] or [0]
    for row, number in enumerate(shown):
        name = breakable(names[number]) if own else tr("All sensors")
        events = [one for one in view.events if number in one.sensors]
        lane = _Lane(view.spans_s[number], events, view.length_s)
        lane.setAccessibleName(stated)
        grid.addWidget(Text(name, size=12, tone="ink2"), row, 0)
        grid.addWidget(lane, row, 1)
    end = tr("{length} s").format(length=figure_text(view.length_s, ".1f"))
    scale = lay_out(QHBoxLayout(), Text("0", size=12, tone="ink2"), 1, Text(end, size=12, tone="ink2"))
    grid.addLayout(scale, len(shown), 1)
    return grid


class _Lane(Painted):
    """A bar while samples came: open where they are missing, a line across it where the clock goes on elsewhere."""

    accessible_role = QAccessible.Role.Graphic

    def __init__(self, span_s: tuple[float, float], events: Sequence[ClockEvent], length_s: float) -> None:
        super().__init__()
        self._span_s, self._events, self._length_s = span_s, events, length_s
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        scaled(self.setFixedHeight, LANE)

    def draw(self, painter: QPainter) -> None:
        colours = current_theme().colours
        self._fill(painter, self._span_s, BAR, colours.ink2)
        missing = [one for one in self._events if one.kind in (ClockEventKind.LOSS, ClockEventKind.PAUSE)]
        for part_s in (part_s for one in missing for part_s in one.parts_s):
            self._fill(painter, part_s, BAR, colours.surface)
            self._fill(painter, part_s, 1, colours.ink2)
        for one in self._events:
            if one.kind is ClockEventKind.SPARSE:  # every other part of the bar
                self._thin_out(painter, one.parts_s[0], colours.surface)
            elif one.kind not in (ClockEventKind.LOSS, ClockEventKind.PAUSE):
                self._fill(painter, (one.at_s, one.at_s), LANE, colours.surface, MARK + 4)
                self._fill(painter, (one.at_s, one.at_s), LANE - 2, colours.ink, MARK)

    def _fill(self, painter: QPainter, span_s: tuple[float, float], height: float, colour: str, least: int = 1) -> None:
        first, last = (second / (self._length_s or 1.0) * (self.width() - px(MARK)) + px(MARK) / 2 for second in span_s)
        width = max(last - first, px(least))
        box = QRectF((first + last - width) / 2, (self.height() - px(height)) / 2, width, px(height))
        painter.fillRect(box, QColor(colour))

    def _thin_out(self, painter: QPainter, span_s: tuple[float, float], colour: str) -> None:
        parts = 40
        step_s = (span_s[1] - span_s[0]) / parts
        for part in range(parts):
            begin_s = span_s[0] + (part + 0.5) * step_s
            self._fill(painter, (begin_s, begin_s + step_s / 2.0), BAR, colour)
