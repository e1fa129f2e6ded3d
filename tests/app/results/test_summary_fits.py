"""The summary in the windows that it is for: the same parts in the same order, nothing cut, nothing scrolls."""

import datetime
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from uuid import UUID

import pytest
from PySide6.QtCore import QPoint
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from app.results.result_page import ResultPage
from app.results.tools_row import ANSWER, CURVES, TABLE
from app.summary.course import course_of
from app.summary.course_lanes import CourseVisit
from app.summary.request import AnalysedVisit
from app.summary.visits import WalkedVisit, conditions_in_words, visits_by_condition
from app.theme.current import px, set_scale
from app.wording.translation import use_language
from core.body import Joint, Side
from core.goals import Goal, GoalOf
from core.results import Analysis
from core.session import Session
from core.verdicts.norms import AgeAndHeight
from tests.app.changed_analysis import recalibrated, rewalked, visit_of, walk_of
from tests.app.hip_visits import hip_visit
from tests.app.reports.patient.test_what_stands_out import with_more
from tests.app.room import settle, words_cut
from tests.simulated import LONG_WALK, analysis_of, session_of

# of the page in px of the design, and the size of everything
ROOMS = {
    "1280 x 800": (1064, 672, 1.0),
    "960 x 600": (896, 480, 1.0),
    "1920 x 1080": (1704, 952, 1.0),
    "1920 x 1200 at 200 %": (896, 480, 2.0),
}
DAYS = (datetime.date(2025, 7, 1), datetime.date(2025, 9, 23), datetime.date(2026, 11, 23))


@cache
def session() -> Session:
    return session_of(LONG_WALK)


@cache
def analysis() -> Analysis:
    return analysis_of(session())


def two_walks() -> tuple[AnalysedVisit, list[WalkedVisit]]:
    """Both the recording and what is thin beside it can be chosen."""
    other = replace(walk_of(analysis()), name="walk 2")
    walked = next(one for one in session().recordings if one.name == walk_of(analysis()).name)
    recordings = (*session().recordings, replace(walked, name=other.name))
    found = replace(analysis(), recordings=(*analysis().recordings, other))
    return visit_of(found, replace(session(), recordings=recordings), AgeAndHeight(50, 1.8)), []


def return_visit() -> tuple[AnalysedVisit, list[WalkedVisit]]:
    """A third visit with goals: a change since the first of another year has the longest sentence and tiles."""
    first = with_more(analysis(), Side.LEFT, "knee_stance_to_swing_rad", -22.0)
    last = with_more(first, Side.LEFT, "stance_percent", 0.5)
    goals = (
        Goal("speed_m_s", GoalOf.WALK, 1.2, DAYS[0]),
        *(Goal("knee_stance_to_swing_deg", of, 60.0, DAYS[0]) for of in (GoalOf.LEFT, GoalOf.RIGHT)),
    )
    visit = visit_of(analysis(), session(), AgeAndHeight(50, 1.8))
    visit = replace(visit, session=replace(visit.session, patient=replace(visit.session.patient, goals=goals)))
    analyses = zip(DAYS, (first, last, analysis()), strict=True)
    return visit, [WalkedVisit(str(day), one, session().recordings, day) for day, one in analyses]


def first_visit() -> tuple[AnalysedVisit, list[WalkedVisit]]:
    return visit_of(analysis(), session(), AgeAndHeight(50, 1.8)), []


def not_reported() -> tuple[AnalysedVisit, list[WalkedVisit]]:
    return visit_of(recalibrated(analysis(), [Joint.LEFT_KNEE], axis_sd_rad=0.2), session()), []


def one_leg() -> tuple[AnalysedVisit, list[WalkedVisit]]:
    gait = {Side.RIGHT: walk_of(analysis()).gait[Side.RIGHT]}
    return visit_of(rewalked(analysis(), gait=gait), session()), []


def with_hips() -> tuple[AnalysedVisit, list[WalkedVisit]]:
    return hip_visit(), []


CASES: dict[str, Callable[[], tuple[AnalysedVisit, list[WalkedVisit]]]] = {
    "first visit": first_visit,
    "return visit": return_visit,
    "not reported": not_reported,
    "one leg": one_leg,
    "hips": with_hips,
}


@pytest.fixture(params=["de", pytest.param("en", marks=pytest.mark.endurance)])  # German is longer
def language(request: pytest.FixtureRequest) -> Iterator[str]:
    use_language(request.param)
    yield request.param
    use_language("en")


@pytest.fixture(params=ROOMS)
def room(request: pytest.FixtureRequest) -> str:
    set_scale(ROOMS[request.param][2])
    return str(request.param)


@pytest.fixture
def holder(qtbot: QtBot) -> QWidget:
    """What a page is in, for as long as the test."""
    found = QWidget()
    qtbot.addWidget(found)
    return found


