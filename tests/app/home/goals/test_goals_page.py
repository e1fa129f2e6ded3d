"""Goals are typed by keys alone; what is wrong is stated at its field, and nothing is proposed."""

import datetime

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.home.goals.goals_page import AT_LEAST, GoalDraft, GoalsPage, about
from app.widgets.text import Text
from core.goals import GOAL_COLUMNS, Goal, GoalOf, with_goal
from core.timed.measures import COLUMNS
from core.timed.protocols import TimedProtocol
from tests.app.room import words_cut

KNEE, SPEED, STANCE, LENGTH = "knee_stance_to_swing_deg", "speed_m_s", "stance_percent", "stride_length_m"
SIT_TO_STAND = COLUMNS[TimedProtocol.SIT_TO_STAND]
DAY = datetime.date(2026, 9, 30)
LATER = datetime.date(2026, 11, 24)
GOALS = with_goal(
    (
        Goal(KNEE, GoalOf.LEFT, 55.0, DAY, "H. Keller", note="stairs"),
        Goal(SPEED, GoalOf.WALK, 1.1, DAY, "H. Keller", until=LATER),
    ),
    Goal(SPEED, GoalOf.WALK, 1.2, LATER, "B. Berger"),
)


@pytest.fixture
def page(qtbot: QtBot) -> GoalsPage:
    page = GoalsPage()
    page.set_room(1064)
    page.resize(1064, 728)
    qtbot.addWidget(page)
    page.show_patient("P-0158")
    with qtbot.waitExposed(page):
        page.show()
    return page


def choose(page: GoalsPage, column: str) -> None:
    """By the keyboard."""
    page.measure.setFocus()
    QTest.keyClick(page.measure, Qt.Key.Key_Home)
    for _ in range(GOAL_COLUMNS.index(column)):
        QTest.keyClick(page.measure, Qt.Key.Key_Down)


def test_a_goal_is_typed_by_keys_and_enter_agrees_on_it(qtbot: QtBot, page: GoalsPage) -> None:
    choose(page, KNEE)
    page.whose.focus()
    QTest.keyClick(page.whose.segments[0], Qt.Key.Key_Right)
    QTest.keyClicks(page.value.line_edit, "57,5")
    QTest.keyClicks(page.weeks.line_edit, "12")
    QTest.keyClicks(page.note.line_edit, " stairs ")
    with qtbot.waitSignal(page.agreed) as reported:
        QTest.keyClick(page.note.line_edit, Qt.Key.Key_Return)
    assert reported.args == [GoalDraft(KNEE, GoalOf.RIGHT, 57.5, is_at_most=False, weeks=12, note="stairs")]


def test_nothing_is_proposed_and_an_empty_value_is_asked_for(qtbot: QtBot, page: GoalsPage) -> None:
    assert page.value.text == page.weeks.text == page.note.text == ""
    with qtbot.assertNotEmitted(page.agreed):
        page.submit()
    assert page.value.is_wrong
    assert any(text.text() == "Enter the target value." for text in page.value.findChildren(Text))


@pytest.mark.parametrize(
    ("column", "typed"), [(KNEE, "200"), (KNEE, "0"), (SPEED, "4"), (KNEE, "much"), (STANCE, "96")]
)
def test_a_value_that_no_walk_has_is_refused_at_its_field(
    qtbot: QtBot, page: GoalsPage, column: str, typed: str
) -> None:
    choose(page, column)
    QTest.keyClicks(page.value.line_edit, typed)
    with qtbot.assertNotEmitted(page.agreed):
        QTest.keyClick(page.value.line_edit, Qt.Key.Key_Return)
    assert page.value.is_wrong


def test_weeks_that_are_none_are_refused(qtbot: QtBot, page: GoalsPage) -> None:
    QTest.keyClicks(page.value.line_edit, "50")
    QTest.keyClicks(page.weeks.line_edit, "soon")
    with qtbot.assertNotEmitted(page.agreed):
        QTest.keyClick(page.weeks.line_edit, Qt.Key.Key_Return)
    assert page.weeks.is_wrong


