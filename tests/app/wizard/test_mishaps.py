"""What goes wrong around a visit: a busy library, a full disk, somebody who thinks again. Nothing is lost."""

import threading
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from uuid import uuid4

import pytest
from pytestqt.qtbot import QtBot

from app.acquisition.heartbeat import ProcessStall
from app.acquisition.recorder import Recorder
from app.editing.session_recording import Ongoing
from app.storage.journal.disk import Trouble
from app.storage.library import Library
from app.storage.opened import OpenedLibrary
from app.storage.shared_edits import SharedEdits
from app.storage.stored import LibraryBusyError, LibraryError, RecordingState
from app.system.progress import Report
from app.wizard import wizard as wizard_module
from app.wizard.free_motion.step import FreeMotionStep
from app.wizard.keys import Intent, KeyAction
from app.wizard.standing.step import StandStillStep
from app.wizard.step import StepId
from app.wizard.visit import Visit
from app.wizard.walking.step import WATCH_TICKS, WalkingStep
from app.wizard.wizard import DEAF_S, Wizard
from app.workers.library_controller import LibraryController
from core.body import LEG_SITES
from core.session import Patient, Recording, RecordingKind, Session
from tests.app.library_answers import asked
from tests.app.wizard.begun_visit import record, resumed, save_patient, start
from tests.app.wizard.present import present

BUSY = LibraryBusyError("Another program is using the library", "Wait a moment")


def failing(times: int, error: Exception, otherwise: Callable[..., object]) -> Callable[..., object]:
    left = [times]

    def call(*arguments: object, **named: object) -> object:
        if left[0]:
            left[0] -= 1
            raise error
        return otherwise(*arguments, **named)

    return call


def failing_once_halted(times: int) -> Callable[..., object]:
    """A recorder that has written all, and whose library is too busy to hear of it."""
    for_real = Recorder.stop
    busy = failing(times, BUSY, for_real)

    def stop(recorder: Recorder, opened: OpenedLibrary) -> object:
        recorder.halt()
        return busy(recorder, opened)

    return stop


