"""Hips on the results page: a third chart, its figures and its evidence; without a pelvis nothing of it is there."""

import math
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.results.result_page import ResultPage
from app.results.tools_row import ANSWER, COMPARE, STRIDES, WHOLE
from app.widgets.stride_list import HIP, KNEE
from app.widgets.table import CellTable
from core.body import Joint, Side, Site
from core.results import Analysis, RecordingAnalysis
from core.signal.reception import Reception
from core.verdicts.model import Verdict
from tests.app.hip_visits import hip_analysis, hip_visit
from tests.app.room import settle
from tests.core.hip.hip_sessions import rewalked, walk_of, with_hip

WIDE, WIZARD, COMPACT = (1280.0, 672.0), (1064.0, 672.0), (960.0, 472.0)
HIPS = (Joint.LEFT_HIP, Joint.RIGHT_HIP)


def show(page: ResultPage, analysis: Analysis) -> None:
    page.show_visit(hip_visit(analysis), can_choose=True)


def without_pelvis() -> Analysis:
    """The same walk, as six sensors report it."""

    def changed(walk: RecordingAnalysis) -> RecordingAnalysis:
        gait = {}
        for side, one in walk.gait.items():
            parameters = {k: v for k, v in one.parameters.items() if not k.startswith(("hip", "pelvis"))}
            cycles = {joint: cycle for joint, cycle in one.cycles.items() if not joint.is_hip}
            gait[side] = replace(one, parameters=parameters, cycles=cycles)
        received: dict[Site, Reception] = {
            site: found for site, found in walk.received.items() if site is not Site.PELVIS
        }
        return replace(walk, hips={}, pelvis=None, turns=(), gait=gait, received=received, leg_clock=None)

    return rewalked(hip_analysis(), changed)


@pytest.fixture
def page(qtbot: QtBot, shared_page: ResultPage) -> ResultPage:
    page = shared_page
    page.resize(1280, 700)
    page.set_room(*WIDE)
    page.leave_behind()
    show(page, hip_analysis())
    page.view.choose(ANSWER)
    with qtbot.waitActive(page):
        page.show()
        page.activateWindow()
    return page


def rows_of(table: CellTable) -> dict[str, list[str]]:
    rows = [line.split("\t") for line in table.as_text().split("\n")]
    return {row[0]: row[1:] for row in rows}


def test_the_hip_is_the_first_of_three_charts_with_its_verdicts(page: ResultPage) -> None:
    charts = page.cycles.charts
    assert charts.frames == (charts.hip, charts.knee, charts.ankle)
    assert charts.hip.isVisible()
    assert set(charts.hip.chart.cycles) == set(Side)
    assert charts.hip.chart.not_reported == {}
    assert "hip" not in page.headline.text.casefold()  # no difference of hips is judged


def test_a_not_reported_hip_has_a_panel_for_a_curve_and_the_door_names_it(page: ResultPage) -> None:
    show(page, with_hip(hip_analysis(), Joint.LEFT_HIP, margin=1.2))
    frame = page.cycles.charts.hip
    assert frame.chart.not_reported == {Side.LEFT: "1.20, required 1.50"}
    assert "Sensor positions could not be confirmed" in frame.not_reported[Side.LEFT]
    assert page.door.words.startswith("Left hip: not reported.")
    assert rows_of(page.cycles.hips.table)["Range of motion"][0] == "not reported"


def test_without_a_pelvis_nothing_of_hips_is_there(page: ResultPage) -> None:
    show(page, without_pelvis())
    assert page.cycles.charts.frames == (page.cycles.charts.knee, page.cycles.charts.ankle)
    page.all_figures.click()
    assert not page.cycles.hips.isVisible()
    page.all_figures.click()
    page.view.choose(WHOLE)
    assert not page.whole.charts.hip.isVisible()
    page.view.choose(ANSWER)
    page.door.click()
    assert page.quality.first.text() == "All four joints are reported."
    assert page.quality.hip_facts.isHidden()
    stated = " ".join([page.quality.in_order.text(), page.cycles.hips.note.text()])
    assert "hip" not in stated
    show(page, hip_analysis())
    assert page.cycles.charts.hip.isVisibleTo(page.cycles)