def page_in(holder: QWidget, room: str) -> ResultPage:
    """An empty page in its room."""
    width, height, _ = ROOMS[room]
    page = ResultPage()
    page.setParent(holder)
    page.set_room(width, height)
    holder.resize(px(width), px(height))
    holder.show()
    return page


def show(page: ResultPage, case: str) -> None:
    """Show a case on a page that is exactly as large as its room."""
    visit, walked = CASES[case]()
    course = tuple(
        CourseVisit(UUID(int=number), day, course_of(one.analysis, one.recordings))
        for number, (day, one) in enumerate(zip(DAYS, walked, strict=False))
    )
    page.set_has_visits(bool(walked))
    page.show_visit(visit, course=course)
    if walked:
        page.show_visits(visits_by_condition(walked), conditions_in_words(walked))
    page.show()
    settle()
    holder = page.parentWidget()
    assert holder is not None
    page.resize(holder.size())
    settle()


def assert_fits(page: ResultPage, case: str = "") -> None:
    holder = page.parentWidget()
    assert holder is not None
    room = holder.size()
    assert page.minimumSizeHint().width() <= room.width(), case
    assert page.minimumSizeHint().height() <= room.height(), case
    assert page.size() == room, case
    assert words_cut(page) == [], case


@pytest.mark.usefixtures("language")
def test_nothing_of_a_summary_is_cut_or_scrolls(holder: QWidget, room: str) -> None:
    page = page_in(holder, room)
    for case in CASES:
        show(page, case)
        assert page.view.choice == ANSWER
        assert_fits(page, case)
        if page.part.isVisible():
            page.part.choose(TABLE)
            settle()
            assert_fits(page, case)
            page.part.choose(CURVES)


def test_the_same_parts_are_there_in_the_order_of_reading_and_of_the_keyboard(holder: QWidget, room: str) -> None:
    """Where room is short curves and table take turns, and the legs are asked for; none is left out."""
    page = page_in(holder, room)
    show(page, "return visit")
    focused = [widget for widget in page.tab_order if widget.isVisible() and widget.isEnabled()]
    rows = [widget.mapTo(page, QPoint(0, 0)).y() for widget in focused]
    assert rows == sorted(rows, key=lambda y: y // px(30))
    assert page.legs in focused or page.part.isVisible()
    charts = page.cycles.charts
    always = [page.view, page.headline, page.tiles, page.door, page.all_figures]
    assert all(part.isVisible() for part in always)
    assert [tile.isVisible() for tile in page.tiles.tiles] == [True] * 4
    assert charts.knee.isVisible()
    assert charts.ankle.isVisible()
    order = [page.view, page.headline, page.tiles, charts.knee, page.door]
    if page.part.isVisible():
        page.part.choose(TABLE)
        settle()
        assert page.differs.isVisible()
        order[3] = page.differs
    else:
        assert page.differs.isVisible()
        assert page.legs.isVisible()
        order[4:4] = [page.differs]
    tops = [part.mapTo(page, QPoint(0, 0)).y() for part in order]
    assert tops == sorted(tops)
    assert page.differs.table.cells.rowCount() >= 3


@pytest.mark.usefixtures("language")
def test_legs_asked_for_where_room_is_short_fit_too(holder: QWidget) -> None:
    page = page_in(holder, "960 x 600")
    show(page, "not reported")
    page.show_legs.click()
    settle()
    assert page.legs.isVisible()
    assert_fits(page)


@pytest.mark.usefixtures("language")
@pytest.mark.parametrize("language", ["de"], indirect=True)
def test_the_name_of_the_thin_line_goes_where_the_page_becomes_too_narrow_for_it(qtbot: QtBot) -> None:
    page = ResultPage()  # in this language
    qtbot.addWidget(page)
    page.show_visit(two_walks()[0])
    page.show()
    for width, has_name in ((1240, True), (1064, False), (1240, True)):
        page.set_room(width, 672)
        page.resize(px(width), px(672))
        settle()
        assert page.thin.isVisible()
        assert page.thin_name.isVisible() is has_name
        assert page.minimumSizeHint().width() <= px(width)


def test_a_session_without_walks_shows_its_recording_whole(result_page: ResultPage) -> None:
    recordings = tuple(one for one in analysis().recordings if one.name != "walk 1")
    page = result_page
    page.set_room(1064, 672)
    page.show_visit(AnalysedVisit(session(), replace(analysis(), recordings=recordings)))
    page.show()
    assert page.whole.isVisible()
    for part in (page.headline, page.tiles, page.cycles, page.legs, page.differs, page.thin, page.show_legs):
        assert not part.isVisible()
    assert page.headline.text == ""
    page.show_visit(AnalysedVisit(session(), replace(analysis(), recordings=())))
    assert page.recording is None
    shown = [page.headline.isVisible(), page.cycles.isVisible(), page.legs.isVisible(), page.recordings.isVisible()]
    assert shown == [False] * 4
