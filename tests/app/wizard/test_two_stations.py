"""Two stations edit the same patient, session and walk: both versions are shown, and what is chosen holds."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.editing.dialog import EditDialog
from app.editing.session_recording import SessionRecording
from app.storage.edited_fields import patient_fields, recording_fields, session_fields
from app.storage.library import Library
from app.storage.opened import open_library
from app.storage.shared_edits import SharedEdits
from app.storage.stored import BEGINNING, LibraryError, Limits, PlacedSensor, StoredRecording, StoredSession
from app.storage.three_way import Value
from app.wizard.report.step import ReportStep
from app.wizard.results.stride_choice import StrideChoice
from app.wizard.step import StepId
from app.wizard.visit import Visit
from app.wizard.wizard import Wizard
from app.workers.library_controller import LibraryController
from core.body import Joint, Side, Site
from core.samples import SensorInfo
from core.session import Patient, Recording, RecordingKind, Session
from tests.app.library_answers import asked
from tests.app.wizard.conftest import PASSPHRASE
from tests.app.wizard.present import present

REPORTED = Patient("DEMO-9", 1966, height_m=1.68, aids="stick")
WALK = Recording("walk 1", RecordingKind.WALKING, "walk_1", {}, condition="shoes")
WORN = {Site.LEFT_THIGH: PlacedSensor("A", SensorInfo()), Site.RIGHT_THIGH: PlacedSensor("B", SensorInfo())}


class OtherStation:
    """Another computer with the same library, one patient, session and walk in it."""

    def __init__(self, library: Library) -> None:
        self.library = library
        self.patient = library.patients.create(REPORTED)
        visit = library.sessions.create(self.patient.id, Session(()))
        library.sessions.place(visit.id, WORN)
        self.session_id = visit.id
        self.walk_id = library.recordings.start(visit.id, WALK, is_simulated=True).id

    def say_of_patient(self, **reported: Value) -> None:
        base = patient_fields(self.library.patients.get(self.patient.id).details)
        self.library.edits.patient(self.patient.id, base, base | reported)

    def say_of_session(self, reported: dict[str, Value]) -> None:
        visit = self.session
        base = session_fields(visit.details, visit.comment, visit.limits)
        self.library.edits.session(self.session_id, base, base | reported)

    def say_of_walk(self, reported: dict[str, Value]) -> None:
        base = recording_fields(self.walk)
        self.library.edits.recording(self.walk_id, base, base | reported)

    @property
    def reported(self) -> Patient:
        return self.library.patients.get(self.patient.id).details

    @property
    def session(self) -> StoredSession:
        return self.library.sessions.get(self.session_id)

    @property
    def stored_walk(self) -> StoredRecording:
        return present(self.library.recordings.find(self.walk_id))

    @property
    def walk(self) -> Recording:
        return self.stored_walk.details

    def history(self) -> list[tuple[str, object, object, bool]]:
        """Field, old and new value of each change, oldest first, and whether it was taken back."""
        return [
            (change.field, change.old, change.new, one.is_undone)
            for one in reversed(self.library.corrections.of_patient(self.patient.id))
            for change in one.changes
        ]

    def refuse_broken_audit(self) -> None:
        assert self.library.audit.verify(BEGINNING).faults == ()


@pytest.fixture
def other(controller: LibraryController, tmp_path: Path) -> Iterator[OtherStation]:
    with open_library(tmp_path / "library", PASSPHRASE) as opened:
        yield OtherStation(opened.library)


@pytest.fixture
def ours(qtbot: QtBot, wizard: Wizard, other: OtherStation) -> Visit:
    """The session at our station, in the wizard, with the walk as it would have been read."""
    wizard.show_session(other.session_id)
    visit = present(wizard.visit)
    qtbot.waitUntil(lambda: visit.session is not None)
    visit.recordings.take_over(present(visit.session), (SessionRecording(other.stored_walk),))  # it has no journal
    return visit


class Ear:
    """Receives what the wizard states in its banner."""

    def __init__(self, visit: Visit) -> None:
        self.received: list[str] = []
        visit.merged.connect(self.hear)
        visit.refused.connect(self.hear)

    def hear(self, what: str, then: str) -> None:
        self.received.append(f"{what} {then}")


def dialog_of(qtbot: QtBot, wizard: Wizard) -> EditDialog:
    qtbot.waitUntil(lambda: wizard.asked.dialog is not None)
    return present(wizard.asked.dialog)


def report_of(wizard: Wizard) -> ReportStep:
    """The last step, with its page."""
    step = wizard.steps[StepId.REPORT]
    assert isinstance(step, ReportStep)
    wizard.shell.add_page(step.id, step.page)
    return step


def answer(dialog: EditDialog, *keys: Qt.Key) -> None:
    for key in keys:
        QTest.keyClick(dialog.focusWidget(), key)


def settle(qtbot: QtBot, visit: Visit, other: OtherStation, is_so: Callable[[], bool]) -> None:
    """Wait until the library holds it and nothing is asked any more."""
    qtbot.waitUntil(lambda: is_so() and not visit.is_asking)
    other.refuse_broken_audit()


def test_a_patient_who_is_deleted_at_another_station_is_missed_here_with_one_word(
    qtbot: QtBot, controller: LibraryController, ours: Visit, wizard: Wizard, other: OtherStation
) -> None:
    received: list[tuple[str, str]] = []
    ours.deleted_elsewhere.connect(lambda what, then: received.append((what, then)))
    with qtbot.assertNotEmitted(ours.deleted_elsewhere, wait=100):
        wizard.look_for_changes()
    other.library.patients.delete(other.library.patients.get(other.patient.id))
    for _ in range(3):  # as the watch has it done
        wizard.look_for_changes()
    qtbot.waitUntil(lambda: bool(received))
    assert wizard.shell.banner.text.startswith("At another workstation, hk deleted DEMO-9.")
    other.library.patients.restore(other.library.patients.get(other.patient.id))
    visit = other.session
    wizard.look_for_changes()
    asked(qtbot, controller, lambda library: library.folder)  # after the look
    other.library.sessions.delete(visit)
    wizard.look_for_changes()
    qtbot.waitUntil(lambda: len(received) > 1)
    assert {what for what, _ in received} == {"At another workstation, hk deleted DEMO-9."}
    other.refuse_broken_audit()


@pytest.mark.parametrize("is_ours", [True, False])
def test_a_height_typed_at_both_stations_is_asked_about_and_what_is_chosen_holds(
    qtbot: QtBot, wizard: Wizard, ours: Visit, other: OtherStation, is_ours: bool
) -> None:
    ear = Ear(ours)
    other.say_of_patient(height_m=1.80)
    ours.patient.edit(replace(ours.patient.details, height_m=1.82, mass_kg=70.0))
    ours.patient.commit()
    dialog = dialog_of(qtbot, wizard)
    ((mine, theirs),) = dialog.cells
    assert (mine.value, mine.whose, theirs.value) == ("182 cm", "Yours", "180 cm")
    assert theirs.whose.startswith("Theirs: H. Keller, today ")
    assert (other.reported.height_m, other.reported.mass_kg) == (1.80, 70.0)
    answer(dialog, Qt.Key.Key_Left if is_ours else Qt.Key.Key_Right, Qt.Key.Key_Return)
    chosen = 1.82 if is_ours else 1.80
    settle(qtbot, ours, other, lambda: other.reported.height_m == chosen == ours.patient.details.height_m)
    expected: list[tuple[str, object, object, bool]] = [
        ("height_m", 1.68, 1.80, False),
        ("mass_kg", None, 70.0, False),
        ("height_m", 1.80, 1.82, True),
        ("height_m", 1.82, 1.80, False),
    ]
    assert other.history() == expected + [("height_m", 1.80, 1.82, False)] * is_ours
    assert ear.received == []  # what is asked about is not reported as saved as well


def test_other_fields_of_a_patient_are_merged_without_a_question_and_reported(
    qtbot: QtBot, wizard: Wizard, ours: Visit, other: OtherStation
) -> None:
    ear = Ear(ours)
    other.say_of_patient(height_m=1.80)
    ours.patient.edit(replace(ours.patient.details, aids="frame"))
    ours.patient.commit()
    qtbot.waitUntil(lambda: bool(ear.received))
    (received,) = ear.received
    assert received.startswith(
        "Saved. DEMO-9 was also changed at another workstation. Height: 180 cm (H. Keller, today "
    )
    assert wizard.asked.dialog is None
    assert (other.reported.height_m, other.reported.aids) == (1.80, "frame")
    assert ours.patient.details == other.reported


def test_what_nobody_else_changed_is_saved_without_a_word(
    qtbot: QtBot, wizard: Wizard, ours: Visit, other: OtherStation
) -> None:
    ear = Ear(ours)
    other.say_of_patient(height_m=1.80)
    ours.patient.edit(replace(ours.patient.details, height_m=1.80))  # the same at both
    ours.patient.commit()
    ours.record.set_turned(Joint.LEFT_KNEE, -1)
    ours.record.set_comment("Limps.", "")
    ours.record.set_zero(Joint.LEFT_KNEE, 0.1)
    settle(qtbot, ours, other, lambda: bool(other.session.details.zero_rad))
    qtbot.waitUntil(lambda: ours.patient.is_saved)
    assert ear.received == []
    assert wizard.asked.dialog is None


def test_going_on_from_the_patient_waits_for_the_answer(qtbot: QtBot, wizard: Wizard, other: OtherStation) -> None:
    wizard.begin(other.patient)
    visit = present(wizard.visit)
    qtbot.waitUntil(lambda: visit.patient.is_saved)
    other.say_of_patient(height_m=1.80)
    visit.patient.edit(replace(visit.patient.details, height_m=1.82))
    wizard.press_primary()
    dialog = dialog_of(qtbot, wizard)
    assert wizard.step_id is not StepId.SENSORS
    answer(dialog, Qt.Key.Key_Escape)
    qtbot.waitUntil(lambda: wizard.step_id is StepId.SENSORS)
    assert other.reported.height_m == 1.80


def test_words_of_the_report_typed_at_both_stations_are_asked_about(
    qtbot: QtBot, wizard: Wizard, ours: Visit, other: OtherStation
) -> None:
    report = report_of(wizard).page.report
    other.say_of_session({"comment": "The left foot drags."})
    report.comment.setPlainText("Keep alignment C.")
    report.editor.flush()
    dialog = dialog_of(qtbot, wizard)
    assert [cell.value for cell in dialog.cells[0]] == ["Keep alignment C.", "The left foot drags."]
    qtbot.waitUntil(lambda: report.comment.toPlainText() == "The left foot drags.")
    answer(dialog, Qt.Key.Key_Left, Qt.Key.Key_Return)
    settle(qtbot, ours, other, lambda: other.session.comment == "Keep alignment C.")
    qtbot.waitUntil(lambda: report.comment.toPlainText() == "Keep alignment C.")
    assert ("comment", "", "The left foot drags.", False) in other.history()


def test_a_sign_turned_here_and_confirmed_there_is_asked_about_and_other_joints_are_not_touched(
    qtbot: QtBot, wizard: Wizard, ours: Visit, other: OtherStation
) -> None:
    other.say_of_session(
        {"turned_sign.left_knee": 1, "turned_sign.right_knee": -1, "zero_rad.left_ankle": np.deg2rad(5)}
    )
    ours.record.set_turned(Joint.LEFT_KNEE, -1)
    dialog = dialog_of(qtbot, wizard)
    assert [cell.value for cell in dialog.cells[0]] == ["reversed by hand", "confirmed by hand"]
    answer(dialog, Qt.Key.Key_Left, Qt.Key.Key_Return)
    required = {Joint.LEFT_KNEE: -1, Joint.RIGHT_KNEE: -1}
    settle(qtbot, ours, other, lambda: other.session.details.turned_sign == required)
    assert other.session.details.zero_rad == {Joint.LEFT_ANKLE: np.deg2rad(5)}
    qtbot.waitUntil(lambda: ours.details.turned_sign == required)


def test_a_limit_stated_here_does_not_take_back_one_stated_there(
    qtbot: QtBot, ours: Visit, other: OtherStation
) -> None:
    other.say_of_session({"without_ankle.left": True})
    ours.record.set_limits(replace(ours.record.limits, cannot_stand=True))
    required = Limits(frozenset({Side.LEFT}), cannot_stand=True)
    settle(qtbot, ours, other, lambda: other.session.limits == required == ours.record.limits)
    assert (other.session.limits, ours.record.limits) == (required, required)


def test_a_condition_typed_at_both_stations_is_asked_about_and_a_further_change_asks_again(
    qtbot: QtBot, wizard: Wizard, ours: Visit, other: OtherStation
) -> None:
    other.say_of_walk({"condition": "AFO"})
    (walk,) = ours.recordings.walks
    ours.recordings.change(walk, lambda reported: replace(reported, condition="barefoot"))
    dialog = dialog_of(qtbot, wizard)
    assert [cell.value for cell in dialog.cells[0]] == ["barefoot", "AFO"]
    other.say_of_walk({"condition": "stick"})
    answer(dialog, Qt.Key.Key_Left, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: wizard.asked.dialog not in (None, dialog))
    again = dialog_of(qtbot, wizard)
    assert [cell.value for cell in again.cells[0]] == ["barefoot", "stick"]
    answer(again, Qt.Key.Key_Left, Qt.Key.Key_Return)
    settle(qtbot, ours, other, lambda: other.walk.condition == "barefoot")


def test_strides_left_out_at_both_stations_are_all_left_out(qtbot: QtBot, ours: Visit, other: OtherStation) -> None:
    ear = Ear(ours)
    other.say_of_walk({"left_out_s.left": (4.0,)})
    (walk,) = ours.recordings.walks
    ours.recordings.change(walk, lambda reported: replace(reported, left_out_s={Side.LEFT: (7.0,)}))
    settle(qtbot, ours, other, lambda: other.walk.left_out_s == {Side.LEFT: (4.0, 7.0)})
    qtbot.waitUntil(lambda: bool(ear.received))
    assert "Strides excluded, left: 2 strides: 4.0 s, 7.0 s" in ear.received[0]
    choice = StrideChoice(ours.recordings, ours)
    choice.take_all_in("walk 1")
    settle(qtbot, ours, other, lambda: other.walk.left_out_s == {})
    qtbot.waitUntil(lambda: ours.recordings.walks[0].details.left_out_s == {})
    assert other.walk.left_out_s == {}


def test_taking_back_what_was_left_out_here_leaves_out_what_was_left_out_there(
    qtbot: QtBot, ours: Visit, other: OtherStation, controller: LibraryController
) -> None:
    undos: list[Callable[[], None]] = []
    choice = StrideChoice(ours.recordings, ours)
    choice.offered.connect(lambda _words, undo: undos.append(undo))
    ours.recordings.change(ours.recordings.walks[0], lambda reported: replace(reported, left_out_s={Side.LEFT: (7.0,)}))
    choice.take_all_in("walk 1")
    other.say_of_walk({"left_out_s.right": (4.0,)})
    undos[0]()
    asked(qtbot, controller, lambda _opened: None)  # what was stated before is there: it may look so amid it, too
    required = {Side.LEFT: (7.0,), Side.RIGHT: (4.0,)}
    settle(qtbot, ours, other, lambda: other.walk.left_out_s == required)
    assert other.walk.left_out_s == required


def test_sides_swapped_at_both_stations_are_swapped_once_and_taken_back_once(
    qtbot: QtBot, ours: Visit, other: OtherStation
) -> None:
    swapped = {Site.LEFT_THIGH: WORN[Site.RIGHT_THIGH], Site.RIGHT_THIGH: WORN[Site.LEFT_THIGH]}
    seen = {walk.id: walk.stored.placement.id for walk in ours.recordings.walks if walk.stored.placement}
    other.library.edits.placement(other.session_id, seen, [([other.walk_id], swapped)])
    with qtbot.waitSignal(ours.recordings.changed):
        ours.worn.swap_sides()
    assert present(other.stored_walk.placement).sensors == swapped


def test_nothing_is_asked_while_the_window_is_locked_and_all_of_it_after(
    qtbot: QtBot, wizard: Wizard, ours: Visit, other: OtherStation
) -> None:
    other.say_of_patient(height_m=1.80)
    ours.patient.edit(replace(ours.patient.details, height_m=1.82))
    ours.patient.commit()
    dialog_of(qtbot, wizard)
    wizard.asked.cover(is_covered=True)
    assert wizard.asked.dialog is None
    assert ours.is_asking
    wizard.asked.cover(is_covered=False)
    answer(dialog_of(qtbot, wizard), Qt.Key.Key_Left, Qt.Key.Key_Return)
    settle(qtbot, ours, other, lambda: other.reported.height_m == 1.82)


def test_what_is_refused_by_another_station_after_the_visit_was_left_is_still_asked(
    qtbot: QtBot, wizard: Wizard, ours: Visit, other: OtherStation
) -> None:
    other.say_of_patient(height_m=1.80)
    ours.patient.edit(replace(ours.patient.details, height_m=1.82))
    wizard.leave()  # which saves
    answer(dialog_of(qtbot, wizard), Qt.Key.Key_Left, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: other.reported.height_m == 1.82)


def test_words_of_the_report_saved_as_the_session_is_left_are_there_when_it_is_opened_again(
    qtbot: QtBot, wizard: Wizard, ours: Visit, other: OtherStation
) -> None:
    """Typed on while the first were being saved, they are saved after the session was left: nobody else's words."""
    report = report_of(wizard).page.report
    wizard.go_to(StepId.REPORT)
    for words in ("Keep", "Keep alignment C."):
        report.comment.setPlainText(words)
        report.editor.flush()
    wizard.show_session(other.session_id)
    visit = present(wizard.visit)
    assert visit is not ours
    ear = Ear(visit)
    qtbot.waitUntil(lambda: visit.session is not None)
    assert visit.record.comment == "Keep alignment C."
    visit.record.set_turned(Joint.LEFT_KNEE, -1)
    settle(qtbot, visit, other, lambda: bool(other.session.details.turned_sign) and not visit.is_saving)
    assert (ear.received, wizard.asked.dialog) == ([], None)


def test_words_typed_after_a_refusal_are_nobody_elses(
    qtbot: QtBot, wizard: Wizard, ours: Visit, other: OtherStation, monkeypatch: pytest.MonkeyPatch
) -> None:
    report = report_of(wizard).page.report
    wizard.go_to(StepId.REPORT)
    with monkeypatch.context() as patched:
        patched.setattr(SharedEdits, "session", _refuse)
        with qtbot.waitSignal(ours.record.refused):
            report.comment.setPlainText("Keep")
            report.editor.flush()
    report.comment.setPlainText("Keep alignment C.")
    report.editor.flush()
    settle(qtbot, ours, other, lambda: other.session.comment == "Keep alignment C.")
    assert wizard.asked.dialog is None


def _refuse(*_anything: object) -> None:
    raise LibraryError("The library is busy", "Try again")
