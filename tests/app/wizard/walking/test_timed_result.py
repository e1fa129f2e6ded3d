"""The result of a timed test: its attempts, and their mean where there are several that count."""

from dataclasses import replace

from pytestqt.qtbot import QtBot

from app.widgets.table import TableRow
from app.widgets.table_cells import TextCell
from app.wizard.evaluation import failure_in_words
from app.wizard.walking.timed_result import TimedAttempt, TimedResult, TimedResultView
from core.timed.found import TimedTest
from core.timed.protocols import PlannedTest, TimedProtocol

TEN = TimedTest(TimedProtocol.TEN_METRES, 3.0, 12.0, False, False, 10.0, 10.0, 105.0, (), (), (), (), (), (), ())


def attempt(number: int, time_s: float, *, is_kept: bool = True) -> TimedAttempt:
    found = replace(TEN, end_s=TEN.start_s + time_s)
    return TimedAttempt(f"walk {number}", PlannedTest(TimedProtocol.TEN_METRES), found, is_kept)


def texts(row: TableRow) -> list[str]:
    return [cell.text for cell in row.cells if isinstance(cell, TextCell)]


def shown(qtbot: QtBot, *attempts: TimedAttempt) -> list[list[str]]:
    view = TimedResultView()
    qtbot.addWidget(view)
    view.show_state(TimedResult(attempts, [f"A{k} Shoes" for k in range(1, len(attempts) + 1)]))
    return list(map(texts, view.attempts.cells.rows))


def test_the_mean_is_of_the_attempts_that_count(qtbot: QtBot) -> None:
    rows = shown(qtbot, attempt(1, 9.0), attempt(2, 20.0, is_kept=False), attempt(3, 8.0))
    assert rows[1][0] == "A2 Shoes, excluded"
    assert rows[3:] == [["Mean of 2", "8.5", "1.18", "105"]]


def test_the_mean_is_of_one_course_and_names_it(qtbot: QtBot) -> None:
    short = replace(attempt(1, 9.0), found=replace(TEN, course_m=6.0))
    long = [attempt(k, time_s) for k, time_s in ((2, 12.0), (3, 14.0))]
    on_ten = [replace(one, found=replace(one.found, course_m=10.0)) for one in long if one.found is not None]
    assert [row[:2] for row in shown(qtbot, short, *on_ten)[3:]] == [["Mean of 2 on 10 m", "13.0"]]
    assert len(shown(qtbot, *on_ten, short)) == 3


def test_one_attempt_has_no_mean(qtbot: QtBot) -> None:
    assert len(shown(qtbot, attempt(1, 9.0), attempt(2, 20.0, is_kept=False))) == 2


def test_what_an_analysis_that_ended_early_left_open_is_not_stated_to_be_analysed(qtbot: QtBot) -> None:
    view = TimedResultView()
    qtbot.addWidget(view)
    open_still = TimedResult([replace(attempt(1, 9.0), found=None)], ["A1 Shoes"])
    view.show_state(open_still)
    assert view.first.text() == "10-metre walk: being analysed."
    view.show_state(replace(open_still, failure=failure_in_words()))
    assert view.first.text() == "The analysis stopped before it finished."
    assert view.then.text() == "The recordings are safe. See the log for details."
