"""The thin line: the headline's visit unless somebody chose, another walk, or nothing; and nothing forbidden."""

import datetime
from dataclasses import replace
from functools import cache
from uuid import UUID

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.results.result_page import ResultPage
from app.results.thin_line import ThinLine
from app.results.tools_row import ANSWER, STRIDES
from app.summary.beside import beside_visit, beside_walk, change_on_curve, walks_alone
from app.summary.course import course_of
from app.summary.course_lanes import CourseVisit
from app.summary.request import AnalysedVisit
from app.summary.visits import WalkedVisit, conditions_in_words, visits_by_condition
from app.wizard.walking.bench_rows import marked_rows
from core.body import Joint, Side
from core.results import Analysis, ZeroKind
from core.session import Session
from core.verdicts.sigmas import ComparisonKind
from devices.simulation.walker import DEMONSTRATION, FreeMotion, Standing, Walk
from devices.simulation.walker_body import Tissue
from tests.app.changed_analysis import recalibrated
from tests.app.reports.patient.test_what_stands_out import with_more
from tests.app.room import settle
from tests.simulated import analysis_of, session_of

JULY, SEPTEMBER, NOW = (datetime.date(2026, month, 1) for month in (7, 9, 11))
VISITS = (JULY, SEPTEMBER, NOW)


@cache
def session() -> Session:
    """Two walks of one strapping, the second slower and with an orthosis."""
    walks = (Walk(strides=13), Walk("walk 2", strides=13, speed_m_s=0.8))
    played: tuple[Standing | FreeMotion | Walk, ...] = (Standing(), FreeMotion(), *walks)
    found = session_of(replace(DEMONSTRATION, tissue=Tissue.RIGID, recordings=played))
    return replace(with_conditions(found, walk_1="shoes", walk_2="AFO"), started=f"{NOW}T10:00:00+00:00")


def with_conditions(session: Session, **conditions: str) -> Session:
    named = {name.replace("_", " "): condition for name, condition in conditions.items()}
    recordings = tuple(replace(one, condition=named.get(one.name, "")) for one in session.recordings)
    return replace(session, recordings=recordings)


@cache
def analysis() -> Analysis:
    return analysis_of(session())


@pytest.fixture
def page(qtbot: QtBot, shared_page: ResultPage) -> ResultPage:
    page = shared_page
    page.set_room(1064, 672)
    page.set_has_visits(True)
    page.show_visit(AnalysedVisit(session(), analysis()))
    page.resize(1064, 672)
    show(page, "walk 1")
    page.view.choose(ANSWER)
    with qtbot.waitActive(page):
        page.show()
        page.activateWindow()
    return page


def show(page: ResultPage, recording: str) -> None:
    page.recordings.setCurrentIndex(page.recordings.findData(recording))


def choose(page: ResultPage, thin: ThinLine | str) -> None:
    page.thin.setCurrentIndex(page.thin.findData(thin))


def offered(page: ResultPage) -> list[str]:
    return [page.thin.itemText(row) for row in range(page.thin.count())]


def return_to(page: ResultPage, *analyses: Analysis, is_read: bool = True) -> list[WalkedVisit]:
    """Show the last of three visits with these analyses, each of the same two walks."""
    walked = [
        WalkedVisit(str(day), one, session().recordings, day) for day, one in zip(VISITS, analyses[-3:], strict=False)
    ]
    course = tuple(
        CourseVisit(UUID(int=number), one.day, course_of(one.analysis, one.recordings))
        for number, one in enumerate(walked)
        if one.day is not None
    )
    page.show_visit(AnalysedVisit(session(), analyses[-1]), course=course)
    show(page, "walk 1")
    if is_read:
        page.show_visits(visits_by_condition(walked), conditions_in_words(walked))
    return walked


def words_beside(page: ResultPage) -> list[str]:
    return [frame.beside.text() if frame.beside.isVisible() else "" for frame in page.cycles.charts.frames]


