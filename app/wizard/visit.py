"""One session in progress: whose it is, what is worn, what was recorded, and what that shows.

It lives on the screen's thread. Steps read it and ask it; it knows no page. What takes long is done by the library's
controller or beside the screen, and comes back as a signal.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal

from app.acquisition.live_sensors import live_sensors
from app.editing.deleted_elsewhere import deleted_by, deletion_message
from app.editing.patient import PatientRecord
from app.editing.question import EditQuestion
from app.editing.session import SessionRecord, current_time
from app.editing.session_recording import SessionRecording
from app.storage.stored import StoredSession
from app.system.progress import Report
from app.wizard.clips import VisitClips
from app.wizard.evaluation import Evaluation
from app.wizard.fetch_control import FetchControl
from app.wizard.kept_results import KeptResults
from app.wizard.recordings import SessionRecordings
from app.wizard.resuming import (
    USABLE,
    EarlierVisit,
    Resumed,
    evaluated,
    read_earlier_visit,
    read_recordings,
    read_session,
    rests_of,
    with_limits,
)
from app.wizard.reviewing import Reviewing
from app.wizard.worn_corrections import WornCorrections
from app.wizard.worn_sensors import SourceChoice, WornSensors
from app.wording.translation import tr
from app.workers.background import Background
from app.workers.library_controller import LibraryController
from core.body import LEG_JOINTS, Joint, Side, Site
from core.prosthesis import JointNature, Prostheses
from core.session import Patient, Recording, RecordingKind, Session

if TYPE_CHECKING:
    from concurrent.futures import Future

    from app.storage.opened import OpenedLibrary
    from app.wizard.memory_fetches import MemoryFetches
    from core.calibration.rest import Rest
    from core.hip.results import HipIdentification
    from core.live.sensors import LiveSensor
    from core.results import JointCalibration

MOST_EARLIER = 4  # visits; more are too many lines on one axis
DEMO = "DEMO"  # how the codes of patients begin that simulated recordings are kept for, as the library has it


class Visit(QObject):
    """`session` is None until the patient is known. Nothing of it is lost when this object goes: all is in the library.

    `earlier_read`: the patient's visits before this one, each an EarlierVisit, in order of time.
    """

    changed = Signal()  # the session's row, or what is known of zero and standing
    changed_elsewhere = Signal()  # by another station of the clinic: what is held here is as it was before
    deleted_elsewhere = Signal(str, str)
    resumed = Signal()  # a session of the library has been read, with its recordings
    earlier_read = Signal(object)
    refused = Signal(str, str)  # what the library or a source refused, and what to do
    merged = Signal(str, str)  # what another station changed of the same meanwhile, in two sentences
    asked = Signal(object)  # an EditQuestion: what both changed; it is answered by `settle`

    def __init__(
        self,
        controller: LibraryController,
        choices: Sequence[SourceChoice],
        parent: QObject | None = None,
        now_s: Callable[[], float] = time.monotonic,
    ) -> None:
        super().__init__(parent)
        self._controller, self._now_s = controller, now_s
        self.known_choices = choices  # which may become more
        self.patient = PatientRecord(controller, self, self._refuses_code)
        self.record = SessionRecord(controller, self.patient, self)
        self.sensors = WornSensors(self)
        self.recordings = SessionRecordings(controller, self)
        self.clips = VisitClips(controller, self.recordings, self)
        self.worn = WornCorrections(controller, self.sensors, self.recordings, self)
        self.evaluation = Evaluation(self)
        self._kept_results = KeptResults(controller, self.evaluation, self.recordings, self)
        self.reviewing = Reviewing(self)
        self.preview = Background(self)
        """Sets the report's pages; of the visit, for its threads outlive a step."""
        self.looking = Background(self)
        """Finds out how a joint was found."""
        self.comparing = Background(self)
        """Compares the session with an optical system."""
        self.rests: dict[str, Rest] = {}
        """What each sensor, by name, reads while the patient is standing; empty until then."""
        self.placement_before: dict[str, Site] = {}
        """Site by the sensor's name as at the last visit, where the same set-up was asked for."""
        self.source_before = ""
        """The key of the source that was received last at this workstation."""
        self._began_s: float | None = None
        self._ended_s: float | None = None
        self._is_of_another_day = self._must_look = False
        self._deleted_by = ""  # who deleted it at another station
        self._questions = 0
        for part in (self.patient, self.record, self.recordings):
            part.merged.connect(self.merged)
            part.asked.connect(self._ask)
            part.refused.connect(self.refused)
        self.record.held.connect(self._on_held)
        self.record.changed.connect(self._on_record_changed)
        self.worn.corrected.connect(self._on_corrected)
        self.worn.asked.connect(self._ask)
        self.worn.refused.connect(self._on_refused)
        self.sensors.refused.connect(self.refused)
        self.sensors.opened.connect(self._on_sensors_opened)
        self.evaluation.refused.connect(self.refused)
        self.clips.refused.connect(self.refused)
        self.reviewing.refused.connect(self.refused)
        self.fetch = FetchControl(self.recordings, self.sensors, self)
        """Gets recordings out of the sensors' memories."""
        self.recordings.ended.connect(self._on_recording_ended)
        self.recordings.begun.connect(self._note_lost_clocks)
        self.recordings.changed.connect(self._on_recordings_changed)

    @property
    def controller(self) -> LibraryController:
        return self._controller

    # the stopwatch

    @property
    def elapsed_s(self) -> float | None:
        """Since the session began; no longer counted once the results are looked at. None: looked at only."""
        if self._began_s is None:
            return None
        return (self._now_s() if self._ended_s is None else self._ended_s) - self._began_s

    def begin_stopwatch(self) -> None:
        self._began_s, self._ended_s = self._now_s(), None

    def end_stopwatch(self) -> None:
        if self._ended_s is None:
            self._ended_s = self._now_s()

    # the session

    @property
    def session(self) -> StoredSession | None:
        return self.record.stored

    @property
    def details(self) -> Session:
        """What was entered about the session, in its newest version as on the screen; without recordings."""
        return self.record.reported

    @property
    def prosthetic_sides(self) -> frozenset[Side]:
        return self.patient.details.prosthetic_sides

    @property
    def prosthetic_joints(self) -> frozenset[Joint]:
        """Those that the prosthesis has, as far as is known; above a stated level they are the patient's."""
        of_prosthesis = (JointNature.PROSTHETIC, JointNature.RIGID)
        return frozenset(joint for joint in LEG_JOINTS if self.patient.details.nature_of(joint) in of_prosthesis)

    @property
    def without_ankle(self) -> frozenset[Side]:
        return self.patient.details.without_ankle(self.record.limits.without_ankle)

    @property
    def has_skipped_standing(self) -> bool:
        return self.record.limits.cannot_stand

    @property
    def is_simulated(self) -> bool:
        acquisition = self.sensors.acquisition
        return bool(self.details.is_simulated or (acquisition is not None and acquisition.is_simulated))

    @property
    def may_simulate(self) -> bool:
        """Whether simulated recordings may be kept for this patient: the demonstration's, or one coded for it."""
        state = self._controller.state
        is_demonstration = state is not None and state.is_demonstration
        return is_demonstration or self.patient.details.code.startswith(DEMO)

    @property
    def cannot_record(self) -> str:
        """Why nothing is kept of what the open sensors send; empty where it is."""
        acquisition = self.sensors.acquisition
        if acquisition is None or not acquisition.is_simulated or self.may_simulate:
            return ""
        stated = tr("These sensors are simulated and {code} is not a demonstration patient. Nothing would be recorded.")
        return stated.format(code=self.patient.details.code)

    @property
    def cannot_calibrate(self) -> str:
        """What is missing for standing or free motion, in a sentence; empty where nothing is."""
        if self.session is None:
            return tr("Enter the patient's code first.")
        if self.sensors.acquisition is None:
            return tr("Choose the sensor source first.")
        if not self.sensors.site_of and not self.sensors.is_left_to_motion:
            return tr("Set the sensor positions first.")
        if self.sensors.are_in_memory:
            return tr("The sensors are ready to record walks. First set them to send data live, on the Sensors step.")
        return self.cannot_record

    @property
    def choices(self) -> tuple[SourceChoice, ...]:
        """The sources through which this patient's sensors can be received."""
        offered = [choice for choice in self.known_choices if self.may_simulate or not choice.is_simulated]
        return tuple(choice.for_patient(self.patient.details) for choice in offered)

    def place_sensors(self, only: Side | None = None) -> None:
        """Report to the library who wears what: what is recorded next takes it, all of it or that of one leg."""
        if self.session is None:
            return
        session_id = self.session.id
        placed = {site: one for site, one in self.sensors.placed().items() if only in (None, site.side)}

        def place(opened: "OpenedLibrary") -> StoredSession:
            opened.library.sessions.place(session_id, placed)
            return opened.library.sessions.get(session_id)

        self._controller.run(place, self.record.take, self._on_refused, self)

    def _note_lost_clocks(self) -> None:
        """Where sensors were stated to be on one clock and some no longer are, report that to the library."""
        reported = self.session.details.sensors if self.session is not None else {}
        worn = self.sensors.placed()
        if any(one.info.clock == "" and site in reported and reported[site].clock for site, one in worn.items()):
            self.place_sensors()

    def resume(self, session_id: UUID) -> None:
        """Take up a session of the library where it was left; `resumed` follows."""

        def read(opened: "OpenedLibrary") -> Resumed:
            return read_session(opened, session_id)

        self._controller.run(read, self._on_resumed, self._on_refused, self)

    def look_for_changes(self) -> None:
        """Find out whether another station changed the session; `changed_elsewhere` follows where it did."""
        if self.session is None:
            return
        self._must_look = not self.recordings.is_idle  # then again once what is recorded has been read back
        session_id, patient_id = self.session.id, self.session.patient_id

        def read(opened: "OpenedLibrary") -> tuple[StoredSession, str]:
            return opened.library.sessions.get(session_id), deleted_by(opened, patient_id, session_id)

        self._controller.run(read, self._on_looked, self._on_not_looked, self)

    def read_again(self) -> None:
        """Show the session as the library has it now; sensors stay."""
        if self.session is None or not self.recordings.is_idle:
            return
        session_id = self.session.id

        def read(opened: "OpenedLibrary") -> tuple[StoredSession, tuple[SessionRecording, ...]]:
            session = opened.library.sessions.get(session_id)
            return session, read_recordings(opened, session)

        self._controller.run(read, self._on_read, self._on_refused, self)

    def live_sensors(self) -> "Mapping[str, LiveSensor]":
        """What the live estimator has to know of each sensor that is worn, by its name."""
        return live_sensors(self.sensors.site_of, self.rests, self.sensors.status)

    @property
    def calibration(self) -> "Mapping[Joint, JointCalibration]":
        """What was found of each joint, as far as it holds for the sensors that are worn there now."""
        return {joint: one for joint, one in self.evaluation.calibration.items() if self._is_of_worn(joint)}

    @property
    def hips(self) -> "Mapping[Joint, HipIdentification]":
        """As `calibration`, of the hips."""
        return {joint: one for joint, one in self.evaluation.hips.items() if self._is_of_worn(joint)}

    def _is_of_worn(self, joint: Joint) -> bool:
        """Whether what was evaluated of a joint was measured by the sensors that are worn at its places now."""
        session, worn = self.evaluation.session, self.sensors.sensor_at
        both = joint.proximal, joint.distal
        for recording in reversed(session.recordings if session is not None else ()):
            if all(site in recording.imu for site in both):
                return all(recording.imu[site].sensor == worn.get(site) for site in both)
        return False

    def evaluate(self, with_walk: Recording | None = None) -> None:
        """Find out what the recordings show, with a walk that still goes on; `evaluation.done` follows."""
        recordings = self.recordings.counted() + ((with_walk,) if with_walk is not None else ())
        if any(recording.kind is not RecordingKind.STANDING for recording in recordings):
            sensors = self.session.details.sensors if self.session is not None else {}
            reported = with_limits(
                replace(self.details, sensors=sensors, is_simulated=self.is_simulated), self.record.limits
            )
            self._kept_results.is_partial = with_walk is not None
            self.evaluation.ask(replace(reported, recordings=recordings))

    def evaluate_if_stale(self) -> None:
        """Find it out again where other recordings count, or other samples of them, or other legs were stated."""
        recordings, evaluated = self.recordings.counted(), self.evaluation.session
        is_stale = (
            evaluated is None
            or not _are_same(evaluated.recordings, recordings)
            or _legs(evaluated.patient) != _legs(self.patient.details)
        )
        if recordings and is_stale and not self.evaluation.is_busy:
            self.evaluate()

    def read_earlier(self) -> None:
        """Evaluate the patient's first visit and the latest before this one; `earlier_read` follows."""
        if self.session is None:
            return
        session = self.session

        def work(opened: "OpenedLibrary", report: Report) -> list[EarlierVisit]:
            lines = opened.library.sessions.list(session.patient_id)  # latest first
            before = [line for line in lines if line.id != session.id and line.started < session.details.started]
            shown = before if len(before) <= MOST_EARLIER else [*before[: MOST_EARLIER - 1], before[-1]]
            return [read_earlier_visit(opened, line.id, report) for line in reversed(shown)]

        self._controller.run_long(work, self._on_earlier_read, self._on_refused, None, self, is_quiet=True)

    def close(self) -> None:
        """Let go of the sensors and wait for what runs; a recording that goes on is stopped first."""
        self.patient.commit()
        acquisition = self.sensors.detach() if self.recordings.is_recording else None
        self.recordings.close()
        if acquisition is not None:

            def close(_opened: "OpenedLibrary", _turn: "Future[None]") -> None:
                acquisition.close()

            # in its turn, after the recording has been stopped
            self._controller.record(close, None, None, self._controller)
        else:
            self.sensors.close()

    @property
    def is_idle(self) -> bool:
        """Whether nothing of it goes on any more: no recording, no thread, no window of Rerun's."""
        is_idle = self.recordings.is_idle and all(part.is_idle for part in self._with_threads)
        return is_idle and not (self.is_asking or self.is_saving)

    @property
    def is_saving(self) -> bool:
        """Whether the library has yet to receive, or to answer, what was entered of the session and its patient."""
        return self.record.is_busy or self.worn.is_busy or self.patient.is_saving

    def finish(self) -> None:
        """Wait for all threads: for the end of the program."""
        for part in self._with_threads:
            part.finish()

    @property
    def _with_threads(
        self,
    ) -> "tuple[MemoryFetches | WornSensors | Evaluation | Reviewing | VisitClips | Background, ...]":
        fetches, pages = self.recordings.fetches, (self.preview, self.looking, self.comparing)
        return (fetches, self.sensors, self.evaluation, self.reviewing, self.clips, *pages)

    @property
    def is_asking(self) -> bool:
        """Whether what two stations changed is still to be chosen from."""
        return self._questions > 0

    def settle(self, question: EditQuestion, fields: frozenset[str]) -> None:
        """Answer what was `asked`: of `fields` our own value is to hold."""
        self._questions -= 1
        question.settle(fields)

    def _ask(self, question: EditQuestion) -> None:
        self._questions += 1
        self.asked.emit(question)

    def _on_held(self) -> None:
        """Find out again what the recordings show, where it was found out with other limits, zeros or signs."""
        evaluated, session = self.evaluation.session, self.session
        if evaluated is None or session is None:
            return
        reported = with_limits(session.details, session.limits)
        if (*_by_hand(evaluated), evaluated.findings) != (*_by_hand(reported), reported.findings):
            self.evaluate()

    def _on_record_changed(self) -> None:
        self.recordings.session = self.session
        self.changed.emit()

    def _on_corrected(self, session: StoredSession, recordings: Sequence[SessionRecording]) -> None:
        self.record.take(session)
        self._put_recordings(session, recordings)

    def _on_read(self, read: tuple[StoredSession, tuple[SessionRecording, ...]]) -> None:
        """Go on from what the library holds now; nothing that was entered here still waits to be saved."""
        session, recordings = read
        self.record.take_instead(session)
        self._put_recordings(session, recordings)

    def _put_recordings(self, session: StoredSession, recordings: Sequence[SessionRecording]) -> None:
        before = {recording.id: recording for recording in self.recordings.every}
        kept = (
            replace(before.get(recording.id, recording), stored=recording.stored, read_back=recording.read_back)
            for recording in recordings
        )
        self.recordings.take_over(session, tuple(kept))
        self.changed.emit()
        self.evaluate()

    def _on_looked(self, looked: tuple[StoredSession, str]) -> None:
        found, by = looked
        is_news, self._deleted_by = by != self._deleted_by, by
        if by:
            if is_news:
                self.deleted_elsewhere.emit(*deletion_message(self.patient.details.code, by))
            return
        if self.session is None or self.record.is_busy or not self.recordings.is_idle:
            return
        here = [(one.id, one.stored.details, one.stored.placement) for one in self.recordings.every]
        there = [(one.id, one.details, one.placement) for one in found.recordings if one.state in USABLE]
        before = (*_by_hand(self.session.details), self.session.limits)
        if here != there or before != (*_by_hand(found.details), found.limits):
            self.changed_elsewhere.emit()

    def _on_not_looked(self, _what: str, _remedy: str) -> None:
        """No harm: it is looked at again."""

    def _on_earlier_read(self, found: list[EarlierVisit]) -> None:
        self.earlier_read.emit(found)

    def _on_resumed(self, read: Resumed) -> None:
        patient, session, recordings, known = read
        self.record.resume(session)
        self.patient.choose(patient)
        self.patient.has_this_session_only = patient.sessions == 1
        latest = _day(recordings[-1].details.started) if recordings else ""
        self._is_of_another_day = latest not in ("", _day(current_time()))
        self.recordings.take_over(session, recordings)
        self.rests = rests_of(recordings)
        if known is not None:
            self.evaluation.take_over(evaluated(session, recordings), known)
        else:
            self.evaluate()
        self.resumed.emit()
        self.changed.emit()

    def _refuses_code(self, code: str) -> tuple[str, str]:
        """A session stays its patient's, and what is simulated a simulated patient's."""
        if self.session is None or self.patient.stored is None:
            return "", ""
        own = self.patient.stored.details.code
        if not self.patient.has_this_session_only:
            what = tr("This session belongs to {code}.").format(code=own)
            return what, tr("Go back to all patients to start a session for another patient.")
        if self.recordings.every and self.is_simulated and own.startswith(DEMO) and not code.startswith(DEMO):
            what = tr("Simulated recordings cannot be assigned to {code}.").format(code=code)
            return what, tr("Go back to all patients to start a session for another patient.")
        return "", ""

    def _on_sensors_opened(self) -> None:
        """What was worn on another day was taken off since."""
        if self._is_of_another_day:
            self._is_of_another_day = False
            self.recordings.say_restrapped()
            self.refused.emit(
                tr("This session began on another day. The sensors have been reattached since."),
                tr("Repeat standing still and free motion before the next walk."),
            )

    def _on_recording_ended(self) -> None:
        self.evaluate()

    def _on_recordings_changed(self) -> None:
        if self._must_look:
            self.look_for_changes()
        self.changed.emit()

    def _on_refused(self, what: str, remedy: str) -> None:
        self.refused.emit(what, remedy)
        self.changed.emit()


def _by_hand(reported: Session) -> tuple[dict[Joint, float], dict[Joint, int]]:
    """What was entered about the joints: zeros and signs."""
    return dict(reported.zero_rad), dict(reported.turned_sign)


def _legs(patient: Patient) -> tuple[str, str, Prostheses]:
    """What was entered about the legs, which the figures depend on."""
    return patient.affected_side, patient.prosthetic_side, patient.worn


def _day(moment: str) -> str:
    return moment[:10]


def _are_same(evaluated: Sequence[Recording], recordings: Sequence[Recording]) -> bool:
    """Whether these are the recordings that were evaluated, with the very samples: amid a walk only a part was seen."""
    return len(evaluated) == len(recordings) and all(
        one.imu is other.imu and replace(one, imu={}) == replace(other, imu={})
        for one, other in zip(evaluated, recordings, strict=True)
    )
