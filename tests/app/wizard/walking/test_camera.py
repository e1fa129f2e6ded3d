"""A camera beside the walk: FFmpeg's test picture in its place, through the real process into the library."""

from collections.abc import Iterator

import pytest
from pytestqt.qtbot import QtBot

from app.acquisition.recorder import Recorder
from app.storage.stored import StoredClip
from app.storage.videos.reader import open_clip
from app.storage.videos.writer import ClipWriter
from app.wizard import clips
from app.wizard.visit import Visit
from app.wizard.walking import camera_control
from app.wizard.walking.step import WalkingStep
from core.body import Site
from core.video.clip import Clip, Sync, SyncBy
from devices.cameras.camera import TEST_PICTURE, V4L2, CameraInfo
from tests.app.wizard.begun_visit import begin
from tests.app.wizard.patient_time import PatientTime
from tests.app.wizard.walking.shown_step import shown_step, start, stop

CAMERA = CameraInfo("Test picture", "testsrc2=size=320x180:rate=30", TEST_PICTURE)
OTHER = CameraInfo("Other picture", "testsrc=size=320x240:rate=15", TEST_PICTURE)
FOUND = Sync(-0.1, 0.03, SyncBy.MOTION)


@pytest.fixture
def cameras() -> list[CameraInfo]:
    return [CAMERA]


@pytest.fixture
def step(
    qtbot: QtBot,
    visit: Visit,
    worn: dict[str, Site],
    patient_time: PatientTime,
    cameras: list[CameraInfo],
    monkeypatch: pytest.MonkeyPatch,
) -> Iterator[WalkingStep]:
    """Looked at as the wizard does, with these cameras."""
    monkeypatch.setattr(camera_control, "find_cameras", lambda: tuple(cameras))
    begin(qtbot, visit, worn)
    with shown_step(qtbot, visit, 672) as step:
        yield step


def switch_on(qtbot: QtBot, step: WalkingStep, visit: Visit) -> None:
    """With consent, until it sends."""
    qtbot.waitUntil(lambda: step.page.camera.isVisible())
    step.page.camera.switch.click()
    if not visit.clips.has_consent:
        step.page.camera.agree.click()
    qtbot.waitUntil(lambda: bool(step.camera.feeds))
    qtbot.waitUntil(lambda: all(feed.latest is not None for feed in step.camera.feeds))


def switch_both_on(qtbot: QtBot, step: WalkingStep, visit: Visit) -> None:
    qtbot.waitUntil(step.page.camera.isVisible)
    step.camera.choose_camera(2)
    switch_on(qtbot, step, visit)


def walk(qtbot: QtBot, step: WalkingStep, visit: Visit, frames: int) -> None:
    """Until each camera has given so many frames of it."""
    start(qtbot, step, visit)
    qtbot.waitUntil(lambda: all(feed.taken >= frames for feed in step.camera.feeds))
    stop(qtbot, step, visit)


def clips_of(qtbot: QtBot, visit: Visit, count: int = 1) -> list[StoredClip]:
    qtbot.waitUntil(lambda: sum(map(len, visit.clips.stored.values())) >= count)
    return [clip for clips in visit.clips.stored.values() for clip in clips]


def test_no_camera_runs_before_the_patient_agreed_nor_under_the_lock(
    qtbot: QtBot, step: WalkingStep, visit: Visit
) -> None:
    card = step.page.camera
    qtbot.waitUntil(card.isVisible)
    assert (card.facts.text(), card.notice.isVisible()) == ("Camera is off.", False)
    card.switch.click()
    assert "has not agreed" in card.notice.text
    assert step.camera.feeds == ()
    card.agree.click()
    qtbot.waitUntil(lambda: bool(step.camera.feeds))
    assert card.notice.text == "Faces are recorded. Video stays in this library."
    qtbot.waitUntil(lambda: not card.pictures[0].pixmap().isNull())
    assert not card.pictures[1].isVisible()
    card.switch.click()
    assert step.camera.feeds == ()
    assert card.pictures[0].pixmap().isNull()  # nothing of it stays in sight
    switch_on(qtbot, step, visit)
    visit.controller.lock()
    assert step.camera.feeds == ()
    assert card.pictures[0].pixmap().isNull()


@pytest.mark.parametrize("cameras", [[CAMERA, OTHER]])
def test_a_walk_has_the_frames_that_came_during_it_in_a_clip_of_each_camera(
    qtbot: QtBot, step: WalkingStep, visit: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clips, "sync_of", lambda *_, **__: FOUND)
    switch_both_on(qtbot, step, visit)
    walk(qtbot, step, visit, frames=10)
    # both are looked into, though the second comes while the first is
    qtbot.waitUntil(lambda: [clip.sync for clip in clips_of(qtbot, visit, 2)] == [FOUND, FOUND])
    found = clips_of(qtbot, visit, 2)
    assert [(one.camera, one.view, one.width, one.height) for one in found] == [
        *((1, "from the left", 320, 180), (2, "from the right", 320, 240))
    ]
    for stored in found:
        assert stored.frames >= 10
        clip = opened(qtbot, visit, stored)
        assert len(clip.pictures) == stored.frames
        assert all(clip.pictures.jpeg(number)[:2] == b"\xff\xd8" for number in range(len(clip.pictures)))
        assert (clip.stamped_s[1:] > clip.stamped_s[:-1]).all()
    (row,) = step.page.rows
    assert "video 0:0" in row.note