def test_a_correction_that_is_refused_does_not_hide_the_walk_that_has_just_begun(
    qtbot: QtBot, looked_at: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    recordings, acquisition = looked_at.recordings, present(looked_at.sensors.acquisition)
    walk = record(qtbot, looked_at, RecordingKind.WALKING, 2.0)
    monkeypatch.setattr(
        SharedEdits, "decision", failing(1, LibraryError("Changed meanwhile", "ThemeNotifier"), SharedEdits.decision)
    )
    with qtbot.waitSignals([recordings.refused, recordings.begun]):
        recordings.keep(walk, is_kept=False)
        recordings.begin(acquisition, RecordingKind.WALKING)
    assert recordings.is_recording
    with qtbot.waitSignal(recordings.ended):
        recordings.stop()
    assert [recording.details.name for recording in recordings.walks] == ["walk 1", "walk 2"]


def test_a_walk_that_the_library_is_too_busy_for_is_read_back_later(
    qtbot: QtBot, looked_at: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.wizard.reading_back.READ_AGAIN_MS", 20)
    monkeypatch.setattr(Recorder, "stop", failing_once_halted(2))
    reported: list[tuple[str, str]] = []
    looked_at.recordings.refused.connect(lambda *words: reported.append(words))
    walk = record(qtbot, looked_at, RecordingKind.WALKING, 2.0)
    assert len(present(walk.read_back).imu) == len(LEG_SITES)
    assert not looked_at.recordings.is_recording
    assert len(reported) == 1
    assert "safe on the disk" in reported[0][1]


def test_a_library_that_stays_busy_does_not_hold_the_visit_for_ever(
    qtbot: QtBot, looked_at: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    recordings = looked_at.recordings
    monkeypatch.setattr("app.wizard.reading_back.READ_AGAIN_MS", 1)
    monkeypatch.setattr(Recorder, "stop", failing(10_000, BUSY, Recorder.stop))
    acquisition = start(qtbot, looked_at)
    reported: list[tuple[str, str]] = []
    recordings.refused.connect(lambda *words: reported.append(words))
    recordings.stop()
    qtbot.waitUntil(lambda: recordings.is_idle)
    assert "next starts" in reported[-1][1]  # what was written, or the whole: the disk may be done by then
    with pytest.raises(RuntimeError):
        acquisition.stop_recording()  # it has been, at once


@pytest.mark.parametrize(("trouble", "ends"), [(Trouble.DISK_FULL, True), (Trouble.LITTLE_ROOM, False)])
def test_a_full_disk_ends_the_recording_on_the_screen_too(
    qtbot: QtBot, looked_at: Visit, trouble: Trouble, ends: bool
) -> None:
    recordings = looked_at.recordings
    start(qtbot, looked_at)
    with qtbot.waitSignal(recordings.troubled) as reported:
        threading.Thread(target=recordings.meet, args=(trouble,)).start()  # as the journal's writer reports it
    assert all(sentence.endswith(".") for sentence in reported.args)
    assert recordings.is_stopping is ends
    if ends:
        qtbot.waitUntil(lambda: not recordings.is_recording)
        assert len(recordings.walks) == 1


def test_what_is_stated_of_a_late_disk_follows_its_counters(
    qtbot: QtBot, looked_at: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Amid a walk: first nothing is lost, then something is, then the disk answers again."""
    recordings = looked_at.recordings
    step = WalkingStep(looked_at)
    qtbot.addWidget(step.page)
    step.enter()
    acquisition = start(qtbot, looked_at)
    fine = present(recordings._latest).status
    now = [replace(fine, stuck_s=3.0)]
    monkeypatch.setattr(Recorder, "status", property(lambda _recorder: now[0]))
    with qtbot.waitSignal(recordings.troubled) as reported:
        recordings.meet(Trouble.DISK_SLOW)
    assert reported.args == [
        "The disk responds slowly.",
        "No data lost so far. Close programs that copy or download to this disk.",
    ]

    def stated() -> str:
        for _ in range(WATCH_TICKS):
            step.tick()
        return step.page.notice.text

    recording = present(step.bar().recording)
    assert "No data lost so far" in stated()
    assert "Saved" not in recording.note
    monkeypatch.setattr(acquisition, "lost", lambda: {"DEMO-left_foot": 400})
    assert "No data lost so far" not in stated()
    now[0] = replace(fine, stuck_s=3.0, dropped_records=5)
    assert "5 data packets were lost so far" in stated()
    now[0] = fine
    monkeypatch.setattr(acquisition, "lost", dict)
    assert stated() == "The disk was slow and now responds again. No data were lost because of this."
    recording = present(step.bar().recording)
    assert "Saved continuously." in recording.note
    step.leave()
    with qtbot.waitSignal(recordings.ended):
        recordings.stop()
    step.deleteLater()


@pytest.mark.parametrize(("is_before", "is_stated"), [(False, True), (True, False)])
def test_a_standstill_amid_a_recording_is_stated_on_every_step_that_records(
    qtbot: QtBot, wizard: Wizard, is_before: bool, is_stated: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    wizard.begin(None)
    visit = present(wizard.visit)
    ended_s = 99.0 if is_before else 121.0
    standstill = ProcessStall(ended_s - 20.0, ended_s, 20.0, 0.0, {"a": 0})
    acquisition = SimpleNamespace(
        standstills=(standstill,), now_s=125.0, lost=lambda: {"a": 9}, status=dict, trouble=None, is_simulated=False
    )
    reported = Recording("free motion", RecordingKind.FREE_MOTION, "free_motion", {})
    monkeypatch.setattr(visit.recordings, "ongoing", Ongoing(reported, 100.0))
    monkeypatch.setattr(visit.recordings, "_acquisition", acquisition)
    wizard._watch_recording()
    assert ("Gaitwright stalled for 20 s, 0:01 min into the recording." in wizard.shell.banner.text) is is_stated
    monkeypatch.setattr(visit.recordings, "ongoing", None)


def test_a_free_motion_that_is_refused_waits_for_a_word(
    qtbot: QtBot, looked_at: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    beginnings: list[object] = []
    begin_for_real = Recorder.begin

    def refused_once(*arguments: object, **more: object) -> object:
        beginnings.append(arguments)
        if len(beginnings) == 1:
            raise LibraryError("A recording needs 620 MB of free disk", "Delete files")
        return begin_for_real(*arguments, **more)  # type: ignore[arg-type]  # whatever the caller gave

    monkeypatch.setattr(Recorder, "begin", refused_once)
    step = FreeMotionStep(looked_at)
    qtbot.addWidget(step.page)
    with qtbot.waitSignal(looked_at.recordings.refused):
        step.enter()
    for _ in range(30):
        step.tick()
        qtbot.wait(1)
    assert len(beginnings) == 1
    primary = present(step.bar().primary)
    assert primary.text == "Start free motion"
    with qtbot.waitSignal(looked_at.recordings.begun):
        step.on_intent(Intent(KeyAction.RUN))
    with qtbot.waitSignal(looked_at.recordings.ended):
        step.leave()


@pytest.mark.parametrize("kind", [StandStillStep, FreeMotionStep])
def test_a_step_that_was_left_before_it_began_leaves_the_samples_to_the_next(
    qtbot: QtBot, looked_at: Visit, kind: type[StandStillStep] | type[FreeMotionStep], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The library answers when the next step looks at the sensors already."""
    acquisition, watching = present(looked_at.sensors.acquisition), list[object]()
    step = kind(looked_at)
    qtbot.addWidget(step.page)
    step.enter()
    if not looked_at.recordings.is_recording:  # a free motion begins by itself
        step.on_intent(Intent(KeyAction.RUN))
    with qtbot.waitSignal(looked_at.recordings.ended):
        step.leave()
        monkeypatch.setattr(acquisition, "set_estimator", watching.append)
    assert watching == []


def test_a_new_calibration_that_is_broken_off_is_asked_for_again(qtbot: QtBot, looked_at: Visit) -> None:
    recordings = looked_at.recordings
    for kind in (RecordingKind.STANDING, RecordingKind.FREE_MOTION, RecordingKind.WALKING):
        recordings.keep(record(qtbot, looked_at, kind, 1.0), is_kept=True)
    recordings.say_restrapped()
    broken_off = record(qtbot, looked_at, RecordingKind.STANDING, 1.0)
    assert broken_off.details.is_restrapped_before
    recordings.keep(broken_off, is_kept=False)
    assert recordings.is_restrapped
    standing = record(qtbot, looked_at, RecordingKind.STANDING, 1.0)
    assert standing.details.is_restrapped_before
    step = WalkingStep(looked_at)
    assert not step.bar().others[0].is_enabled  # nobody has moved since
    assert "Repeat standing still and free motion" in step.bar().note
    record(qtbot, looked_at, RecordingKind.FREE_MOTION, 1.0)
    assert step.bar().others[0].is_enabled


def test_strapping_again_before_what_does_not_count_is_reported_of_what_does(qtbot: QtBot, looked_at: Visit) -> None:
    recordings = looked_at.recordings
    record(qtbot, looked_at, RecordingKind.STANDING, 0.5)
    recordings.say_restrapped()
    discarded = record(qtbot, looked_at, RecordingKind.STANDING, 0.5)
    record(qtbot, looked_at, RecordingKind.FREE_MOTION, 0.5)
    recordings.keep(discarded, is_kept=False)
    qtbot.waitUntil(lambda: len(recordings.counted()) == 2)
    assert [recording.is_restrapped_before for recording in recordings.counted()] == [False, True]


def test_a_demonstration_that_was_left_gives_its_patient_to_no_other_session(
    qtbot: QtBot, controller: LibraryController, wizard: Wizard
) -> None:
    wizard.begin(None)
    wizard.steps[StepId.PATIENT].demonstration_required.emit()
    wizard.begin(None)  # before the library has answered
    asked(qtbot, controller, lambda _opened: None)
    assert present(wizard.visit).patient.details.code == ""


def test_who_skips_the_free_motion_is_reported_its_price(qtbot: QtBot, looked_at: Visit) -> None:
    step = WalkingStep(looked_at)
    assert step.bar().note == "Without free motion, joint angles are uncertain or missing."
    record(qtbot, looked_at, RecordingKind.FREE_MOTION, 0.5)
    qtbot.waitUntil(lambda: step.bar().note.startswith("Next:"))  # on a busy machine nothing is received for a moment


def test_walks_are_judged_without_sensors(qtbot: QtBot, library: Library, looked_at: Visit) -> None:
    looked_at.recordings.keep(record(qtbot, looked_at, RecordingKind.WALKING, 1.0), is_kept=True)
    qtbot.waitUntil(lambda: looked_at.recordings.walks[0].stored.is_decided)
    again = resumed(qtbot, looked_at)
    step = WalkingStep(again)
    qtbot.addWidget(step.page)
    assert step.cannot_enter == ""
    step.enter()
    assert not step.bar().others[0].is_enabled
    assert step.bar().note == "Choose the sensor source first."
    (walk,) = again.recordings.walks
    sha256 = {journal.segment: journal.sha256 for journal in walk.stored.journals}
    recovered = library.recordings.close(walk.id, RecordingState.RECOVERED, sha256)
    again.recordings.every = (replace(walk, stored=recovered, is_decided=False),)
    step.tick()
    assert "was recovered, up to the last data on disk" in step.page.notice.text
    step.page.discard_pressed.emit(str(walk.id))
    qtbot.waitUntil(lambda: not again.recordings.walks[0].details.is_kept)
    step.leave()
    again.finish()


def test_sensors_of_another_day_were_strapped_again(
    qtbot: QtBot, looked_at: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    for kind in (RecordingKind.STANDING, RecordingKind.FREE_MOTION, RecordingKind.WALKING):
        record(qtbot, looked_at, kind, 0.5)
    monkeypatch.setattr("app.wizard.visit.current_time", lambda: "2031-02-03T09:00:00+01:00")
    again = resumed(qtbot, looked_at, looked_at.known_choices)
    assert again.recordings.has_moved
    looked_at.sensors.close()
    with qtbot.waitSignal(again.refused) as reported:
        again.sensors.search(again.choices[0])
    assert "another day" in reported.args[0]
    assert again.recordings.must_move
    again.close()
    again.finish()


def test_a_session_stays_its_patients(qtbot: QtBot, begun: Visit) -> None:
    record(qtbot, begun, RecordingKind.WALKING, 0.5)
    begun.recordings.session = begun.session
    for code, is_taken in (("DEMO-8", True), ("P-8", False)):
        begun.patient.edit(replace(begun.patient.details, code=code))
        with qtbot.waitSignals([begun.patient.changed if is_taken else begun.patient.refused]):
            begun.patient.commit()
    assert begun.patient.details.code == "DEMO-8"  # corrected; what is simulated becomes nobody's who is not
    assert present(begun.patient.stored).id == present(begun.session).patient_id
    qtbot.waitUntil(lambda: not begun.evaluation.is_busy)


def test_the_session_of_somebody_with_others_is_given_to_nobody_else(
    qtbot: QtBot, library: Library, visit: Visit
) -> None:
    library.sessions.create(library.patients.create(Patient(code="DEMO-98")).id, Session(recordings=()))
    demo = present(library.patients.find("DEMO-98"))
    visit.patient.choose(demo)
    with qtbot.waitSignal(visit.changed):
        visit.record.begin()
    visit.patient.edit(Patient(code="DEMO-99", birth_year=1990))
    with qtbot.waitSignal(visit.patient.refused) as refused:
        visit.patient.commit()
    assert refused.args[0] == f"This session belongs to {demo.details.code}."
    assert visit.patient.details == demo.details
    assert library.patients.find("DEMO-99") is None


def test_a_code_is_written_otherwise_by_its_own_patient(qtbot: QtBot, visit: Visit) -> None:
    for code in ("demo-5", "DEMO-5"):
        save_patient(qtbot, visit, Patient(code=code))
    assert present(visit.patient.stored).details.code == "DEMO-5"


def test_a_session_that_is_gone_leads_back_and_states_so(
    qtbot: QtBot, wizard: Wizard, controller: LibraryController
) -> None:
    with qtbot.waitSignals([wizard.left, controller.refused]):
        wizard.show_session(uuid4())
    assert wizard.visit is None


def test_a_session_that_was_left_while_it_opened_does_not_open_in_the_next(
    qtbot: QtBot, wizard: Wizard, library: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(wizard_module, "choices", tuple)
    session = library.sessions.create(library.patients.create(Patient(code="DEMO-98")).id, Session(recordings=()))
    wizard.show_session(session.id)
    before = present(wizard.visit)
    wizard.begin(None)
    with qtbot.waitSignal(before.resumed):
        pass
    assert wizard.current is not wizard.steps[StepId.RESULTS]
    assert present(wizard.visit).session is None


def test_a_report_still_being_set_when_the_session_is_left_is_waited_for_at_the_end(
    qtbot: QtBot, wizard: Wizard
) -> None:
    wizard.begin(None)
    left, may_end, is_over = present(wizard.visit), threading.Event(), threading.Event()

    def work(_report: Report) -> None:
        may_end.wait(10.0)
        is_over.set()

    left.preview.start(work)
    wizard.begin(None)
    wizard.begin(None)
    assert not left.is_idle
    may_end.set()
    wizard.finish()
    assert is_over.is_set()
    assert left.is_idle


def test_a_key_that_was_meant_for_the_page_before_does_nothing(wizard: Wizard, monkeypatch: pytest.MonkeyPatch) -> None:
    """Space ends the free motion, and begins a walk once that page is there: it may have turned by itself meanwhile."""
    received: list[Intent] = []

    def hear(_step: WalkingStep, intent: Intent) -> bool:
        received.append(intent)
        return True

    monkeypatch.setattr(WalkingStep, "on_intent", hear)
    monkeypatch.setattr(WalkingStep, "cannot_enter", "")
    now_s = 1000.0
    monkeypatch.setattr("app.wizard.wizard.time.monotonic", lambda: now_s)
    wizard.begin(None)
    wizard._go_to(StepId.FREE_MOTION)
    wizard.steps[StepId.FREE_MOTION].done.emit()
    assert wizard.step_id is StepId.WALKING
    wizard.act_on(Intent(KeyAction.RUN))
    assert received == []
    wizard.act_on(Intent(KeyAction.UNDO))
    assert received == [Intent(KeyAction.UNDO)]
    now_s += DEAF_S + 0.01
    wizard.act_on(Intent(KeyAction.RUN))
    assert received[1:] == [Intent(KeyAction.RUN)]
