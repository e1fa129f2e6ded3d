"""Videos behind the results: imported to a walk, exported with a choice about faces, deleted."""

from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal, SignalInstance, Slot
from PySide6.QtWidgets import QWidget

from app.importing.untrusted_files import read_foreign_video
from app.storage.stored import ClipRefusedError
from app.storage.videos.destroying import destroy_clip
from app.storage.videos.reader import recording_opened_ns
from app.storage.videos.writer import ClipWriter
from app.system.progress import Report
from app.theme.icons import Icon
from app.video.exporting import write_video
from app.widgets.action_bar import BarAction
from app.widgets.folder_dialog import ask_for_files, ask_for_new_file
from app.widgets.question_dialog import QuestionDialog
from app.wording.numbers import clock
from app.wording.translation import later, tr
from app.workers.background import Work
from app.workers.refusals import refusal_of
from devices.cameras.camera import CameraMode, CapturedFrame

if TYPE_CHECKING:
    from app.editing.session_recording import SessionRecording
    from app.storage.opened import OpenedLibrary
    from app.storage.stored import StoredClip
    from app.wizard.visit import Visit
    from core.video.clip import Clip

FACES, BLURRED, NONE, DELETE, AGREES = "faces", "blurred", "none", "delete", "agrees"
PROPOSED = "video.webm"
PIECE = 60  # frames that are read at a time
USUAL_RATE_HZ = 30.0  # of a video that states none
FULL = later("There is not enough disk space for a video"), later("Delete or move files, then try again")
LEAST_STEP_S = 0.0005  # between two frames: no video that is read has more than 1000 a second


class VideoActions(QObject):
    """What can be done with the video of a walk. `reported`: how it went, in two sentences."""

    reported = Signal(str, str)

    def __init__(self, visit: "Visit", parent: QObject) -> None:
        super().__init__(parent)
        self._visit, self._clips = visit, visit.clips
        self._clips.exporting.done.connect(self._on_exported)
        self._clips.exporting.failed.connect(self._on_not_exported)
        self._is_importing = False
        self._export: Work | None = None  # which begins once it is noted
        visit.controller.locking.connect(self._on_locking)

    def actions(self, clip: "Clip | None", walk: "SessionRecording | None", window: QWidget) -> tuple[BarAction, ...]:
        """Give those of the clip in sight, or the import where the walk has none."""
        if clip is not None:
            export = BarAction(tr("Export video"), partial(self.ask_export, clip, window), icon=Icon.FOLDER)
            delete = BarAction(tr("Delete video"), partial(self.ask_deletion, clip, window), icon=Icon.DELETE)
            return (export, delete) if find_spec("av") is not None else (delete,)
        if walk is None or not (self._clips.are_kept and self._clips.are_sealed) or find_spec("av") is None:
            return ()
        return (BarAction(tr("Import video"), partial(self.ask_import, walk, window), icon=Icon.IMPORT),)

    def ask_export(self, clip: "Clip", window: QWidget) -> None:
        sentences = (
            tr("The exported file is not encrypted and shows the patient."),
            tr("Blurring covers the upper third of the picture. A face further down stays visible."),
        )
        answers = ((FACES, tr("Export with faces")), (BLURRED, tr("Blur the upper third")))
        self._ask(tr("Export this video?"), sentences, answers, window).connect(
            lambda answer: self._ask_where(clip, window, is_blurred=answer == BLURRED)
        )

    def ask_review(
        self, window: QWidget, clips: "tuple[Clip, ...]", show: "Callable[[tuple[Clip, ...]], object]"
    ) -> None:
        """Ask whether faces may be in the review, then `show` it with these clips or none."""
        sentences = (tr("While its window is open, the review lies unencrypted on this computer. Faces are in it."),)
        answers = ((FACES, tr("With video")), (NONE, tr("Without video")))
        self._ask(tr("Review with the video?"), sentences, answers, window).connect(
            lambda answer: show(clips if answer == FACES else ())
        )

    def ask_deletion(self, clip: "Clip", window: QWidget) -> None:
        sentences = (tr("The video is destroyed at once. The measurements stay. Backups may still hold the video."),)
        answered = self._ask(tr("Delete this video?"), sentences, ((DELETE, tr("Delete video")),), window)
        answered.connect(lambda _answer: self._clips.delete(clip.id))

    def ask_import(self, walk: "SessionRecording", window: QWidget) -> None:
        """Ask for the patient's consent where there is none yet, then for the file."""
        if self._clips.has_consent:
            ask_for_files(window, tr("Choose the video of this walk"), partial(self._import, walk))
            return
        sentences = (tr("Ask before the first video. Who asked, and when, is stored with the patient."),)
        answers = ((AGREES, tr("Patient agrees")),)
        answered = self._ask(tr("Does the patient agree to video?"), sentences, answers, window)
        answered.connect(lambda _answer: self._on_agreed(walk, window))

    def _ask(
        self, title: str, sentences: tuple[str, ...], answers: tuple[tuple[str, str], ...], window: QWidget
    ) -> SignalInstance:
        """Open a question, which Lock closes; gives the signal of its answer."""
        dialog = QuestionDialog(title, sentences, answers, window)
        self._visit.controller.locking.connect(dialog.reject)
        dialog.open()
        return dialog.answered

    def _on_agreed(self, walk: "SessionRecording", window: QWidget) -> None:
        self._clips.give_consent()
        ask_for_files(window, tr("Choose the video of this walk"), partial(self._import, walk))

    def _import(self, walk: "SessionRecording", files: list[str]) -> None:
        path, walk_id = Path(files[0]), walk.id
        self.reported.emit(tr("The video is being imported."), tr("This takes about as long as the video."))
        self._is_importing = True
        self._visit.controller.run_long(
            lambda opened, report: import_video(opened, walk_id, path, report),
            self._on_imported,
            self._on_not_imported,
            None,
            self,
        )

    def _on_imported(self, imported: "tuple[StoredClip | None, bool]") -> None:
        self._is_importing = False
        clip, is_damaged = imported
        if is_damaged and clip is not None:
            what = tr("The video is damaged after {length}.").format(length=clock(clip.length_s))
            self.reported.emit(what, tr("What is before is imported."))
        else:
            self.reported.emit("", "")
        self._clips.take(clip)

    def _on_not_imported(self, what: str, remedy: str) -> None:
        self._is_importing = False
        self.reported.emit(what, remedy)

    def _ask_where(self, clip: "Clip", window: QWidget, *, is_blurred: bool) -> None:
        ask_for_new_file(window, tr("Export video"), PROPOSED, lambda path: self._note(clip, Path(path), is_blurred))

    def _note(self, clip: "Clip", path: Path, is_blurred: bool) -> None:
        """Note it in the library's audit first: what the library refuses does not leave it."""

        def note(opened: "OpenedLibrary") -> None:
            opened.library.clips.note_export(clip.id, is_blurred=is_blurred)

        self._export = lambda report: write_video(clip, path, is_blurred=is_blurred, report=report)
        self._visit.controller.run(note, self._on_noted, self._on_not_noted, self)

    def _on_noted(self, _nothing: None) -> None:
        export, self._export = self._export, None
        if export is not None:
            self.reported.emit(tr("The video is being exported."), "")
            self._clips.exporting.start(export)

    def _on_not_noted(self, what: str, remedy: str) -> None:
        self._export = None
        self.reported.emit(what, remedy)

    @Slot()
    def _on_locking(self) -> None:
        """Nothing of a video is read or written under the lock."""
        if self._is_importing:
            self._is_importing = False
            self._visit.controller.stop_long()
            self.reported.emit(tr("The lock ended the import of the video."), tr("Import it again."))
        if self._export is not None or self._clips.exporting.is_busy:
            self._export = None
            self._clips.exporting.stop()
            self.reported.emit(tr("The lock ended the export of the video."), tr("Export it again."))

    def _on_exported(self, _nothing: object) -> None:
        self.reported.emit(tr("The video is exported."), tr("The file is not encrypted."))

    def _on_not_exported(self, error: Exception) -> None:
        self.reported.emit(*refusal_of(error))