def thin_curves(page: ResultPage) -> dict[Side, np.ndarray]:
    return {curve.side: curve.angle_deg for curve in page.cycles.charts.knee.chart.described.beside}


def test_at_a_first_visit_another_walk_is_offered_and_nothing_is_drawn(page: ResultPage) -> None:
    assert offered(page) == ["B AFO", "No thin line"]
    assert page.thin.currentData() is ThinLine.NOTHING
    assert thin_curves(page) == {}
    show(page, "walk 2")
    assert offered(page) == ["A shoes", "No thin line"]


def test_a_first_visit_of_one_walk_has_no_choice_of_a_thin_line(page: ResultPage) -> None:
    alone = tuple(one for one in analysis().recordings if one.name != "walk 2")
    page.show_visit(AnalysedVisit(session(), replace(analysis(), recordings=alone)))
    assert not page.thin.isVisible()
    QTest.keyClick(page.legs, Qt.Key.Key_T)
    assert page.thin.currentData() is ThinLine.NOTHING
    assert thin_curves(page) == {}


def test_the_last_visit_is_drawn_unless_the_headline_is_of_another(page: ResultPage) -> None:
    less = with_more(analysis(), Side.LEFT, "knee_stance_to_swing_rad", -25.0)
    return_to(page, analysis(), analysis(), analysis())
    assert offered(page) == ["Last visit, 1 Sep", "First visit, 1 Jul", "B AFO", "No thin line"]
    assert page.thin.currentData() is ThinLine.LAST_VISIT
    return_to(page, less, analysis(), analysis())
    assert "since 1 Jul" in page.headline.text
    assert page.thin.currentData() is ThinLine.FIRST_VISIT
    return_to(page, less, less, analysis())
    assert "since 1 Sep" in page.headline.text
    assert page.thin.currentData() is ThinLine.LAST_VISIT
    assert set(thin_curves(page)) == set(Side)  # nobody is affected


def test_the_cursor_stays_where_somebody_put_it_when_the_thin_line_changes(page: ResultPage) -> None:
    return_to(page, analysis(), analysis(), analysis())
    page.legs.show_percent(20.0)
    choose(page, ThinLine.FIRST_VISIT)
    choose(page, ThinLine.NOTHING)
    choose(page, "walk 2")
    assert page.legs.percent == 20.0
    show(page, "walk 2")  # its cursor is where its curves count
    assert page.legs.percent != 20.0


def test_what_somebody_chose_stays_when_another_walk_is_shown(page: ResultPage) -> None:
    return_to(page, analysis(), analysis(), analysis())
    choose(page, ThinLine.FIRST_VISIT)
    show(page, "walk 2")
    assert page.thin.currentData() is ThinLine.FIRST_VISIT
    choose(page, ThinLine.NOTHING)
    show(page, "walk 1")
    assert page.thin.currentData() is ThinLine.NOTHING
    return_to(page, analysis(), analysis(), analysis())  # another session: nobody chose there
    assert page.thin.currentData() is ThinLine.LAST_VISIT


def test_t_takes_the_thin_line_away_and_brings_it_back(page: ResultPage) -> None:
    return_to(page, analysis(), analysis(), analysis())
    choose(page, ThinLine.FIRST_VISIT)
    drawn = thin_curves(page)
    QTest.keyClick(page.legs, Qt.Key.Key_T)
    assert page.thin.currentData() is ThinLine.NOTHING
    assert thin_curves(page) == {}
    QTest.keyClick(page.legs, Qt.Key.Key_T)
    assert page.thin.currentData() is ThinLine.FIRST_VISIT
    assert set(thin_curves(page)) == set(drawn)


def test_with_the_line_go_its_legs(page: ResultPage) -> None:
    return_to(page, analysis(), analysis(), analysis())
    assert set(page.legs.picture.thin) == set(Side)
    for bend in page.legs.picture.thin.values():
        np.testing.assert_allclose(bend.knee_deg, 0.0, atol=1e-9)  # as it was then
    choose(page, ThinLine.NOTHING)
    assert page.legs.picture.thin == {}


