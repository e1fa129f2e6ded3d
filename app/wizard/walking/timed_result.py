"""What came of a timed test: one sentence, the attempts so far, and how it went from third to third and lap to lap."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QAccessible
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from app.plots.course import CourseCard
from app.summary.course_lanes import CourseLane, CourseVisit
from app.summary.course_words import changes_since_in_words
from app.theme.icons import Icon
from app.widgets.card import Card
from app.widgets.focus_ring import NO_RING
from app.widgets.icons import IconMark
from app.widgets.lay_out import lay_out
from app.widgets.reading_area import scrolled
from app.widgets.table import CellTable, TableColumn, TableRow
from app.widgets.table_cells import RIGHT, TextCell
from app.widgets.text import SEMIBOLD, Text
from app.wording.timed_tests import (
    course_sentence,
    error_words,
    name_of_test,
    pauses_sentence,
    result_sentence,
    stairs_sentence,
    tape_sentence,
    why_sentence,
)
from app.wording.translation import figure_text, tr
from core.timed.found import TimedPart, TimedTest
from core.timed.protocols import TimedProtocol

NO_FIGURE = "\N{EN DASH}"
TURNS = 4  # their column, which has no mean
MOST_LAPS = 12  # more do not fit; the table in the files has all


@dataclass(frozen=True, slots=True)
class TimedAttempt:
    """One test that was recorded: which walk it is, and what the analysis reports; None until it does."""

    name: str
    protocol: TimedProtocol
    found: TimedTest | None
    is_kept: bool


@dataclass(frozen=True, slots=True)
class TimedResult:
    """The latest test, and every attempt at the same one in this session; `called`: each walk's name on the screen.

    `lane`: what the test is made for over the `visits` that have it, this one the last; None where it is the first.
    `failure`: that the analysis ended early and what is left, so that nobody works on what the latest one lacks.
    """

    attempts: Sequence[TimedAttempt]
    called: Sequence[str]
    visits: Sequence[CourseVisit] = ()
    lane: CourseLane | None = None
    failure: tuple[str, str] | None = None

    @property
    def latest(self) -> TimedAttempt:
        return self.attempts[-1]


class TimedResultView(QWidget):
    """In the place of the curves, between walks."""

    accessible_role = QAccessible.Role.Grouping

    def __init__(self) -> None:
        super().__init__()
        self._mark = IconMark(Icon.CHECK, size=24)
        self.first = Text(size=20, weight=SEMIBOLD, wraps=True)
        self.then = Text(tone="ink2", wraps=True)
        self.attempts = CellTable(tr("Attempts"))
        self.parts = CellTable(tr("Test sections"))
        self.course = CourseCard()
        self.errors = Text(size=12, tone="ink2", wraps=True)
        self._build()

    def show_state(self, state: TimedResult) -> None:
        found, latest = state.latest.found, state.latest
        if found is None and state.failure is not None:
            self.first.setText(state.failure[0])
            self.then.setText(state.failure[1])
        elif found is None:
            self.first.setText(tr("{test}: being analysed.").format(test=name_of_test(latest.protocol)))
            self.then.setText("")
        else:
            self.first.setText(result_sentence(found))
            stated = [
                changes_since_in_words(state.lane, state.visits) if state.lane is not None else "",
                why_sentence(found),
                tape_sentence(found),
                stairs_sentence(found),
                course_sentence(found),
                pauses_sentence(found),
            ]
            self.then.setText(" ".join(filter(None, stated)))
        self.then.setVisible(bool(self.then.text()))
        self._mark.set_icon(Icon.CHECK if found is not None and not found.missing else Icon.INFO)
        self.setAccessibleDescription(f"{self.first.text()} {self.then.text()}")
        self.attempts.show_rows(*_attempts(state))
        self.course.setVisible(state.lane is not None)
        if state.lane is not None:
            self.course.show_course(state.visits, [state.lane])
        parts = _parts(found) if found is not None else []
        self._parts_card.setVisible(bool(parts))
        if parts:
            self.parts.show_rows(_part_columns(), parts)
        errors = found.definition.errors if found is not None else ()
        self.errors.setText(" ".join(error_words(one) for one in errors))

    def _build(self) -> None:
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setProperty(NO_RING, True)
        self.setAccessibleName(tr("Test result"))
        words = lay_out(QVBoxLayout(), self.first, self.then)
        head = lay_out(QHBoxLayout(), (self._mark, 0, Qt.AlignmentFlag.AlignTop), (words, 1))
        attempts, self._parts_card = Card(), Card()
        lay_out(attempts.column, Text(tr("Attempts"), size=16, weight=SEMIBOLD), self.attempts)
        lay_out(self._parts_card.column, Text(tr("Test sections"), size=16, weight=SEMIBOLD), self.parts)
        inside = QWidget()
        parts = (head, attempts, self.course, self._parts_card, self.errors, 1)
        lay_out(QVBoxLayout(inside), *parts, margins=0, spacing=12)
        lay_out(QVBoxLayout(self), scrolled(inside, is_upright=False), margins=0)


def number(value: float, digits: int) -> str:
    """A figure, or a dash where it was not measured."""
    return figure_text(value, f".{digits}f") if math.isfinite(value) else NO_FIGURE


def _attempts(state: TimedResult) -> tuple[list[TableColumn], list[TableRow]]:
    heads = (tr("time, s"), tr("distance, m"), tr("speed, m/s"), tr("steps/min"), tr("turns"), tr("Diff. to tape, m"))
    has_tape = any(one.found is not None and math.isfinite(one.found.tape_difference_m) for one in state.attempts)
    shown = len(heads) if has_tape else len(heads) - 1
    columns = [TableColumn(share=1), *(TableColumn(TextCell(head, align=RIGHT, tone="ink2")) for head in heads[:shown])]
    rows = []
    for called, attempt in zip(state.called, state.attempts, strict=True):
        found = attempt.found
        figures = [""] * len(heads) if found is None else _texts(_values(found))
        tone = "ink" if attempt.is_kept else "ink3"
        name = called if attempt.is_kept else tr("{walk}, excluded").format(walk=called)
        cells = [TextCell(name, tone=tone), *(TextCell(one, align=RIGHT, tone=tone) for one in figures[:shown])]
        rows.append(TableRow(tuple(cells)))
    kept = [_values(one.found) for one in state.attempts if one.is_kept and one.found is not None]
    if len(kept) > 1:
        figures = _texts([float(np.mean(of_attempts)) for of_attempts in zip(*kept, strict=True)])
        figures[TURNS] = ""
        name = tr("Mean of {count}").format(count=len(kept))
        reported = [TextCell(one, align=RIGHT, weight=SEMIBOLD) for one in figures[:shown]]
        rows.append(TableRow((TextCell(name, weight=SEMIBOLD), *reported)))
    return columns, rows


def _values(found: TimedTest) -> list[float]:
    return [
        found.time_s,
        found.distance_m,
        found.speed_m_s,
        found.cadence_steps_min,
        len(found.turns),
        found.tape_difference_m,
    ]


def _texts(values: Sequence[float]) -> list[str]:
    texts = [number(value, digits) for value, digits in zip(values, (1, 1, 2, 0, 0, 2), strict=True)]
    return [*texts[:-1], f"+{texts[-1]}" if values[-1] >= 0 else texts[-1]]


def _part_columns() -> list[TableColumn]:
    heads = (tr("from, s"), tr("to, s"), tr("distance, m"), tr("speed, m/s"), tr("steps/min"))
    return [TableColumn(share=1), *(TableColumn(TextCell(head, align=RIGHT, tone="ink2")) for head in heads)]


def _parts(found: TimedTest) -> list[TableRow]:
    """Thirds and laps of a walk of a set time, rises from a chair."""
    rows = []
    if found.definition.duration_s is not None:
        rows += [_part(tr("Third {number}"), k, one, found) for k, one in enumerate(found.thirds, 1)]
        rows += [_part(tr("Lap {number}"), k, one, found) for k, one in enumerate(found.laps[:MOST_LAPS], 1)]
    if found.definition.rises > 1:
        for k, one in enumerate(found.rises, 1):
            from_s, to_s = one.left_seat_s - found.start_s, one.upright_s - found.start_s
            reported = [number(from_s, 1), number(to_s, 1), "", "", ""]
            rows.append(_row(tr("Rise {number}").format(number=k), reported))
    return rows


def _part(word: str, k: int, part: TimedPart, found: TimedTest) -> TableRow:
    figures = [
        number(part.start_s - found.start_s, 1),
        number(part.end_s - found.start_s, 1),
        number(part.distance_m, 1),
        number(part.speed_m_s, 2),
        number(part.cadence_steps_min, 0),
    ]
    return _row(word.format(number=k), figures)


def _row(name: str, figures: list[str]) -> TableRow:
    return TableRow((TextCell(name), *(TextCell(one, align=RIGHT) for one in figures)))
