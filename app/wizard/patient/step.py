"""Whom the session is about: found or made in the library as it is typed."""

import datetime
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject

from app.widgets.action_bar import BarAction, BarState
from app.widgets.rail_row import StepState
from app.wizard.patient.cards import LastVisit
from app.wizard.patient.page import PatientDraft, PatientPage
from app.wizard.step import Step, StepId
from app.wording.body import name_of
from app.wording.dates import date
from app.wording.recordings import name_in_words
from app.wording.translation import tr
from core.body import LEG_JOINTS, Side
from core.session import Patient, RecordingKind, Session

if TYPE_CHECKING:
    from uuid import UUID

    from app.storage.opened import OpenedLibrary
    from app.storage.stored import StoredPatient, StoredSession
    from app.wizard.visit import Visit


class PatientStep(Step):
    """Goes on once the library has the patient, not before: what is recorded next belongs to somebody."""

    id = StepId.PATIENT

    def __init__(self, visit: "Visit", parent: QObject | None = None) -> None:
        super().__init__(visit, parent)
        self._page: PatientPage | None = None
        self._shown_id: UUID | None = None  # whose facts fill the page
        self._last: StoredSession | None = None
        self._last_of: UUID | None = None
        self._is_going_on = False
        self._taken_code = ""
        self._is_entered = False
        self._shown_without: frozenset[Side] = frozenset()  # feet answered to have no ankle joint, as the page has it
        visit.patient.read_again.connect(self._fill)
        visit.changed.connect(self._on_visit_changed)
        visit.patient.changed.connect(self._on_patient_changed)
        visit.patient.code_taken.connect(self._on_code_taken)
        visit.patient.refused.connect(self._on_refused)

    @property
    def page(self) -> PatientPage:
        if self._page is None:
            page = self._page = PatientPage()
            page.edited.connect(self._on_edited)
            page.code.committed.connect(self._visit.patient.commit)
            page.open_pressed.connect(self._on_open_pressed)
            page.same_set_up_pressed.connect(self._on_same_set_up_pressed)
        return self._page

    @property
    def title(self) -> str:
        return tr("Patient")

    @property
    def note(self) -> str:
        reported = self._visit.patient.details
        return _about(reported) if reported.code else tr("new session")

    @property
    def state(self) -> StepState:
        return StepState.DONE if self._visit.patient.stored is not None else StepState.TODO

    @property
    def topic(self) -> str:
        return "patient"

    def enter(self) -> None:
        self._is_entered = True
        self._fill()
        self._ask_last()

    def leave(self) -> None:
        self._is_entered = False
        self._visit.patient.commit()

    def bar(self) -> BarState:
        has_code = bool(self._visit.patient.details.code)
        note = tr("Enter the patient's code to continue.")
        if has_code:
            note = tr("Saved as you type.") if self._visit.patient.is_saved else tr("Not saved yet.")
        if self._taken_code:
            note = tr("Not saved: {code} is another patient's code.").format(code=self._taken_code)
        can_go_on = has_code and not self._taken_code
        go_on = BarAction(tr("Attach sensors"), self._go_on, tr("Enter"), is_enabled=can_go_on)
        if self._last is None or not self._last.placements or self._visit.session is not None:
            return BarState(primary=go_on, note=note)
        words = tr("Use last visit's set-up")
        again = BarAction(words, self._on_same_set_up_pressed, tr("Enter"), is_enabled=can_go_on)
        return BarState(primary=again, others=(replace(go_on, key="", is_requested=False),), note=note)

    def _go_on(self) -> None:
        patient = self._visit.patient
        if not patient.details.code:
            self.page.focus()
            return
        self._is_going_on = True
        patient.commit()
        self._go_on_if_saved()

    def _go_on_if_saved(self) -> None:
        if self._is_going_on and self._visit.patient.is_saved and not self._visit.is_asking:
            self._is_going_on = False
            self._visit.record.begin()
            self.done.emit()

    def _fill(self) -> None:
        """Fill the page with what is known of the patient; nothing that is being typed is overwritten."""
        patient = self._visit.patient
        self._shown_id = patient.stored.id if patient.stored is not None else None
        self._shown_without = self._visit.record.limits.without_ankle
        self.page.show_draft(PatientDraft(patient.details, self._shown_without))
        self._show_saved()

    def _show_saved(self) -> None:
        if self._page is not None:
            patient = self._visit.patient
            self._page.show_saved(
                tr("saved") if patient.is_saved else tr("draft") if patient.stored is None else tr("saving")
            )

    def _ask_last(self) -> None:
        """Look in the library for the visit before this one."""
        stored, session = self._visit.patient.stored, self._visit.session
        if stored is None or stored.id == self._last_of:
            return
        self._last_of = patient_id = stored.id
        own_id = session.id if session is not None else None

        def read(opened: "OpenedLibrary") -> "StoredSession | None":
            lines = opened.library.sessions.list(patient_id)
            before = next((line for line in lines if line.id != own_id and line.recordings), None)
            return None if before is None else opened.library.sessions.get(before.id)

        self._visit.controller.run(read, self._on_last_read, self._on_refused, self)

    def _on_last_read(self, session: "StoredSession | None") -> None:
        self._last = session
        if self._page is not None:
            self._page.show_last_visit(None if session is None else _last_visit(session))
        self.changed.emit()

    def _on_edited(self, draft: PatientDraft) -> None:
        self._shown_without = draft.without_ankle
        self._visit.record.set_limits(replace(self._visit.record.limits, without_ankle=draft.without_ankle))
        self._visit.patient.edit(draft.patient)
        if self._visit.patient.details.code != self._taken_code:
            self._taken_code = ""
        self._show_saved()
        self.changed.emit()

    def _on_visit_changed(self) -> None:
        """Show what another station entered about the feet, so that nobody answers over what was not seen."""
        if self._is_entered and self._visit.record.limits.without_ankle != self._shown_without:
            self._fill()

    def _on_patient_changed(self) -> None:
        self._taken_code = ""
        stored = self._visit.patient.stored
        if self._page is not None:
            if stored is not None and stored.id != self._shown_id and not self._page.draft.patient.code:
                self._fill()
            elif stored is not None:
                self._shown_id = stored.id
            self._page.show_code_taken("")
            self._show_saved()
            self._ask_last()
        self.changed.emit()
        self._go_on_if_saved()

    def _on_code_taken(self, code: str) -> None:
        self._is_going_on = False
        self._taken_code = code
        self.page.show_code_taken(code)
        self.changed.emit()

    def _on_refused(self, _what: str, _remedy: str) -> None:
        self._is_going_on = False  # the wizard's banner states why
        if self._page is not None and self._page.draft.patient.code.strip() != self._visit.patient.details.code:
            self._fill()  # another's code, which was not taken
            self.changed.emit()

    def _on_open_pressed(self, code: str) -> None:
        if self._visit.session is not None:
            reported = self._visit.session.details.patient.code
            self.reported.emit(
                tr("This session belongs to {code}.").format(code=reported),
                tr("Go back to all patients to start a session for another patient."),
            )
            return

        def find(opened: "OpenedLibrary") -> "StoredPatient | None":
            return opened.library.patients.find(code)

        self._visit.controller.run(find, self._on_found, self._on_refused, self)

    def _on_found(self, stored: "StoredPatient | None") -> None:
        if stored is not None:
            self._visit.patient.choose(stored)
            self._fill()
            self.page.focus()

    def _on_same_set_up_pressed(self) -> None:
        """Take zero and placement as they were, and go on."""
        if self._last is None:
            return
        for joint, zero_rad in self._last.details.zero_rad.items():
            self._visit.record.set_zero(joint, zero_rad)
        if self._last.placements:
            self._visit.placement_before = self._last.placements[-1].site_of
        self._go_on()


