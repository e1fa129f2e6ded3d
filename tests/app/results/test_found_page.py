"""Tests of the page on how a joint was found.

The pictures' numbers are in the files. The words have their room, and the way back is open.
"""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QObject
from PySide6.QtWidgets import QFileDialog
from pytestqt.qtbot import QtBot

from app.results.diagnostics_controller import DiagnosticsController
from app.results.found_page import TEN_SECONDS, FoundPage
from app.summary.diagnostics import (
    AXIS_COST,
    FIGURES,
    PROJECTED_RATES,
    TWO_WAYS,
    figures_of,
    names_of_files,
    write_diagnostics,
)
from app.theme.current import set_dark, set_scale
from app.widgets.text import Text
from app.workers.background import Background
from core.body import LEG_JOINTS, Joint, Site
from core.findings import Finding, Severity
from core.results import Analysis
from core.session import Session
from core.verdicts.diagnostics import JointDiagnostics, diagnostics_of
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings
from tests.app.room import words_cut
from tests.simulated import analysis_of, session_of

KNEE = Joint.RIGHT_KNEE
DIGITS = 1e-5
ROOMS = {  # of the page in the window: its size, the size of everything
    "1280 x 720 at 100 %": (1064, 592, 1.0),
    "1920 x 1080 at 200 %": (1792, 824, 2.0),
    "800 x 560 at 100 %": (736, 432, 1.0),
    "1920 x 1080 at 100 %": (1680, 952, 1.0),
}


@pytest.fixture(scope="module")
def session() -> Session:
    """The right knee of a patient, quickly simulated."""
    recordings = (Standing(), FreeMotion(duration_s=4.0), Walk(strides=3))
    sites = (Site.RIGHT_THIGH, Site.RIGHT_SHANK)
    return session_of(WalkerSettings(seed=5, sites=sites, recordings=recordings))


@pytest.fixture(scope="module")
def analysis(session: Session) -> Analysis:
    return analysis_of(session)


@pytest.fixture(scope="module")
def found(session: Session, analysis: Analysis) -> JointDiagnostics:
    found = diagnostics_of(session, analysis.calibrations[0].joints[KNEE], analysis.recordings[-1].name)
    assert found is not None
    return found


@pytest.fixture
def page(qtbot: QtBot) -> FoundPage:
    page = FoundPage()
    qtbot.addWidget(page)
    page.resize(1064, 592)
    page.set_room(1064, 592)
    page.show_joints([KNEE], KNEE)
    page.show()
    return page


def columns_of(path: Path) -> dict[str, list[str]]:
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: [row[name] for row in rows] for name in rows[0]}


def numbers(cells: list[str]) -> np.ndarray:
    return np.array([float(cell) if cell else np.nan for cell in cells])


def test_every_number_drawn_or_stated_is_in_the_files(page: FoundPage, found: JointDiagnostics, tmp_path: Path) -> None:
    page.show_found(found, [], is_simulated=True)
    write_diagnostics(found, True, tmp_path / "new")
    files = {what: columns_of(tmp_path / "new" / name) for what, name in names_of_files(KNEE, True).items()}
    # Figure 3
    for sensor, chart in zip(("proximal", "distal"), page.axis.maps, strict=True):
        cost = files[AXIS_COST]
        reported = zip(cost["sensor"], cost["what"], cost["rms_deg_s"], strict=True)
        values = numbers([value for one, what, value in reported if one == sensor and what == "direction"])
        assert chart.limits_deg_s == pytest.approx((values.min(), values.max()), abs=DIGITS)
    np.testing.assert_allclose(values, np.rad2deg(found.costs[1].rms_rad_s.ravel()), atol=DIGITS)
    # Figure 4
    names = [f"{name}_{part}_deg_s" for name in ("proximal", "distal", "reversed_distal") for part in "xy"]
    drawn = [part for curve in page.pairing.plot.curves_deg_s() for part in curve]
    for name, values in zip(names, drawn, strict=True):
        np.testing.assert_allclose(numbers(files[PROJECTED_RATES][name]), values, atol=DIGITS)
    # Figure 6
    names = ["from_accelerations_deg", "from_rates_deg", "fused_deg"]
    is_reported = np.isfinite(page.angle.chart.time_s)
    for name, curve in zip(names, page.angle.chart.curves_deg, strict=True):
        np.testing.assert_allclose(numbers(files[TWO_WAYS][name]), curve[is_reported], atol=DIGITS)
    # what is stated in words
    stated = dict(zip(files[FIGURES]["figure"], files[FIGURES]["value"], strict=True))
    assert stated["is_simulated"] == "true"
    shown = {text.text() for text in page.figures.findChildren(Text)}
    for figure in figures_of(found).values():
        assert replace(figure, value=float(stated[figure.column] or "nan")).in_words in shown
        assert figure.name in shown


def test_simulated_data_say_so_on_every_picture_and_recorded_ones_do_not(
    page: FoundPage, found: JointDiagnostics
) -> None:
    for is_simulated in (True, False):
        page.show_found(found, [], is_simulated)
        marks = [one for one in page.findChildren(Text) if one.text() == "SIMULATED"]
        assert [one.isVisible() for one in marks] == [is_simulated] * 3


