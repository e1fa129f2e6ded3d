"""What came of a timed test: one sentence, the attempts so far, and its parts; of one that is not valid why not."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QAccessible, QResizeEvent
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.plots.course import CourseCard
from app.summary.course_lanes import CourseLane, CourseVisit
from app.summary.course_words import changes_since_in_words
from app.summary.timed_tables import Sections, columns_of, means_of, sections_of
from app.theme.current import px
from app.theme.icons import Icon
from app.widgets.card import Card
from app.widgets.focus_ring import NO_RING
from app.widgets.icons import IconMark
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.reading_area import scrolled
from app.widgets.table import CellTable, TableColumn, TableRow
from app.widgets.table_cells import RIGHT, SpanStrip, TextCell
from app.widgets.text import SEMIBOLD, Text
from app.wizard.walking.course_entry import CourseEntry
from app.wording.timed_tests import (
    error_words,
    name_of_test,
    not_compared_sentence,
    not_valid_sentence,
    remedy_sentence,
    result_sentence,
    sentences_of,
    why_sentence,
)
from app.wording.translation import figure_text, tr
from core.timed.found import TimedTest
from core.timed.measures import length_of, on_one_course
from core.timed.protocols import PlannedTest, TimedProtocol

BETWEEN = 12


@dataclass(frozen=True, slots=True)
class TimedAttempt:
    """One test that was recorded: which walk it is, and what the analysis reports; None until it does."""

    name: str
    planned: PlannedTest
    found: TimedTest | None
    is_kept: bool

    @property
    def protocol(self) -> TimedProtocol:
        return self.planned.protocol

    @property
    def counts(self) -> bool:
        """Whether it is in the mean, and compared."""
        return self.is_kept and self.found is not None and self.found.is_valid


@dataclass(frozen=True, slots=True)
class TimedResult:
    """The latest test, and every attempt at the same one in this session; `called`: each walk's name on the screen.

    `lane`: what the test is made for over the `visits` that have it, this one the last; None where it is the first.
    `published`: what others published about changes of it.
    `failure`: that the analysis ended early and what is left, so that nobody works on what the latest one lacks.
    """

    attempts: Sequence[TimedAttempt]
    called: Sequence[str]
    visits: Sequence[CourseVisit] = ()
    lane: CourseLane | None = None
    published: str = ""
    failure: tuple[str, str] | None = None

    @property
    def latest(self) -> TimedAttempt:
        return self.attempts[-1]


class TimedResultView(QWidget):
    """In the place of the curves, between walks. `course_entered`: of the latest test."""

    accessible_role = QAccessible.Role.Grouping

    course_entered = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._mark = IconMark(Icon.CHECK, size=24)
        self.first = Text(size=20, weight=SEMIBOLD, wraps=True)
        self.then = Text(tone="ink2", wraps=True)
        self.not_valid = Notice(size=20)
        self.entry = CourseEntry()
        self.attempts = CellTable(tr("Attempts"))
        self.parts = CellTable(tr("Test sections"))
        self.course = CourseCard()
        self.published = Text(size=12, tone="ink2", wraps=True)
        self.errors = Text(size=12, tone="ink2", wraps=True)
        self._build()
        self.entry.entered.connect(self.course_entered)

    def show_state(self, state: TimedResult) -> None:
        found = state.latest.found
        self._show_words(state)
        self.entry.show_test(state.latest.planned)
        self.attempts.show_rows(*_attempts(state))
        is_compared = state.lane is not None and state.latest.counts
        self.course.setVisible(is_compared)
        if is_compared and state.lane is not None:
            self.course.show_course(state.visits, [state.lane])
        sections = sections_of(found) if found is not None else None
        self._parts_card.setVisible(sections is not None)
        if found is not None and sections is not None:
            self.parts.show_rows(*_section_rows(sections, found.time_s))
        errors = [error_words(one) for one in found.definition.errors] if found else []
        self.errors.setText(" ".join(errors))
        self.published.setText(state.published)
        self.published.setVisible(bool(state.published) and state.latest.counts)
        self._arrange()

    def _show_words(self, state: TimedResult) -> None:
        found, latest = state.latest.found, state.latest
        is_valid = found is None or found.is_valid
        stated: list[str] = []
        if found is None and state.failure is not None:
            first, *stated = state.failure
        elif found is None:
            first = tr("{test}: being analysed.").format(test=name_of_test(latest.protocol))
        elif is_valid:
            first = result_sentence(found)
            changed = changes_since_in_words(state.lane, state.visits) if state.lane is not None else ""
            stated = [changed, *sentences_of(found)]
        else:
            first = not_valid_sentence(found)
            stated = [not_compared_sentence(found), *sentences_of(found)]
            self.not_valid.show_message(Icon.WARNING, first, remedy_sentence(found), is_caution=True)
        self.not_valid.setVisible(not is_valid)
        for part in (self._mark, self.first):
            part.setVisible(is_valid)
        self.first.setText(first)
        self.then.setText(" ".join(filter(None, stated)))
        self.then.setVisible(bool(self.then.text()))
        is_whole = found is not None and not why_sentence(found)
        self._mark.set_icon(Icon.CHECK if is_whole else Icon.INFO)
        answer = self.first.text() if is_valid else self.not_valid.text
        self.setAccessibleDescription(f"{answer} {self.then.text()}")

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._arrange()

    def _arrange(self) -> None:
        """Put the tables side by side where both have their room."""
        least = sum(card.minimumSizeHint().width() for card in (self._attempts_card, self._parts_card))
        is_beside = least + px(BETWEEN) <= self.width()
        self._tables.setDirection(QBoxLayout.Direction.LeftToRight if is_beside else QBoxLayout.Direction.TopToBottom)

    def _build(self) -> None:
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setProperty(NO_RING, True)
        self.setAccessibleName(tr("Test result"))
        words = lay_out(QVBoxLayout(), self.first, self.then)
        head = lay_out(QHBoxLayout(), (self._mark, 0, Qt.AlignmentFlag.AlignTop), (words, 1))
        self._attempts_card, self._parts_card = Card(), Card()
        lay_out(self._attempts_card.column, Text(tr("Attempts"), size=16, weight=SEMIBOLD), self.attempts, 1)
        lay_out(self._parts_card.column, Text(tr("Test sections"), size=16, weight=SEMIBOLD), self.parts, 1)
        cards = ((self._attempts_card, 1), (self._parts_card, 1))
        self._tables = lay_out(QBoxLayout(QBoxLayout.Direction.TopToBottom), *cards, spacing=BETWEEN)
        inside = QWidget()
        parts = (self.not_valid, head, self.entry, self._tables, self.course, self.published, self.errors, 1)
        lay_out(QVBoxLayout(inside), *parts, margins=0, spacing=BETWEEN)
        lay_out(QVBoxLayout(self), scrolled(inside, is_upright=False), margins=0)


def _attempts(state: TimedResult) -> tuple[list[TableColumn], list[TableRow]]:
    columns = columns_of(state.latest.protocol, [one.found for one in state.attempts if one.found is not None])
    rows = []
    for called, attempt in zip(state.called, state.attempts, strict=True):
        found, tone = attempt.found, "ink" if attempt.counts or attempt.found is None else "ink3"
        name = called
        if not attempt.is_kept:
            name = tr("{walk}, excluded").format(walk=called)
        elif found is not None and not found.is_valid:
            name = tr("{walk}, not valid").format(walk=called)
        figures = [""] * len(columns) if found is None else [one.text(one.value(found)) for one in columns]
        rows.append(_row(name, figures, tone))
    counting = on_one_course([one.found for one in state.attempts if one.counts and one.found is not None])
    if len(counting) > 1:
        name = tr("Mean of {count}").format(count=len(counting))
        if len(counting) < sum(one.counts for one in state.attempts):
            length = figure_text(length_of(counting[-1]), "g")
            name = tr("Mean of {count} on {length} m").format(count=len(counting), length=length)
        means = means_of(columns, counting)
        bold = (TextCell(one, align=RIGHT, weight=SEMIBOLD) for one in means)
        rows.append(TableRow((TextCell(name, weight=SEMIBOLD), *bold)))
    return [TableColumn(share=1), *_heads([one.head for one in columns])], rows


def _section_rows(sections: Sections, whole_s: float) -> tuple[list[TableColumn], list[TableRow]]:
    """The parts with their figures; when each was, as a bar on the time of the test, for those of a chair test."""
    columns = [TableColumn(share=1 - sections.has_strip), *_heads(sections.heads)]
    columns += [TableColumn(share=1)] * sections.has_strip
    rows = []
    for one in sections.rows:
        name = tr("{part}, slowest").format(part=one.name) if one.is_marked else one.name
        weight = SEMIBOLD if one.is_marked else TextCell().weight
        figures = (TextCell(text, align=RIGHT, weight=weight) for text in one.texts)
        strip = [SpanStrip(one.start_s, one.end_s, whole_s, is_marked=one.is_marked)] * sections.has_strip
        rows.append(TableRow((TextCell(name, weight=weight), *figures, *strip)))
    return columns, rows


def _heads(heads: Sequence[str]) -> list[TableColumn]:
    return [TableColumn(TextCell(head, align=RIGHT, tone="ink2")) for head in heads]


def _row(name: str, figures: Sequence[str], tone: str) -> TableRow:
    return TableRow((TextCell(name, tone=tone), *(TextCell(one, align=RIGHT, tone=tone) for one in figures)))
