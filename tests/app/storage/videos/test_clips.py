"""A video is read as it was made: every frame, and when it was taken, whatever the camera's clock and the disk did."""

import threading
from collections.abc import Callable
from dataclasses import replace
from uuid import UUID, uuid4

import numpy as np
import pytest

from app.storage.clinic.station import Station
from app.storage.journal.disk import ROOM, JournalFile, Room, Trouble
from app.storage.journal.header import HEADER_BYTES
from app.storage.opened import OpenedLibrary
from app.storage.stored import ClipRefusedError, ClipState, StoredClip
from app.storage.videos.content import MOST_BYTES
from app.storage.videos.reader import open_clip, taken_ns
from app.storage.videos.writer import CLIP_ROOM, ClipWriter
from core.video.clip import SyncBy
from tests.videos import FRAME_NS, MODE, OPENED_NS, Frame, frame, picture, plain_pieces

ANY_ROOM = Room(start_s=0.0, start_bytes=0, warn_s=0.0, kept_bytes=0)
MakeVideo = Callable[..., StoredClip]


def test_every_frame_comes_back_with_the_time_it_was_taken_at(
    opened: OpenedLibrary, recording_id: UUID, make_video: MakeVideo
) -> None:
    stored = make_video(recording_id, 90)
    assert (stored.state, stored.frames) == (ClipState.CLOSED, 90)
    assert stored.length_s == pytest.approx(89 * FRAME_NS / 1e9)
    clip = open_clip(opened, stored, "walk 1")
    assert (clip.recording, clip.camera, clip.view, clip.width, clip.height) == (
        "walk 1",
        1,
        "from the left",
        1280,
        720,
    )
    assert [clip.pictures.jpeg(k) for k in range(len(clip.pictures))] == [picture(k) for k in range(90)]
    np.testing.assert_allclose(clip.stamped_s, (np.arange(90) * FRAME_NS + 50_000_000) / 1e9, atol=1e-9)
    assert clip.sync is not None
    assert clip.sync.by is SyncBy.CLOCK
    assert list(plain_pieces([picture(k) for k in range(90)], opened.folder)) == []