def test_what_was_noticed_about_the_joint_is_below(page: FoundPage, found: JointDiagnostics) -> None:
    page.show_found(found, [Finding("lag_corrected", Severity.INFO, str(KNEE), {"lag_ms": 12.0})], False)
    assert any("12 ms" in text.text() for text in page.noticed.findChildren(Text))
    page.show_found(found, [], False)
    assert page.noticed.isHidden()


def test_a_motion_that_drew_no_curve_and_reported_no_drift_is_shown_all_the_same(
    page: FoundPage, found: JointDiagnostics
) -> None:
    ways = replace(found.ways, drift_rad_s=float("nan"))
    calibration = replace(found.calibration, axis_sd_rad=None, sign_margin=float("inf"), centre_proximal_m=None)
    page.show_found(replace(found, projected=None, ways=ways, calibration=calibration), [], False)
    page.grab()
    stated = " ".join(text.text() for text in page.pairing.findChildren(Text))
    assert "No second of this motion" in stated
    assert "more than 100 times worse" in stated


def test_ten_seconds_are_seen_closer_on_the_axis_that_they_need(page: FoundPage, found: JointDiagnostics) -> None:
    long_s = np.arange(0, 60, 0.02)
    angle = np.deg2rad(20 * np.sin(long_s) + long_s)
    ways = replace(found.ways, time_s=long_s, from_rates_rad=angle, from_accelerations_rad=angle, fused_rad=0.1 * angle)
    page.show_found(replace(found, ways=ways), [], False)
    assert page.angle.chart.visible_s == pytest.approx((0, 59.98))
    whole_range = page.angle.chart.range_deg
    page.angle.stretch.choose(TEN_SECONDS)
    assert page.angle.chart.visible_s == pytest.approx((24.99, 34.99))
    assert page.angle.chart.range_deg != whole_range
    page.grab()


def test_every_word_has_its_room(page: FoundPage, found: JointDiagnostics) -> None:
    assert cut_in(page, found, "1280 x 720 at 100 %") == []


@pytest.mark.endurance  # a second each
@pytest.mark.usefixtures("pseudo_language")
@pytest.mark.parametrize("room", ROOMS)
def test_every_word_of_a_longer_language_has_its_room(qtbot: QtBot, found: JointDiagnostics, room: str) -> None:
    page = FoundPage()  # which is made in the language that it speaks
    qtbot.addWidget(page)
    page.show()
    assert cut_in(page, found, room) == []


def cut_in(page: FoundPage, found: JointDiagnostics, room: str) -> list[str]:
    """What is cut on the page, and on what is scrolled in it."""
    width, height, scale = ROOMS[room]
    set_scale(scale)
    set_dark(True)
    page.show_joints(list(LEG_JOINTS), KNEE)
    page.set_room(width / scale, height / scale)
    page.show_found(found, [Finding("strap_slipped", Severity.WARNING, str(KNEE))], True)
    page.resize(width, height)
    assert page.width() == width
    inside = page.cards.widget()
    assert inside is not None
    return words_cut(page) + words_cut(inside)


class Listener(QObject):
    """Receives what is to be written, and writes it."""

    def __init__(self) -> None:
        super().__init__()
        self.folder: Path | None = None

    def on_writing(self, folder: Path, write: object) -> None:
        assert callable(write)
        write()
        self.folder = folder


@pytest.mark.endurance  # finds out again, and opens a dialog
def test_the_controller_answers_beside_the_screen_and_saves(
    qtbot: QtBot, page: FoundPage, session: Session, analysis: Analysis, tmp_path: Path
) -> None:
    background, listener = Background(page), Listener()
    controller = DiagnosticsController(page, background, page)
    controller.writing.connect(listener.on_writing)
    findings = [
        Finding("strap_slipped", Severity.WARNING, f"{where}, {site}", {"from_s": 2.0, "turn_deg": turn})
        for where, site, turn in (("walk 1", Site.RIGHT_SHANK, 9), ("free motion", Site.RIGHT_SHANK, 8))
    ]
    walk = analysis.recordings[-1]
    controller.show(session, replace(analysis, findings=(*analysis.findings, *findings)), walk)
    assert not page.save.isEnabled()
    assert page.waiting.isVisible()
    qtbot.waitUntil(lambda: page.save.isEnabled())
    assert [button.isHidden() for button in page.joints.segments] == [True, False, True, True]
    assert page.cards.isVisible()
    noticed = " ".join(text.text() for text in page.noticed.findChildren(Text))
    assert "by about 9°" in noticed
    assert "by about 8°" not in noticed  # in another recording
    page.save.click()
    dialog = page.findChild(QFileDialog)
    assert dialog is not None
    dialog.fileSelected.emit(str(tmp_path / "figures"))
    dialog.close()
    assert listener.folder == tmp_path / "figures"
    assert {one.name for one in listener.folder.iterdir()} == set(names_of_files(KNEE, True).values())
    qtbot.waitUntil(lambda: background.is_idle)


def test_without_a_joint_the_page_states_so(
    qtbot: QtBot, page: FoundPage, session: Session, analysis: Analysis
) -> None:
    controller = DiagnosticsController(page, Background(page), page)
    controller.show(session, analysis, replace(analysis.recordings[-1], joints={}))
    assert page.waiting.isVisible()
    assert not page.save.isEnabled()
    assert page.back.isEnabled()
