"""Videos of a visit's walks: what the library has of them, opened where they are looked at, and their consent."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal, Slot

from app.storage.videos.destroying import destroy_clip, withdraw_consent
from app.storage.videos.reader import open_clip, open_clips
from app.system.progress import Report
from app.video.jpeg import JpegDecoder
from app.video.motion import sync_of
from app.wizard.recordings import SessionRecordings
from app.workers.background import Background
from app.workers.library_controller import LibraryController
from app.workers.refusals import refusal_of
from core.video.clip import SyncBy

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from app.storage.stored import ClipRefusedError, StoredClip, VideoConsent
    from app.storage.videos.writer import ClipWriter
    from core.session import Recording
    from core.video.clip import Clip, Sync


class VisitClips(QObject):
    """All calls to the library are made by the controller's thread; this lives on the screen's."""

    changed = Signal()
    opened = Signal(object)  # tuple[Clip, ...]: of every walk; empty under the lock
    refused = Signal(str, str)

    def __init__(self, controller: LibraryController, recordings: SessionRecordings, parent: QObject) -> None:
        super().__init__(parent)
        self._controller, self._recordings = controller, recordings
        self._read_of: UUID | None = None
        self._consent: VideoConsent | None = None
        self.stored: Mapping[UUID, Sequence[StoredClip]] = {}
        """By the walk's id, camera 1 first."""
        self._clips: tuple[Clip, ...] = ()
        self._tried: frozenset[UUID] = frozenset()  # which were to be opened; those of `_clips` did
        self._unsynchronised: list[StoredClip] = []
        self._sought: StoredClip | None = None  # of these, the one that is looked into
        self._decoder = JpegDecoder()
        self._looking = Background(self)
        """Finds a clip's offset from the motion in it."""
        self._looking.done.connect(self._on_synchronised)
        self._looking.failed.connect(self._on_not_synchronised)
        self.finding = Background(self)
        """Finds cameras; of the visit, as its threads outlive a step."""
        self.exporting = Background(self)
        """Writes a clip for other programs."""
        recordings.changed.connect(self._follow)
        recordings.ended.connect(self._synchronise_next)
        controller.locking.connect(self._on_locking)

    @property
    def has_consent(self) -> bool:
        return self._consent is not None and self._consent.is_given

    @property
    def are_kept(self) -> bool:
        """Whether the open library keeps videos: one that a clinic's stations share does not."""
        state = self._controller.state
        return state is not None and state.library.shared is None

    @property
    def are_sealed(self) -> bool:
        """Whether they would be encrypted: in the demonstration a face would lie plain on the disk."""
        state = self._controller.state
        return state is not None and not state.is_demonstration

    def length_s(self, recording_id: UUID) -> float:
        """How long the video of a walk is; 0 where it has none."""
        return max((clip.length_s for clip in self.stored.get(recording_id, ())), default=0.0)

    def find(self, clip_id: UUID) -> "StoredClip | None":
        return next((clip for clips in self.stored.values() for clip in clips if clip.id == clip_id), None)

    def give_consent(self) -> None:
        patient_id = self._patient_id
        if patient_id is not None:
            self._run(lambda opened: opened.library.clips.give_consent(patient_id), self._on_consent)

    def withdraw_consent(self) -> None:
        """The patient agrees no longer: all of the patient's videos, of every visit, are destroyed at once."""
        patient_id = self._patient_id
        if patient_id is None:
            return

        def withdraw(opened: "OpenedLibrary") -> "VideoConsent":
            withdraw_consent(opened, patient_id)
            return opened.library.clips.consent(patient_id)

        self._unsynchronised.clear()
        self._drop()
        self._run(withdraw, self._on_consent)
        self.read()

    def close(self, writer: "ClipWriter") -> None:
        """End a clip that is being written; what holds for its times is found out from the motion in it."""
        self._run(lambda _opened: writer.stop(), self.take)

    def delete(self, clip_id: UUID) -> None:
        """Destroy one video."""

        def delete(opened: "OpenedLibrary") -> None:
            destroy_clip(opened, clip_id)

        self._unsynchronised = [one for one in self._unsynchronised if one.id != clip_id]
        self._drop()
        self._run(delete, None)
        self.read()

    def synchronise(self, clip_id: UUID, sync: "Sync") -> None:
        """Take what somebody found of a clip's times."""
        if (clip := self.find(clip_id)) is not None:
            self._run(lambda opened: opened.library.clips.synchronise(clip, sync), self._on_changed)

    def read(self) -> None:
        """Read which videos the visit has, and whether the patient agreed."""
        session = self._recordings.session
        if session is None:
            return

        def read(opened: "OpenedLibrary") -> "tuple[Mapping[UUID, Sequence[StoredClip]], VideoConsent]":
            clips = opened.library.clips
            return clips.of_session(session.id), clips.consent(session.patient_id)

        self._run(read, self._on_read)

    def open(self) -> None:
        """Open the videos of all walks, unless they are; `opened` follows."""
        session = self._recordings.session
        required = frozenset(clip.id for clips in self.stored.values() for clip in clips)
        if session is None or required == self._tried:
            self.opened.emit(self._clips)
            return
        self._tried = required

        def open_all(
            opened: "OpenedLibrary", _report: Report
        ) -> "tuple[frozenset[UUID], tuple[Clip, ...], tuple[ClipRefusedError, ...]]":
            return required, *open_clips(opened, session.id)

        self._run_beside(open_all, self._on_opened)

    @property
    def _patient_id(self) -> UUID | None:
        session = self._recordings.session
        return session.patient_id if session is not None else None

    def _run(self, call: "Callable[[OpenedLibrary], object]", done: Callable[..., object] | None) -> None:
        self._controller.run(call, done, self._on_refused, self)

    def _run_beside(
        self,
        work: "Callable[[OpenedLibrary, Report], object]",
        done: Callable[..., object],
        failed: "Callable[[str, str], object] | None" = None,
    ) -> None:
        """Run what reads all of a clip's file, a second for each minute, beside what else the library is asked."""
        self._controller.run_long(work, done, failed or self._on_refused, None, self, is_quiet=True)

    def _drop(self) -> None:
        """Let go of every picture that is held; what was looked into is again, later."""
        self._looking.stop()
        self._sought, self._clips, self._tried = None, (), frozenset()
        self.opened.emit(())

    @Slot()
    def _follow(self) -> None:
        session = self._recordings.session
        if session is not None and session.id != self._read_of:
            self._read_of = session.id
            self.read()

    def _on_opened(self, found: "tuple[frozenset[UUID], tuple[Clip, ...], tuple[ClipRefusedError, ...]]") -> None:
        required, clips, refused = found
        if required is not self._tried:
            return  # they were let go meanwhile
        self._clips = clips
        self.opened.emit(self._clips)
        self._synchronise_next()
        for refusal in refused:
            self.refused.emit(*refusal_of(refusal))

    def _on_read(self, read: "tuple[Mapping[UUID, Sequence[StoredClip]], VideoConsent]") -> None:
        self.stored, self._consent = read
        self.changed.emit()

    def _on_consent(self, consent: "VideoConsent") -> None:
        self._consent = consent
        self.changed.emit()

    def take(self, clip: "StoredClip | None") -> None:
        """Have a clip that is new in the library; None: it held no frame."""
        if clip is None:
            return
        self._unsynchronised.append(clip)
        self._on_changed(clip)
        self._synchronise_next()

    def _on_changed(self, clip: "StoredClip") -> None:
        others = [one for one in self.stored.get(clip.recording_id, ()) if one.id != clip.id]
        every = sorted([*others, clip], key=lambda one: one.camera)
        self.stored = {**self.stored, clip.recording_id: tuple(every)}
        self._clips = tuple(replace(one, sync=clip.sync) if one.id == clip.id else one for one in self._clips)
        self.changed.emit()

    # times, from the motion

    @Slot()
    def _synchronise_next(self) -> None:
        """Look into the next clip whose walk has been read back."""
        if self._sought is not None:
            return
        for clip in self._unsynchronised:
            recording = self._recordings.find(clip.recording_id)
            if recording is not None and recording.read_back is not None:
                self._sought = clip
                self._run_beside(_opening(clip, recording.read_back), self._on_to_look_into, self._on_not_opened)
                return

    def _on_to_look_into(self, opened: "tuple[StoredClip, Clip, Recording]") -> None:
        clip, found, recording = opened
        if clip is not self._sought:
            return  # it was let go meanwhile
        decoder = self._decoder
        self._looking.start(
            lambda report: (clip, sync_of(found, recording, decoder, report, is_imported=clip.is_imported))
        )

    def _on_synchronised(self, found: "tuple[StoredClip, Sync | None]") -> None:
        clip, sync = found
        now = self.find(clip.id)
        is_by_hand = now is not None and now.sync is not None and now.sync.by is SyncBy.HAND  # meanwhile
        if sync is not None and not is_by_hand:
            self.synchronise(clip.id, sync)
        self._go_on()

    def _on_not_synchronised(self, _error: Exception) -> None:
        """It keeps the computer's clock alone, and can be synchronised by hand."""
        self._go_on()

    def _on_not_opened(self, what: str, remedy: str) -> None:
        self.refused.emit(what, remedy)
        self._go_on()

    def _go_on(self) -> None:
        """Look into the next clip."""
        self._unsynchronised = [clip for clip in self._unsynchronised if clip is not self._sought]
        self._sought = None
        self._synchronise_next()

    def _on_refused(self, what: str, remedy: str) -> None:
        self.refused.emit(what, remedy)

    @Slot()
    def _on_locking(self) -> None:
        """Have nothing at hand until the unlock, which `open` waits for."""
        self._drop()
        self.open()

    @property
    def is_idle(self) -> bool:
        """Whether no thread is left."""
        return all(one.is_idle for one in self._threads)

    def finish(self) -> None:
        """Wait until no thread is left."""
        for one in self._threads:
            one.finish()

    @property
    def _threads(self) -> tuple[Background, ...]:
        return self._looking, self.finding, self.exporting


def _opening(
    clip: "StoredClip", recording: "Recording"
) -> "Callable[[OpenedLibrary, Report], tuple[StoredClip, Clip, Recording]]":
    def opening(opened: "OpenedLibrary", _report: Report) -> "tuple[StoredClip, Clip, Recording]":
        return clip, open_clip(opened, clip, recording.name), recording

    return opening
