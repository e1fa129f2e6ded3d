"""Videos behind the results: a file of others becomes a clip, what leaves is asked about, Lock drops all."""

import errno
import io
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from uuid import UUID

import av
import numpy as np
import pytest
from PIL import Image
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QFileDialog
from pytestqt.qtbot import QtBot

from app.importing.untrusted_files import read_foreign_video
from app.storage.journal.disk import JournalFile
from app.storage.opened import OpenedLibrary
from app.storage.stored import Action, Role, StoredClip
from app.storage.videos.reader import open_clips, recording_opened_ns
from app.storage.videos.writer import ClipWriter
from app.video import exporting
from app.widgets.question_dialog import QuestionDialog
from app.wizard import clips
from app.wizard.results import videos
from app.wizard.results.step import ResultsStep
from app.wizard.results.videos import import_video
from app.wizard.visit import Visit
from app.workers.library_controller import LibraryController
from core.body import Side
from core.video.clip import Sync, SyncBy
from devices.cameras.camera import CameraMode, CapturedFrame
from devices.files.video_file import VideoPiece
from devices.simulation.walker import DEMONSTRATION, simulate
from tests.app.library_answers import asked
from tests.app.wizard.conftest import PASSPHRASE
from tests.app.wizard.present import present
from tests.app.wizard.pressing import press
from tests.app.wizard.results.test_step import one_walk, session_id, step, walk_of
from tests.devices.files.videos import write_video
from tests.walking_video import Scene, render

__all__ = ["one_walk", "session_id", "step"]  # fixtures

pytestmark = pytest.mark.endurance

FRAMES = 45  # as `write_video` makes them


@pytest.fixture
def clip(qtbot: QtBot, controller: LibraryController, visit: Visit, step: ResultsStep, tmp_path: Path) -> StoredClip:
    """Imported to the walk in sight, with consent, and synchronised by hand."""
    (walk,) = visit.recordings.walks
    session = present(visit.session)
    path = write_video(tmp_path / "walk.mp4")

    def bring_in(opened: OpenedLibrary) -> StoredClip | None:
        opened.library.clips.give_consent(session.patient_id)
        return import_video(opened, walk.id, path, lambda _share, _what: None)[0]

    found = asked(qtbot, controller, bring_in)
    assert isinstance(found, StoredClip)
    with qtbot.waitSignal(visit.clips.changed):
        visit.clips.read()
    with qtbot.waitSignal(visit.clips.changed):
        visit.clips.synchronise(found.id, Sync(0.0, 0.033, SyncBy.HAND))
    qtbot.waitUntil(lambda: step.page.results().video.has_clips)
    return found


class Held:
    """A slow piece of work: it waits until it may end."""

    def __init__(self) -> None:
        self.begun, self.may_end = threading.Event(), threading.Event()

    def wait(self) -> None:
        self.begun.set()
        assert self.may_end.wait(60.0)


def sentences_of(step: ResultsStep) -> list[tuple[str, str]]:
    stated: list[tuple[str, str]] = []
    step.reported.connect(lambda *both: stated.append(both))
    return stated


def begin_import(qtbot: QtBot, visit: Visit, step: ResultsStep, path: Path) -> None:
    visit.clips.give_consent()
    qtbot.waitUntil(lambda: visit.clips.has_consent)
    press(step, "Import video")
    step.page.findChildren(QFileDialog)[-1].filesSelected.emit([str(path)])


def begin_export(step: ResultsStep, path: Path, answer: str = "faces") -> None:
    step.page.results().show_video.click()
    press(step, "Export video")
    dialog_of(step).answers[answer].click()
    step.page.findChildren(QFileDialog)[-1].fileSelected.emit(str(path))


def files_of(visit: Visit) -> list[Path]:
    return list(present(visit.controller.state).library.videos.glob("*.journal"))


def words(step: ResultsStep) -> list[str]:
    return [action.text for action in step.bar().quiet]


def dialog_of(step: ResultsStep) -> QuestionDialog:
    """The one that was opened last; the one before is deleted in its time."""
    return step.page.findChildren(QuestionDialog)[-1]


def test_a_walk_without_video_offers_the_import_alone(step: ResultsStep) -> None:
    assert words(step) == ["Correct", "Review in Rerun", "Import video"]


def test_a_file_of_others_becomes_a_clip_frame_by_frame(clip: StoredClip, visit: Visit, step: ResultsStep) -> None:
    assert (clip.frames, clip.is_imported) == (FRAMES, True)
    assert words(step) == ["Correct", "Review in Rerun"]
    results = step.page.results()
    results.show_video.click()
    assert results.video.isVisible()
    assert words(step) == ["Export video", "Delete video"]


