"""Every stride is in a line, is left out and taken in again by key and mouse, and it is stated what was left out."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QColor
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.results.result_page import ResultPage
from app.results.tools_row import ANSWER, STRIDES
from app.summary.request import AnalysedVisit
from app.widgets.stride_list import ANKLE_SHAPE, KNEE_SHAPE, STATE, STRIDE, StrideLine
from core.body import Joint, Side
from core.gait.chosen_strides import leave_out
from core.results import Analysis
from core.session import Session
from tests.app.room import words_cut
from tests.simulated import LONG_WALK, analysis_of, session_of

Turned = list[tuple[str, StrideLine, bool]]


@pytest.fixture(scope="module")
def session() -> Session:
    return session_of(LONG_WALK)


@pytest.fixture(scope="module")
def analysis(session: Session) -> Analysis:
    return analysis_of(session)


@pytest.fixture
def page(qtbot: QtBot, shared_page: ResultPage, session: Session, analysis: Analysis) -> ResultPage:
    page = shared_page
    page.resize(1280, 700)
    page.set_room(1280.0, 672.0)
    page.show_visit(AnalysedVisit(session, analysis), can_choose=True)
    page.view.choose(STRIDES)
    with qtbot.waitActive(page):
        page.show()
        page.activateWindow()
    return page


@pytest.fixture
def turned(page: ResultPage) -> Turned:
    reported: Turned = []
    page.strides.turned.connect(lambda walk, line, is_left_out: reported.append((walk, line, is_left_out)))
    return reported


def without(session: Session, analysis: Analysis, line: StrideLine) -> Analysis:
    """The analysis, with one stride left out."""
    chosen = {line.side: ((line.start_s + line.end_s) / 2,)}
    return leave_out(analysis, [replace(one, left_out_s=chosen) for one in session.recordings if one.name == "walk 1"])


def first_used(page: ResultPage) -> int:
    return next(row for row, line in enumerate(page.strides.list.lines) if line.is_used)


def test_a_stride_is_left_out_by_key_and_by_mouse_and_stays_where_it_was(
    page: ResultPage, turned: Turned, session: Session, analysis: Analysis
) -> None:
    """Space, Enter, the mark and the button do the same; a click on the figures only looks at the stride."""
    strides = page.strides.list
    strides.setFocus()
    row = first_used(page)
    strides.choose(row)
    line = strides.line
    assert line is not None
    for key in (Qt.Key.Key_Space, Qt.Key.Key_Return):
        QTest.keyClick(strides, key)
    page.strides.turn.click()
    for column, count in ((STRIDE, 4), (STATE, 4)):
        at = strides.visualRect(strides.cells.index(row, column)).center()
        QTest.mouseClick(strides.viewport(), Qt.MouseButton.LeftButton, pos=at)
        assert len(turned) == count
    assert turned == [("walk 1", line, True)] * 4
    page.show_visit(AnalysedVisit(session, without(session, analysis, line)), can_choose=True)
    assert page.view.choice == STRIDES
    assert strides.hasFocus()
    assert strides.currentIndex().row() == row
    assert strides.line is not None
    assert strides.line.is_by_hand
    assert page.strides.turn.text() == "Include this stride"
    QTest.keyClick(strides, Qt.Key.Key_Space)
    assert turned[-1] == ("walk 1", strides.line, False)


@pytest.mark.endurance
def test_a_stride_that_cannot_be_used_cannot_be_turned(page: ResultPage, turned: Turned) -> None:
    """What was found to be wrong with a stride is not put right by a mark."""
    lines = page.strides.list.lines
    out = next(row for row, line in enumerate(lines) if not line.is_used)
    page.strides.list.choose(out)
    QTest.keyClick(page.strides.list, Qt.Key.Key_Space)
    assert turned == []
    assert not page.strides.turn.isEnabled()


@pytest.mark.endurance
def test_where_nothing_is_kept_nothing_can_be_left_out(
    page: ResultPage, turned: Turned, session: Session, analysis: Analysis
) -> None:
    """A session folder is looked at: nothing looks as if it could be pressed, and it is stated why."""
    strides = page.strides.list
    page.show_visit(AnalysedVisit(session, analysis))
    row = first_used(page)
    strides.choose(row)
    mark = strides.cells.index(row, STRIDE)
    without_boxes = strides.grab().toImage()
    QTest.keyClick(strides, Qt.Key.Key_Space)
    QTest.mouseClick(strides.viewport(), Qt.MouseButton.LeftButton, pos=strides.visualRect(mark).center())
    assert turned == []
    assert page.strides.turn.isHidden()
    assert strides.accessibleDescription() == ""
    assert mark.data(Qt.ItemDataRole.CheckStateRole) is None
    assert "Strides can be excluded only in the library" in page.strides.note.text()
    page.show_visit(AnalysedVisit(session, analysis), can_choose=True)
    assert not page.strides.turn.isHidden()
    assert mark.data(Qt.ItemDataRole.CheckStateRole) is not None
    assert strides.grab().toImage() != without_boxes


@pytest.mark.endurance
def test_the_stride_in_force_is_drawn_and_found_by_a_click_into_the_chart(page: ResultPage, analysis: Analysis) -> None:
    """Bold over all others while strides are chosen, and gone with that."""
    page.strides.list.choose(first_used(page) + 1)
    line = page.strides.list.line
    assert line is not None
    knee = page.cycles.charts.knee.chart
    (walk,) = (recording for recording in analysis.recordings if recording.gait)
    curve = np.rad2deg(walk.gait[Side.LEFT].cycles[Joint.LEFT_KNEE][line.number - 1])
    assert knee.stride is not None
    np.testing.assert_array_equal(knee.stride[1], curve)
    page.strides.list.choose(len(page.strides.list.lines) - 2)
    at = knee.at(70, float(curve[70])).toPoint()
    QTest.mouseClick(knee, Qt.MouseButton.LeftButton, pos=QPoint(at.x(), at.y()))
    found = page.strides.list.line
    assert found is not None
    nearest = np.rad2deg(walk.gait[found.side].cycles[Joint(f"{found.side}_knee")][found.number - 1])
    assert abs(nearest[70] - curve[70]) < 1.0
    page.view.choose(ANSWER)
    assert knee.stride is None


def test_what_was_left_out_by_hand_is_stated_wherever_figures_stand(
    page: ResultPage, session: Session, analysis: Analysis
) -> None:
    """Under the charts, under both tables, under the list and in the comparison."""
    page.strides.list.choose(first_used(page))
    line = page.strides.list.line
    assert line is not None
    found = without(session, analysis, line)
    (walk,) = (recording for recording in found.recordings if recording.gait)
    stated = f"1 of {len(walk.gait[Side.LEFT].strides)} left strides excluded by hand."
    page.show_visit(AnalysedVisit(session, found), can_choose=True)
    assert page.strides.note.text() == stated
    assert not page.cycles.by_hand.isVisible()
    page.view.choose(ANSWER)
    assert page.cycles.by_hand.isVisible()
    assert page.cycles.by_hand.text() == stated
    assert stated in page.cycles.time_distance.note.text()
    assert "excluded by hand" in page.cycles.peaks.note.text()
    assert stated in page.compare.conclusion.text()
    page.show_visit(AnalysedVisit(session, analysis), can_choose=True)
    assert page.cycles.by_hand.text() == ""
    assert not page.cycles.by_hand.isVisible()


def test_without_room_for_charts_every_line_draws_its_own_curves(page: ResultPage, analysis: Analysis) -> None:
    """Whoever chooses sees what is chosen, in the smallest window, too."""
    strides = page.strides.list
    shapes = (KNEE_SHAPE, ANKLE_SHAPE)
    assert page.cycles.isVisible()
    assert all(strides.isColumnHidden(shape) for shape in shapes)
    page.set_room(736.0, 432.0)
    page.resize(736, 550)
    QApplication.processEvents()
    assert not page.cycles.isVisible()
    assert not any(strides.isColumnHidden(shape) for shape in shapes)
    (walk,) = (recording for recording in analysis.recordings if recording.gait)
    row = first_used(page)
    line = strides.lines[row]
    for shape, joint in zip(shapes, (Joint.LEFT_KNEE, Joint.LEFT_ANKLE), strict=True):
        np.testing.assert_array_equal(line.shapes_deg[joint.kind], np.rad2deg(walk.gait[Side.LEFT].cycles[joint][row]))
        room = strides.visualRect(strides.cells.index(row, shape))
        picture = strides.viewport().grab(room).toImage()
        colours = {picture.pixelColor(x, y).rgb() for x in range(picture.width()) for y in range(4, picture.height())}
        assert page.strides.list.viewport().rect().contains(room)
        assert any(abs(QColor(one).hslHue() - 25) < 12 and QColor(one).hslSaturation() > 120 for one in colours)
    page.set_room(1280.0, 672.0)
    QApplication.processEvents()
    assert all(strides.isColumnHidden(shape) for shape in shapes)


@pytest.mark.endurance
def test_no_word_is_cut_in_any_room(page: ResultPage) -> None:
    """Where charts have no room beside the list, the list is alone."""
    for width, height in ((736.0, 432.0), (1000.0, 592.0), (1680.0, 900.0)):
        page.set_room(width, height)
        QApplication.processEvents()
        page.resize(round(width), max(round(height), page.minimumSizeHint().height()))
        QApplication.processEvents()
        assert page.minimumSizeHint().width() <= width
        assert words_cut(page) == []
        assert page.cycles.isVisible() == (width > 940)


def test_every_cell_of_a_stride_is_stated_and_the_mark_is_a_box_to_tick(
    page: ResultPage, session: Session, analysis: Analysis
) -> None:
    strides, stated = page.strides.list, Qt.ItemDataRole.AccessibleTextRole
    row = first_used(page)
    line = strides.lines[row]
    received = [str(strides.cells.index(row, column).data(stated)) for column in range(strides.cells.columnCount())]
    assert received[STRIDE] == received[STATE] == received[KNEE_SHAPE] == f"Left stride {line.number}, used"
    assert received[1:3] == [f"start (s): {line.start_s:.1f}", f"duration (s): {line.end_s - line.start_s:.2f}"]
    ticked = Qt.ItemDataRole.CheckStateRole
    assert strides.cells.index(row, STRIDE).data(ticked) == Qt.CheckState.Checked
    assert strides.cells.index(row, STATE).data(ticked) is None
    page.show_visit(AnalysedVisit(session, without(session, analysis, line)), can_choose=True)
    assert strides.cells.index(row, STRIDE).data(ticked) == Qt.CheckState.Unchecked
    assert str(strides.cells.index(row, STRIDE).data(stated)) == f"Left stride {line.number}, excluded by hand"