def test_between_the_legs_only_how_far_they_are_apart_is_asked(qtbot: QtBot, page: GoalsPage) -> None:
    choose(page, STANCE)
    page.whose.choose(GoalOf.BETWEEN)
    assert page.sense.isHidden()
    assert not page.apart.isHidden()
    QTest.keyClicks(page.value.line_edit, "0")
    with qtbot.waitSignal(page.agreed) as reported:
        page.submit()
    assert reported.args == [GoalDraft(STANCE, GoalOf.BETWEEN, 0.0, is_at_most=True, weeks=None, note="")]


def test_each_measure_offers_whose_it_can_be(page: GoalsPage) -> None:
    choose(page, SPEED)
    assert page.whose.isHidden()
    choose(page, LENGTH)
    assert [segment.isHidden() for segment in page.whose.segments] == [False, False, True]
    choose(page, KNEE)
    assert [segment.isHidden() for segment in page.whose.segments] == [False, False, False]
    page.whose.choose(GoalOf.BETWEEN)
    choose(page, LENGTH)
    assert page.whose.choice == GoalOf.LEFT


def test_a_value_of_another_measure_does_not_stay(page: GoalsPage) -> None:
    choose(page, KNEE)
    QTest.keyClicks(page.value.line_edit, "1.2")
    choose(page, SPEED)
    assert page.value.text == ""


def test_what_holds_is_first_and_what_ended_cannot_be_taken_back(qtbot: QtBot, page: GoalsPage) -> None:
    page.show_goals(GOALS)
    assert [row.key for row in page.rows] == [(SPEED, GoalOf.WALK), (KNEE, GoalOf.LEFT), (SPEED, GoalOf.WALK)]
    assert [row.take_back is not None for row in page.rows] == [True, True, False]
    knee = page.rows[1].take_back
    assert knee is not None
    with qtbot.waitSignal(page.taken_back) as reported:
        QTest.keyClick(knee, Qt.Key.Key_Return)
    assert reported.args == [(KNEE, GoalOf.LEFT)]
    assert not page.none_yet.isVisible()


def test_who_agreed_and_when_is_beneath() -> None:
    speed, ended = (next(goal for goal in GOALS if goal.value == value) for value in (1.2, 1.1))
    assert about(speed) == "agreed 24 Nov 2026, B. Berger"
    assert about(ended) == "agreed 30 Sep 2026, H. Keller · by 24 Nov 2026 · ended 24 Nov 2026, B. Berger"
    assert about(next(goal for goal in GOALS if goal.note)).endswith(" · stairs")


@pytest.mark.usefixtures("pseudo_language")
@pytest.mark.parametrize(("width", "height"), [(1064, 728), (896, 528)])
def test_no_word_is_cut_in_a_longer_language(qtbot: QtBot, width: int, height: int) -> None:
    page = GoalsPage()
    page.set_room(width)
    page.resize(width, height)
    qtbot.addWidget(page)
    page.show_patient("P-0158")
    page.show_goals(GOALS)
    with qtbot.waitExposed(page):
        page.show()
    page.value.set_text("200")
    page.submit()
    page.resize(width, max(height, page.minimumHeight()))
    assert words_cut(page) == []


def test_a_time_is_required_to_be_at_most_so_long_unless_somebody_states_otherwise(
    qtbot: QtBot, page: GoalsPage
) -> None:
    choose(page, SIT_TO_STAND)
    assert not page.whose.isVisible()
    QTest.keyClicks(page.value.line_edit, "15")
    with qtbot.waitSignal(page.agreed) as reported:
        QTest.keyClick(page.value.line_edit, Qt.Key.Key_Return)
    assert reported.args == [GoalDraft(SIT_TO_STAND, GoalOf.WALK, 15.0, is_at_most=True, weeks=None, note="")]
    choose(page, SPEED)
    assert page.sense.choice == AT_LEAST
