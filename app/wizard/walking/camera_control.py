"""Cameras beside the walk: found, switched on with the patient's consent, and recorded with each walk."""

from collections.abc import Callable
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal, Slot
from PySide6.QtWidgets import QWidget

from app.storage.videos.writer import ClipWriter
from app.system.progress import Report
from app.widgets.question_dialog import QuestionDialog
from app.wizard.walking.camera_card import MODES, VIEWS, CameraShown
from app.wizard.walking.camera_feed import CameraFeed
from app.wording.cameras import camera_gone_words, withdrawal_words
from app.wording.numbers import clock
from app.wording.translation import tr
from devices.cameras.camera import STAND_INS, CameraInfo, CameraLostError, CameraMode
from devices.cameras.finding import find_cameras

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from app.wizard.clips import VisitClips
    from app.wizard.visit import Visit

WITHDRAW = "withdraw"
PREVIEW_TICKS = 3  # of 30 a second: a preview of ten pictures a second costs little


class CameraControl(QObject):
    """Knows the visit and no page. What befalls a camera costs the video, never the walk."""

    changed = Signal()

    def __init__(self, visit: "Visit", parent: QObject) -> None:
        super().__init__(parent)
        self._visit = visit
        self._clips: VisitClips = visit.clips
        self._clips.changed.connect(self._follow)
        self._clips.finding.done.connect(self._on_found)
        self._cameras: tuple[CameraInfo, ...] = ()
        self._chosen, self._views, self._mode = 0, list(VIEWS[:2]), MODES[0]
        self._is_on = False
        self._message: tuple[str, str] = "", ""
        self._began_s = 0.0
        self.feeds: tuple[CameraFeed, ...] = ()
        self._waiting: dict[CameraFeed, tuple[UUID, int]] = {}  # for the walk: its id, and when it was opened, ns
        self._ticks = 0
        self.dialog: QuestionDialog | None = None
        visit.controller.locking.connect(self._on_locking)

    def look(self) -> None:
        """Find out which cameras there are, beside the screen."""
        if not self._is_on and not self._clips.finding.is_busy:
            self._clips.finding.start(_find)

    @property
    def is_recording(self) -> bool:
        return any(feed.writer is not None for feed in self.feeds)

    @property
    def shown(self) -> CameraShown | None:
        """What the card shows; None where there is no camera, or video is kept nowhere."""
        if not self._cameras or not self._clips.are_kept:
            return None
        names = [camera.name for camera in self._cameras]
        both = [tr("{one} and {other}").format(one=names[0], other=names[1])] if len(names) > 1 else []
        what, then = self._message
        return CameraShown(
            cameras=(*names, *both),
            chosen=self._chosen,
            views=tuple(self._views[: len(self._required)]),
            lost=frozenset(feed.number for feed in self.feeds if feed.is_over),
            mode=self._mode,
            is_on=self._is_on,
            is_recording=self.is_recording,
            needs_consent=self._is_on and not self._clips.has_consent,
            has_consent=self._clips.has_consent,
            facts=self.facts,
            what=what,
            then=then,
        )

    def turn(self, is_on: bool) -> None:
        """Switch the cameras on, once the patient has agreed, or off."""
        self._is_on, self._message = is_on, ("", "")
        self._follow()

    def agree(self) -> None:
        self._clips.give_consent()  # `changed` follows

    def choose_camera(self, number: int) -> None:
        self._chosen = number
        self.changed.emit()

    def choose_view(self, number: int, view: str) -> None:
        self._views[number] = view

    def choose_mode(self, mode: tuple[int, int, int]) -> None:
        self._mode = mode

    def pictures(self) -> tuple[bytes, ...]:
        """What each camera sees now, some ten times a second; empty in between."""
        self._ticks += 1
        if self._ticks % PREVIEW_TICKS:
            return ()
        return tuple(feed.latest.jpeg if feed.latest is not None else b"" for feed in self.feeds)

    def withdraw(self, window: QWidget) -> None:
        """Ask once more, then take the consent back, and with it every video of the patient."""
        question, follows, answer = withdrawal_words()
        self.dialog = QuestionDialog(question, follows, ((WITHDRAW, answer),), window)
        self.dialog.answered.connect(lambda _answer: self._clips.withdraw_consent())
        self._visit.controller.locking.connect(self.dialog.reject)
        self.dialog.open()

    def watch(self) -> None:
        """Say of a clip that it ended before its walk did: its disk takes no more."""
        if any(feed.writer is not None and feed.writer.has_ended for feed in self.feeds):
            self.walk_ended()
            what = tr("The disk has no space left for video.")
            self._message = what, tr("The walk goes on without video. Delete or move files you do not need.")
            self.changed.emit()

    def leave(self) -> None:
        """Switch off: nobody looks at it any more."""
        self._is_on = False
        self._close()

    # with the walk

    def walk_begun(self) -> None:
        """Record a clip of each camera with the walk that is being written."""
        latest = self._visit.recordings.latest
        if not self.feeds or latest is None:
            return
        self._message = "", ""
        if not latest.has_row:
            self._message = tr("This walk has no video."), tr("The library does not answer. The walk is recorded.")
            self.changed.emit()
            return
        self._began_s = self._now_s()
        self._waiting = {feed: (latest.id, latest.opened_ns) for feed in self.feeds if not feed.is_over}
        self._begin_clips()

    @Slot()
    def _begin_clips(self) -> None:
        """Begin the clip of each camera once it is known what it gives: a walk waits for none."""
        for feed in [one for one in self._waiting if one.is_known]:
            recording_id, opened_ns = self._waiting.pop(feed)
            start = self._start_of(recording_id, opened_ns, feed.number, feed.view, feed.mode)
            self._visit.controller.run(start, self._on_writing, self._on_not_written, self)

    def walk_ended(self) -> None:
        """End the clips with the walk."""
        self._waiting.clear()
        for feed in self.feeds:
            if (writer := feed.end_clip()) is not None:
                self._clips.close(writer)
        self.changed.emit()

    def _start_of(
        self, recording_id: UUID, opened_ns: int, number: int, view: str, mode: CameraMode
    ) -> "Callable[[OpenedLibrary], tuple[int, ClipWriter]]":
        def start(opened: "OpenedLibrary") -> "tuple[int, ClipWriter]":
            return number, ClipWriter.create(opened, recording_id, opened_ns, number, view, mode)

        return start

    @property
    def _required(self) -> tuple[CameraInfo, ...]:
        return self._cameras[:2] if self._chosen >= len(self._cameras) else (self._cameras[self._chosen],)

    @Slot()
    def _follow(self) -> None:
        """Open the cameras where they are on and the patient has agreed, else close them."""
        must_run = self._is_on and self._clips.has_consent
        if must_run and not self.feeds:
            width, height, rate = self._mode
            mode = CameraMode(width, height, rate)
            pairs = zip(self._required, self._views, strict=False)
            self.feeds = tuple(CameraFeed(k, info, mode, view, self) for k, (info, view) in enumerate(pairs, 1))
            for feed in self.feeds:
                feed.ended.connect(self._on_ended)
                feed.changed.connect(self._begin_clips)
                feed.changed.connect(self.changed)
        elif not must_run:
            self._close()
        self.changed.emit()

    def _close(self) -> None:
        self.walk_ended()
        feeds, self.feeds = self.feeds, ()
        for feed in feeds:
            feed.stop()
            feed.deleteLater()

    @property
    def facts(self) -> str:
        """How the cameras send, and how long the clip is; empty while they are off."""
        if not self.feeds:
            return ""
        live = [feed for feed in self.feeds if not feed.is_over]
        mode = min((feed.mode for feed in live), key=lambda one: one.rate_hz * one.width)
        stated = [tr("{rate:.0f} frames/s").format(rate=mode.rate_hz)]
        if any(feed.is_reduced for feed in live):
            stated.append(tr("reduced: this computer is too slow for more"))
        if self.is_recording:
            stated.insert(0, clock(self._now_s() - self._began_s))
        return " · ".join(stated)

    def _now_s(self) -> float:
        acquisition = self._visit.sensors.acquisition
        return acquisition.now_s if acquisition is not None else 0.0

    @Slot(object)
    def _on_found(self, cameras: tuple[CameraInfo, ...]) -> None:
        if not self._clips.are_sealed:
            cameras = tuple(camera for camera in cameras if camera.format in STAND_INS)
        if cameras != self._cameras and not self._is_on:
            self._cameras, self._chosen = cameras, 0
            self.changed.emit()

    @Slot(object)
    def _on_writing(self, begun: "tuple[int, ClipWriter]") -> None:
        number, writer = begun
        feed = next((one for one in self.feeds if one.number == number and not one.is_over), None)
        if feed is not None and self._visit.recordings.has_begun:
            feed.record(writer)
        else:
            self._clips.close(writer)  # the walk, or the camera, ended before it began
        self.changed.emit()

    @Slot(str, str)
    def _on_not_written(self, what: str, remedy: str) -> None:
        self._message = what, remedy
        self.changed.emit()

    @Slot(object)
    def _on_ended(self, error: CameraLostError) -> None:
        lost = self.sender()
        others = [feed for feed in self.feeds if feed is not lost and not feed.is_over]
        is_recording = self._visit.recordings.is_recording and not others
        self._message = camera_gone_words(error, is_recording=is_recording)
        if isinstance(lost, CameraFeed) and others:  # which go on
            self._waiting.pop(lost, None)
            if (writer := lost.end_clip()) is not None:
                self._clips.close(writer)
            lost.stop()
        else:
            self._is_on = False
            self._close()
        self.changed.emit()

    @Slot()
    def _on_locking(self) -> None:
        """Nobody looks: what goes on being recorded is, and no picture of it is kept at hand."""
        if not self.is_recording:
            self.leave()
            self.changed.emit()


def _find(_report: Report) -> tuple[CameraInfo, ...]:
    return find_cameras()