def test_the_affected_leg_alone_has_a_thin_line(page: ResultPage) -> None:
    affected = replace(analysis(), affected_side=Side.LEFT)
    return_to(page, affected, affected, affected)
    assert set(thin_curves(page)) == {Side.LEFT}


def test_the_other_walk_is_drawn_thin_and_named(page: ResultPage) -> None:
    chart = page.cycles.charts.knee.chart
    choose(page, "walk 2")
    other = walks_alone(analysis(), session().recordings)["walk 2"]
    assert [curve.side for curve in chart.described.beside] == list(Side)
    for curve in chart.described.beside:
        assert np.allclose(curve.angle_deg, other.cycle(Joint(f"{curve.side}_knee")).mean)
    assert page.cycles.charts.knee.key.words.thin == "B AFO"
    assert "Thin line: B AFO." in chart.accessibleDescription()
    choose(page, ThinLine.NOTHING)
    assert (chart.described.beside, words_beside(page)) == ((), ["", ""])
    assert page.cycles.charts.knee.key.words.thin == ""


def test_single_strides_are_chosen_without_a_thin_line(page: ResultPage) -> None:
    choose(page, "walk 2")
    page.view.choose(STRIDES)
    assert thin_curves(page) == {}
    assert words_beside(page) == ["", ""]


def test_the_thin_line_changes_no_sentence_tile_or_row(page: ResultPage) -> None:
    """It is drawn; what is compared by numbers is in the view of comparisons."""

    def stated() -> tuple[str, list[object], str]:
        return page.headline.text, [one.tile for one in page.tiles.tiles], page.differs.table.as_text()

    before = stated()
    choose(page, "walk 2")
    assert stated() == before


def test_a_long_name_of_a_walk_leaves_the_page_as_narrow_as_it_was(page: ResultPage) -> None:
    long = with_conditions(session(), walk_1="shoes", walk_2="AFO with a carbon spring and a wedge of eight degrees")
    page.show_visit(AnalysedVisit(long, analysis()))
    show(page, "walk 1")
    choose(page, "walk 2")
    settle()
    assert page.minimumSizeHint().width() <= 1064
    assert page.cycles.charts.knee.key.words.thin.startswith("B AFO")


def test_a_not_reported_joint_has_no_thin_curve_and_no_difference(page: ResultPage) -> None:
    gated = recalibrated(analysis(), [Joint.LEFT_KNEE], axis_sd_rad=np.deg2rad(11.0))
    page.show_visit(AnalysedVisit(session(), gated))
    show(page, "walk 1")
    choose(page, "walk 2")
    _, ankle = page.cycles.charts.frames
    assert set(thin_curves(page)) == {Side.RIGHT}
    assert words_beside(page) == ["L: not reported in B AFO.", ""]
    assert [curve.side for curve in ankle.chart.described.beside] == list(Side)
    assert set(page.legs.picture.thin) == {Side.RIGHT}
    alone = walks_alone(gated, session().recordings)
    found = beside_walk(alone["walk 1"], alone["walk 2"], is_simulated=True)
    assert not any(row.is_reported for row in found.rows if row.measure.kind == "knee" and row.side is Side.LEFT)


def test_without_a_common_zero_shapes_are_laid_over_one_another_and_that_is_stated(page: ResultPage) -> None:
    other = recalibrated(analysis(), [Joint.LEFT_KNEE], zero=ZeroKind.GONIOMETER)
    return_to(page, analysis(), other, analysis())
    assert page.thin.currentData() is ThinLine.LAST_VISIT
    knee, ankle = words_beside(page)
    assert knee == "No common standing reference: compare range of motion and curve shape, not absolute angles."
    assert ankle == ""
    assert page.cycles.charts.knee.chart.is_about_mean
    for curve_deg in thin_curves(page).values():
        assert np.mean(curve_deg) == pytest.approx(0.0, abs=1e-9)
    assert set(page.legs.picture.thin) == {Side.RIGHT}  # the left knee cannot be laid beside itself


