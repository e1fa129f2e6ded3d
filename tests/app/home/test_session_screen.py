"""A session of a folder: opening, stopping, refusals, methods, and whether every word fits."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from threading import Event

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QFontInfo, QPalette
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QApplication, QLabel, QWidget
from pytestqt.qtbot import QtBot

from app.home import session_screen
from app.home.session_screen import ENDED_EARLY, STOPPED, SessionScreen
from app.plots.angle_chart import AngleChart
from app.results.found_page import FoundPage
from app.results.result_page import ResultPage
from app.results.tools_row import ANSWER, COMPARE, STRIDES, WHOLE
from app.results.whole_page import BOTH, ORIENTATION, PUBLISHED, RESULT
from app.summary.request import AnalysedVisit
from app.system.progress import Report
from app.theme.colours import DARK, LIGHT
from app.theme.current import current_theme, set_dark, set_scale
from app.widgets.findings_list import FindingRow
from app.widgets.table_cells import TextCell
from app.workers.background import Stopped, Work
from core.body import LEG_JOINTS, Joint, Side
from core.findings import Finding, Severity
from core.results import (
    Analysis,
    AxisSource,
    Calibration,
    JointAngle,
    JointCalibration,
    Method,
    RecordingAnalysis,
    ZeroKind,
)
from core.samples import FloatArray
from core.session import Patient, RecordingKind, Session
from tests.app.room import is_cut
from tests.simulated import SLOW_WALK, analysis_of, session_of

TIME_S = np.arange(600) / 100
GAP = slice(200, 260)
SOME_FINDINGS = (
    Finding("simulated", Severity.INFO, ""),
    Finding("gaps", Severity.WARNING, "left_foot, walk 1", {"count": 3, "missing_percent": 2.5, "longest_s": 0.42}),
    Finding("all_zero", Severity.GRAVE, "right_foot, walk 1"),
)


def calibration(joint: Joint) -> JointCalibration:
    axis = np.array([0.0, 1.0, 0.0])
    return JointCalibration(
        joint=joint,
        method=Method.ROBUST,
        axis_proximal=axis,
        axis_distal=axis,
        axis_source=AxisSource.FREE_MOTION if joint.is_knee else AxisSource.POOLED,
        axis_sd_rad=np.deg2rad(4.2),
        centre_proximal_m=None,
        centre_distal_m=None,
        centre_sd_m=None,
        sign_margin=1.1 if joint is Joint.LEFT_ANKLE else 3.4,
        clinical_sign=1,
        is_sign_certain=joint is not Joint.RIGHT_ANKLE,
        clinical_sign_margin=2.0,
        lag_s=-0.012 if joint.is_knee else 0.0,
        lag_sd_s=None,
        hinge_residual_rad_s=0.3,
        is_hinge=False,
        gyro_bias_proximal_rad_s=None,
        gyro_bias_distal_rad_s=None,
        zero=ZeroKind.STANDING if joint.side is Side.LEFT else ZeroKind.NONE,
        zero_rad=0.0,
        offset_rad=0.0,
        standing_from="standing",
        free_motion_from="free motion",
        walks_from=("walk 1",),
    )


def angle(joint: Joint, has_orientation: bool) -> JointAngle:
    highest = 1.0 if joint.is_knee else 0.3
    result = highest * np.sin(2 * np.pi * TIME_S + (joint.side is Side.RIGHT)) ** 2
    result[GAP] = np.nan
    return JointAngle(result, np.full(600, 0.03), result + 0.02, 0.8 * result if has_orientation else None)


def analysis(is_simulated: bool = False, has_orientation: bool = True) -> Analysis:
    recordings = tuple(
        RecordingAnalysis(name, name, kind, TIME_S, {joint: angle(joint, has_orientation) for joint in LEG_JOINTS})
        for name, kind in (("free motion", RecordingKind.FREE_MOTION), ("walk 1", RecordingKind.WALKING))
    )
    calibrated = Calibration(("walk 1",), {joint: calibration(joint) for joint in LEG_JOINTS})
    return Analysis(Method.ROBUST, is_simulated, (calibrated,), recordings, SOME_FINDINGS)


def opened(is_simulated: bool = False, has_orientation: bool = True) -> AnalysedVisit:
    patient = Patient(code="P-0147", birth_year=1968, sex="male", prosthetic_side="left")
    return AnalysedVisit(Session((), patient, is_simulated=is_simulated), analysis(is_simulated, has_orientation))


@pytest.fixture
def window(qtbot: QtBot) -> SessionScreen:
    def end_work(window: SessionScreen) -> None:
        window._background.stop()
        qtbot.waitUntil(lambda: window._background.is_idle)

    window = SessionScreen()
    window.resize(1280, 800)
    qtbot.addWidget(window, before_close_func=end_work)
    with qtbot.waitActive(window):  # only then a widget can have the focus
        window.show()
        window.activateWindow()
    return window


OpenWork = Callable[[Work], None]


@pytest.fixture
def open_work(monkeypatch: pytest.MonkeyPatch, window: SessionScreen) -> OpenWork:
    """Open a folder whose reading and analysis is the given work."""

    def open_it(work: Work) -> None:
        monkeypatch.setattr(session_screen, "opening_folder", lambda _folder: work)
        window.open_folder(Path("visit"))

    return open_it


@pytest.fixture
def results(qtbot: QtBot, window: SessionScreen, open_work: OpenWork) -> ResultPage:
    """The page of an analysis with all four joints and all methods."""
    open_work(lambda _report: opened())
    qtbot.waitUntil(lambda: not window.is_working)
    assert window.results is not None
    return window.results


def endless(ended: Event) -> Work:
    def work(report: Report) -> None:
        try:
            while True:
                report(0.4, "left_knee")
        except Stopped:
            ended.set()
            raise

    return work


def drawn_deg(page: ResultPage, joint: Joint) -> FloatArray:
    frame = page.whole.charts.knee if joint.is_knee else page.whole.charts.ankle
    return frame.chart.curve_points(joint.side)[1]


def test_the_empty_window_offers_the_two_ways_on(window: SessionScreen) -> None:
    assert window.pages.currentWidget() is window.empty
    assert window.empty.open_folder.isVisible()
    assert window.empty.open_demonstration.isVisible()
    assert window.empty.open_folder.hasFocus()
    assert not window.bar.isVisible()


def test_a_session_is_shown_with_its_patient_and_its_first_walk(window: SessionScreen, results: ResultPage) -> None:
    assert window.pages.currentWidget() is results
    assert window.header.code.text() == "P-0147"
    assert window.header.facts.text() == "1968, male · left prosthetic"
    assert results.recordings.currentText() == "walk 1"
    for joint in LEG_JOINTS:
        expected = np.rad2deg(angle(joint, True).angle_rad)
        np.testing.assert_allclose(drawn_deg(results, joint), expected)


def test_how_a_joint_was_found_opens_over_the_results_and_gives_way_to_them(
    qtbot: QtBot, window: SessionScreen, results: ResultPage
) -> None:
    window.bar.how_found.click()
    found = window.pages.currentWidget()
    assert isinstance(found, FoundPage)
    assert found.back.hasFocus()
    assert not window.bar.isVisible()
    qtbot.waitUntil(lambda: window._looking.is_idle)
    assert found.waiting.isVisible()  # this session holds no samples
    window.leave()
    assert window.pages.currentWidget() is results
    assert window.bar.isVisible()


def test_progress_is_shown_in_words_and_stopping_ends_the_analysis_and_the_window_goes_on(
    qtbot: QtBot, window: SessionScreen, open_work: OpenWork
) -> None:
    ended = Event()
    open_work(endless(ended))
    qtbot.waitUntil(lambda: window.working.progress == (0.4, "Left knee"))
    assert window.pages.currentWidget() is window.working
    assert window.working.stop.hasFocus()
    QTest.mouseClick(window.working.stop, Qt.MouseButton.LeftButton)
    assert window.pages.currentWidget() is window.empty
    assert window.banner.text == " ".join(STOPPED)
    qtbot.waitUntil(lambda: window._background.is_idle)
    assert ended.is_set()
    open_work(lambda _report: opened())
    qtbot.waitUntil(lambda: window.results is not None)
    assert not window.banner.isVisible()


def test_stopping_brings_the_session_before_back(
    qtbot: QtBot, window: SessionScreen, results: ResultPage, open_work: OpenWork
) -> None:
    open_work(endless(Event()))
    QTest.mouseClick(window.working.stop, Qt.MouseButton.LeftButton)
    assert window.pages.currentWidget() is results
    assert window.header.code.text() == "P-0147"


def test_stopping_for_good_waits_for_the_thread(qtbot: QtBot, window: SessionScreen, open_work: OpenWork) -> None:
    ended = Event()
    open_work(endless(ended))
    qtbot.waitUntil(lambda: window.working.progress[0] > 0)
    window.stop()
    window.finish()
    assert ended.is_set()
    assert window._background.is_idle


def test_a_folder_that_is_no_session_is_refused_in_the_page(
    qtbot: QtBot, window: SessionScreen, tmp_path: Path
) -> None:
    window.open_folder(tmp_path)
    qtbot.waitUntil(window.banner.isVisible)
    assert "session.toml" in window.banner.text
    assert str(tmp_path) in window.banner.text
    assert QApplication.activeModalWidget() is None
    assert window.pages.currentWidget() is window.empty
    QTest.mouseClick(window.banner.dismiss, Qt.MouseButton.LeftButton)
    assert not window.banner.isVisible()


def test_what_nobody_foresaw_is_reported_and_logged(
    qtbot: QtBot, window: SessionScreen, open_work: OpenWork, caplog: pytest.LogCaptureFixture
) -> None:
    def work(_report: Report) -> None:
        raise ZeroDivisionError

    open_work(work)
    qtbot.waitUntil(window.banner.isVisible)
    assert window.banner.text == " ".join(ENDED_EARLY)
    assert "ZeroDivisionError" in caplog.text


def test_the_method_changes_what_is_drawn_and_gaps_stay_gaps_with_every_one(results: ResultPage) -> None:
    knee = angle(Joint.LEFT_KNEE, True)
    assert knee.orientation_rad is not None
    for method, expected in ((PUBLISHED, knee.published_rad), (ORIENTATION, knee.orientation_rad)):
        results.whole.methods.choose(method)
        np.testing.assert_allclose(drawn_deg(results, Joint.LEFT_KNEE), np.rad2deg(expected))
        assert results.whole.charts.knee.chart.curves[Side.LEFT].sd_deg is None
    results.whole.methods.choose(BOTH)
    curve = results.whole.charts.knee.chart.curves[Side.LEFT]
    np.testing.assert_allclose(curve.angle_deg, np.rad2deg(knee.angle_rad))
    assert curve.second_deg is not None
    np.testing.assert_allclose(curve.second_deg, np.rad2deg(knee.published_rad))
    for method in (RESULT, PUBLISHED, ORIENTATION, BOTH):
        results.whole.methods.choose(method)
        for joint in LEG_JOINTS:
            drawn = drawn_deg(results, joint)
            assert np.isnan(drawn[GAP]).all()
            assert np.isfinite(drawn[: GAP.start]).all()


def test_enter_presses_the_button_in_focus(window: SessionScreen) -> None:
    pressed: list[None] = []
    window.empty.open_demonstration.clicked.disconnect()
    window.empty.open_demonstration.clicked.connect(lambda: pressed.append(None))
    QTest.keyClick(window.empty.open_folder, Qt.Key.Key_Tab)
    focused = QApplication.focusWidget()
    assert focused is window.empty.open_demonstration
    QTest.keyClick(focused, Qt.Key.Key_Return)
    assert pressed == [None]


def test_arrows_change_the_method(qtbot: QtBot, results: ResultPage) -> None:
    results.whole.methods.focus()
    focused = QApplication.focusWidget()
    assert focused is not None
    QTest.keyClick(focused, Qt.Key.Key_Right)
    assert results.whole.methods.choice == PUBLISHED


def test_without_orientations_that_method_is_off_and_states_why(
    qtbot: QtBot, window: SessionScreen, results: ResultPage, open_work: OpenWork
) -> None:
    results.whole.methods.choose(ORIENTATION)
    open_work(lambda _report: opened(has_orientation=False))
    qtbot.waitUntil(lambda: not window.is_working)
    segment = results.whole.methods._segments[ORIENTATION]
    assert results.whole.methods.choice == RESULT
    assert not segment.isEnabled()
    assert segment.accessibleName() == "Orientation, no magnetometer"


def test_the_whole_is_come_back_to_by_its_button_and_with_another_recording(results: ResultPage) -> None:
    assert not results.whole.to_whole.isVisible()
    results.whole.charts.zoom(0.5)
    assert results.whole.shown.text() == "1.5 to 4.5 s of 6.0 s"
    assert results.whole.to_whole.isVisible()
    QTest.mouseClick(results.whole.to_whole, Qt.MouseButton.LeftButton)
    assert results.whole.charts.is_whole
    results.whole.charts.zoom(0.5)
    results.recordings.setCurrentIndex(0)
    assert results.whole.charts.accessibleName() == "Knee and ankle angles of free motion"
    assert results.whole.charts.is_whole
    assert not results.whole.to_whole.isVisible()


def test_simulated_is_stated_in_header_and_charts_and_only_then(
    qtbot: QtBot, window: SessionScreen, results: ResultPage, open_work: OpenWork
) -> None:
    assert not window.header.simulated.isVisible()
    assert not results.whole.charts.knee.simulated.isVisible()
    open_work(lambda _report: opened(is_simulated=True))
    qtbot.waitUntil(lambda: not window.is_working)
    assert window.header.simulated.isVisible()
    assert results.whole.charts.knee.simulated.isVisible()


def test_details_state_how_each_joint_was_found_and_findings_the_gravest_first(results: ResultPage) -> None:
    results.quality.engineering.click()
    rows = [line.split("\t") for line in results.quality.facts.as_text().split("\n")]
    assert rows == [
        ["", "left knee", "right knee", "left ankle", "right ankle"],
        ["Axis from", "free motion", "free motion", "free motion, walking", "free motion, walking"],
        ["Calibration uncertainty", "± 4.2°", "± 4.2°", "± 4.2°", "± 4.2°"],
        ["Clarity", "3.4", "3.4", "1.1", "3.4"],
        ["Direction", "certain", "certain", "certain", "uncertain"],
        ["Clock lag", "\N{MINUS SIGN}12 ms", "\N{MINUS SIGN}12 ms", "none", "none"],
        ["Standing reference", "posture", "none", "posture", "none"],
    ]
    model = results.quality.facts.cells
    every = [(r, c) for r in range(6) for c in range(5)]
    received = {at: str(model.index(*at).data(Qt.ItemDataRole.AccessibleTextRole)) for at in every}
    marked = {(2, 3), (3, 4), (5, 2), (5, 4)}
    assert {cell for cell, stated in received.items() if stated.endswith("needs checking")} == marked
    cells = [(at, model.cell(model.index(*at))) for at in received]
    assert {at for at, cell in cells if isinstance(cell, TextCell) and cell.mark is not None} == marked
    assert received[3, 4] == "right ankle, Direction: uncertain, needs checking"
    assert "1.3" in model.index(2, 1).data(Qt.ItemDataRole.ToolTipRole)
    reported = [row.accessibleName() for row in results.quality.findings.findChildren(FindingRow)]
    assert [text.split(":")[0] for text in reported] == ["serious", "warning", "info"]
    assert "0.42 s" in reported[1]


def test_a_session_without_joints_is_no_trouble(qtbot: QtBot, window: SessionScreen, open_work: OpenWork) -> None:
    nothing = replace(opened(), analysis=Analysis(Method.ROBUST, False, (), ()))
    open_work(lambda _report: nothing)
    qtbot.waitUntil(lambda: window.results is not None)
    assert window.results is not None
    assert window.results.recording is None
    assert window.results.door.words == "No data quality findings."


@pytest.mark.endurance
def test_the_demonstration_is_analysed_and_shown(qtbot: QtBot, window: SessionScreen) -> None:
    window.open_demonstration()
    qtbot.waitUntil(lambda: not window.is_working)
    page = window.results
    assert page is not None, window.banner.text
    assert window.header.simulated.isVisible()
    for joint, lowest, highest in (
        (Joint.LEFT_KNEE, 45, 75),
        (Joint.RIGHT_KNEE, 45, 75),
        (Joint.LEFT_ANKLE, 5, 25),
        (Joint.RIGHT_ANKLE, 5, 25),
    ):
        assert lowest < np.nanmax(drawn_deg(page, joint)) < highest


def test_dark_and_light_change_palette_and_charts(results: ResultPage, qapp: QApplication) -> None:
    for is_dark, colours in ((True, DARK), (False, LIGHT)):
        set_dark(is_dark)
        assert qapp.palette().color(QPalette.ColorRole.Window).name().upper() == colours.ground
        picture = results.whole.charts.knee.chart.grab().toImage()
        assert picture.pixelColor(picture.width() - 2, 2).name().upper() == colours.surface


def test_the_bundled_fonts_are_used() -> None:
    assert QFontInfo(current_theme().font(14)).family() == "Inter"
    assert QFontInfo(current_theme().font(26)).family() == "Inter Display"


def visible(window: QWidget) -> list[QWidget]:
    return [widget for widget in window.findChildren(QWidget) if widget.isVisible()]


def sticks_out(widget: QWidget, window: SessionScreen) -> bool:
    """Return whether a widget can never be seen whole: beside the window, or wider than the page that scrolls."""
    left = widget.mapTo(window, QPoint(0, 0)).x()
    return left < 0 or left + widget.width() > window.width()


@pytest.fixture(scope="module")
def walked() -> AnalysedVisit:
    """A simulated session whose walk is long enough for a spread."""
    session = session_of(SLOW_WALK)
    return AnalysedVisit(session, analysis_of(session))


@pytest.mark.parametrize(
    ("size", "scale"),
    [
        ((1280, 800), 0.8),
        ((1280, 800), 1.0),
        ((1280, 800), 2.0),
        ((960, 600), 0.8),
        ((960, 600), 1.0),
        ((800, 560), 1.0),
        ((1920, 1080), 1.0),
        ((1920, 1080), 2.0),
    ],
)
@pytest.mark.endurance
def test_every_word_fits(
    qtbot: QtBot,
    window: SessionScreen,
    open_work: OpenWork,
    walked: AnalysedVisit,
    qapp: QApplication,
    size: tuple[int, int],
    scale: float,
) -> None:
    open_work(lambda _report: walked)
    qtbot.waitUntil(lambda: not window.is_working)
    results = window.results
    assert results is not None
    window.resize(*size)
    set_scale(scale)
    window.banner.show_message("left_thigh.csv, line 4: the clock steps back.", "Export the recording again.")
    results.whole.charts.zoom(0.5)
    results.whole.charts.read_at(4.0)
    pages: list[tuple[QWidget, str]] = [(results, view) for view in (ANSWER, WHOLE, COMPARE, STRIDES)]
    behind = [(results, ANSWER, button) for button in (results.all_figures, results.door, results.quality.engineering)]
    others = [(page, view, None) for page, view in (*pages, (window.empty, ANSWER), (window.working, ANSWER))]
    for page, view, button in (*others, *behind):
        results.view.choose(view)
        if button is not None:
            button.click()
        window._show_page(page)
        for _ in range(10):  # what wraps settles its height in a second round
            qapp.processEvents()
        shown = [widget for widget in visible(window) if not isinstance(widget, AngleChart)]
        cut = [(type(w).__name__, w.accessibleName() or getattr(w, "text", str)()) for w in shown if is_cut(w)]
        assert cut == []
        out = [type(w).__name__ for w in shown if isinstance(w, QLabel | QAbstractButton) and sticks_out(w, window)]
        assert out == []


def test_everything_that_takes_the_focus_has_a_name(window: SessionScreen, results: ResultPage) -> None:
    for page in (results, window.empty, window.working):
        window._show_page(page)
        takers = [w for w in visible(window) if w.focusPolicy() & Qt.FocusPolicy.TabFocus and w.isEnabled()]
        assert takers
        assert [(w, w.parentWidget()) for w in takers if not w.accessibleName()] == []


def test_tab_goes_in_the_order_of_reading(qtbot: QtBot, window: SessionScreen, results: ResultPage) -> None:
    results.focus()
    passed: list[str] = []
    for _ in range(8):
        focused = QApplication.focusWidget()
        assert focused is not None
        passed.append(focused.accessibleName().split(",")[0])
        QTest.keyClick(focused, Qt.Key.Key_Tab)
    assert passed == [
        "Whole walk",
        "Recording",
        "Result",
        "Knee and ankle angles of walk 1",
        "Data quality: R foot",
        "Open a session folder",
        "Open the demonstration",
        "Show calibration",
    ]


def test_a_click_on_a_curve_gives_its_keys_the_focus(qtbot: QtBot, results: ResultPage) -> None:
    QTest.mouseClick(results.whole.charts.ankle.chart.viewport(), Qt.MouseButton.LeftButton)
    assert results.whole.charts.hasFocus()
