"""The step of results on a session of the library: shown quickly, put right after the fact, undone, and audited."""

import math
from dataclasses import replace
from pathlib import Path
from time import process_time
from uuid import UUID

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog
from pytestqt.qtbot import QtBot

from app.results.thin_line import ThinLine
from app.results.tools_row import STRIDES
from app.storage.exchange import import_session
from app.storage.opened import OpenedLibrary
from app.summary.comparison import Contrast
from app.wizard import reviewing
from app.wizard.keys import Intent, KeyAction
from app.wizard.results.step import ResultsStep
from app.wizard.resuming import current_course_key
from app.wizard.visit import Visit
from app.workers.library_controller import LibraryController
from core.body import LEG_JOINTS, Joint, Side
from core.gait.chosen_strides import left_out_by_hand
from core.prosthesis import AmputationLevel, JointNature, Prosthesis
from core.results import RecordingAnalysis
from core.samples import FloatArray
from core.session import RecordingKind, Session
from core.verdicts.measurement_error import ErrorSource
from devices.simulation.walker import DEMONSTRATION
from tests.app.library_answers import asked
from tests.app.room import words_cut
from tests.app.wizard.present import present
from tests.app.wizard.pressing import press
from tests.simulated import session_of

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

QUICK_S = 1.0  # of the processor, whatever else the machine does


@pytest.fixture(scope="module")
def one_walk() -> Session:
    return session_of(DEMONSTRATION)


@pytest.fixture
def session_id(qtbot: QtBot, controller: LibraryController, one_walk: Session) -> UUID:
    def bring_in(opened: OpenedLibrary) -> UUID:
        for started in ("2026-09-01T10:00:00", "2026-10-01T10:00:00"):
            import_session(opened, replace(one_walk, started=started), lambda _share, _what: None, "DEMO-1")
        return opened.library.sessions.list()[0].id

    found = asked(qtbot, controller, bring_in)
    assert isinstance(found, UUID)
    return found


@pytest.fixture
def step(qtbot: QtBot, qapp: QApplication, visit: Visit, session_id: UUID) -> ResultsStep:
    step = ResultsStep(visit)
    with qtbot.waitSignals([visit.resumed, visit.evaluation.done]):
        visit.resume(session_id)
    qtbot.addWidget(step.page)
    step.page.set_room(1064, 672)
    step.page.resize(1064, 672)
    step.page.show()
    step.enter()
    return step


def walk_of(visit: Visit) -> RecordingAnalysis:
    analysis = present(visit.evaluation.analysis)
    return next(recording for recording in analysis.recordings if recording.gait)


def wait_for(qtbot: QtBot, visit: Visit, count: int) -> None:
    """Until so many of the left side's strides are left out by hand."""
    qtbot.waitUntil(lambda: left_out_by_hand(walk_of(visit).gait[Side.LEFT]) == count)


def angle_of(visit: Visit, joint: Joint) -> FloatArray:
    return walk_of(visit).joints[joint].angle_rad


def test_results_are_on_the_screen_quickly_once_they_are_known(visit: Visit, step: ResultsStep) -> None:
    assert step.page.currentWidget() is step.page.results()
    began = process_time()
    other = ResultsStep(visit)
    other.page.set_room(1064, 672)
    other.enter()
    assert process_time() - began < QUICK_S
    assert other.page.currentWidget() is other.page.results()
    other.page.deleteLater()


def test_results_that_are_made_ready_ahead_open_with_the_walk(visit: Visit, step: ResultsStep) -> None:
    """The free motion is analysed first; who comes after a walk wants to see that walk."""
    session, analysis = present(visit.evaluation.session), present(visit.evaluation.analysis)
    ahead = ResultsStep(visit)
    ahead.page.results()
    of_motion = (one for one in analysis.recordings if one.kind is not RecordingKind.WALKING)
    visit.evaluation.take_over(session, replace(analysis, recordings=tuple(of_motion)))
    visit.evaluation.take_over(session, analysis)
    assert ahead.page.results().recording is walk_of(visit)  # before anybody came
    ahead.enter()
    assert ahead.page.results().recording is walk_of(visit)
    ahead.page.deleteLater()


