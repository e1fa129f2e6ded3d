"""Page of walking:

how the patient walks now, and what becomes of each walk. It has live curves and steps, and the next walk's label.
"""

import math
from collections.abc import Mapping, Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import (
    QApplication,
    QBoxLayout,
    QHBoxLayout,
    QVBoxLayout,
    QWidget,
)

from app.patient_screen.controls import ControlsCard
from app.theme.current import on_theme, px, scaled
from app.theme.icons import Icon
from app.widgets.focus_ring import NO_RING
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.reading_area import scrolled
from app.widgets.segmented import Segmented
from app.widgets.sensors_progress import ProgressShown, SensorsProgress
from app.widgets.text import MEDIUM, Text
from app.wizard.walking.bench import ChangeEntry
from app.wizard.walking.bench_view import BenchState, BenchView
from app.wizard.walking.camera_card import CameraCard, CameraShown
from app.wizard.walking.cards import ACROSS, DOWN, FIGURE, EmptyCard, NextCard, StoppedCard, WalkFigures
from app.wizard.walking.charts import WalkingCharts, last_angles_in_words
from app.wizard.walking.readout import WalkingReadout
from app.wizard.walking.received_card import ReceivedCard, ReceivedRow
from app.wizard.walking.timed_result import TimedResult, TimedResultView
from app.wizard.walking.timed_view import TimedView, TimedViewState
from app.wizard.walking.walk_list import WalkList, WalkRow, WalkState
from app.wording.recordings import LETTERS
from app.wording.translation import tr
from core.timed.protocols import PlannedTest, TimedProtocol

MARGIN, BETWEEN = 24, 12
MARGIN_COMPACT, BETWEEN_COMPACT = 8, 8
NOTICE = 64  # reserved above the charts while a walk is recorded, so that nothing jumps when a message appears
SIDE_WIDTH, SIDE_WIDTH_WIDE = 244, 320
FIGURE_WIDE, FIGURE_COMPACT = 72, 36
NARROW_BELOW = 660  # of the page: a question is above its answers, a word above its figure
WIDE_FROM = 1400  # of the page
MOST_WIDTH = 1600
HIPS_FROM = 680  # of the page
SECONDS, SECONDS_WIDE = 8.0, 12.0
DESCRIBED_EVERY_S = 1.0  # screen readers are not notified every frame
ANY_WIDTH = 16777215  # what Qt calls no limit


