"""How does the patient walk now, and what becomes of each walk? Live curves and steps, and the next walk's label."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import (
    QApplication,
    QBoxLayout,
    QFrame,
    QHBoxLayout,
    QScrollArea,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from app.pages.label_chooser import LabelChooser
from app.pages.walk_list import WalkList, WalkRow, WalkState
from app.pages.walking_charts import Hairline, WalkingCharts, last_angles_in_words
from app.plots.live_lanes import LiveLane
from app.plots.live_strip import LiveTrace
from app.theme import Look
from app.widgets.button import Button, Kind
from app.widgets.card import Card
from app.widgets.chip import Chip
from app.widgets.focus_ring import NO_RING
from app.widgets.icons import Icon
from app.widgets.notice import Notice
from app.widgets.segmented import Segmented
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording import tr, tr_n
from core.body import Side

MARGIN, BETWEEN = 24, 12
MARGIN_COMPACT, BETWEEN_COMPACT = 8, 8
NOTICE = 64  # reserved above the charts while a walk is recorded, so that nothing jumps when something is to be said
SIDE_WIDTH, SIDE_WIDTH_WIDE = 244, 320
FIGURE, FIGURE_WIDE, FIGURE_COMPACT = 60, 72, 36
NARROW_BELOW = 660  # of the page: a question stands above its answers, a word above its figure
WIDE_FROM = 1400  # of the page
MOST_WIDTH = 1600
SECONDS, SECONDS_WIDE = 8.0, 12.0
DESCRIBED_EVERY_S = 1.0  # who listens is not told every frame
UNDER_FIGURES = 0.14  # of their size lies below the line that the unit shares
NO_FIGURE = "\N{EN DASH}"
ANY_WIDTH = 16777215  # what Qt calls no limit

_ACROSS, _DOWN = QBoxLayout.Direction.LeftToRight, QBoxLayout.Direction.TopToBottom


@dataclass(frozen=True, slots=True)
class LiveWalk:
    """What the patient does right now: the last seconds on the screen's clock up to `now_s`; a side without sensors
    is left out. `cadence_steps_min` is NaN while nobody walks.
    """

    now_s: float
    knees: Mapping[Side, LiveTrace] = field(default_factory=dict)
    ankles: Mapping[Side, LiveTrace] = field(default_factory=dict)
    lanes: Mapping[Side, LiveLane] = field(default_factory=dict)
    strides: Mapping[Side, int] = field(default_factory=dict)
    cadence_steps_min: float = math.nan


class WalkingPage(QWidget):
    """Its look follows the walks it is shown: none yet, one being recorded, or in between.

    Signals
    -------
    label_chosen
        What the next walk is called.
    keep_pressed, discard_pressed, undo_pressed
        With the walk's id; undo takes back that it was discarded.
    restrapped_pressed
        The sensors were taken off and put on again.
    """

    label_chosen = Signal(str)
    keep_pressed = Signal(str)
    discard_pressed = Signal(str)
    undo_pressed = Signal(str)
    restrapped_pressed = Signal()

    keeps_place_for_messages = True

    def __init__(self, look: Look) -> None:
        super().__init__()
        self._look = look
        self._is_compact = False
        self._rows: tuple[WalkRow, ...] = ()
        self._asked: WalkRow | None = None
        self._live = LiveWalk(0.0)
        self._described_s = -math.inf
        self.notice = Notice(look, size=16)
        self._has_message = False
        self._message: tuple[str, str] | None = None
        self.tabs = Segmented(look, tr("What is shown"), [("walks", tr("Walks"), ""), ("curves", tr("Curves"), "")])
        self.stopped = _StoppedCard(look)
        self.empty = _EmptyCard(look)
        self.charts = WalkingCharts(look)
        self.figures = _Figures(look)
        self.walks = WalkList(look)
        self.next = _NextCard(look)
        self._inside = QWidget()
        self._scroll = QScrollArea()
        self._build()
        self._connect()
        look.changed.connect(self._on_look_changed)
        self._on_look_changed()
        self._arrange()

    @property
    def is_recording(self) -> bool:
        return any(row.state is WalkState.RECORDING for row in self._rows)

    @property
    def tab_order(self) -> list[QWidget]:
        """The controls in the order of reading, those of this moment only."""
        controls: list[QWidget] = [*self.tabs.segments, self.stopped.keep, self.stopped.discard]
        controls += [*self.walks.undo_buttons, self.walks.restrapped]
        controls += [*self.next.chooser.buttons, self.next.chooser.own.line_edit]
        return [one for one in controls if one.isVisibleTo(self)]

    def focus(self) -> None:
        """Put the focus where reading starts, and on no button: Space is to start and stop the walk."""
        next((one for one in self._regions if one.isVisibleTo(self)), self.walks).setFocus()

    def show_view(self, live: LiveWalk) -> None:
        """Draw the present, up to thirty times a second."""
        self._live = live
        self.charts.show_live(live.now_s, live.knees, live.ankles, live.lanes)
        self.figures.show_figures(live.strides, live.cadence_steps_min)
        if not 0.0 <= live.now_s - self._described_s < DESCRIBED_EVERY_S:
            self._described_s = live.now_s
            said = [self.figures.in_words, last_angles_in_words(live.knees, live.ankles)]
            self.charts.setAccessibleDescription(" ".join(filter(None, said)))

    def show_walks(self, rows: tuple[WalkRow, ...], facts: str = "") -> None:
        """Show the walks of this session in the order of recording.

        Parameters
        ----------
        facts
            Of the walk that is asked about, in words: its length, its cadence.
        """
        was_recording, had_focus = self.is_recording, self._has_focus()
        self._rows = rows
        asked = [row for row in rows if row.state in (WalkState.ASKING, WalkState.RECOVERED)]
        self._asked = next((row for row in reversed(asked) if row.state is WalkState.ASKING), next(iter(asked), None))
        self.walks.show_walks(rows)
        self.stopped.show_walk(self._asked, facts)
        self._name_next()
        if self.is_recording and not was_recording:
            self.charts.clear()
        if self.is_recording != was_recording:
            self.tabs.choose("curves" if self.is_recording else "walks")
        self._arrange()
        if had_focus and not self._has_focus():
            self.focus()

    def show_labels(self, labels: tuple[str, ...], choice: str) -> None:
        """Offer what the next walk may be called, and what it will be called as things stand."""
        self.next.chooser.show_labels(labels, choice)
        self._name_next()

    def choose_digit(self, digit: int) -> bool:
        """Choose the label whose cap shows `digit`; False where it means nothing now."""
        return not self.is_recording and self.next.chooser.choose_digit(digit)

    def show_message(self, what: str, then: str = "") -> None:
        """Say what happened and what to do or what follows; nothing takes it back."""
        if (what, then) == self._message:
            return
        self._message = what, then
        self._has_message = bool(what)
        if what:
            self.notice.tell(Icon.WARNING, what, then, is_caution=True)
        else:
            self.notice.tell(
                Icon.INFO,
                tr("Ten strides of each leg make a spread"),
                tr("Starting, turning and stopping are left out by themselves."),
            )
        self._arrange()

    def set_simulated(self, is_simulated: bool) -> None:
        self.charts.set_simulated(is_simulated)

    def set_compact(self, is_compact: bool) -> None:
        if is_compact != self._is_compact:
            self._is_compact = is_compact
            self.charts.set_compact(is_compact)
            self.walks.set_compact(is_compact)
            self._on_look_changed()
            self._arrange()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def _has_focus(self) -> bool:
        focused = QApplication.focusWidget()
        return focused is not None and self.isAncestorOf(focused)

    @property
    def _regions(self) -> tuple[QWidget, ...]:
        """What may have the focus and is no button; in a small window the walks stand in the place of the charts."""
        return self.empty, self.charts, self.walks

    def _build(self) -> None:
        for region in self._regions:
            region.setFocusPolicy(Qt.FocusPolicy.TabFocus)
            region.setProperty(NO_RING, True)
        self.charts.setAccessibleName(tr("Live angles and gait phases"))
        self._left, self._right = QVBoxLayout(), QVBoxLayout()
        self._left.addWidget(self.empty, 1)
        self._left.addWidget(self.charts, 1)
        self._right.addWidget(self.figures)
        self._right.addWidget(self.walks, 1)
        self._middle = QBoxLayout(_ACROSS)
        self._middle.addLayout(self._left, 1)
        self._middle.addLayout(self._right)
        self._column = QVBoxLayout(self._inside)
        for widget in (self.notice, self.tabs, self.stopped):
            self._column.addWidget(widget)
        self._column.addLayout(self._middle, 1)
        self._column.addWidget(self.next)
        self._scroll.setWidget(self._inside)
        self._scroll.setWidgetResizable(True)
        self._scroll.setFrameShape(QFrame.Shape.NoFrame)
        self._scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._outer = QHBoxLayout(self)
        self._outer.setContentsMargins(0, 0, 0, 0)
        self._outer.addWidget(self._scroll)
        self.show_message("")
        self.stopped.show_walk(None, "")

    def _connect(self) -> None:
        self.next.chooser.chosen.connect(self._on_chosen)
        self.stopped.keep.clicked.connect(self._on_keep_clicked)
        self.stopped.discard.clicked.connect(self._on_discard_clicked)
        self.walks.undo_pressed.connect(self.undo_pressed)
        self.walks.restrapped_pressed.connect(self.restrapped_pressed)
        self.tabs.chosen.connect(self._arrange)

    def _arrange(self) -> None:
        """Show what belongs to this moment."""
        was_on_region = QApplication.focusWidget() in self._regions
        is_recording, has_walks = self.is_recording, bool(self._rows)
        is_tabbed = self._is_compact and has_walks and not is_recording
        shows_curves = has_walks and (not self._is_compact or is_recording or self.tabs.choice == "curves")
        shows_walks = not self._is_compact or (not is_recording and not (is_tabbed and shows_curves))
        self.notice.setVisible(self._has_message or (is_recording and not self._is_compact))
        self.tabs.setVisible(is_tabbed)
        self.stopped.setVisible(self._asked is not None and not is_recording and shows_walks)
        self.empty.setVisible(not has_walks)
        self.charts.setVisible(shows_curves)
        self.figures.setVisible(is_recording)
        self.next.setVisible(not is_recording and shows_walks)
        self.walks.setVisible(has_walks and shows_walks)
        self.walks.set_restrap_offered(not is_recording)
        self._place(self.figures, self._column if self._is_compact else self._right, 0)
        after_stopped = self._column.indexOf(self.stopped) + 1
        self._place(self.next, self._column, after_stopped if self._is_compact else -1)
        self._middle.setDirection(_DOWN if self._is_compact else _ACROSS)
        self._fit()
        if was_on_region and QApplication.focusWidget() not in self._regions:
            self.focus()  # else it is on the next button, which Space would press

    def _place(self, widget: QWidget, layout: QVBoxLayout, index: int) -> None:
        if layout.indexOf(widget) < 0 or widget is self.next:
            for other in (self._column, self._right):
                other.removeWidget(widget)
            layout.insertWidget(index, widget)

    def _fit(self) -> None:
        px = self._look.theme.px
        is_wide = self.width() >= px(WIDE_FROM) and not self._is_compact
        self.charts.set_seconds(SECONDS_WIDE if is_wide else SECONDS)
        self.figures.set_size(FIGURE_COMPACT if self._is_compact else FIGURE_WIDE if is_wide else FIGURE)
        is_narrow = self.width() < px(NARROW_BELOW)
        self.stopped.set_narrow(is_narrow)
        self.figures.set_compact(self._is_compact, is_narrow)
        side = max(px(SIDE_WIDTH_WIDE if is_wide else SIDE_WIDTH), self.walks.minimumSizeHint().width())
        for card in (self.figures, self.walks):
            card.setMinimumWidth(0 if self._is_compact else side)
            card.setMaximumWidth(ANY_WIDTH if self._is_compact else side)
        margin = px(MARGIN_COMPACT if self._is_compact else MARGIN)
        top = px(MARGIN_COMPACT if self._is_compact else 16)
        aside = max(margin, (self.width() - px(MOST_WIDTH)) // 2)
        self._column.setContentsMargins(aside, top, aside, top)

    def _name_next(self) -> None:
        """Say which letter the next walk gets: the one of its label, or the next."""
        letters = {row.label: row.letter for row in self._rows}
        self.next.name(letters.get(self.next.chooser.choice) or _next_letter(self._rows))

    def _on_chosen(self, label: str) -> None:
        self._name_next()
        self.label_chosen.emit(label)

    def _on_keep_clicked(self) -> None:
        if self._asked is not None:
            self.keep_pressed.emit(self._asked.id)

    def _on_discard_clicked(self) -> None:
        if self._asked is not None:
            self.discard_pressed.emit(self._asked.id)

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        between = px(BETWEEN_COMPACT if self._is_compact else BETWEEN)
        for layout in (self._column, self._left, self._right):
            layout.setSpacing(between)
        self._middle.setSpacing(between if self._is_compact else px(16))
        self.notice.setMinimumHeight(px(44 if self._is_compact else NOTICE))
        self._fit()


class _Figures(Card):
    """Strides and cadence, to be read from across the room."""

    def __init__(self, look: Look) -> None:
        self._strides = Text(look, NO_FIGURE, size=FIGURE, weight=SEMIBOLD)
        self._cadence = Text(look, NO_FIGURE, size=FIGURE, weight=SEMIBOLD)
        self._counts = {side: Text(look, "0", size=18, weight=MEDIUM) for side in Side}
        self._chips = {side: Chip(look, side) for side in Side}
        self._line = Hairline(look)
        self._unit = Text(look, tr("steps/min"), size=14, tone="ink2")
        self._stride_row, self._cadence_row, self._sides = QHBoxLayout(), QHBoxLayout(), QBoxLayout(_DOWN)
        self._both = QBoxLayout(_DOWN)
        self._pairs: list[QHBoxLayout] = []
        self._parts: list[QBoxLayout] = []
        self.in_words = ""
        super().__init__(look, spacing=0)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        for side in Side:
            pair = QHBoxLayout()
            pair.addWidget(self._chips[side])
            pair.addWidget(self._counts[side])
            self._pairs.append(pair)
            self._sides.addLayout(pair)
        self._stride_row.addWidget(self._strides)
        self._stride_row.addStretch(1)
        self._stride_row.addLayout(self._sides)
        self._cadence_row.addWidget(self._cadence)
        self._cadence_row.addWidget(self._unit, 0, Qt.AlignmentFlag.AlignBottom)
        self._cadence_row.addStretch(1)
        for title, row in ((tr("Strides"), self._stride_row), (tr("Cadence"), self._cadence_row)):
            part = QBoxLayout(_DOWN)
            part.addWidget(Text(look, title, size=14, tone="ink2"))
            part.addLayout(row)
            self._parts.append(part)
        self._both.addLayout(self._parts[0], 1)
        self._both.addWidget(self._line)
        self._both.addLayout(self._parts[1], 1)
        self.column.addLayout(self._both)
        self._on_look_changed()

    def show_figures(self, strides: Mapping[Side, int], cadence_steps_min: float) -> None:
        shown = str(max(strides.values())) if strides else NO_FIGURE
        cadence = f"{cadence_steps_min:.0f}" if math.isfinite(cadence_steps_min) else NO_FIGURE
        for label, text in ((self._strides, shown), (self._cadence, cadence)):
            if label.text() != text:
                label.setText(text)
        for side in Side:
            self._chips[side].setVisible(side in strides)
            self._counts[side].setVisible(side in strides)
            count = str(strides.get(side, 0))
            if self._counts[side].text() != count:
                self._counts[side].setText(count)
        said = [tr("{count} strides.").format(count=shown)] if strides else []
        words = {Side.LEFT: tr("Left {count}."), Side.RIGHT: tr("Right {count}.")}
        said += [words[side].format(count=strides[side]) for side in Side if side in strides]
        if math.isfinite(cadence_steps_min):
            said.append(tr("Cadence {cadence} steps per minute.").format(cadence=cadence))
        self.in_words = " ".join(said)

    def set_size(self, size: float) -> None:
        self._strides.set_size(size)
        self._cadence.set_size(size)
        self._reserve_room()
        self._unit.setContentsMargins(0, 0, 0, self._look.theme.px(size * UNDER_FIGURES))

    def set_compact(self, is_compact: bool, is_narrow: bool) -> None:
        """Stand in one line; where it is narrow, with the words above the figures."""
        self._both.setDirection(_ACROSS if is_compact else _DOWN)
        self._sides.setDirection(_ACROSS if is_compact else _DOWN)
        for part in self._parts:
            part.setDirection(_ACROSS if is_compact and not is_narrow else _DOWN)
        self._line.setVisible(not is_compact)
        self._padding = 8.0 if is_compact else 16.0
        self._on_look_changed()

    def _reserve_room(self) -> None:
        """As wide as the figures get, so that nothing jumps."""
        for label in (self._strides, self._cadence):
            label.setMinimumWidth(label.fontMetrics().horizontalAdvance("000"))
        for label in self._counts.values():
            label.setMinimumWidth(label.fontMetrics().horizontalAdvance("000"))

    def _on_look_changed(self) -> None:
        super()._on_look_changed()
        px = self._look.theme.px
        for row in (self._stride_row, self._cadence_row, *self._pairs):
            row.setSpacing(px(8))
        self._sides.setSpacing(px(8))
        self._both.setSpacing(px(32) if self._both.direction() is _ACROSS else px(4))
        for part in self._parts:
            part.setSpacing(px(12) if part.direction() is _ACROSS else 0)
        self._reserve_room()


class _StoppedCard(Card):
    """What was just recorded, and the one question about it."""

    def __init__(self, look: Look) -> None:
        self._title = Text(look, size=16, weight=SEMIBOLD, wraps=True)
        self._facts = Text(look, size=14, tone="ink2", wraps=True)
        self.keep = Button(look, "", Kind.PRIMARY, key="K")
        self.discard = Button(look, tr("Discard"), Kind.SECONDARY, key="D")
        self._row, self._verbs = QBoxLayout(_ACROSS), QHBoxLayout()
        super().__init__(look)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        words = QVBoxLayout()
        words.setSpacing(0)
        words.addWidget(self._title)
        words.addWidget(self._facts)
        self._row.addLayout(words, 1)
        self._verbs.addStretch(1)
        self._verbs.addWidget(self.discard)
        self._verbs.addWidget(self.keep)
        self._row.addLayout(self._verbs)
        self.column.addLayout(self._row)

    def show_walk(self, walk: WalkRow | None, facts: str) -> None:
        if walk is None:
            return
        is_recovered = walk.state is WalkState.RECOVERED
        title = tr("{label}: recovered") if is_recovered else tr("{label}: stopped")
        self._title.setText(title.format(label=f"{walk.letter}  {walk.label}"))
        self._facts.setText(facts)
        self._facts.setVisible(bool(facts))
        keep = tr("Keep walk")
        if walk.strides:
            keep = tr_n("Keep {count} stride", "Keep {count} strides", walk.strides).format(count=walk.strides)
        self.keep.setText(keep)
        self.keep.setAccessibleName(keep)
        self.keep.updateGeometry()

    def set_narrow(self, is_narrow: bool) -> None:
        """Put the buttons below the words where the width is too small for both."""
        self._row.setDirection(_DOWN if is_narrow else _ACROSS)

    def _on_look_changed(self) -> None:
        super()._on_look_changed()
        for row in (self._row, self._verbs):
            row.setSpacing(self._look.theme.px(12))


class _EmptyCard(Card):
    """Before the first walk: what to do, and why to stand a moment."""

    def __init__(self, look: Look) -> None:
        self._what = Text(look, tr("Choose a label, then press Space."), size=26, weight=SEMIBOLD, wraps=True)
        self._then = Text(
            look,
            tr("Two seconds of standing first make the ankle's line right from the start."),
            size=16,
            tone="ink2",
            wraps=True,
        )
        super().__init__(look)
        self.setAccessibleName(f"{self._what.text()} {self._then.text()}")
        for text in (self._what, self._then):
            text.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.column.addStretch(1)
        self.column.addWidget(self._what)
        self.column.addWidget(self._then)
        self.column.addStretch(1)


class _NextCard(Card):
    """What the next walk is called, beside the button that starts it."""

    def __init__(self, look: Look) -> None:
        self._title = Text(look, size=14, weight=MEDIUM, tone="ink2")
        self.chooser = LabelChooser(look)
        super().__init__(look)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        self.column.addWidget(self._title)
        self.column.addWidget(self.chooser)

    def sizeHint(self) -> QSize:
        return self.minimumSizeHint()

    def name(self, letter: str) -> None:
        self._title.setText(tr("Next condition: {letter}").format(letter=letter) if letter else tr("Next condition"))


def _next_letter(rows: tuple[WalkRow, ...]) -> str:
    """Give the letter after the last; none where letters have run out or mean something else."""
    last = max((row.letter for row in rows), default="")
    if not last:
        return "A"
    return chr(ord(last) + 1) if len(last) == 1 and "A" <= last < "Z" else ""