def test_a_sign_is_turned_kept_in_the_history_and_undone(
    qtbot: QtBot, controller: LibraryController, visit: Visit, step: ResultsStep, session_id: UUID
) -> None:
    before = angle_of(visit, Joint.LEFT_KNEE)
    press(step, "Correct")
    page = step.page.correct()
    assert step.page.currentWidget() is page
    with qtbot.waitSignal(step.offered), qtbot.waitSignal(visit.evaluation.done):
        page.joint_rows[Joint.LEFT_KNEE].turned.click()
    np.testing.assert_allclose(angle_of(visit, Joint.LEFT_KNEE), -before, atol=1e-9)
    analysis = present(visit.evaluation.analysis)
    assert "sign_turned" in {finding.key for finding in analysis.findings}
    with qtbot.waitSignal(visit.evaluation.done):
        step.undo()
    np.testing.assert_allclose(angle_of(visit, Joint.LEFT_KNEE), before)

    def corrected(opened: OpenedLibrary) -> list[str]:
        corrections = opened.library.corrections.of_session(session_id)
        return [change.field for correction in corrections for change in correction.changes]

    assert asked(qtbot, controller, corrected) == ["turned_sign", "turned_sign"]


def test_a_walk_is_left_out_comes_back_and_changes_its_condition(qtbot: QtBot, visit: Visit, step: ResultsStep) -> None:
    press(step, "Correct")
    (row,) = step.page.correct().walk_rows.values()
    assert row.condition.line_edit.accessibleName() == "Condition of walk 1"
    with (
        qtbot.waitSignal(step.offered) as offered,
        qtbot.waitSignal(visit.evaluation.done),
    ):
        row.kept.click()
    assert offered.args == ["Walk 1 is excluded."]
    assert not any(recording.gait for recording in present(visit.evaluation.analysis).recordings)
    with qtbot.waitSignal(visit.evaluation.done):
        step.undo()
    assert walk_of(visit).gait
    ((key, _),) = step.page.correct().walk_rows.items()
    with qtbot.waitSignal(visit.evaluation.done):
        step.page.correct().condition_typed.emit(key, "AFO")
    assert row.condition.line_edit.accessibleName() == "Condition of A AFO"
    stated: list[str] = []
    step.offered.connect(stated.append)
    for is_kept in (False, True):
        with qtbot.waitSignal(visit.evaluation.done):
            step.page.correct().kept_turned.emit(key, is_kept)
    assert stated == ["A AFO is excluded.", "A AFO is included."]
    assert step.page.results().recordings.currentText() == "A AFO"
    assert [recording.details.condition for recording in visit.recordings.walks] == ["AFO"]
    step.page.correct().back.click()
    assert [part.name for part in step.page.results().compare._conditions] == ["AFO"]


def test_an_earlier_visit_is_compared_as_worn_again(qtbot: QtBot, visit: Visit, step: ResultsStep) -> None:
    compare = step.page.results().compare
    with qtbot.waitSignal(visit.earlier_read):
        compare.kinds.setCurrentIndex(compare.kinds.findData(Contrast.VISITS))
    found = present(compare.comparison)
    assert [(part.letter, part.name) for part in found.parts] == [("1", "2026-09-01"), ("2", "2026-10-01")]
    knees = [row for row in found.rows if row.measure.column == "knee_range_deg"]
    assert [row.difference.difference for row in knees] == [0.0, 0.0]
    for row in knees:
        assert ErrorSource.DAYS in row.difference.sources
        strapped_again = 1.96 * math.sqrt(2) * math.hypot(1.2, 0.043 * row.value.mean)
        assert strapped_again < row.difference.error < 1.2 * strapped_again  # chance is added


def test_the_last_visit_is_read_from_the_library_and_drawn_thin(qtbot: QtBot, visit: Visit, step: ResultsStep) -> None:
    """Without that anybody asks for it."""
    results = step.page.results()
    knee = results.cycles.charts.knee
    qtbot.waitUntil(lambda: bool(knee.chart.described.beside))
    assert results.thin.currentData() is ThinLine.LAST_VISIT
    assert knee.key.words.thin
    results.thin.turn()
    assert not knee.chart.described.beside


def test_rerun_that_is_missing_is_reported(
    qtbot: QtBot, visit: Visit, step: ResultsStep, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reviewing, "viewer_program", lambda: None)
    with qtbot.waitSignal(visit.refused) as reported:
        press(step, "Review in Rerun")
    assert reported.args is not None
    assert "Rerun is not installed on this computer" in reported.args[0]


