"""Corrections of who wore what in kept recordings: left and right swapped, or all since strapped on."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal, Slot

from app.editing.edited_record import EditedRecord
from app.editing.session_recording import SessionRecording
from app.storage.stored import PlacedSensor, StoredRecording, StoredSession
from app.storage.three_way import Edited, Values
from app.wizard.recordings import SessionRecordings
from app.wizard.resuming import read_recordings
from app.wizard.worn_sensors import WornSensors
from app.wording.translation import tr
from app.workers.library_controller import LibraryController
from core.body import Site

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary

Worn = tuple[Sequence[UUID], Mapping[Site, PlacedSensor]]
"""Recordings, and who wore what in them."""
Seen = Mapping[UUID, UUID | None]
"""By recording the placement as it was shown."""


@dataclass(frozen=True, slots=True)
class Corrected:
    """The session as the library has it now, and what was stated about its recordings."""

    session: StoredSession
    worn: Sequence[Worn]


class WornCorrections(EditedRecord[Corrected]):
    """One correction is made at a time; what is asked for meanwhile is made after it."""

    corrected = Signal(object, object)  # the session and its recordings, read again

    def __init__(
        self, controller: LibraryController, sensors: WornSensors, recordings: SessionRecordings, parent: QObject
    ) -> None:
        super().__init__(controller, parent)
        self._sensors, self._recordings = sensors, recordings
        self._is_busy = self._must_swap = False
        self._next: Mapping[Site, PlacedSensor] | None = None  # to be placed after what is being corrected
        self._once_ended: Mapping[Site, PlacedSensor] | None = None
        recordings.ended.connect(self._on_ended)

    @property
    def is_busy(self) -> bool:
        return self._is_busy

    def place_once_ended(self) -> None:
        """As `place_as_stated_now`, once what is being recorded has ended, though the sensors may be let go before."""
        self._once_ended = self._sensors.placed()

    def swap_sides(self) -> None:
        """Swap left and right in all recordings, worn sensors and later recordings; a second call undoes it."""
        if self._is_busy:
            self._must_swap = not self._must_swap
            return
        self._sensors.assign_all({name: opposite(site) for name, site in self._sensors.site_of.items()})
        placed: dict[UUID, list[SessionRecording]] = {}
        for recording in self._recordings.every:
            if recording.stored.placement is not None:
                placed.setdefault(recording.stored.placement.id, []).append(recording)
        worn: list[Worn] = []
        for recordings in placed.values():
            placement = recordings[0].stored.placement
            assert placement is not None  # only such were gathered
            other = {opposite(site): sensor for site, sensor in placement.sensors.items()}
            worn.append(([recording.id for recording in recordings], other))
        self._correct(worn, self._seen(), self._sensors.placed() or None)

    def place_as_stated_now(self) -> None:
        """Store that all recordings since strapping were worn as stated now, and read them again."""
        self._place(self._sensors.placed())

    def _place(self, placed: Mapping[Site, PlacedSensor]) -> None:
        if self._is_busy:
            self._next = placed
            return
        strapped = [recording.id for recording in self._recordings.since_strapped]
        self._correct([(strapped, placed)] if strapped else [], self._seen(), placed)

    @Slot()
    def _on_ended(self) -> None:
        if self._once_ended is not None:
            placed, self._once_ended = self._once_ended, None
            self._place(placed)

    def _seen(self) -> Seen:
        return _placements([recording.stored for recording in self._recordings.every])

    def _correct(self, worn: Sequence[Worn], seen: Seen, placed: Mapping[Site, PlacedSensor] | None = None) -> None:
        """Say who wore what in recordings, seen as they were; `placed`: also for what is recorded next."""
        if self._recordings.session is None:
            return
        session_id, self._is_busy = self._recordings.session.id, True

        def correct(opened: "OpenedLibrary") -> tuple[Edited[Corrected], tuple[SessionRecording, ...]]:
            if placed is not None:
                opened.library.sessions.place(session_id, placed)
            edited = opened.library.edits.placement(session_id, seen, worn)
            return Edited(Corrected(edited.stored, worn), edited.contests), read_recordings(opened, edited.stored)

        self._run(correct, self._on_corrected)

    def _on_corrected(self, answer: tuple[Edited[Corrected], tuple[SessionRecording, ...]]) -> None:
        """Show what came of it; swapped again meanwhile, it is swapped again."""
        edited, recordings = answer
        self._is_busy = False
        self.corrected.emit(edited.stored.session, recordings)
        self._ask(edited)
        must_swap, placed = self._must_swap, self._next
        self._must_swap, self._next = False, None
        if placed is not None:
            self._place(placed)
        if must_swap:
            self.swap_sides()

    def _called(self, stored: Corrected) -> str:
        return tr("The session")

    def _choose(self, stored: Corrected, base: Values, stated: Values) -> None:
        self._correct(stored.worn, _placements(stored.session.recordings))

    def _on_refused(self, what: str, remedy: str) -> None:
        self._is_busy = self._must_swap = False
        self._next = None
        super()._on_refused(what, remedy)


def _placements(recordings: Sequence[StoredRecording]) -> Seen:
    return {one.id: one.placement.id if one.placement is not None else None for one in recordings}


def opposite(site: Site) -> Site:
    """The same place on the other leg; the pelvis stays."""
    return Site.PELVIS if site.side is None else Site(f"{site.side.other}_{site.segment}")