def test_earlier_visits_are_asked_for_once_and_come_when_they_are_read(qtbot: QtBot, page: ResultPage) -> None:
    with qtbot.waitSignal(page.compare.visits_requested):
        walked = return_to(page, analysis(), analysis(), analysis(), is_read=False)
    assert (thin_curves(page), words_beside(page)) == ({}, ["", ""])  # nobody waits for them
    with qtbot.assertNotEmitted(page.compare.visits_requested):
        choose(page, ThinLine.NOTHING)
        choose(page, ThinLine.LAST_VISIT)
    page.show_visits(visits_by_condition(walked), conditions_in_words(walked))
    assert set(thin_curves(page)) == set(Side)


def test_earlier_visits_that_never_came_are_asked_for_again_with_the_next_results(
    qtbot: QtBot, page: ResultPage
) -> None:
    return_to(page, analysis(), analysis(), analysis(), is_read=False)  # and the library refused
    with qtbot.waitSignal(page.compare.visits_requested):
        return_to(page, analysis(), analysis(), analysis(), is_read=False)


def test_a_visit_is_compared_by_its_condition_and_by_the_error_between_visits() -> None:
    older = with_conditions(session(), walk_1="AFO", walk_2="shoes")
    visits = visits_by_condition(
        [
            WalkedVisit("2026-05-01", analysis(), session().recordings),
            WalkedVisit("2026-06-20", analysis(), older.recordings),
            WalkedVisit("2026-11-14", analysis(), session().recordings),
        ]
    )
    shown = walks_alone(analysis(), session().recordings)["walk 1"]
    for is_first, name in ((False, "walk 2"), (True, "walk 1")):  # what was walked in shoes then
        found = beside_visit(shown, "shoes", visits, is_first=is_first, is_simulated=True)
        assert found is not None
        assert [walk.name for walk in found.against.walks] == [name]
        assert {found.error_kind(part) for part in found.others} == {ComparisonKind.VISITS}
    assert beside_visit(shown, "stick", visits, is_first=False, is_simulated=True) is None


def test_an_earlier_visit_without_this_curve_is_named(page: ResultPage) -> None:
    walked = return_to(page, analysis(), analysis(), analysis(), is_read=False)
    older = with_conditions(session(), walk_1="stick", walk_2="AFO")
    changed = [WalkedVisit(one.name, one.analysis, older.recordings, one.day, one.agreed) for one in walked[:-1]]
    page.show_visits(visits_by_condition([*changed, walked[-1]]), conditions_in_words(walked))
    assert words_beside(page) == ["The earlier visit has no curve in this condition."] * 2
    assert thin_curves(page) == {}


def test_a_leg_that_the_other_walk_has_not_measured_is_named(page: ResultPage) -> None:
    walk = next(one for one in analysis().recordings if one.name == "walk 2")
    gait = walk.gait[Side.LEFT]
    cycles = dict(gait.cycles)
    del cycles[Joint.LEFT_KNEE]
    bare = replace(walk, gait={**walk.gait, Side.LEFT: replace(gait, cycles=cycles)})
    recordings = tuple(bare if one is walk else one for one in analysis().recordings)
    page.show_visit(AnalysedVisit(session(), replace(analysis(), recordings=recordings)))
    show(page, "walk 1")
    choose(page, "walk 2")
    assert words_beside(page) == ["L: not measured in B AFO.", ""]


def test_changes_on_the_curves_of_a_bench_are_of_the_movement_that_differs_most() -> None:
    alone = walks_alone(analysis(), session().recordings)
    rows = marked_rows(beside_walk(alone["walk 1"], alone["walk 2"], is_simulated=True), Side.LEFT)
    assert rows
    marked = [change_on_curve(row, row.side.letter, row.against.name) for row in rows.values()]
    assert all(one.more.endswith("than B AFO") for one in marked)
    same = beside_walk(alone["walk 1"], replace(alone["walk 1"], name="again"), is_simulated=True)
    assert marked_rows(same, Side.LEFT) == {}
