"""Videos behind the results: a file of others becomes a clip, what leaves is asked about, Lock drops all."""

import io
from pathlib import Path

import av
import pytest
from PIL import Image
from PySide6.QtWidgets import QFileDialog
from pytestqt.qtbot import QtBot

from app.storage.opened import OpenedLibrary
from app.storage.stored import Action, StoredClip
from app.storage.videos.reader import recording_opened_ns
from app.storage.videos.writer import ClipWriter
from app.widgets.question_dialog import QuestionDialog
from app.wizard.results.step import ResultsStep
from app.wizard.results.videos import import_video
from app.wizard.visit import Visit
from app.workers.library_controller import LibraryController
from core.body import Side
from core.video.clip import Sync, SyncBy
from devices.cameras.camera import CameraMode, CapturedFrame
from devices.simulation.walker import DEMONSTRATION, simulate
from tests.app.library_answers import asked
from tests.app.wizard.conftest import PASSPHRASE
from tests.app.wizard.pressing import press
from tests.app.wizard.results.test_step import one_walk, session_id, step, walk_of
from tests.devices.files.videos import write_video
from tests.walking_video import Scene, render

__all__ = ["one_walk", "session_id", "step"]  # fixtures

pytestmark = pytest.mark.endurance

FRAMES = 45  # as `write_video` makes them
PATIENCE_MS = 60_000


@pytest.fixture
def clip(qtbot: QtBot, controller: LibraryController, visit: Visit, step: ResultsStep, tmp_path: Path) -> StoredClip:
    """Imported to the walk in sight, with consent, and synchronised by hand."""
    (walk,) = visit.recordings.walks
    session = visit.session
    assert session is not None
    path = write_video(tmp_path / "walk.mp4")

    def bring_in(opened: OpenedLibrary) -> StoredClip | None:
        opened.library.clips.give_consent(session.patient_id)
        return import_video(opened, walk.id, path, lambda _share, _what: None)[0]

    found = asked(qtbot, controller, bring_in)
    assert isinstance(found, StoredClip)
    with qtbot.waitSignal(visit.clips.changed, timeout=PATIENCE_MS):
        visit.clips.read()
    with qtbot.waitSignal(visit.clips.changed, timeout=PATIENCE_MS):
        visit.clips.synchronise(found.id, Sync(0.0, 0.033, SyncBy.HAND))
    qtbot.waitUntil(lambda: step.page.results().video.has_clips, timeout=PATIENCE_MS)
    return found


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
    qtbot.waitUntil(lambda: visit.clips.has_consent, timeout=PATIENCE_MS)
    qtbot.waitUntil(lambda: bool(step.page.findChildren(QFileDialog)), timeout=PATIENCE_MS)
    step.page.findChildren(QFileDialog)[0].filesSelected.emit([str(path)])
    qtbot.waitUntil(lambda: step.page.results().video.has_clips, timeout=PATIENCE_MS)


def test_a_file_that_is_no_video_is_refused_and_leaves_nothing(
    qtbot: QtBot, visit: Visit, step: ResultsStep, tmp_path: Path
) -> None:
    path = tmp_path / "walk.mp4"
    path.write_bytes(b"no video at all" * 1000)
    visit.clips.give_consent()
    qtbot.waitUntil(lambda: visit.clips.has_consent, timeout=PATIENCE_MS)
    stated: list[tuple[str, str]] = []
    step.reported.connect(lambda *both: stated.append(both))
    press(step, "Import video")
    step.page.findChildren(QFileDialog)[0].filesSelected.emit([str(path)])
    qtbot.waitUntil(lambda: len(stated) > 1, timeout=PATIENCE_MS)
    assert "walk.mp4" in " ".join(stated[-1])
    state = visit.controller.state
    assert state is not None
    assert list(state.library.videos.glob("*.journal")) == []


def test_what_leaves_is_asked_about_written_and_noted(
    qtbot: QtBot, controller: LibraryController, clip: StoredClip, step: ResultsStep, tmp_path: Path
) -> None:
    step.page.results().show_video.click()
    press(step, "Export video")
    dialog_of(step).answers["blurred"].click()
    dialog = step.page.findChildren(QFileDialog)[0]
    with qtbot.waitSignal(step.reported, timeout=PATIENCE_MS, check_params_cb=lambda what, _: "is exported" in what):
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
    state = visit.controller.state
    assert state is not None
    assert list(state.library.videos.glob("*.journal"))
    dialog_of(step).answers["delete"].click()
    qtbot.waitUntil(lambda: not step.page.results().video.has_clips, timeout=PATIENCE_MS)
    qtbot.waitUntil(lambda: not visit.clips.stored, timeout=PATIENCE_MS)
    assert list(state.library.videos.glob("*.journal")) == []


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
    qtbot.waitUntil(lambda: step.page.results().video.has_clips, timeout=PATIENCE_MS)


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
    session, delay_s = visit.session, 0.12
    assert session is not None

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
        timeout=120_000,
    )
    ((found,),) = visit.clips.stored.values()
    assert found.sync is not None
    assert abs(found.sync.offset_s + delay_s) < 2 / 30
    video = step.page.results().video
    qtbot.waitUntil(lambda: video.has_clips, timeout=PATIENCE_MS)
    step.page.results().show_video.click()
    stated = "Synchronised, ±1 frame"
    qtbot.waitUntil(lambda: stated in [one.text for one in video.player.painted_texts()], timeout=PATIENCE_MS)