@pytest.mark.parametrize("cameras", [[CAMERA, OTHER]])
def test_a_camera_that_ends_costs_its_own_video_and_never_the_walk(
    qtbot: QtBot, step: WalkingStep, visit: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clips, "sync_of", lambda *_, **__: FOUND)
    switch_both_on(qtbot, step, visit)
    start(qtbot, step, visit)
    first, second = step.camera.feeds
    qtbot.waitUntil(lambda: first.taken >= 3 and second.taken >= 3)
    first.kill()
    card = step.page.camera
    qtbot.waitUntil(lambda: card.pictures[0].isHidden())
    assert card.pictures[1].isVisible()
    assert card.notice.text
    assert "without video" not in card.notice.text
    before = second.taken
    qtbot.waitUntil(lambda: second.taken >= before + 5)
    second.kill()
    qtbot.waitUntil(lambda: "goes on without video" in card.notice.text)
    assert visit.recordings.is_recording
    stop(qtbot, step, visit)
    lost, later = clips_of(qtbot, visit, 2)
    assert (lost.camera, later.camera) == (1, 2)
    assert lost.frames >= 3
    assert later.frames >= before + 5
    (recorded,) = visit.recordings.walks
    assert recorded.read_back is not None
    assert recorded.read_back.imu


def opened(qtbot: QtBot, visit: Visit, stored: StoredClip) -> Clip:
    state = visit.controller.state
    assert state is not None
    return open_clip(state.library, stored, "walk")


@pytest.mark.parametrize("cameras", [[CAMERA, CameraInfo("Real one", "/dev/video0", V4L2)]])
def test_in_the_demonstration_nobodys_face_is_filmed_and_without_a_camera_there_is_no_card(
    qtbot: QtBot, step: WalkingStep, visit: Visit, cameras: list[CameraInfo], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its library lies plain on the disk."""
    qtbot.waitUntil(step.page.camera.isVisible)
    shown = step.camera.shown
    assert shown is not None
    assert shown.cameras[:2] == ("Test picture", "Real one")
    state = visit.controller.state
    assert state is not None
    monkeypatch.setattr(type(state), "is_demonstration", property(lambda _state: True))
    step.camera.look()
    qtbot.waitUntil(lambda: step.camera.shown is not None and step.camera.shown.cameras == ("Test picture",))
    cameras.clear()
    step.camera.look()
    qtbot.waitUntil(step.page.camera.isHidden)


def test_a_full_disk_or_a_walk_that_the_library_does_not_know_yet_costs_its_video_only(
    qtbot: QtBot, step: WalkingStep, visit: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    switch_on(qtbot, step, visit)
    notice = step.page.camera.notice
    start(qtbot, step, visit)
    (feed,) = step.camera.feeds
    qtbot.waitUntil(lambda: feed.taken >= 3)
    assert "disk" not in notice.text
    with monkeypatch.context() as full:
        full.setattr(ClipWriter, "has_ended", property(lambda _writer: True))
        qtbot.waitUntil(lambda: "no space left for video" in notice.text)
    assert feed.writer is None
    assert visit.recordings.is_recording
    clips_of(qtbot, visit)
    stop(qtbot, step, visit)
    with monkeypatch.context() as without_row:
        without_row.setattr(Recorder, "has_row", property(lambda _recorder: False))
        start(qtbot, step, visit)
        assert "This walk has no video." in notice.text
        (feed,) = step.camera.feeds
        assert feed.writer is None
    stop(qtbot, step, visit)
    walk(qtbot, step, visit, frames=feed.taken + 3)  # the next has one, and nothing more is stated of the one before
    *_, stored = clips_of(qtbot, visit, 2)
    assert stored.recording_id == visit.recordings.walks[-1].id
    assert "no video" not in notice.text


@pytest.mark.parametrize("cameras", [[CameraInfo("Square", "testsrc=size=320x240:rate=15", TEST_PICTURE)]])
def test_a_walk_begun_before_the_first_picture_has_a_video_until_the_patient_agrees_no_longer(
    qtbot: QtBot, step: WalkingStep, visit: Visit
) -> None:
    card = step.page.camera
    qtbot.waitUntil(card.isVisible)
    card.switch.click()
    card.agree.click()
    qtbot.waitUntil(lambda: bool(step.camera.feeds))
    walk(qtbot, step, visit, frames=8)
    (stored,) = clips_of(qtbot, visit)
    assert (stored.width, stored.height) == (320, 240)
    assert stored.rate_hz <= 15.0
    card.switch.click()
    assert card.withdraw.isVisible()
    card.withdraw.click()
    assert step.camera.dialog is not None
    assert visit.clips.stored  # until it is confirmed
    step.camera.dialog.answers["withdraw"].click()
    qtbot.waitUntil(lambda: not visit.clips.stored)
    assert not visit.clips.has_consent
    state = visit.controller.state
    assert state is not None
    assert list(state.library.videos.glob("*.journal")) == []