def test_the_import_asks_for_consent_first(qtbot: QtBot, visit: Visit, step: ResultsStep, tmp_path: Path) -> None:
    path = write_video(tmp_path / "walk.mp4")
    press(step, "Import video")
    assert not step.page.findChildren(QFileDialog)
    dialog_of(step).answers["agrees"].click()
    qtbot.waitUntil(lambda: visit.clips.has_consent)
    qtbot.waitUntil(lambda: bool(step.page.findChildren(QFileDialog)))
    step.page.findChildren(QFileDialog)[0].filesSelected.emit([str(path)])
    qtbot.waitUntil(lambda: step.page.results().video.has_clips)


def test_a_file_that_is_no_video_is_refused_and_leaves_nothing(
    qtbot: QtBot, visit: Visit, step: ResultsStep, tmp_path: Path
) -> None:
    path = tmp_path / "walk.mp4"
    path.write_bytes(b"no video at all" * 1000)
    stated = sentences_of(step)
    begin_import(qtbot, visit, step, path)
    qtbot.waitUntil(lambda: len(stated) > 1)
    assert "walk.mp4" in " ".join(stated[-1])
    assert files_of(visit) == []


def test_what_leaves_is_asked_about_written_and_noted(
    qtbot: QtBot, controller: LibraryController, clip: StoredClip, step: ResultsStep, tmp_path: Path
) -> None:
    step.page.results().show_video.click()
    press(step, "Export video")
    dialog_of(step).answers["blurred"].click()
    dialog = step.page.findChildren(QFileDialog)[0]
    with qtbot.waitSignal(step.reported, check_params_cb=lambda what, _: "is exported" in what):
        dialog.fileSelected.emit(str(tmp_path / "out.webm"))
    with av.open(str(tmp_path / "out.webm")) as written:
        assert len(list(written.decode(video=0))) == FRAMES

    def exports(opened: OpenedLibrary) -> list[str]:
        return [one.details for one in opened.library.audit.entries() if one.action == Action.EXPORT]

    noted = asked(qtbot, controller, exports)
    assert isinstance(noted, list)
    assert any('"is_blurred":true' in one.replace(" ", "") for one in noted)


def test_a_deleted_video_is_gone_at_once(qtbot: QtBot, visit: Visit, clip: StoredClip, step: ResultsStep) -> None:
    step.page.results().show_video.click()
    press(step, "Delete video")
    assert files_of(visit)
    dialog_of(step).answers["delete"].click()
    qtbot.waitUntil(lambda: not step.page.results().video.has_clips)
    qtbot.waitUntil(lambda: not visit.clips.stored)
    assert files_of(visit) == []


def test_lock_drops_what_was_shown(visit: Visit, clip: StoredClip, step: ResultsStep) -> None:
    step.page.results().show_video.click()
    press(step, "Delete video")
    visit.controller.locking.emit()
    assert not dialog_of(step).isVisible()
    assert not step.page.results().video.has_clips
    assert not step.page.results().video.isVisible()


def test_what_was_shown_is_there_again_after_the_lock(
    qtbot: QtBot, controller: LibraryController, clip: StoredClip, step: ResultsStep
) -> None:
    controller.lock()
    assert not step.page.results().video.has_clips
    qtbot.wait(0)
    assert not step.page.results().video.has_clips  # what was asked waits
    controller.call(lambda holder: holder.unlock("hk", PASSPHRASE, None), None, None, controller)
    qtbot.waitUntil(lambda: step.page.results().video.has_clips)