def test_how_a_joint_was_found_is_shown_saved_audited_and_left_again(
    qtbot: QtBot, visit: Visit, step: ResultsStep, controller: LibraryController, tmp_path: Path
) -> None:
    step.page.results().quality.how_found.click()
    page = present(step.page.behind.found)
    assert step.page.currentWidget() is page
    assert not step.bar().has_back
    qtbot.waitUntil(page.save.isEnabled)
    page.joints.choose(str(Joint.RIGHT_ANKLE))
    assert not page.save.isEnabled()
    qtbot.waitUntil(page.save.isEnabled)
    page.save.click()
    dialog = present(page.findChild(QFileDialog))
    # its files name no patient, so neither does their folder
    assert [Path(one).name for one in dialog.selectedFiles()] == ["session_how-found"]
    with qtbot.waitSignal(step.reported):
        dialog.fileSelected.emit(str(tmp_path / "how"))
    dialog.close()
    assert "how" in page.note.text()
    assert any(one.name.startswith("simulated_right_ankle") for one in (tmp_path / "how").iterdir())
    exports = asked(qtbot, controller, lambda opened: [entry.details for entry in opened.library.audit.entries()])
    assert any("how-found" in details for details in exports)  # type: ignore[attr-defined] # answers are objects
    assert not step.on_intent(Intent(KeyAction.PRIMARY))
    assert step.on_intent(Intent(KeyAction.BACK))
    assert step.page.currentWidget() is step.page.results()
    assert not step.on_intent(Intent(KeyAction.BACK))


def test_swapped_sides_are_read_again_and_swapped_back(qtbot: QtBot, visit: Visit, step: ResultsStep) -> None:
    strides = {side: len(gait.strides) for side, gait in walk_of(visit).gait.items()}
    left, right = angle_of(visit, Joint.LEFT_KNEE), angle_of(visit, Joint.RIGHT_KNEE)
    press(step, "Correct")
    with qtbot.waitSignal(visit.evaluation.done):
        step.page.correct().swap.click()
    swapped = {side: len(gait.strides) for side, gait in walk_of(visit).gait.items()}
    assert swapped == {Side.LEFT: strides[Side.RIGHT], Side.RIGHT: strides[Side.LEFT]}
    np.testing.assert_allclose(np.nanmax(angle_of(visit, Joint.LEFT_KNEE)), np.nanmax(right), atol=0.02)
    with qtbot.waitSignal(visit.evaluation.done):
        step.undo()
    np.testing.assert_allclose(np.nanmax(angle_of(visit, Joint.LEFT_KNEE)), np.nanmax(left), atol=0.02)


def test_what_is_stated_of_the_legs_afterwards_is_in_the_results_when_they_are_looked_at_again(
    qtbot: QtBot, visit: Visit, step: ResultsStep
) -> None:
    def nature() -> JointNature:
        analysis = present(visit.evaluation.analysis)
        return analysis.calibrations[-1].joints[Joint.LEFT_KNEE].nature

    computed: list[object] = []
    visit.evaluation.computed.connect(lambda _session, analysis: computed.append(analysis))
    assert nature() is JointNature.NOT_STATED
    for change, found in (
        ({"prosthetic_side": "left"}, JointNature.PROSTHETIC),
        ({"prostheses": {Side.LEFT: Prosthesis(AmputationLevel.TRANSTIBIAL)}}, JointNature.OWN),
    ):
        visit.patient.edit(replace(visit.patient.details, **change))
        step.leave()
        with qtbot.waitSignal(visit.evaluation.done):
            step.enter()
        assert nature() is found
    assert len(computed) == 2
    visit.patient.edit(replace(visit.patient.details, device="socket"))
    step.leave()
    step.enter()
    assert not visit.evaluation.is_busy