def _about(patient: Patient) -> str:
    """Give which side it is about, in two words: "Left prosthetic"."""
    words = {
        "left": (tr("Left affected"), tr("Left prosthetic")),
        "right": (tr("Right affected"), tr("Right prosthetic")),
        "both": (tr("Both affected"), tr("Both prosthetic")),
    }
    if patient.prosthetic_side in words:
        return words[patient.prosthetic_side][1]
    return words[patient.affected_side][0] if patient.affected_side in words else ""


def _last_visit(session: "StoredSession") -> LastVisit:
    reported = session.details
    try:
        day = date(datetime.datetime.fromisoformat(reported.started).date())
    except ValueError:
        day = reported.started
    walks = [one for one in reported.recordings if one.kind is RecordingKind.WALKING and one.is_kept]
    called = dict.fromkeys(name_in_words(walk.condition or walk.name) for walk in walks)
    facts = [
        (tr("Walks"), ", ".join(called) or tr("none included")),
        (tr("Standing angle (goniometer)"), _zero_in_words(reported)),
    ]
    if session.placements:
        sensors = session.placements[-1].site_of
        facts.append((tr("Sensors"), ", ".join(sorted(sensors))))
    if reported.surface:
        facts.append((tr("Surface"), reported.surface))
    return LastVisit(tr("Last visit, {day}").format(day=day), tuple(facts))


def _zero_in_words(reported: Session) -> str:
    """Give the goniometer's values while standing: "left knee 15°, others 0°"."""
    values = {joint: round(float(np.rad2deg(reported.zero_rad.get(joint, 0.0)))) for joint in LEG_JOINTS}
    bent = [
        tr("{joint} {angle}°").format(joint=name_of(joint), angle=str(angle).replace("-", "\N{MINUS SIGN}"))
        for joint, angle in values.items()
        if angle
    ]
    if not bent:
        return tr("all 0°")
    return ", ".join(bent if len(bent) == len(LEG_JOINTS) else [*bent, tr("others 0°")])