def test_a_review_with_faces_is_asked_about(
    clip: StoredClip, visit: Visit, step: ResultsStep, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown: list[int] = []
    monkeypatch.setattr(visit.reviewing, "show", lambda _session, _analysis, clips=(): shown.append(len(clips)))
    for answer, count in (("none", 0), ("faces", 1)):
        press(step, "Review in Rerun")
        dialog_of(step).answers[answer].click()
        assert shown[-1] == count


def test_both_legs_have_values_beside_the_picture(clip: StoredClip, step: ResultsStep) -> None:
    results = step.page.results()
    results.show_video.click()
    results.video.move_to(1.0)
    assert {tag.side for tag in results.video.player.values} == set(Side)
    results.video.move_to(8.0)  # the clip is over by then
    assert results.video.player.values == ()


def test_a_cameras_delay_is_found_by_the_motion(
    qtbot: QtBot, controller: LibraryController, visit: Visit, step: ResultsStep
) -> None:
    (moved,) = (one for one in simulate(DEMONSTRATION).moved if one.name == walk_of(visit).name)
    drawn = render(moved, Scene("oblique", jitter_s=0.0), 0.0, float(moved.legs[Side.LEFT].time_s[-1]))
    (walk,) = visit.recordings.walks
    session, delay_s = present(visit.session), 0.12

    def write(opened: OpenedLibrary) -> StoredClip | None:
        opened.library.clips.give_consent(session.patient_id)
        opened_ns = recording_opened_ns(opened, walk.id)
        writer = ClipWriter.create(opened, walk.id, opened_ns, 1, "", CameraMode(160, 90, 30.0))
        for number, (time_s, grey) in enumerate(zip(drawn.time_s, drawn.grey, strict=True)):
            picture = io.BytesIO()
            Image.fromarray(grey).save(picture, "JPEG", quality=90)
            arrival_ns = opened_ns + round((time_s + delay_s) * 1e9)
            writer.add(CapturedFrame(number, arrival_ns, None, picture.getvalue()), waits=True)
        return writer.stop()

    stored = asked(qtbot, controller, write)
    assert isinstance(stored, StoredClip)
    visit.clips.take(stored)
    by_motion = [SyncBy.MOTION]
    qtbot.waitUntil(
        lambda: [clip.sync.by for clips in visit.clips.stored.values() for clip in clips if clip.sync] == by_motion,
    )
    ((found,),) = visit.clips.stored.values()
    assert abs(present(found.sync).offset_s + delay_s) < 2 / 30
    video = step.page.results().video
    qtbot.waitUntil(lambda: video.has_clips)
    step.page.results().show_video.click()
    stated = "Synchronised, ±1 frame"
    qtbot.waitUntil(lambda: stated in [one.text for one in video.player.painted_texts()])


def test_a_synchronisation_by_hand_stays_when_the_motion_is_found_later(
    qtbot: QtBot,
    controller: LibraryController,
    visit: Visit,
    step: ResultsStep,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    held = Held()

    def slow(*_: object, **__: object) -> Sync:
        held.wait()
        return Sync(-3.3, 0.03, SyncBy.MOTION)

    monkeypatch.setattr(clips, "sync_of", slow)
    begin_import(qtbot, visit, step, write_video(tmp_path / "walk.mp4"))
    qtbot.waitUntil(held.begun.is_set)
    results = step.page.results()
    qtbot.waitUntil(lambda: results.video.has_clips)
    results.show_video.click()
    results.video.synchronise.click()
    results.video.sync.confirm.click()

    def by() -> list[SyncBy]:
        return [clip.sync.by for some in visit.clips.stored.values() for clip in some if clip.sync is not None]

    qtbot.waitUntil(lambda: by() == [SyncBy.HAND])
    held.may_end.set()
    qtbot.waitUntil(lambda: visit.clips.is_idle)
    asked(qtbot, controller, lambda _opened: None)  # what was asked before is done
    assert by() == [SyncBy.HAND]


def test_what_the_library_refuses_to_note_does_not_leave_it(
    qtbot: QtBot, controller: LibraryController, clip: StoredClip, step: ResultsStep, tmp_path: Path
) -> None:
    def be_viewer(opened: OpenedLibrary) -> None:
        (own,) = (one for one in opened.library.operators.list() if one.code == "hk")
        opened.library.operators.add(replace(own, code="ab", role=Role.ADMINISTRATOR))
        opened.library.log_in("ab")
        opened.library.operators.change(replace(own, role=Role.VIEWER))
        opened.library.log_in("hk")

    asked(qtbot, controller, be_viewer)
    stated = sentences_of(step)
    begin_export(step, tmp_path / "out.webm")
    qtbot.waitUntil(lambda: bool(stated))
    assert stated[-1][0] == "This requires the role clinician."
    assert not (tmp_path / "out.webm").exists()


def test_an_import_that_fills_the_disk_is_reported_and_leaves_nothing(
    qtbot: QtBot, visit: Visit, step: ResultsStep, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    append, pieces = JournalFile.append, list[int]()

    def full(file: JournalFile, data: bytes) -> object:
        pieces.append(len(data))
        if len(pieces) == 3:
            raise OSError(errno.ENOSPC, "full")
        return append(file, data)

    monkeypatch.setattr(JournalFile, "append", full)
    stated = sentences_of(step)
    begin_import(qtbot, visit, step, write_video(tmp_path / "walk.mp4", frames=900))
    qtbot.waitUntil(lambda: len(stated) > 1)
    assert stated[-1][0] == "There is not enough disk space for a video."
    assert files_of(visit) == []


def test_a_lock_ends_an_import_and_its_half_is_gone(
    qtbot: QtBot, visit: Visit, step: ResultsStep, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pieces = list[float]()

    def slow(path: Path, from_s: float, _most: int, waiting: Callable[[], None]) -> VideoPiece:
        pieces.append(from_s)
        for _ in range(6):
            time.sleep(0.05)
            waiting()
        return read_foreign_video(path, from_s, 5, waiting)

    monkeypatch.setattr(videos, "read_foreign_video", slow)
    stated = sentences_of(step)
    begin_import(qtbot, visit, step, write_video(tmp_path / "walk.mp4", frames=300))
    qtbot.waitUntil(lambda: len(pieces) > 2)
    visit.controller.lock()
    assert stated[-1] == ("The lock ended the import of the video.", "Import it again.")
    qtbot.waitUntil(lambda: files_of(visit) == [])
    count = len(pieces)
    qtbot.wait(600)
    assert len(pieces) == count


def test_a_lock_ends_an_export_and_no_file_is_left(
    qtbot: QtBot, clip: StoredClip, visit: Visit, step: ResultsStep, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    held, blur = Held(), exporting.blur_upper_part

    def slow(image: QImage) -> None:
        held.wait()
        blur(image)

    monkeypatch.setattr(exporting, "blur_upper_part", slow)
    stated = sentences_of(step)
    begin_export(step, tmp_path / "out.webm", "blurred")
    qtbot.waitUntil(held.begun.is_set)
    visit.controller.lock()
    held.may_end.set()
    qtbot.waitUntil(lambda: visit.clips.exporting.is_idle)
    assert stated[-1] == ("The lock ended the export of the video.", "Export it again.")
    assert [path.name for path in tmp_path.iterdir() if "out" in path.name] == []


def test_a_video_whose_file_is_gone_is_not_called_exported(
    qtbot: QtBot, clip: StoredClip, visit: Visit, step: ResultsStep, tmp_path: Path
) -> None:
    for file in files_of(visit):
        file.unlink()
    stated = sentences_of(step)
    begin_export(step, tmp_path / "out.webm")
    qtbot.waitUntil(lambda: len(stated) > 1)
    assert "is exported" not in stated[-1][0]
    assert not (tmp_path / "out.webm").exists()


def test_clips_that_come_under_the_lock_are_not_shown(
    qtbot: QtBot, clip: StoredClip, visit: Visit, step: ResultsStep, monkeypatch: pytest.MonkeyPatch
) -> None:
    held = Held()

    def slow(opened: OpenedLibrary, session_id: UUID) -> object:
        found = open_clips(opened, session_id)
        held.wait()
        return found

    monkeypatch.setattr(clips, "open_clips", slow)
    visit.controller.locking.emit()  # they are dropped and read anew
    qtbot.waitUntil(held.begun.is_set)
    visit.controller.lock()
    held.may_end.set()
    qtbot.wait(500)
    assert not step.page.results().video.has_clips


def test_a_video_deleted_while_its_motion_is_searched_is_missed_by_nobody(
    qtbot: QtBot, visit: Visit, step: ResultsStep, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    held = Held()

    def slow(*_: object, **__: object) -> None:
        held.wait()

    monkeypatch.setattr(clips, "sync_of", slow)
    path = write_video(tmp_path / "walk.mp4")
    begin_import(qtbot, visit, step, path)
    qtbot.waitUntil(held.begun.is_set)
    results = step.page.results()
    qtbot.waitUntil(lambda: results.video.has_clips)
    results.show_video.click()
    press(step, "Delete video")
    dialog_of(step).answers["delete"].click()
    qtbot.waitUntil(lambda: not visit.clips.stored)
    held.may_end.set()
    refused: list[tuple[str, str]] = []
    visit.clips.refused.connect(lambda *both: refused.append(both))
    begin_import(qtbot, visit, step, path)
    qtbot.waitUntil(lambda: bool(visit.clips.stored) and results.video.has_clips)
    qtbot.waitUntil(lambda: visit.clips.is_idle)
    assert refused == []


def test_of_a_file_whose_rate_varies_no_frame_is_lost_between_its_pieces(
    qtbot: QtBot, visit: Visit, step: ResultsStep, tmp_path: Path
) -> None:
    steps_ms = [17 if number % 10 == 0 else 120 for number in range(150)]  # as phones film in dim light
    path = write_video(tmp_path / "walk.mp4", 150, times_ms=np.cumsum(steps_ms).tolist())
    begin_import(qtbot, visit, step, path)
    qtbot.waitUntil(lambda: bool(visit.clips.stored))
    ((stored,),) = visit.clips.stored.values()
    assert stored.frames == 150


def test_an_exported_file_has_the_times_of_the_video(
    qtbot: QtBot, clip: StoredClip, visit: Visit, step: ResultsStep, tmp_path: Path
) -> None:
    stated = sentences_of(step)
    begin_export(step, tmp_path / "out.webm")
    qtbot.waitUntil(lambda: bool(stated) and "is exported" in stated[-1][0])
    with av.open(str(tmp_path / "out.webm")) as written:
        times_s = [frame.time for frame in written.decode(video=0)]
    np.testing.assert_allclose(times_s, np.arange(FRAMES) / 30.0, atol=1.1e-3)