def test_strides_are_left_out_by_hand_taken_back_one_by_one_and_stay_out_after_a_restart(
    qtbot: QtBot, controller: LibraryController, visit: Visit, step: ResultsStep, session_id: UUID
) -> None:
    """At once, without another analysis; each by the key, in the history and the audit, and in the kept files."""
    computed: list[object] = []
    visit.evaluation.computed.connect(lambda _session, analysis: computed.append(analysis))
    page = step.page.results()
    page.view.choose(STRIDES)
    strides = page.strides.list
    rows = [row for row, line in enumerate(strides.lines) if line.is_used][:2]
    used = int(walk_of(visit).gait[Side.LEFT].strides.is_used.sum())
    strides.setFocus()
    for row in rows:  # both before the library has answered
        strides.choose(row)
        with qtbot.waitSignal(step.offered):
            QTest.keyClick(strides, Qt.Key.Key_Space)
    wait_for(qtbot, visit, 2)
    assert int(walk_of(visit).gait[Side.LEFT].strides.is_used.sum()) == used - 2
    assert page.view.choice == STRIDES
    assert strides.hasFocus() or not page.window().isActiveWindow()
    assert strides.currentIndex().row() == rows[1]
    assert not computed

    def reported(opened: OpenedLibrary) -> tuple[list[str], str]:
        corrections = opened.library.corrections.of_session(session_id)
        fields = [change.field for correction in corrections for change in correction.changes]
        return fields, opened.library.audit.entries(f"session:{session_id}")[-1].details

    answer = asked(qtbot, controller, reported)
    assert isinstance(answer, tuple)
    assert answer[0] == ["left_out", "left_out"]
    assert "left_out" in answer[1]

    def of_the_course(opened: OpenedLibrary) -> tuple[str, str, int]:
        key, course = opened.library.courses.find([session_id])[session_id]
        strides = sum(condition.strides for condition in course.conditions)
        return key, current_course_key(opened.library.sessions.get(session_id)), strides

    kept_course = asked(qtbot, controller, of_the_course)
    assert isinstance(kept_course, tuple)
    kept, current, strides_reported = kept_course
    assert kept == current  # so that home can show it as it is now
    gait = walk_of(visit).gait
    assert strides_reported == sum(int(one.strides.is_used.sum()) for one in gait.values())

    again = Visit(controller, [])
    again.evaluation.computed.connect(lambda _session, analysis: computed.append(analysis))
    with qtbot.waitSignals([again.resumed, again.evaluation.done]):
        again.resume(session_id)
    assert left_out_by_hand(walk_of(again).gait[Side.LEFT]) == 2
    assert "strides_left_out_by_hand" in {finding.key for finding in present(again.evaluation.analysis).findings}
    assert not computed
    again.finish()

    for left in (1, 0):
        step.undo()
        wait_for(qtbot, visit, left)
    step.undo()  # there is nothing before that
    assert int(walk_of(visit).gait[Side.LEFT].strides.is_used.sum()) == used
    strides.choose(rows[0])
    page.strides.turn.click()
    wait_for(qtbot, visit, 1)
    page.strides.all.click()
    wait_for(qtbot, visit, 0)


def test_no_word_of_the_corrections_is_cut(step: ResultsStep) -> None:
    press(step, "Correct")
    page = step.page.correct()
    for room in ((1064, 672), (736, 432), (1680, 952)):
        step.page.set_room(*room)
        page.resize(room[0], max(room[1], page.minimumSizeHint().height()))
        assert page.minimumSizeHint().width() <= room[0]
        assert words_cut(page) == []


def test_the_agreement_with_an_optical_system_is_saved_audited_and_left_again(
    qtbot: QtBot, visit: Visit, step: ResultsStep, controller: LibraryController, tmp_path: Path
) -> None:
    walk = walk_of(visit)
    joints = [joint for joint in LEG_JOINTS if joint in walk.joints]
    columns = [np.rad2deg(walk.joints[joint].angle_rad) for joint in joints]
    rows = [
        ",".join(f"{value:.5f}" for value in row)
        for row in zip(walk.time_s + 5.0, *columns, strict=True)
        if np.isfinite(row).all()
    ]
    reference = tmp_path / "optics.csv"
    reference.write_text("\n".join([f"time_s,{','.join(joints)}", *rows, ""]), encoding="utf-8")
    step.page.results().quality.agreement.click()
    page = present(step.page.behind.agreement)
    assert step.page.currentWidget() is page
    page.choose.click()
    (chooser,) = page.findChildren(QFileDialog)
    chooser.filesSelected.emit([str(reference)])
    chooser.close()
    qtbot.waitUntil(lambda: page.sheets.count > 0)
    page.save.click()
    dialog = page.findChildren(QFileDialog)[-1]
    with qtbot.waitSignal(step.reported):
        dialog.fileSelected.emit(str(tmp_path / "agreed"))
    dialog.close()
    assert page.note.text() == "Saved in agreed."
    assert (tmp_path / "agreed" / "agreement.pdf").exists()
    exports = asked(qtbot, controller, lambda opened: [entry.details for entry in opened.library.audit.entries()])
    assert any("agreement" in details for details in exports)  # type: ignore[attr-defined] # answers are objects
    assert step.on_intent(Intent(KeyAction.BACK))
    assert step.page.currentWidget() is step.page.results()
