"""What is stated about the session of a visit, kept as it is stated."""

import datetime
from dataclasses import replace

from PySide6.QtCore import QObject, Signal

from app.editing.confirmation import confirmation, confirmed_by, is_confirmed
from app.editing.edited_record import EditedRecord
from app.editing.patient import PatientRecord
from app.storage.edited_fields import CONFIRMED, SESSION_CORRECTABLE, session_fields, with_session_fields
from app.storage.stored import Limits, StoredSession
from app.storage.three_way import Edited, Value, Values, rebased
from app.system.logs import version_of
from app.wording.translation import tr
from app.workers.library_controller import LibraryController
from core.body import Joint
from core.session import Session


class SessionRecord(EditedRecord[StoredSession]):
    """`reported` is what is on the screen, `stored` what the library holds; the second follows the first.

    There is no session before `begin` or `resume`; what is stated before waits for it.
    """

    held = Signal()  # the library holds all that is stated; `changed` follows

    def __init__(self, controller: LibraryController, patient: PatientRecord, parent: QObject) -> None:
        super().__init__(controller, parent)
        self._patient = patient
        self.stored: StoredSession | None = None
        self._say(_stated_fields(*_whole(None)))
        self._sent = self._stated
        """What was stated about the session when the library was asked last."""
        self._is_busy = False

    @property
    def is_busy(self) -> bool:
        """Whether the library is still to answer."""
        return self._is_busy

    @property
    def reported(self) -> Session:
        """What was stated about the session, the last word of it on the screen; without recordings."""
        return replace(self._reported, recordings=(), patient=self._patient.details)

    def begin(self) -> None:
        """Make the session's row, once the patient has one; `changed` follows."""
        patient = self._patient.stored
        if self.stored is not None or patient is None or self._is_busy:
            return
        self._is_busy = True
        self._patient.has_this_session_only = patient.sessions == 0
        state = self._controller.state
        reported = Session(
            recordings=(),
            started=current_time(),
            operator=state.operator.name if state is not None else "",
            software=f"gaitwright {version_of('gaitwright')}",
        )
        limits = self.limits
        self._sent = _stated_fields(reported, "", limits, "")
        self._run(lambda opened: Edited(opened.library.sessions.create(patient.id, reported, limits)), self._on_saved)

    def resume(self, stored: StoredSession) -> None:
        """Go on with a session of the library, of which nothing has been stated here."""
        self.stored = stored
        self._say(_fields_of(stored))

    def take(self, stored: StoredSession) -> None:
        """Go on from what the library holds; what was stated since it was read last is kept, and saved."""
        self._take(stored, _fields_of(self.stored or stored))

    def take_instead(self, stored: StoredSession) -> None:
        """Go on from what the library holds, in place of all that is stated here."""
        self._take(stored, self._stated)

    def set_zero(self, joint: Joint, zero_rad: float | None) -> None:
        """Take the goniometer's value while standing, radians in the clinical sign; None: the standing itself is 0."""
        self._change({f"zero_rad.{joint}": zero_rad})

    def set_limits(self, limits: Limits) -> None:
        """Take what the patient's body does not allow; before there is a session, it waits for that."""
        if limits != self.limits:
            self._change(_stated_fields(self.reported, self.comment, limits, self._confirmed))

    def set_comment(self, comment: str, shown: str) -> None:
        """Take the comment typed where `shown` stood; own unsaved or refused words are no conflict."""
        self._change({"comment": comment}, {"comment": shown} if shown != self.comment else {})

    def confirm_comment(self, comment: str, shown: str) -> None:
        """Take words as in `set_comment`, and that the user who is logged in confirms them."""
        state = self._controller.state
        by = state.operator.name if state is not None else ""
        base = {"comment": shown} if shown != self.comment else {}
        self._change({"comment": comment, CONFIRMED: confirmation(comment, by)}, base)

    @property
    def is_comment_confirmed(self) -> bool:
        return is_confirmed(self.comment, self._confirmed)

    @property
    def comment_by(self) -> str:
        """Who confirmed the comment as it is now; empty where nobody did."""
        return confirmed_by(self._confirmed) if self.is_comment_confirmed else ""

    def set_turned(self, joint: Joint, sign: int | None) -> None:
        """Turn (-1) or confirm (1) the sign that was found of a joint; None: as found. `held` follows."""
        self._change({f"turned_sign.{joint}": sign})

    def _say(self, stated: Values) -> None:
        """Put what is stated on the screen."""
        self._stated = stated
        whole = with_session_fields(*_whole(self.stored), stated)
        self._reported, self.comment, self.limits, self._confirmed = whole

    def _change(self, stated: Values, base: Values | None = None) -> None:
        """Save what is stated about the session; `base`: what it was based on, if not what the library has."""
        self._say({field: stated.get(field, before) for field, before in self._stated.items()})
        if self.stored is not None and not self._is_busy:
            self._save(self.stored, base or {})

    def _save(self, stored: StoredSession, base: Values) -> None:
        self._is_busy, self._sent = True, self._stated
        held = session_fields(*_whole(stored))
        shown, stated = {**held, **base}, {**held, **self._sent}
        self._run(lambda opened: opened.library.edits.session(stored.id, shown, stated), self._on_saved)

    def _called(self, stored: StoredSession) -> str:
        return tr("The session")

    def _choose(self, stored: StoredSession, base: Values, stated: Values) -> None:
        self._run(lambda opened: opened.library.edits.session(stored.id, base, stated), self._on_settled)

    def _on_saved(self, edited: Edited[StoredSession]) -> None:
        self._is_busy = False
        self._take(edited.stored, self._sent)
        self._show_message(edited)
        self._ask(edited)

    def _on_settled(self, edited: Edited[StoredSession]) -> None:
        self.take(edited.stored)
        self._show_message(edited)
        self._ask(edited)

    def _take(self, session: StoredSession, base: Values) -> None:
        """Go on from what the library holds; what was stated since `base` is kept, and saved."""
        held = _fields_of(session)
        shown, stated = rebased(base, self._stated, held)
        self.stored = session
        self._say(stated)
        if stated == held:
            self.held.emit()
        elif not self._is_busy:
            self._save(session, shown)
        self.changed.emit()

    def _on_refused(self, what: str, remedy: str) -> None:
        """Keep words and limits as typed, saved with the next; drop a confirmation the library does not hold."""
        self._is_busy = False
        details, _, limits, confirmed = _whole(self.stored)
        limits = limits if self.stored is not None else self.limits
        self._say(_stated_fields(details, self.comment, limits, confirmed))
        super()._on_refused(what, remedy)
        self.changed.emit()


def current_time() -> str:
    """The moment as a session's start is kept."""
    return datetime.datetime.now().astimezone().isoformat(timespec="seconds")


def _whole(session: StoredSession | None) -> tuple[Session, str, Limits, str]:
    if session is None:
        return Session(recordings=()), "", Limits(), ""
    return session.details, session.comment, session.limits, session.comment_confirmed


def _fields_of(session: StoredSession) -> dict[str, Value]:
    return _stated_fields(*_whole(session))


def _stated_fields(reported: Session, comment: str, limits: Limits, confirmed: str) -> dict[str, Value]:
    """What is stated about a session while it goes on; the rest is stated once, by whatever made it."""
    every = session_fields(reported, comment, limits, confirmed)
    return {name: value for name, value in every.items() if name not in SESSION_CORRECTABLE}