class WalkingPage(QWidget):
    """Its look follows the walks it is shown: none yet, one being recorded, or in between.

    `keep_pressed`, `discard_pressed`: with the walk's id.
    """

    label_chosen = Signal(str)  # what the next walk is called
    keep_pressed = Signal(str)
    discard_pressed = Signal(str)

    keeps_place_for_messages = True

    def __init__(self, entry: ChangeEntry | None = None) -> None:
        super().__init__()
        self._is_compact = self._has_bench = self._has_test = self._has_result = False
        self._has_memory = self._has_hips = self._has_camera = False
        self.bench = BenchView(entry or ChangeEntry())
        self.rows: tuple[WalkRow, ...] = ()
        self._asked: WalkRow | None = None
        self.live = WalkingReadout()
        self._described_s = -math.inf
        self.notice = Notice(size=16)
        self._has_message = False
        self._message: tuple[str, str] | None = None
        self.tabs = Segmented(tr("View"), [("walks", tr("Walks"), ""), ("curves", tr("Curves"), "")])
        self.output = Text(size=14, weight=MEDIUM, tone="ink2", wraps=True)
        self.patient_controls = ControlsCard()  # in sight while the patient's screen is
        self.stopped = StoppedCard()
        self.received = ReceivedCard()
        self.empty = EmptyCard()
        self.charts = WalkingCharts()
        self.memory = SensorsProgress()
        self.figures = WalkFigures()
        self.walks = WalkList()
        self.camera = CameraCard()
        self.next = NextCard()
        self.timed = TimedView()
        self.timed_result = TimedResultView()
        self._inside = QWidget()
        self._scroll = scrolled(self._inside, is_upright=False)
        self._build()
        self._connect()
        self._space()
        self._arrange()
        on_theme(self._fit)

    @property
    def is_recording(self) -> bool:
        return any(row.state is WalkState.RECORDING for row in self.rows)

    @property
    def tab_order(self) -> list[QWidget]:
        """The controls in the order of reading, those of this moment only; the bench asks for others by itself."""
        bench = self.bench.tab_order if self.bench.isVisibleTo(self) else []
        controls: list[QWidget] = [*self.patient_controls.controls, *bench, *self.tabs.segments]
        controls += [self.memory.stop, self.stopped.discard, self.stopped.keep]
        controls += [*self.walks.buttons, self.walks.restrapped, *self.camera.tab_order]
        controls += [*self.next.chooser.stops, self.next.chooser.own]
        controls += self.timed_result.entry.fields
        controls += [self.next.course.field, self.next.test]
        return [one for one in controls if one in bench or one.isVisibleTo(self)]

    def focus(self) -> None:
        """Put the focus where reading starts, and on no button: Space is to start and stop the walk."""
        next((one for one in self._regions if one.isVisibleTo(self)), self.walks).setFocus()

    def show_view(self, live: WalkingReadout) -> None:
        """Draw the present, up to thirty times a second."""
        self.live = live
        self.charts.show_live(live)
        self.figures.show_figures(live.strides, live.cadence_steps_min)
        if not 0.0 <= live.now_s - self._described_s < DESCRIBED_EVERY_S:
            self._described_s = live.now_s
            stated = [self.figures.in_words, last_angles_in_words(live)]
            self.charts.setAccessibleDescription(" ".join(filter(None, stated)))

    def count_again(self) -> None:
        """Show no stride of a walk that begins: those of the one before are not its own."""
        self.figures.show_figures(dict.fromkeys(self.live.strides, 0), math.nan)

    def show_walks(self, rows: tuple[WalkRow, ...], facts: str = "") -> None:
        """Show the session's walks in order of recording; `facts` describe the walk that is asked about."""
        was_recording, had_focus = self.is_recording, self._has_focus()
        self.rows = rows
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

    def show_received(self, rows: Sequence[ReceivedRow]) -> None:
        """Show which sensors lost samples in which recording; nothing where none did."""
        self.received.show_rows(rows)
        self._arrange()

    def show_bench(self, state: BenchState | None) -> None:
        """Show the bench in the place of walks and curves, between walks; None: they stand there."""
        had_focus, self._has_bench = self._has_focus(), state is not None
        if state is not None:
            self.bench.show_state(state)
        self._arrange()
        if had_focus and not self._has_focus():
            self.focus()

    def show_labels(self, labels: tuple[str, ...], choice: str) -> None:
        """Offer what the next walk may be called, and what it will be called as things stand."""
        self.next.chooser.show_labels(labels, choice)
        self._name_next()

    def show_test(self, state: TimedViewState | None) -> None:
        """Show a timed test in the place of the curves while it is recorded; None: they stand there."""
        if state is not None:
            self.timed.show_state(state)
        if (state is not None) != self._has_test:
            self._has_test = state is not None
            self._arrange()
            if self._has_test:
                self.timed.setFocus()

    def show_tests(
        self, planned: PlannedTest | None, state: TimedResult | None, before: Mapping[TimedProtocol, str]
    ) -> None:
        """Show the next test and the latest result in place of curves; `before`: results of an earlier visit."""
        self.empty.show_test(planned)
        self.next.show_test(planned)
        self.next.test.show_before(before)
        self._has_result = state is not None
        if state is not None:
            self.timed_result.show_state(state)
        self._arrange()

    def enter_course(self) -> None:
        """Lead to the length of the test's course, if it has one."""
        if self.next.course.isVisible():
            self.next.course.take_focus()

    def show_memory(self, shown: ProgressShown | None) -> None:
        """Show what is done with the sensors' memories in the place of the curves; None: they stand there."""
        if shown is not None:
            self.memory.show_state(shown)
        if (shown is not None) != self._has_memory:
            self._has_memory = shown is not None
            self._arrange()

    def show_camera(self, shown: CameraShown | None) -> None:
        """Show the camera beside the walks; None: there is none."""
        if shown is not None:
            self.camera.show_camera(shown)
        if (shown is not None) != self._has_camera:
            self._has_camera = shown is not None
            self._arrange()

    def choose_digit(self, digit: int) -> bool:
        """Choose the label whose cap shows `digit`; False where it means nothing now."""
        return not self.is_recording and self.next.chooser.choose_digit(digit)

    def show_message(self, what: str, then: str = "", *, is_caution: bool = True) -> None:
        """Show what happened and what to do or what follows; nothing takes it back. No caution: it is as was asked."""
        if (what, then) == self._message:
            return
        self._message = what, then
        self._has_message = bool(what)
        if what:
            self.notice.show_message(Icon.WARNING if is_caution else Icon.INFO, what, then, is_caution=is_caution)
        else:
            self.notice.show_message(
                Icon.INFO,
                tr("A standard deviation needs ten strides per leg"),
                tr("Starting, turning and stopping are excluded automatically."),
            )
        self._arrange()

    def show_output(self, sentence: str) -> None:
        """Say what other programs receive; empty: nothing."""
        if sentence != self.output.text():
            self.output.setText(sentence)
            self.output.setVisible(bool(sentence))

    def set_simulated(self, is_simulated: bool) -> None:
        self.charts.set_simulated(is_simulated)

    def set_hips(self, has_hips: bool) -> None:
        """Keep a place for the hips above the knees, or none."""
        self._has_hips = has_hips
        self._fit()

    def set_compact(self, is_compact: bool) -> None:
        if is_compact != self._is_compact:
            self._is_compact = is_compact
            self.charts.set_compact(is_compact)
            self.walks.set_compact(is_compact)
            self.bench.set_compact(is_compact)
            self.timed.set_compact(is_compact)
            self._space()
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
        return self.bench, self.timed, self.empty, self.charts, self.timed_result, self.memory, self.walks

    def _build(self) -> None:
        for region in self._regions:
            region.setFocusPolicy(Qt.FocusPolicy.TabFocus)
            region.setProperty(NO_RING, True)
        self.charts.setAccessibleName(tr("Live angles and gait phases"))
        regions = (self.empty, self.charts, self.timed_result, self.memory)
        self._left = lay_out(QVBoxLayout(), *((region, 1) for region in regions))
        self._right = lay_out(QVBoxLayout(), self.figures, (self.walks, 1), self.camera)
        self._right.addStretch()  # below the camera, where there are no walks yet
        self._middle = lay_out(QBoxLayout(ACROSS), (self._left, 1), self._right)
        self.patient_controls.setVisible(False)
        self.output.hide()
        above = (self.output, self.notice, self.patient_controls, self.tabs, self.stopped, self.received)
        large = ((part, 1) for part in (self.bench, self.timed, self._middle))
        self._column = lay_out(QVBoxLayout(self._inside), *above, *large, self.next)
        lay_out(QHBoxLayout(self), self._scroll, margins=0)
        self.show_message("")
        self.stopped.show_walk(None, "")

    def _connect(self) -> None:
        self.next.chooser.chosen.connect(self._on_chosen)
        self.stopped.keep.clicked.connect(self._on_keep_clicked)
        self.stopped.discard.clicked.connect(self._on_discard_clicked)
        for entry in (self.next.course, self.timed_result.entry):
            entry.left.connect(self.focus)
        self.tabs.chosen.connect(self._arrange)
        self.patient_controls.offered.connect(self._arrange)

    def _arrange(self) -> None:
        """Show what belongs to this moment."""
        was_on_region = QApplication.focusWidget() in self._regions
        is_recording, has_walks = self.is_recording, bool(self.rows)
        is_bench = self._has_bench and not is_recording
        is_test = self._has_test and is_recording
        has_controls = not self.patient_controls.isHidden()  # of the patient's screen: they need the room
        is_tabbed = self._is_compact and has_walks and not is_recording
        shows_curves = has_walks and (not self._is_compact or is_recording or self.tabs.choice == "curves")
        shows_walks = not self._is_compact or (not is_recording and not (is_tabbed and shows_curves))
        shows_curves, shows_walks = shows_curves and not is_bench, shows_walks and not is_bench
        shows_result = self._has_result and shows_curves and not is_recording
        shows_curves, shows_walks = shows_curves and not is_test and not shows_result, shows_walks and not is_test
        self.bench.setVisible(is_bench)
        self.notice.setVisible(
            (self._has_message and not is_bench)
            or (is_recording and not self._is_compact and not is_test and not self._has_memory and not has_controls)
        )
        self.tabs.setVisible(is_tabbed and not is_bench)
        self.received.setVisible(bool(self.received.rows) and not is_recording)
        self.stopped.setVisible(self._asked is not None and not is_recording and shows_walks)
        is_memory = self._has_memory and not is_bench
        shows_curves, shows_result = shows_curves and not is_memory, shows_result and not is_memory
        self.memory.setVisible(is_memory)
        self.empty.setVisible(not has_walks and not is_memory)
        self.charts.setVisible(shows_curves)
        self.timed.setVisible(is_test)
        self.timed_result.setVisible(shows_result)
        self.figures.setVisible(is_recording and not is_test and not is_memory)
        self.next.setVisible(not is_recording and shows_walks)
        self.walks.setVisible(has_walks and shows_walks)
        self.camera.setVisible(self._has_camera and not is_test and (not self._is_compact or shows_walks))
        self.walks.set_restrap_offered(not is_recording)
        self._place(self.figures, self._column if self._is_compact else self._right, 0)
        after_stopped = self._column.indexOf(self.received) + 1
        self._place(self.next, self._column, after_stopped if self._is_compact else -1)
        self._middle.setDirection(DOWN if self._is_compact else ACROSS)
        self._fit()
        if was_on_region and QApplication.focusWidget() not in self._regions:
            self.focus()  # else it is on the next button, which Space would press

    def _place(self, widget: QWidget, layout: QVBoxLayout, index: int) -> None:
        if layout.indexOf(widget) < 0 or widget is self.next:
            for other in (self._column, self._right):
                other.removeWidget(widget)
            layout.insertWidget(index, widget)

    def _fit(self) -> None:
        is_wide = self.width() >= px(WIDE_FROM) and not self._is_compact
        self.charts.set_seconds(SECONDS_WIDE if is_wide else SECONDS)
        # between walks what comes next needs the room more
        is_high = self.is_recording or self._is_compact or self.height() >= px(HIPS_FROM)
        self.charts.set_hips(self._has_hips and is_high)
        is_aside = self._has_camera and not is_wide and not self._is_compact  # the camera needs the room below
        self.figures.set_size(FIGURE_COMPACT if self._is_compact or is_aside else FIGURE_WIDE if is_wide else FIGURE)
        is_narrow = self.width() < px(NARROW_BELOW)
        self.stopped.set_narrow(is_narrow)
        self.figures.set_compact(self._is_compact, is_narrow, is_aside=is_aside)
        side = max(px(SIDE_WIDTH_WIDE if is_wide else SIDE_WIDTH), self.walks.minimumSizeHint().width())
        for card in (self.figures, self.walks, self.camera):
            card.setMinimumWidth(0 if self._is_compact else side)
            card.setMaximumWidth(ANY_WIDTH if self._is_compact else side)
        margin = px(MARGIN_COMPACT if self._is_compact else MARGIN)
        top = px(MARGIN_COMPACT if self._is_compact else 16)
        aside = max(margin, (self.width() - px(MOST_WIDTH)) // 2)
        self._column.setContentsMargins(aside, top, aside, top)
        self.bench.fit(self.width() - 2 * aside - self._scroll.verticalScrollBar().sizeHint().width())

    def _name_next(self) -> None:
        """Say which letter the next walk gets: the one of its label, or the next."""
        letters = {row.label: _condition_letter(row) for row in self.rows if row.letter and not row.is_of_old_straps}
        self.next.name(letters.get(self.next.chooser.choice) or _next_letter(self.rows))

    def _on_chosen(self, label: str) -> None:
        self._name_next()
        self.label_chosen.emit(label)

    def _on_keep_clicked(self) -> None:
        if self._asked is not None:
            self.keep_pressed.emit(self._asked.id)

    def _on_discard_clicked(self) -> None:
        if self._asked is not None:
            self.discard_pressed.emit(self._asked.id)

    def _space(self) -> None:
        between = BETWEEN_COMPACT if self._is_compact else BETWEEN
        for layout in (self._column, self._left, self._right):
            scaled(layout.setSpacing, between)
        scaled(self._middle.setSpacing, between if self._is_compact else 16)
        scaled(self.notice.setMinimumHeight, 44 if self._is_compact else NOTICE)


def _condition_letter(row: WalkRow) -> str:
    return row.letter.rstrip("0123456789")


def _next_letter(rows: tuple[WalkRow, ...]) -> str:
    """Give the letter after the last; none where letters have run out."""
    last = max(map(_condition_letter, rows), default="")
    return LETTERS[LETTERS.index(last) + 1 :][:1] if last else LETTERS[0]
