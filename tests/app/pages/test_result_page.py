"""A walk as its mean cycle or as a whole: which views there are, their keys, and the words and figures beside them."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit
from pytestqt.qtbot import QtBot

from app.pages.cycle_page import FASTER, NO_SPEED, SLOWER
from app.pages.result_page import FACTS, FIGURES, MEAN, WHOLE, ResultPage
from app.reports.gait_csv import parameter
from app.theme import Look, load_fonts
from core.analysis import analyse
from core.body import Joint, Side
from core.gait.strides import Reason
from core.results import Analysis, RecordingAnalysis, SideGait
from devices.walker import DEMONSTRATION, FreeMotion, Standing, Walk, simulate

WIDE, COMPACT = (1280.0, 672.0), (960.0, 472.0)  # of a window of 1280 x 800 and of 960 x 600 without a rail


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    recordings = (Standing(), FreeMotion(), Walk(strides=13, speed_m_s=0.95))
    return analyse(simulate(replace(DEMONSTRATION, recordings=recordings)).session)


@pytest.fixture
def page(qtbot: QtBot, qapp: QApplication, analysis: Analysis) -> Iterator[ResultPage]:
    load_fonts()
    look = Look()
    look.set_dark(False)
    page = ResultPage(look)
    qtbot.addWidget(page)
    page.resize(1280, 700)
    page.set_room(*WIDE)
    page.show_analysis(analysis)
    with qtbot.waitActive(page):
        page.show()
        page.activateWindow()
    yield page
    qapp.setStyleSheet("")


def changed(analysis: Analysis, gait: Mapping[Side, SideGait]) -> Analysis:
    """Give the analysis with another gait in its walk."""
    recordings = [replace(r, gait=gait) if r.gait else r for r in analysis.recordings]
    return replace(analysis, recordings=tuple(recordings))


def walk_of(analysis: Analysis) -> RecordingAnalysis:
    (walk,) = (recording for recording in analysis.recordings if recording.gait)
    return walk


def at_speed(analysis: Analysis, speed_m_s: float) -> Analysis:
    """Give the analysis of a walk whose strides were as long as that speed makes them."""
    gait = {}
    for side, found in walk_of(analysis).gait.items():
        strides = replace(found.strides, length_m=speed_m_s * found.strides.time_s)
        gait[side] = replace(found, strides=strides)
    return changed(analysis, gait=gait)


def with_used(analysis: Analysis, count: int) -> Analysis:
    gait = {}
    for side, found in walk_of(analysis).gait.items():
        reason = (Reason.USED,) * count + (Reason.TURN,) * (len(found.strides) - count)
        gait[side] = replace(found, strides=replace(found.strides, reason=reason))
    return changed(analysis, gait=gait)


def rows_of(page: ResultPage) -> dict[str, list[str]]:
    rows = [line.split("\t") for line in page.cycles.peaks.table.as_text().split("\n")]
    rows += [line.split("\t") for line in page.cycles.time_distance.table.as_text().split("\n")]
    return {row[0]: row[1:] for row in rows}


def test_a_walk_opens_as_its_mean_cycle(page: ResultPage) -> None:
    assert page.view.choice == MEAN
    assert page.cycles.isVisible()
    assert page.cycles.peaks.isVisible()
    assert page.cycles.time_distance.isVisible()
    assert page.findings.isVisible()
    assert not page.charts.isVisible()
    assert set(page.cycles.charts.knee.chart.cycles) == set(Side)


def test_the_whole_walk_has_its_lanes_and_its_methods(page: ResultPage) -> None:
    page.view.choose(WHOLE)
    assert page.charts.phases.isVisible()
    assert page.methods.isVisible()
    assert page.facts.isVisible()
    assert not page.single_strides.isVisible()
    assert not page.cycles.peaks.isVisible()


def test_free_motion_is_shown_whole_and_the_walk_comes_back_as_it_was_left(page: ResultPage) -> None:
    page.recordings.setCurrentIndex(page.recordings.findText("free motion"))
    assert page.view.choice == WHOLE
    assert not page.view.isVisible()
    assert not page.charts.phases.isVisible()
    page.recordings.setCurrentIndex(page.recordings.findText("walk 1"))
    assert page.view.choice == MEAN
    assert page.view.isVisible()


def test_a_walk_without_strides_says_so_and_shows_the_whole(page: ResultPage, analysis: Analysis) -> None:
    page.show_analysis(changed(analysis, gait={}))
    assert page.view.choice == WHOLE
    assert page.view._segments[MEAN].accessibleName() == "Mean cycle, no strides"
    page.show_analysis(analysis)
    assert page.view.choice == MEAN


def test_where_room_is_short_figures_and_findings_are_views(page: ResultPage) -> None:
    page.set_room(*COMPACT)
    assert not page.cycles.peaks.isVisible()
    assert not page.findings.isVisible()
    assert page.cycles.note.isVisible()
    page.view.choose(FIGURES)
    assert page.cycles.peaks.isVisible()
    assert page.cycles.time_distance.isVisible()
    assert not page.cycles.isVisible()
    page.view.choose(FACTS)
    assert page.facts.isVisible()
    assert page.findings.isVisible()
    page.set_room(*WIDE)
    assert page.view.choice == MEAN
    assert page.view._segments[FACTS].isHidden()


def test_keys_switch_single_strides_and_band_while_they_are_in_sight(qtbot: QtBot, page: ResultPage) -> None:
    page.focus()
    QTest.keyClick(page, Qt.Key.Key_S)
    assert page.single_strides.isChecked()
    assert page.cycles.charts.knee.chart.has_strides
    QTest.keyClick(page, Qt.Key.Key_B)
    assert not page.cycles.charts.ankle.chart.has_band
    page.view.choose(WHOLE)
    QTest.keyClick(page, Qt.Key.Key_S)
    assert page.single_strides.isChecked()


def test_a_letter_typed_into_a_field_stays_there(qtbot: QtBot, page: ResultPage) -> None:
    field = QLineEdit(page)
    field.show()
    field.setFocus()
    QTest.keyClick(field, Qt.Key.Key_S)
    assert field.text() == "s"
    assert not page.single_strides.isChecked()


def test_the_tables_hold_the_figures_of_the_strides_used(page: ResultPage, analysis: Analysis) -> None:
    gait = walk_of(analysis).gait[Side.RIGHT]
    used = gait.strides.is_used
    peaks = parameter(gait, "knee_swing_peak_deg")[used]
    stance = gait.strides.stance_percent[used]
    rows = rows_of(page)
    assert rows["Swing peak"][1] == f"{np.mean(peaks):.1f} ± {np.std(peaks, ddof=1):.1f}"
    assert rows["Stance %"][1] == f"{np.mean(stance):.1f} ± {np.std(stance, ddof=1):.1f}"
    assert rows["Swing peak"][2] == "59 to 66"
    assert rows["Range"][2] == ""
    assert rows[""][1] == f"R, {np.count_nonzero(used)} strides"


def test_under_ten_strides_no_spread_is_shown_and_under_three_the_mean_is_grey(
    page: ResultPage, analysis: Analysis
) -> None:
    model = page.cycles.peaks.table.figures
    for count, has_spread, is_grey in ((10, True, False), (9, False, False), (2, False, True)):
        page.show_analysis(with_used(analysis, count))
        swing = next(k for k, row in enumerate(model.rows) if not isinstance(row, str) and row.name == "Swing peak")
        cell = model.index(swing, 1)
        assert ("±" in model.cell(cell)[1]) is has_spread, count
        assert model.is_grey(cell) is is_grey, count
    assert "L and R: under 3 strides" in page.cycles.peaks.note.text()


def test_a_cell_is_heard_with_its_joint_side_and_unit(page: ResultPage) -> None:
    model = page.cycles.peaks.table.figures
    said = [
        str(model.data(model.index(row, column), Qt.ItemDataRole.AccessibleTextRole))
        for row in range(model.rowCount())
        for column in range(1, 4)
    ]
    assert any(text.startswith("Knee swing peak, left: ") and text.endswith("°") for text in said)
    assert "Knee swing peak, reference band: 59 to 66 °" in said
    times = page.cycles.time_distance.table.figures
    cadence = str(times.data(times.index(1, 1), Qt.ItemDataRole.AccessibleTextRole))
    assert cadence.startswith("Cadence, both sides: ")
    assert cadence.endswith(" steps/min")


def test_the_source_of_the_band_and_both_speeds_are_printed(page: ResultPage) -> None:
    told = page.cycles.peaks_note.text
    for part in ("24 young adults", "treadmill", "1.25 m/s", "Fukuchi", "2018", "This walk: 0.9"):
        assert part in told
    assert "34 of 42 adults, 24 young and 18 older" in page.cycles.time_distance.note.text()


def test_a_speed_unlike_the_bands_is_pointed_out(page: ResultPage, analysis: Analysis) -> None:
    for speed_m_s, words in ((0.9, SLOWER), (1.245, None), (1.6, FASTER)):
        page.show_analysis(at_speed(analysis, speed_m_s))
        told = page.cycles.peaks_note.text
        assert f"This walk: {speed_m_s:.2f} m/s." in told
        assert [one for one in (SLOWER, FASTER) if one in told] == ([] if words is None else [words])
        assert page.cycles.peaks_note._mark.isVisible() is (words is not None)
    page.show_analysis(at_speed(analysis, np.nan))
    assert NO_SPEED in page.cycles.peaks_note.text


def test_the_same_doubt_stands_in_chart_and_table(page: ResultPage, analysis: Analysis) -> None:
    gait = walk_of(analysis).gait
    doubted = replace(gait[Side.LEFT], sign_in_doubt=frozenset({Joint.LEFT_KNEE}))
    page.show_analysis(changed(analysis, gait={**gait, Side.LEFT: doubted}))
    assert page.cycles.charts.knee.note.startswith("L: sign unsure.")
    assert rows_of(page)["Swing peak"][0] == "sign unsure"
    assert "sign unsure" not in rows_of(page)["Swing peak"][1]


def test_one_side_alone_has_its_column_alone(page: ResultPage, analysis: Analysis) -> None:
    page.show_analysis(changed(analysis, gait={Side.RIGHT: walk_of(analysis).gait[Side.RIGHT]}))
    table = page.cycles.peaks.table
    assert table.isColumnHidden(1)
    assert not table.isColumnHidden(2)
    assert set(page.cycles.charts.knee.chart.cycles) == {Side.RIGHT}
    assert page.charts.phases.lanes.lanes.keys() == {Side.RIGHT}