def import_video(
    opened: "OpenedLibrary", walk_id: UUID, path: Path, report: Report
) -> "tuple[StoredClip | None, bool]":
    """Read a video of others in the limited process and keep its frames with the walk.

    Returns the clip, None where it holds no frame, and whether the video is damaged after it.

    Raises FileRefusedError, LibraryError or OSError.
    """
    opened_ns, writer, from_s, count, share = recording_opened_ns(opened, walk_id), None, 0.0, 0, 0.0

    def waiting() -> None:
        report(share, "")

    try:
        while True:
            piece = read_foreign_video(path, from_s, PIECE, waiting)
            if writer is None:
                mode = CameraMode(piece.width, piece.height, piece.rate_hz if piece.rate_hz > 0 else USUAL_RATE_HZ)
                writer = ClipWriter.create(opened, walk_id, opened_ns, 1, "", mode, is_imported=True)
            for time_s, jpeg in zip(piece.time_s, piece.jpegs, strict=True):
                frame = CapturedFrame(count, opened_ns + round(time_s * 1e9), None, jpeg)
                if not writer.add(frame, waits=True) and writer.has_ended:
                    raise ClipRefusedError(*FULL)
                count += 1
            if piece.is_end or not piece.jpegs:
                return writer.stop(), piece.is_damaged
            from_s = float(piece.time_s[-1]) + LEAST_STEP_S
            share = min(1.0, from_s / piece.length_s) if piece.length_s > 0 else 0.0
    except BaseException:
        if writer is not None and (stored := writer.stop()) is not None:
            destroy_clip(opened, stored.id)  # half a video of a walk is none
        raise
