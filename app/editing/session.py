"""What is said of the session of a visit, kept as it is said."""

import datetime
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal

from app.editing.patient import PatientRecord
from app.editing.question import EditQuestion, chosen_fields
from app.editing.words import others_message
from app.storage.edited_fields import SESSION_CORRECTABLE, session_fields, with_session_fields
from app.storage.stored import Limits, StoredSession
from app.storage.three_way import Contest, Edited, Value, Values, rebased
from app.system.logs import version_of
from app.wording.translation import tr
from app.workers.library_controller import LibraryController
from core.body import Joint
from core.samples import Session

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary


class SessionRecord(QObject):
    """`told` is what stands on the screen, `stored` what the library holds; the second follows the first.

    There is no session before `begin` or `resume`; what is said before waits for it.

    Signals
    -------
    changed
        What the library holds, or what was refused of what is said.
    held
        The library holds all that is said; `changed` follows.
    refused
        What the library refused, and what to do.
    merged
        What another station changed of the same session meanwhile, in two sentences.
    asked
        An EditQuestion: what both changed.
    """

    changed = Signal()
    held = Signal()
    refused = Signal(str, str)
    merged = Signal(str, str)
    asked = Signal(object)

    def __init__(self, controller: LibraryController, patient: PatientRecord, parent: QObject) -> None:
        super().__init__(parent)
        self._controller, self._patient = controller, patient
        self.stored: StoredSession | None = None
        self.limits = Limits()
        """What the patient's body does not allow, the last word of it on the screen."""
        self.comment = ""
        """The clinician's words, the last of them on the screen."""
        self._wanted: Session | None = None
        self._sent: dict[str, Value] = {}
        """What was said of the session when the library was asked last."""
        self._is_busy = False

    @property
    def is_busy(self) -> bool:
        """Whether the library is still to answer."""
        return self._is_busy

    @property
    def told(self) -> Session:
        """What was said about the session, the last word of it on the screen; without recordings."""
        told = self._wanted or (self.stored.details if self.stored is not None else Session(recordings=()))
        return replace(told, recordings=(), patient=self._patient.details)

    @property
    def is_settled(self) -> bool:
        """Whether the library holds all that is said."""
        return not self._is_busy and self._wanted is None

    def begin(self) -> None:
        """Make the session's row, once the patient has one; `changed` follows."""
        patient = self._patient.stored
        if self.stored is not None or patient is None or self._is_busy:
            return
        self._is_busy = True
        self._patient.has_this_session_only = patient.sessions == 0
        state = self._controller.state
        told = Session(
            recordings=(),
            started=current_time(),
            operator=state.operator.name if state is not None else "",
            software=f"gaitwright {version_of('gaitwright')}",
        )
        limits = self.limits
        self._sent = _said_fields(told, "", limits)

        def create(opened: "OpenedLibrary") -> StoredSession:
            return opened.library.sessions.create(patient.id, told, limits)

        self._controller.run(create, self._on_created, self._on_refused, self)

    def resume(self, stored: StoredSession) -> None:
        """Go on with a session of the library, of which nothing has been said here."""
        self.stored, self.limits, self.comment = stored, stored.limits, stored.comment

    def take(self, stored: StoredSession) -> None:
        """Go on from what the library holds; what was said since it was read last stays said, and is saved."""
        self._take(stored, _fields_of(self.stored or stored))

    def take_instead(self, stored: StoredSession) -> None:
        """Go on from what the library holds, in place of all that is said here."""
        self._take(stored, _said_fields(self.told, self.comment, self.limits))

    def set_zero(self, joint: Joint, zero_rad: float | None) -> None:
        """Take the goniometer's value while standing, radians in the clinical sign; None: the standing itself is 0."""
        zero = {**self.told.zero_rad}
        if zero_rad is None:
            zero.pop(joint, None)
        else:
            zero[joint] = zero_rad
        self._change(replace(self.told, zero_rad=zero))

    def set_limits(self, limits: Limits) -> None:
        """Take what the patient's body does not allow; before there is a session, it waits for that."""
        if limits != self.limits:
            self.limits = limits
            self._change(self.told)

    def set_comment(self, comment: str, shown: str) -> None:
        """Take the clinician's words, which were typed where `shown` stood.

        Words that stood here still to be saved, or were refused, are nobody else's.
        """
        upon = {"comment": shown} if shown != self.comment else None
        self.comment = comment
        self._change(self.told, upon)

    def set_turned(self, joint: Joint, sign: int | None) -> None:
        """Turn (-1) or confirm (1) the sign that was found of a joint; None: as found. `held` follows."""
        turned = {**self.told.turned_sign}
        if sign is None:
            turned.pop(joint, None)
        else:
            turned[joint] = sign
        self._change(replace(self.told, turned_sign=turned))

    def _change(self, told: Session, upon: Values | None = None) -> None:
        """Save what is said of the session; `upon`: where it was said upon something else than the library has."""
        self._wanted = told
        if self.stored is not None and not self._is_busy:
            self._save({**_fields_of(self.stored), **(upon or {})})

    def _save(self, upon: Values) -> None:
        assert self.stored is not None  # whoever asks has seen to it
        self._is_busy = True
        session_id = self.stored.id
        held = session_fields(self.stored.details, self.stored.comment, self.stored.limits)
        self._sent = _said_fields(self.told, self.comment, self.limits)
        shown, said = {**held, **upon}, {**held, **self._sent}

        def save(opened: "OpenedLibrary") -> Edited[StoredSession]:
            return opened.library.edits.session(session_id, shown, said)

        self._controller.run(save, self._on_saved, self._on_refused, self)

    def _on_created(self, session: StoredSession) -> None:
        self._is_busy = False
        self._take(session, self._sent)

    def _on_saved(self, edited: Edited[StoredSession]) -> None:
        self._is_busy = False
        self._take(edited.stored, self._sent)
        self._tell(edited)

    def _tell(self, edited: Edited[StoredSession]) -> None:
        if edited.others:
            now = datetime.datetime.now().astimezone()
            self.merged.emit(*others_message(tr("The session"), edited.others, now))
        if edited.contests:
            settle = partial(self._settle, edited.stored.id, edited.contests)
            self.asked.emit(EditQuestion(tr("The session"), edited.contests, settle))

    def _settle(self, session_id: UUID, contests: Sequence[Contest], fields: frozenset[str]) -> None:
        """Save what was chosen of both sides."""
        upon, said = chosen_fields(contests, fields)
        if not said:
            self.changed.emit()
            return

        def save(opened: "OpenedLibrary") -> Edited[StoredSession]:
            return opened.library.edits.session(session_id, upon, said)

        self._controller.run(save, self._on_settled, self._on_refused, self)

    def _on_settled(self, edited: Edited[StoredSession]) -> None:
        self.take(edited.stored)
        self._tell(edited)

    def _take(self, session: StoredSession, upon: Values) -> None:
        """Go on from what the library holds; what was said since `upon` stays said, and is saved."""
        held = _fields_of(session)
        shown, said = rebased(upon, _said_fields(self.told, self.comment, self.limits), held)
        self.stored = session
        told, self.comment, self.limits = with_session_fields(session.details, session.comment, session.limits, said)
        self._wanted = None
        if said != held:
            self._wanted = told
            if not self._is_busy:
                self._save(shown)
        else:
            self.held.emit()
        self.changed.emit()

    def _on_refused(self, what: str, remedy: str) -> None:
        self._is_busy = False
        self._wanted = None
        if self.stored is not None:  # the words stay as they were typed, and are saved with the next
            self.limits = self.stored.limits
        self.refused.emit(what, remedy)
        self.changed.emit()


def current_time() -> str:
    """The moment as a session's start is kept."""
    return datetime.datetime.now().astimezone().isoformat(timespec="seconds")


def _fields_of(session: StoredSession) -> dict[str, Value]:
    return _said_fields(session.details, session.comment, session.limits)


def _said_fields(told: Session, comment: str, limits: Limits) -> dict[str, Value]:
    """What is said of a session while it goes on; the rest is said once, by whatever made it."""
    every = session_fields(told, comment, limits)
    return {name: value for name, value in every.items() if name not in SESSION_CORRECTABLE}
