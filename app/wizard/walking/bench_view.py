"""The prosthetist's bench: alignments, the prosthetic side's curves of two of them, and what differs."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import Qt
from PySide6.QtGui import QAccessible
from PySide6.QtWidgets import QBoxLayout, QGridLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.plots.compared_chart import ComparedChart, ComparedFrame
from app.results.compared_words import not_reported_in_words
from app.summary.beside import change_on_curve
from app.summary.comparison import Comparison
from app.summary.conditions import Part
from app.summary.walk_figures import why_in_words
from app.theme.current import current_theme, on_theme, scaled
from app.theme.icons import Icon
from app.widgets.focus_ring import NO_RING
from app.widgets.icons import IconMark
from app.widgets.lay_out import lay_out
from app.widgets.segmented import Segmented
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wizard.walking.alignment_card import AlignmentCard, AlignmentRow
from app.wizard.walking.bench import ChangeEntry
from app.wizard.walking.bench_differences import BenchDifferences
from app.wizard.walking.bench_rows import cautions_of, marked_rows, shape_of
from app.wizard.walking.bench_words import Answer, Outcome
from app.wording.translation import tr
from core.body import JointKind, Side
from core.verdicts.model import worst

LIST, CURVES_LEAST, DIFFERENCES = 284, 308, 320
MORE_FOR_CHANGES = 60  # px: where there is room, which the curves have else
BETWEEN = 12
ONE_PLACES = ((0, 0), (1, 0), (1, 0), (1, 0))  # row and column of tabs, alignments, curves and differences
TABBED_PLACES = ((0, 1), (0, 0, 2, 1), (1, 1), (1, 1))  # and of how many rows and columns
BESIDE_PLACES = ((0, 0), (1, 0), (1, 1), (1, 2))
ANY_WIDTH = 16_777_215  # Qt's own
ACROSS, DOWN = QBoxLayout.Direction.LeftToRight, QBoxLayout.Direction.TopToBottom
ALIGNMENTS, CURVES, CHANGES = "alignments", "curves", "changes"


@dataclass(frozen=True, slots=True)
class BenchState:
    """What the bench shows. `parts`: what is drawn, the earlier first; `found` None where one is shown alone.

    `notes`: how walks of one alignment vary, and what is shown otherwise than before.
    """

    answer: Answer
    rows: Sequence[AlignmentRow]
    next_title: str
    side: Side
    parts: Sequence[Part]
    found: Comparison | None
    is_simulated: bool
    notes: tuple[str, ...] = ()


class BenchView(QWidget):
    """Three cards; where they have not all room, curves or differences beside the alignments, or one at a time."""

    accessible_role = QAccessible.Role.Grouping

    def __init__(self, entry: ChangeEntry) -> None:
        super().__init__()
        self._is_compact, self._room = False, 0
        self._places: Sequence[tuple[int, ...]] = ()
        self._mark = IconMark(Icon.DIFFERENCE, size=24)
        self.first = Text(size=20, weight=SEMIBOLD, wraps=True)
        self.then = Text(tone="ink2", wraps=True)
        self.notes = Text(weight=MEDIUM, wraps=True)
        self.tabs = Segmented(
            tr("View"),
            [(ALIGNMENTS, tr("Alignments"), ""), (CURVES, tr("Curves"), ""), (CHANGES, tr("Differences"), "")],
        )
        self.alignments = AlignmentCard(entry)
        self.differences = BenchDifferences()
        self._curves = QWidget()
        self._frames: dict[tuple[Side, JointKind], ComparedFrame] = {}
        self._build()
        self.tabs.chosen.connect(self._arrange)
        self.alignments.fields.left.connect(self._on_field_left)
        on_theme(self._arrange)

    @property
    def tab_order(self) -> list[QWidget]:
        return [*self.tabs.segments, *self.alignments.fields.tab_order, self.differences.table]

    @property
    def is_marked(self) -> bool:
        """Whether the sentence has the mark of a change beyond its error."""
        return not self._mark.isHidden()

    @property
    def frames(self) -> list[ComparedFrame]:
        """Those of the prosthetic side: the knee's and the ankle's."""
        return [frame for frame in self._frames.values() if not frame.isHidden()]

    def focus_entry(self) -> None:
        """Give the focus to the entry of the next change, and bring it into sight."""
        self.tabs.choose(ALIGNMENTS)
        self.alignments.fields.parts.setFocus(Qt.FocusReason.ShortcutFocusReason)

    def show_state(self, state: BenchState) -> None:
        self.first.setText(state.answer.first)
        self.then.setText(state.answer.then)
        self._mark.setVisible(state.answer.outcome is Outcome.DIFFERS)
        self.notes.setText(" ".join(state.notes))
        self.notes.setVisible(bool(state.notes))
        self.setAccessibleDescription(" ".join([state.answer.first, state.answer.then, *state.notes]))
        self.alignments.show_rows(state.rows, state.side)
        self.alignments.show_entry(state.next_title)
        self.differences.show_pair(state.found, state.side, state.answer.first)
        self._show_curves(state)
        self._arrange()

    def set_compact(self, is_compact: bool) -> None:
        self._is_compact = is_compact
        self.alignments.set_compact(is_compact)
        self.first.set_size(16 if is_compact else 20)
        self._arrange()

    def fit(self, room: int) -> None:
        """Arrange the cards for the page's width, px; the bench's own width depends on the arrangement."""
        self._room = room
        self._arrange()

    def _on_field_left(self) -> None:
        self.setFocus(Qt.FocusReason.OtherFocusReason)

    def _show_curves(self, state: BenchState) -> None:
        marked = marked_rows(state.found, state.side) if state.found is not None else {}
        has_one_zero = state.found is None or state.found.has_one_zero_throughout
        for kind in (JointKind.KNEE, JointKind.ANKLE):
            for side in Side:
                frame = self._frame(side, kind)
                frame.setVisible(side is state.side)
            joint = kind.of(state.side)
            measured = [part for part in state.parts if joint in part.joints]
            curves = [part.curve(joint, is_about_mean=not has_one_zero) for part in measured if part.is_drawn(joint)]
            notes = [not_reported_in_words(part, joint) for part in measured if not part.is_drawn(joint)]
            cautions = cautions_of([part for part in measured if part.is_drawn(joint)], shape_of(joint))
            frame = self._frame(state.side, kind)
            row = marked.get(kind) if has_one_zero else None
            frame.chart.deviations = (
                (change_on_curve(row, row.part.letter, row.against.letter),) if row is not None else ()
            )
            notes += [tr("Caution. {reasons}").format(reasons=" ".join(cautions))] if cautions else []
            verdict = worst(part.verdicts.joint(joint).shape.verdict for part in state.parts)
            why = [(part.letter, why_in_words(part.verdicts.joint(joint))) for part in measured]
            frame.show_verdict(verdict, " ".join(f"{letter}: {words}" for letter, words in why if words))
            frame.show_curves(curves, " ".join(notes), state.is_simulated, is_about_mean=not has_one_zero)

    def _frame(self, side: Side, kind: JointKind) -> ComparedFrame:
        if (side, kind) not in self._frames:
            frame = ComparedFrame(ComparedChart(kind), side, kind)
            self._frames[side, kind] = frame
            self._curves_column.addWidget(frame, 1)
        return self._frames[side, kind]

    def _build(self) -> None:
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setProperty(NO_RING, True)
        self.setAccessibleName(tr("Alignment"))
        self._curves_column = lay_out(QBoxLayout(DOWN, self._curves), margins=0, spacing=12)
        words = lay_out(QVBoxLayout(), self.first, self.then, self.notes)
        words.setSpacing(2)
        mark = self._mark, 0, Qt.AlignmentFlag.AlignTop
        head = lay_out(QHBoxLayout(), mark, (words, 1), spacing=12)
        self._cards = QGridLayout()
        scaled(self._cards.setSpacing, BETWEEN)
        self._cards.setRowStretch(1, 1)
        spoken = (self._mark, self.first, self.then, self.notes)
        for part in (*spoken, self.tabs, self.alignments, self._curves, self.differences):
            part.setParent(self)  # in the order of reading; what is shown without one is a window
        lay_out(QVBoxLayout(self), head, (self._cards, 1), margins=0, spacing=12)

    def _arrange(self) -> None:
        px = current_theme().px
        list_width = max(px(LIST), self.alignments.minimumSizeHint().width())
        curves = max([px(CURVES_LEAST), *(frame.minimumSizeHint().width() for frame in self.frames)])
        changes = max(px(DIFFERENCES), self.differences.needed)
        spare = self._room - list_width - curves - changes - 2 * px(BETWEEN)
        is_one = self._is_compact or self._room < list_width + max(curves, changes) + px(BETWEEN)
        is_tabbed = is_one or spare < 0
        changes += min(spare // 2, px(MORE_FOR_CHANGES)) if spare > 0 else 0
        is_new = is_one and self.tabs.segments[0].isHidden()
        self.tabs.set_offered(ALIGNMENTS, is_one)
        if is_new:  # they were in sight before
            self.tabs.choose(ALIGNMENTS)
        choice = self.tabs.choice
        self.tabs.setVisible(is_tabbed)
        self._curves_column.setDirection(ACROSS if is_one else DOWN)
        places = ONE_PLACES if is_one else TABBED_PLACES if is_tabbed else BESIDE_PLACES
        cards: tuple[tuple[str, QWidget, int], ...] = (
            (ALIGNMENTS, self.alignments, 0 if is_one else list_width),
            (CURVES, self._curves, 0),
            (CHANGES, self.differences, 0 if is_tabbed else changes),
        )
        self._cards.setColumnStretch(0, int(is_one))
        self._cards.setColumnStretch(1, int(not is_one))
        if places is not self._places:
            self._places = places
            for widget, place in zip((self.tabs, *(card for _, card, _ in cards)), places, strict=True):
                self._cards.addWidget(widget, *place)
        for key, card, width in cards:
            card.setVisible(choice == key or not is_tabbed or (not is_one and key == ALIGNMENTS))
            card.setMinimumWidth(width)
            card.setMaximumWidth(width or ANY_WIDTH)
