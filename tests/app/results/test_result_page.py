"""A walk as its mean cycle or as a whole: which views there are, their keys, and the words and figures beside them."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QAccessible
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLineEdit
from pytestqt.qtbot import QtBot

from app.results.cycle_page import NO_SIDE, NO_SPEED
from app.results.result_page import ResultPage
from app.results.tools_row import ANSWER, COMPARE, STRIDES, WHOLE
from app.summary.reference_bands import NOBODY, OTHER_AGES, WHY_NO_BAND
from app.widgets.table import CellTable
from app.widgets.table_cells import TextCell
from core.body import LEG_JOINTS, Joint, Side
from core.results import Analysis, SideGait, ZeroKind
from core.session import Session
from core.verdicts.model import Verdict
from core.verdicts.norms import AgeAndHeight, NoBand
from core.verdicts.quantities import raw_values
from tests.app.accessibility.accessible_tree import elements, wrong_hearing
from tests.app.changed_analysis import recalibrated, rewalked, visit_of, walk_of, with_few_strides
from tests.app.reports.patient.test_what_stands_out import with_more
from tests.simulated import SLOW_WALK, analysis_of, session_of

GROWN = AgeAndHeight(30, 1.70)
WIDE, COMPACT = (1280.0, 672.0), (960.0, 472.0)  # of a window of 1280 x 800 and of 960 x 600 without a rail


@cache
def session() -> Session:
    return session_of(SLOW_WALK)


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    return analysis_of(session())


def show(page: ResultPage, analysis: Analysis, who: AgeAndHeight = NOBODY) -> None:
    page.show_visit(visit_of(analysis, session(), who))


@pytest.fixture
def page(qtbot: QtBot, shared_page: ResultPage, analysis: Analysis) -> ResultPage:
    shared_page.leave_behind()
    opened(shared_page, qtbot, analysis)
    shared_page.view.choose(ANSWER)
    return shared_page


@pytest.fixture
def own_page(qtbot: QtBot, result_page: ResultPage, analysis: Analysis) -> ResultPage:
    """A page whose legs are chosen: from then on no room changes that."""
    return opened(result_page, qtbot, analysis)


def opened(page: ResultPage, qtbot: QtBot, analysis: Analysis) -> ResultPage:
    page.resize(1280, 700)
    page.set_room(*WIDE)
    show(page, analysis)
    with qtbot.waitActive(page):
        page.show()
        page.activateWindow()
    return page


def changed(analysis: Analysis, gait: Mapping[Side, SideGait]) -> Analysis:
    """Give the analysis with another gait in its walk."""
    return rewalked(analysis, gait=gait)


def at_speed(analysis: Analysis, speed_m_s: float) -> Analysis:
    """Give the analysis of a walk whose strides were as long as that speed makes them."""
    gait = {}
    for side, found in walk_of(analysis).gait.items():
        length_m = speed_m_s * found.strides.time_s
        parameters = {**found.parameters, "stride_length_m": length_m, "speed_m_s": length_m / found.strides.time_s}
        gait[side] = replace(found, strides=replace(found.strides, length_m=length_m), parameters=parameters)
    return changed(analysis, gait=gait)


def with_prostheses(analysis: Analysis, *sides: Side) -> Analysis:
    gait = {side: replace(found, is_toe_off_biased=side in sides) for side, found in walk_of(analysis).gait.items()}
    return changed(analysis, gait=gait)


def rows_of(page: ResultPage) -> dict[str, list[str]]:
    rows = [line.split("\t") for line in page.cycles.peaks.table.as_text().split("\n")]
    rows += [line.split("\t") for line in page.cycles.time_distance.table.as_text().split("\n")]
    return {row[0]: row[1:] for row in rows}


def row_named(table: CellTable, name: str) -> int:
    return next(k for k, row in enumerate(table.cells.rows) if row.cells[0].words == name)


def test_a_walk_opens_with_headline_tiles_mean_cycle_legs_and_what_differs(page: ResultPage) -> None:
    assert page.view.choice == ANSWER
    for part in (page.headline, page.tiles, page.cycles, page.legs, page.differs, page.door):
        assert part.isVisible()
    assert page.differs.table.cells.rowCount() > 2
    assert not page.cycles.peaks.isVisible()
    assert not page.whole.charts.isVisible()
    assert set(page.cycles.charts.knee.chart.cycles) == set(Side)


def test_the_whole_walk_has_its_lanes_and_its_methods(page: ResultPage) -> None:
    page.view.choose(WHOLE)
    assert page.whole.charts.phases.isVisible()
    assert page.whole.methods.isVisible()
    for part in (page.headline, page.tiles, page.cycles, page.legs, page.differs):
        assert not part.isVisible()


def test_free_motion_is_shown_whole_and_the_walk_comes_back_as_it_was_left(page: ResultPage) -> None:
    page.recordings.setCurrentIndex(page.recordings.findText("free motion"))
    assert page.view.choice == WHOLE
    assert not page.view.isVisible()
    assert not page.whole.charts.phases.isVisible()
    page.recordings.setCurrentIndex(page.recordings.findText("walk 1"))
    assert page.view.choice == ANSWER
    assert page.view.isVisible()


def test_a_walk_without_strides_states_so_and_shows_the_whole(page: ResultPage, analysis: Analysis) -> None:
    show(page, changed(analysis, gait={}))
    assert page.view.choice == WHOLE
    assert page.view.segments[0].accessibleName() == "Summary, no strides"
    show(page, analysis)
    assert page.view.choice == ANSWER


def test_where_room_is_short_curves_and_table_are_shown_one_at_a_time_and_nothing_else_goes(page: ResultPage) -> None:
    page.set_room(*COMPACT)
    for part in (page.headline, page.tiles, page.part, page.cycles, page.door):
        assert part.isVisible()
    assert not page.differs.isVisible()
    page.part.segments[1].click()
    assert page.differs.isVisible()
    assert page.headline.isVisible()
    assert page.tiles.isVisible()
    assert not page.cycles.isVisible()
    page.set_room(*WIDE)
    assert not page.part.isVisible()
    assert page.cycles.isVisible()
    assert page.differs.isVisible()


def test_where_room_is_short_the_legs_take_the_ankles_place(own_page: ResultPage) -> None:
    page = own_page
    page.set_room(*COMPACT)
    assert not page.legs.isVisible()
    assert page.cycles.charts.ankle.isVisible()
    page.focus()
    QTest.keyClick(page, Qt.Key.Key_G)
    assert page.legs.isVisible()
    assert page.cycles.charts.knee.isVisible()
    assert not page.cycles.charts.ankle.isVisible()
    page.set_room(*WIDE)
    assert page.legs.isVisible()  # somebody chose them
    assert page.cycles.charts.ankle.isVisible()


def test_all_figures_take_the_curves_place_and_give_it_back(page: ResultPage) -> None:
    page.focus()
    QTest.keyClick(page, Qt.Key.Key_F)
    assert page.all_figures.isChecked()
    assert page.cycles.peaks.isVisible()
    assert page.cycles.time_distance.isVisible()
    assert not page.cycles.isVisible()
    page.view.choose(WHOLE)
    assert not page.cycles.peaks.isVisible()
    page.view.choose(ANSWER)
    QTest.keyClick(page, Qt.Key.Key_F)
    assert page.cycles.isVisible()
    assert not page.cycles.peaks.isVisible()


def test_the_door_leads_to_what_can_be_read_and_back(page: ResultPage, analysis: Analysis) -> None:
    assert page.door.words == "Data quality: good. 11 and 12 strides, sensors synchronised, no strap moved."
    page.focus()
    QTest.keyClick(page, Qt.Key.Key_Q)
    assert page.quality.isVisible()
    assert not page.cycles.isVisible()
    assert page.quality.first.text() == "All four joints are reported."
    assert page.leave_behind()
    assert page.cycles.isVisible()
    assert not page.leave_behind()
    show(page, recalibrated(analysis, [Joint.LEFT_ANKLE], axis_sd_rad=np.deg2rad(11.0)))
    assert page.door.words == "Left ankle: not reported. The calibration has an uncertainty of ±11.0° (limit ±9.0°)."
    page.door.click()
    assert page.quality.first.text() == "3 of 4 joints: Good. Not reported: left ankle."


def test_the_reference_goes_and_comes_back_by_its_key(page: ResultPage) -> None:
    page.focus()
    for has_band in (False, True):
        QTest.keyClick(page, Qt.Key.Key_B)
        assert [frame.chart.has_band for frame in page.cycles.charts.frames] == [has_band] * 2


def test_a_letter_typed_into_a_field_stays_there(qtbot: QtBot, page: ResultPage) -> None:
    field = QLineEdit(page)
    field.show()
    field.setFocus()
    QTest.keyClick(field, Qt.Key.Key_F)
    assert field.text() == "f"
    assert not page.all_figures.isChecked()
    field.deleteLater()


def test_the_tables_hold_the_figures_of_the_strides_used(page: ResultPage, analysis: Analysis) -> None:
    gait = walk_of(analysis).gait[Side.RIGHT]
    used = gait.strides.is_used
    peaks = raw_values(gait, "knee_swing_peak_deg")[used]
    stance = gait.strides.stance_percent[used]
    rows = rows_of(page)
    assert rows["Peak flexion, swing"][1] == f"{np.mean(peaks):.1f} ± {np.std(peaks, ddof=1):.1f}"
    assert rows["Stance %"][1] == f"{np.mean(stance):.1f} ± {np.std(stance, ddof=1):.1f}"
    assert rows["Peak flexion, swing"][2] == ""  # at 0.95 m/s the curves of 1.25 m/s are no comparison
    assert rows[""][1] == f"R, {np.count_nonzero(used)} strides"


def test_under_ten_strides_no_spread_is_shown_and_under_three_no_mean(page: ResultPage, analysis: Analysis) -> None:
    table = page.cycles.peaks.table
    for count, has_spread, words in ((10, True, ""), (9, False, "*"), (2, False, "not reported")):
        show(page, with_few_strides(analysis, left=count, right=count))
        cell = table.cells.rows[row_named(table, "Peak flexion, swing")].cells[1]
        assert isinstance(cell, TextCell)
        assert ("±" in cell.small) is has_spread, count
        assert cell.small.endswith(words), count
        assert bool(cell.text) is (count > 2), count
        assert ("°" in cell.spoken) is (count > 2), count  # a word has no unit
    assert "L and R: fewer than 3 strides, no mean." in page.cycles.peaks.note.text()


def test_a_cell_is_received_with_its_joint_side_and_unit(page: ResultPage) -> None:
    model = page.cycles.peaks.table.cells
    stated = [
        str(model.data(model.index(row, column), Qt.ItemDataRole.AccessibleTextRole))
        for row in range(model.rowCount())
        for column in range(1, 4)
    ]
    assert any(text.startswith("Knee peak flexion, swing, left: ") and text.endswith("°") for text in stated)
    assert "Knee peak flexion, swing, reference: no value" in stated
    times = page.cycles.time_distance.table.cells
    cadence = str(times.data(times.index(1, 1), Qt.ItemDataRole.AccessibleTextRole))
    assert cadence.startswith("Cadence, both sides: ")
    assert cadence.endswith(" steps/min")


def test_a_cell_to_be_read_with_care_states_so_to_who_receives_it(page: ResultPage, analysis: Analysis) -> None:
    show(page, recalibrated(analysis, [Joint.LEFT_KNEE], axis_sd_rad=np.deg2rad(8.0)))
    model = page.cycles.peaks.table.cells
    swing = row_named(page.cycles.peaks.table, "Peak flexion, swing")
    received = [str(model.data(model.index(swing, k), Qt.ItemDataRole.AccessibleTextRole)) for k in (1, 2)]
    assert received[0].endswith("°, caution")
    assert received[1].endswith("°")
    assert rows_of(page)["Peak flexion, swing"][0].endswith(" *")
    assert "*: caution." in page.cycles.peaks.note.text()
    assert page.cycles.charts.knee.key.words.legs == {Side.LEFT: Verdict.CARE, Side.RIGHT: Verdict.READ}
    assert page.door.words.startswith("Left knee: caution. The calibration has an uncertainty of ±8.0°")
    show(page, analysis)
    assert "caution" not in page.cycles.peaks.note.text() + page.door.words


def test_the_source_of_the_band_and_both_speeds_are_printed(page: ResultPage, analysis: Analysis) -> None:
    show(page, at_speed(analysis, 1.2), who=GROWN)
    reported = page.cycles.band_words
    for part in ("24 young adults", "treadmill", "1.25 m/s", "Fukuchi", "2018", "This walk: 1.20"):
        assert part in reported
    assert "32 of 42 adults, 24 young and 18 older" in page.cycles.time_distance.note.text()
    assert rows_of(page)["Peak flexion, swing"][2] == "59 to 66"
    assert rows_of(page)["Range of motion"][2] == ""


def test_a_band_is_drawn_only_where_it_may_stand_and_else_stated_why_not(page: ResultPage, analysis: Analysis) -> None:
    for speed_m_s, who, why in (
        (1.2, AgeAndHeight(30, 1.70), None),
        (1.2, AgeAndHeight(9, 1.30), NoBand.CHILD),
        (1.09, AgeAndHeight(30, None), NoBand.HEIGHT_MISSING),
        (0.9, AgeAndHeight(30, 1.70), NoBand.OTHER_SPEED),
        (1.6, AgeAndHeight(30, 1.70), NoBand.OTHER_SPEED),
        (np.nan, AgeAndHeight(30, 1.70), NoBand.SPEED_UNKNOWN),
    ):
        show(page, at_speed(analysis, speed_m_s), who=who)
        reported = page.cycles.band_words
        assert (page.cycles.charts.knee.chart.band is not None) is (why is None), speed_m_s
        assert [one for one, words in WHY_NO_BAND.items() if words in reported] == ([] if why is None else [why])
        assert (NO_SPEED in reported) is bool(np.isnan(speed_m_s))


def test_a_band_of_other_ages_states_so(page: ResultPage, analysis: Analysis) -> None:
    for age, is_other in ((30, False), (62, True)):
        show(page, at_speed(analysis, 1.2), who=AgeAndHeight(age, 1.7))
        assert (OTHER_AGES in page.cycles.band_words) is is_other


def test_a_prosthetic_leg_has_no_band(page: ResultPage, analysis: Analysis) -> None:
    walk = at_speed(analysis, 1.2)
    show(page, with_prostheses(walk, Side.RIGHT), who=GROWN)
    assert "The reference applies to the left leg only." in page.cycles.band_words
    show(page, with_prostheses(walk, *Side), who=GROWN)
    assert NO_SIDE in page.cycles.band_words
    assert page.cycles.charts.knee.chart.band is None
    show(page, walk, who=GROWN)
    assert "alone" not in page.cycles.band_words


def test_the_same_doubt_is_in_chart_and_table(page: ResultPage, analysis: Analysis) -> None:
    show(page, recalibrated(analysis, [Joint.LEFT_KNEE], is_sign_certain=False))
    assert page.cycles.charts.knee.note.startswith("L: it is unclear which direction is flexion.")
    assert rows_of(page)["Peak flexion, swing"][0] == "sign unclear"
    assert "sign unclear" not in rows_of(page)["Peak flexion, swing"][1]


def test_a_not_reported_ankle_has_no_number_and_no_curve_and_states_what_to_do(
    page: ResultPage, analysis: Analysis
) -> None:
    show(page, recalibrated(analysis, [Joint.RIGHT_ANKLE], is_same_joint=False, sign_margin=1.05))
    rows = rows_of(page)
    for name in ("Peak dorsiflexion, stance", "Peak plantarflexion, push-off", "Peak dorsiflexion, swing"):
        assert rows[name][1] == "not reported"
        assert rows[name][0] != "not reported"
    assert rows["Double support %"][0] == "not reported"
    not_reported = page.cycles.charts.ankle.not_reported
    assert list(not_reported) == [Side.RIGHT]
    assert not_reported[Side.RIGHT].startswith("Sensor positions could not be confirmed")
    assert "Sensor positions could not be confirmed" in page.door.words
    assert any("record free motion" in line.to_do for line in page.quality.lines)
    assert "Right ankle: Sensor positions could not be confirmed" in page.cycles.peaks.note.text()
    show(page, analysis)
    assert page.cycles.charts.ankle.not_reported == {}
    assert "Sensor positions" not in page.cycles.peaks.note.text()


def test_one_side_alone_has_its_column_alone(page: ResultPage, analysis: Analysis) -> None:
    show(page, changed(analysis, gait={Side.RIGHT: walk_of(analysis).gait[Side.RIGHT]}))
    table = page.cycles.peaks.table
    assert table.isColumnHidden(1)
    assert not table.isColumnHidden(2)
    assert set(page.cycles.charts.knee.chart.cycles) == {Side.RIGHT}
    assert page.whole.charts.phases.lanes.lanes.keys() == {Side.RIGHT}


def test_the_headline_is_over_the_mean_cycle_and_nothing_scrolls_for_it(page: ResultPage, analysis: Analysis) -> None:
    in_wizard = (1064.0, 672.0)  # of a window of 1280 x 800 with its rail
    page.set_room(*in_wizard)
    show(page, analysis)
    assert page.headline.text.startswith("Left and right are similar: knee 59° and 60° from stance to swing. L − R ")
    assert page.headline.text.endswith("° fits.")
    show(page, with_more(analysis, Side.LEFT, "knee_stance_to_swing_rad", -20.0))
    assert page.headline.text.startswith("Left knee flexes 39° from stance to swing, 21° less than the right.")
    assert page.minimumSizeHint().height() <= in_wizard[1]
    for view in (WHOLE, STRIDES):
        page.view.choose(view)
        assert not page.headline.isVisible(), view
    show(page, changed(analysis, gait={}))
    page.view.choose(WHOLE)
    assert page.headline.isVisible()
    assert page.headline.text.startswith("No results for this walk: no foot or shank sensor showed a stride")


def test_no_view_scrolls_in_the_windows_of_laptops(own_page: ResultPage, analysis: Analysis) -> None:
    page = own_page
    for room in ((1064.0, 672.0), (1150.0, 640.0)):  # of windows of 1280 x 800 and 1366 x 768
        page.set_room(*room)
        show(page, analysis)
        heights = []
        for view in (ANSWER, WHOLE, STRIDES, COMPARE, ANSWER):
            page.view.choose(view)
            heights.append(least_height(page, room[0]))
        assert page.legs.isVisible()
        page.show_legs.click()
        assert max(*heights, least_height(page, room[0])) <= room[1], (room, heights)
        page.show_legs.click()


def least_height(page: ResultPage, width: float) -> int:
    layout = page.layout()
    assert layout is not None
    return layout.minimumHeightForWidth(round(width))


def test_without_a_zero_marks_stand_on_the_curves_as_they_are_drawn(page: ResultPage, analysis: Analysis) -> None:
    """Their height was taken away twice."""
    found = with_more(analysis, Side.LEFT, "knee_stance_to_swing_rad", -20.0)
    for joints in (LEG_JOINTS, (Joint.RIGHT_KNEE,)):
        show(page, recalibrated(found, joints, zero=ZeroKind.NONE))
        chart = page.cycles.charts.knee.chart
        (marked,) = chart.deviations
        for point in marked.points:
            drawn = chart.cycles[point.joint.side].mean.mean
            assert point.angle_deg == pytest.approx(drawn[round(point.percent)], abs=1e-6), joints


def test_where_heights_alone_are_not_reported_no_joint_is_called_so(page: ResultPage, analysis: Analysis) -> None:
    show(page, recalibrated(analysis, LEG_JOINTS, zero=ZeroKind.NONE))
    assert page.door.words.startswith("Absolute angle of all joints: not reported.")
    show(page, recalibrated(analysis, LEG_JOINTS, is_same_joint=False, sign_margin=1.05))
    assert page.door.words.startswith("All joints: not reported.")


def test_that_a_living_joint_is_no_hinge_is_no_finding(page: ResultPage, analysis: Analysis) -> None:
    assert "not_a_hinge" in {finding.key for finding in analysis.findings}
    page.quality.engineering.click()
    stated = page.quality.findings.accessibleDescription()
    assert "simulated" in stated
    assert "more than one axis" not in stated


def test_legs_stand_beside_the_curves_each_at_the_cursors_percent_of_its_own_cycle(own_page: ResultPage) -> None:
    page = own_page
    page.legs.show_percent(72.0)
    knee = page.cycles.charts.knee.chart
    assert knee.readings == dict.fromkeys(Side, 72.0)
    QTest.keyClick(page.legs, Qt.Key.Key_Right)
    assert knee.readings == page.cycles.charts.ankle.chart.readings == dict.fromkeys(Side, 73.0)
    at = knee.at(30.0, 20.0).toPoint()
    QTest.mouseClick(knee, Qt.MouseButton.LeftButton, pos=at)
    assert page.legs.percent == pytest.approx(30.0, abs=1.0)
    page.show_legs.click()
    assert not page.legs.isVisible()
    assert knee.readings == {}
    page.show_legs.click()
    assert page.legs.percent == pytest.approx(30.0, abs=1.0)
    assert set(knee.readings) == set(Side)


def test_the_cursor_begins_at_the_headlines_instant_else_where_the_knee_is_bent_most(
    page: ResultPage, analysis: Analysis
) -> None:
    curve_deg = page.cycles.charts.knee.chart.cycles[Side.RIGHT].mean.mean
    assert page.headline.text.startswith("Left and right are similar")
    assert page.legs.percent == pytest.approx(np.argmax(curve_deg), abs=1.0)
    show(page, with_more(analysis, Side.LEFT, "ankle_push_off_rad", -25.0))
    (marked,) = page.cycles.charts.ankle.chart.deviations
    assert page.legs.percent == max(marked.points, key=lambda one: one.angle_deg).percent


def test_the_views_are_received_before_what_they_show_in_every_room(page: ResultPage) -> None:
    for room in (COMPACT, WIDE, (700.0, 600.0)):
        page.set_room(*room)
        for view in (ANSWER, COMPARE, WHOLE, STRIDES):
            page.view.choose(view)
            assert wrong_hearing(page) == []
            received = [one.name for one in elements(page)]
            assert received.index("View") == min(k for k, name in enumerate(received) if name)


def test_a_folded_part_is_reported_as_not_checked_and_is_received_only_unfolded(own_page: ResultPage) -> None:
    page = own_page
    page.show_legs.click()
    folds = {page.show_legs: page.legs, page.all_figures: page.cycles.peaks.table}
    folds[page.quality.engineering] = page.quality.facts
    for fold, part in folds.items():
        if fold is page.quality.engineering:
            page.door.click()
        for is_unfolded in (False, True, False):
            reported = elements(page)
            (toggle,) = (one for one in reported if (one.kind, one.name) == ("Toggle", fold.text()))
            assert (toggle.role, toggle.is_checked) == (QAccessible.Role.CheckBox, is_unfolded)
            named = (type(part).__name__, part.accessibleName())
            assert any((one.kind, one.name) == named for one in reported) is is_unfolded
            fold.click()
        fold.click()


def test_legs_are_drawn_where_room_came_after_the_walk(result_page: ResultPage, analysis: Analysis) -> None:
    """The wizard fills the page before it has a size."""
    result_page.set_room(0.0, 0.0)
    show(result_page, analysis)
    result_page.set_room(*WIDE)
    assert result_page.legs.picture.legs is not None