@pytest.mark.endurance
@pytest.mark.parametrize("room", [WIDE, WIZARD, (1150.0, 640.0)])
def test_no_view_is_higher_than_its_window(result_page: ResultPage, room: tuple[float, float]) -> None:
    page = result_page
    page.resize(1280, 700)
    page.set_room(*room)
    show(page, hip_analysis())
    page.show()

    def height() -> float:
        settle()
        layout = page.layout()
        assert layout is not None
        return layout.minimumHeightForWidth(round(room[0]))

    for view in (ANSWER, WHOLE, STRIDES, COMPARE):
        page.view.choose(view)
        assert height() <= room[1], view
    page.view.choose(ANSWER)
    page.show_legs.click()
    assert not page.legs.isVisible()
    assert height() <= room[1]


def test_the_summary_with_three_charts_fits_the_smallest_window(page: ResultPage) -> None:
    page.set_room(*COMPACT)
    show(page, hip_analysis())
    layout = page.layout()
    assert layout is not None
    assert layout.minimumHeightForWidth(round(COMPACT[0])) <= COMPACT[1]
    assert [frame.isVisible() for frame in page.cycles.charts.frames] == [True] * 3


def test_every_stride_shows_its_hip(page: ResultPage) -> None:
    page.view.choose(STRIDES)
    table = page.strides.list
    assert not table.isColumnHidden(HIP)
    gait = walk_of(hip_analysis()).gait[Side.LEFT]
    first = int(np.flatnonzero(gait.strides.is_used)[0])
    assert f"{np.rad2deg(gait.parameters['hip_range_rad'][first]):.1f}" in table.as_text()
    show(page, without_pelvis())
    assert table.isColumnHidden(HIP)
    assert not table.isColumnHidden(KNEE)


def test_the_whole_walk_has_three_lanes(page: ResultPage) -> None:
    page.view.choose(WHOLE)
    assert page.whole.charts.hip.isVisible()
    hip = walk_of(hip_analysis()).hips[Joint.LEFT_HIP]
    drawn = page.whole.charts.hip.chart.curves[Side.LEFT].angle_deg
    np.testing.assert_allclose(drawn, np.rad2deg(hip.angle_rad))


def test_figures_of_hip_and_pelvis_have_a_card_that_states_what_is_not_reported(page: ResultPage) -> None:
    page.all_figures.click()
    assert page.cycles.hips.isVisible()
    rows = rows_of(page.cycles.hips.table)
    assert rows["Obliquity, range"][0][0].isdigit()
    assert rows["Tilt, range"][0] == "not reported"
    assert "cannot be distinguished from measurement error" in page.cycles.hips.note.text()
    assert not [name for name in rows if "otation" in name and "ip" in name.split(",")[0]]


def test_behind_q_stand_six_joints_the_pelvis_and_how_each_hip_was_found(page: ResultPage) -> None:
    page.focus()
    QTest.keyClick(page, Qt.Key.Key_Q)
    quality = page.quality
    assert quality.first.text() == "All six joints are reported."
    assert "from hip movement: the right leg was 40 ms late, ± 5 ms" in quality.in_order.text()
    quality.engineering.click()
    assert quality.hip_facts.isVisible()
    stated = quality.figure.accessibleDescription().casefold() + quality.figure.accessibleName().casefold()
    assert "hip" in stated


def test_abduction_that_cannot_be_read_is_a_line_and_no_joint_is_not_reported(page: ResultPage) -> None:
    show(page, with_hip(hip_analysis(), *HIPS, heading_sd_rad=math.radians(7.0), is_3d=False))
    page.door.click()
    assert page.quality.first.text() == "All six joints are reported."
    (line,) = page.quality.lines
    assert line.where.startswith("Abduction of")
    assert line.verdict is Verdict.NOT_REPORTED


def test_the_legs_have_a_pelvis_where_it_can_be_read(page: ResultPage) -> None:
    def has_pelvis() -> bool:
        legs = page.legs.picture.legs
        return legs is not None and legs.tilt_rad is not None

    drawn = page.legs.picture.grab().toImage()
    found = [has_pelvis()]
    show(page, with_hip(hip_analysis(), *HIPS, margin=1.2))
    found.append(has_pelvis())
    assert found == [True, False]
    assert page.legs.picture.grab().toImage() != drawn