def test_frames_are_opened_from_any_thread(opened: OpenedLibrary, recording_id: UUID, make_video: MakeVideo) -> None:
    clip = open_clip(opened, make_video(recording_id, 60), "walk 1")
    wrong: list[int] = []

    def look(first: int) -> None:
        wrong.extend(k for k in range(first, 60, 4) if clip.pictures.jpeg(k) != picture(k))

    threads = [threading.Thread(target=look, args=(first,)) for first in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


def test_a_damaged_stretch_costs_its_frames_only(
    opened: OpenedLibrary, recording_id: UUID, make_video: MakeVideo
) -> None:
    stored = make_video(recording_id, 30)
    path = opened.videos / stored.file
    before = open_clip(opened, stored, "walk 1")
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    with pytest.raises(OSError, match="damaged"):
        [before.pictures.jpeg(k) for k in range(30)]  # it was damaged while it was open
    after = open_clip(opened, stored, "walk 1")
    got = [after.pictures.jpeg(k) for k in range(len(after.pictures))]
    assert len(got) == 29
    assert set(got) < {picture(k) for k in range(30)}
    np.testing.assert_array_equal(np.isin(after.stamped_s, before.stamped_s), True)


def test_where_its_first_words_are_damaged_the_walks_file_has_its_beginning(
    opened: OpenedLibrary, recording_id: UUID, make_video: MakeVideo
) -> None:
    stored = make_video(recording_id, 5)
    path = opened.videos / stored.file
    content = bytearray(path.read_bytes())
    content[HEADER_BYTES + 30] ^= 1
    path.write_bytes(content)
    clip = open_clip(opened, stored, "walk 1")
    assert len(clip.pictures) == 5
    assert np.all(np.isfinite(clip.stamped_s))
    np.testing.assert_allclose(np.diff(clip.stamped_s), FRAME_NS / 1e9, atol=1e-6)


def test_a_file_that_is_gone_damaged_or_another_videos_is_refused(
    opened: OpenedLibrary, recording_id: UUID, make_video: MakeVideo
) -> None:
    first, second = make_video(recording_id), make_video(recording_id, camera=2, seed=1)
    kept = (opened.videos / first.file).read_bytes()
    (opened.videos / first.file).write_bytes((opened.videos / second.file).read_bytes())
    with pytest.raises(ClipRefusedError, match="damaged"):
        open_clip(opened, first, "walk 1")
    (opened.videos / first.file).write_bytes(kept[:40])
    with pytest.raises(ClipRefusedError, match="damaged"):
        open_clip(opened, first, "walk 1")
    (opened.videos / first.file).unlink()
    with pytest.raises(ClipRefusedError, match="missing"):
        open_clip(opened, first, "walk 1")


def test_the_least_delayed_frame_is_the_cameras_clock() -> None:
    rng = np.random.default_rng(1)
    pts = np.arange(300, dtype=np.int64) * FRAME_NS
    late = 40_000_000 + rng.exponential(15e6, 300).astype(np.int64)
    arrival = np.maximum.accumulate(OPENED_NS + pts + late)
    got = taken_ns(arrival, pts + 77)
    np.testing.assert_array_equal(got - got[0], pts)
    assert np.all(got <= arrival)
    assert np.min(arrival - got) == 0


@pytest.mark.parametrize("clock", ["none", "stands still", "half as fast", "jumps back", "late in one stall"])
def test_a_camera_whose_clock_is_of_no_use_is_taken_by_its_arrivals(clock: str) -> None:
    number = np.arange(300, dtype=np.int64)
    arrival = OPENED_NS + number * FRAME_NS + 30_000_000
    pts = number * FRAME_NS
    expected = arrival.copy()
    match clock:
        case "none":
            pts = np.full(300, -1)
        case "stands still":
            pts = np.full(300, 5)
        case "half as fast":
            pts = pts // 2
        case "jumps back":  # the camera was begun again: each stretch by its own least delay
            pts = pts % (150 * FRAME_NS)
        case "late in one stall":  # what came a second late was still taken when the camera states
            arrival = arrival.copy()
            arrival[100:130] = arrival[130]
    np.testing.assert_array_equal(taken_ns(arrival, pts), expected)


def test_times_never_go_back(opened: OpenedLibrary) -> None:
    rng = np.random.default_rng(3)
    for _ in range(200):
        arrival = np.cumsum(rng.integers(0, 60_000_000, 50))
        pts = np.where(rng.random(50) < 0.2, -1, np.cumsum(rng.integers(-5_000_000, 60_000_000, 50)))
        got = taken_ns(arrival, pts)
        assert np.all(np.diff(got) >= 0)
        assert np.all(got <= np.maximum.accumulate(arrival))
    assert len(taken_ns(np.zeros(0, np.int64), np.zeros(0, np.int64))) == 0


def test_a_video_without_a_picture_is_none(opened: OpenedLibrary, recording_id: UUID) -> None:
    writer = ClipWriter.create(opened, recording_id, OPENED_NS, 1, "", MODE, room=ANY_ROOM)
    assert writer.stop() is None
    assert opened.library.clips.known() == frozenset()
    assert list(opened.videos.iterdir()) == []
    assert writer.stop() is None


def test_a_frame_that_does_not_fit_is_dropped_counted_and_waited_for_by_nobody(
    opened: OpenedLibrary, recording_id: UUID, monkeypatch: pytest.MonkeyPatch
) -> None:
    go_on, is_stalled = threading.Event(), threading.Event()
    append = JournalFile.append

    def stall(file: JournalFile, data: bytes | bytearray) -> None:
        is_stalled.set()
        go_on.wait()
        append(file, data)

    monkeypatch.setattr(JournalFile, "append", stall)
    writer = ClipWriter.create(opened, recording_id, OPENED_NS, 1, "", MODE, room=ANY_ROOM, queue_bytes=50_000)
    assert writer.add(frame(0))
    is_stalled.wait()
    taken = [writer.add(frame(k)) for k in range(1, 100)]
    assert not writer.add(replace(frame(100), jpeg=bytes(MOST_BYTES + 1)))
    go_on.set()
    stored = writer.stop()
    assert stored is not None
    assert taken.count(True) + 1 == writer.frames == stored.frames
    assert writer.dropped_frames == taken.count(False) + 1
    assert 5 < stored.frames < 20
    clip = open_clip(opened, stored, "walk 1")
    assert [clip.pictures.jpeg(k) for k in range(stored.frames)] == [picture(k) for k in range(stored.frames)]


def test_a_video_needs_its_walk_and_a_library_of_this_computer(
    opened: OpenedLibrary, recording_id: UUID, tmp_path: object
) -> None:
    def create(into: OpenedLibrary, recording: UUID = recording_id, room: Room = ANY_ROOM) -> None:
        ClipWriter.create(into, recording, OPENED_NS, 1, "", MODE, room=room)

    with pytest.raises(ClipRefusedError, match="not in the library, so no video"):
        create(opened, uuid4())
    assert list(opened.videos.iterdir()) == []
    station = Station("postgresql://nowhere/x", "", "")
    with pytest.raises(ClipRefusedError, match="clinic's shared library stores no videos"):
        create(replace(opened, away_from=station))
    with pytest.raises(ClipRefusedError, match="not enough disk space"):
        create(opened, room=replace(ANY_ROOM, start_bytes=1 << 60))
    elsewhere = opened.folder.with_name("elsewhere")
    opened.folder.rename(elsewhere)
    with pytest.raises(ClipRefusedError, match="not available"):
        create(opened)
    elsewhere.rename(opened.folder)
    assert opened.library.clips.known() == frozenset()


def test_a_full_disk_ends_the_video_while_a_walk_has_ten_minutes_of_room_and_a_next_one_can_begin(
    opened: OpenedLibrary, recording_id: UUID, monkeypatch: pytest.MonkeyPatch
) -> None:
    free = [CLIP_ROOM.start_bytes + 200_000_000]
    usage = type("Usage", (), {"free": property(lambda _: free[0])})
    monkeypatch.setattr("app.storage.journal.disk.shutil.disk_usage", lambda _: usage())
    ended: list[Trouble] = []
    has_ended = threading.Event()

    def note(trouble: Trouble) -> None:
        ended.append(trouble)
        has_ended.set()

    writer = ClipWriter.create(opened, recording_id, OPENED_NS, 1, "", MODE, on_trouble=note)
    for number in range(20):
        writer.add(frame(number))
    free[0] = CLIP_ROOM.kept_bytes
    assert has_ended.wait(20)
    assert ended == [Trouble.NO_ROOM]
    stored = writer.stop()
    assert stored is not None
    assert (stored.state, stored.frames, writer.has_ended) == (ClipState.CLOSED, 20, True)
    assert not writer.add(frame(21))
    assert (free[0] - ROOM.kept_bytes) / 200_000 >= 600  # at the full rate of six sensors
    ROOM.check(opened.folder, 200_000)  # the next walk may begin


def test_frames_of_an_import_are_given_as_they_are_and_wait_for_their_times(
    opened: OpenedLibrary, recording_id: UUID
) -> None:
    writer = ClipWriter.create(
        opened, recording_id, OPENED_NS, 2, "", MODE, is_imported=True, room=ANY_ROOM, queue_bytes=9000
    )
    for number in range(200):
        assert writer.add(Frame(OPENED_NS + number * FRAME_NS, None, picture(number)), waits=True)
    stored = writer.stop()
    assert stored is not None
    clip = open_clip(opened, stored, "walk 1")
    assert (stored.sync, stored.is_imported, len(clip.pictures)) == (None, True, 200)
    np.testing.assert_allclose(clip.time_s, np.arange(200) * FRAME_NS / 1e9, atol=1e-9)
