"""Videos that nobody stopped are closed with what they hold; files of nobody and rows without a file are handled."""

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from uuid import UUID, uuid4

import pytest
from sqlalchemy import text

from app.storage.journal.reader import Damage, JournalReader
from app.storage.journal.records import Record
from app.storage.layout import segment_name
from app.storage.opened import OpenedLibrary, open_library
from app.storage.stored import ClipState, ServerSilentError, StoredClip
from app.storage.videos.destroying import withdraw_consent
from app.storage.videos.reader import open_clip
from app.storage.videos.recovery import recover_clips
from app.storage.videos.rows import Clips
from app.storage.videos.writer import ClipWriter
from app.workers.library_opening import tidy
from tests.driver import end_of_child
from tests.quick_library import PASSPHRASE
from tests.videos import MODE, NO_ROOM_ASKED, OPENED_NS, frame, picture, walk

MakeVideo = Callable[..., StoredClip]


def interrupted(opened: OpenedLibrary, recording_id: UUID, frames: int = 20, camera: int = 1) -> UUID:
    """A video as a kill leaves it: an open row, and a file with half a record at its end."""
    writer = ClipWriter.create(opened, recording_id, OPENED_NS, camera, "", MODE, room=NO_ROOM_ASKED)
    for number in range(frames):
        writer.add(frame(number), waits=True)
    with pytest.MonkeyPatch.context() as patched:
        for step in ("close", "delete"):
            patched.setattr(Clips, step, _silent)
        with pytest.raises(ServerSilentError):
            writer.stop()
    path = opened.videos / segment_name(writer.id, 1)
    with path.open("r+b") as file:
        file.truncate(path.stat().st_size - 70)  # its footer, and a piece of the frame before where there is one
    return writer.id


def _silent(*_: object) -> None:
    raise ServerSilentError("The library does not answer", "Try again")


def test_what_a_kill_left_is_closed_with_all_but_its_last_moment(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID
) -> None:
    clip_id = interrupted(opened, recording_id)
    tidy(opened)  # as at every start
    (clip,) = opened.library.clips.of_session(session_id)[recording_id]
    assert (clip.id, clip.state) == (clip_id, ClipState.RECOVERED)
    assert clip.frames in (19, 20)
    shown = open_clip(opened, clip, "walk 1")
    assert [shown.pictures.jpeg(k) for k in range(clip.frames)] == [picture(k) for k in range(clip.frames)]
    assert recover_clips(opened).closed == []


def test_one_without_a_picture_is_removed(opened: OpenedLibrary, session_id: UUID, recording_id: UUID) -> None:
    interrupted(opened, recording_id, 0)
    found = recover_clips(opened)
    assert (found.closed, found.removed, found.left) == ([], 1, {})
    assert list(opened.videos.iterdir()) == []
    assert opened.library.clips.known() == frozenset()


def test_a_header_that_a_kill_left_half_written_is_removed(opened: OpenedLibrary, recording_id: UUID) -> None:
    writer = ClipWriter.create(opened, recording_id, OPENED_NS, 1, "", MODE, room=NO_ROOM_ASKED)
    for clip_id in (writer.id, uuid4()):
        (opened.videos / f"{segment_name(clip_id, 1)}.new").write_bytes(b"half a header")
    recover_clips(opened)
    assert sorted(path.name for path in opened.videos.iterdir()) == [
        segment_name(writer.id, 1),
        f"{segment_name(writer.id, 1)}.new",  # another thread of this program may just be writing it
    ]
    writer.stop()


def test_one_that_is_being_made_is_left_alone(opened: OpenedLibrary, recording_id: UUID) -> None:
    writer = ClipWriter.create(opened, recording_id, OPENED_NS, 1, "", MODE, room=NO_ROOM_ASKED)
    writer.add(frame(0))
    found = recover_clips(opened)
    assert (found.closed, found.removed, found.left) == ([], 0, {})
    stored = writer.stop()
    assert stored is not None
    assert stored.state is ClipState.CLOSED


def test_a_row_whose_file_is_gone_goes_if_it_was_open_and_stays_if_it_was_closed(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID, make_video: MakeVideo
) -> None:
    closed = make_video(recording_id, camera=2)
    interrupted(opened, recording_id)
    for path in opened.videos.iterdir():
        path.unlink()
    assert recover_clips(opened).removed == 1
    assert opened.library.clips.of_session(session_id) == {recording_id: (closed,)}


def test_a_file_without_a_row_is_its_walks_again(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID, make_video: MakeVideo
) -> None:
    """An older copy of the database was put back: it does not know of the video."""
    clip = make_video(recording_id)
    kept = (opened.videos / clip.file).read_bytes()
    opened.library.clips.delete(clip.id)
    opened.library.clips.forget(clip.id)
    (opened.videos / clip.file).write_bytes(kept)
    found = recover_clips(opened)
    assert [one.id for one in found.closed] == [clip.id]
    (again,) = opened.library.clips.of_session(session_id)[recording_id]
    assert (again.frames, again.sha256, again.view, again.state) == (10, clip.sha256, clip.view, ClipState.CLOSED)
    assert open_clip(opened, again, "walk 1").pictures.jpeg(9) == picture(9)


@pytest.mark.parametrize("why", ["withdrawn", "walk destroyed"])
def test_a_file_without_a_row_that_nobody_may_see_is_destroyed(
    opened: OpenedLibrary, session_id: UUID, patient_id: UUID, make_video: MakeVideo, why: str
) -> None:
    recording = walk(opened, session_id, "walk 2")
    clip = make_video(recording.id)
    kept = (opened.videos / clip.file).read_bytes()
    if why == "withdrawn":
        withdraw_consent(opened, patient_id)
    else:
        opened.library.clips.delete(clip.id)
        opened.library.clips.forget(clip.id)
        opened.library.recordings.discard(recording.id)
    (opened.videos / clip.file).write_bytes(kept)
    assert recover_clips(opened).removed == 1
    assert list(opened.videos.iterdir()) == []


def test_a_file_without_a_row_stays_while_its_walk_waits_to_be_recovered(
    opened: OpenedLibrary, tmp_path: Path, recording_id: UUID, make_video: MakeVideo
) -> None:
    """The database is older than both: the walk's journal is an orphan, too."""
    older = tmp_path / "older"
    recording = opened.library.recordings.find(recording_id)
    assert recording is not None
    clip = make_video(recording_id)
    shutil.copytree(opened.folder, older)
    with open_library(older, PASSPHRASE) as again:
        again.library.clips.delete(clip.id)
        again.library.clips.forget(clip.id)
        with again.library.database.writing() as session:
            session.execute(text("DELETE FROM recordings"))
        found = recover_clips(again)
        assert list(found.left) == [clip.file]
        assert (again.videos / clip.file).exists()
        (again.recordings / recording.journals[0].file).unlink()
        assert recover_clips(again).removed == 1
        assert not (again.videos / clip.file).exists()


def test_a_file_that_cannot_be_read_stays_and_is_named(opened: OpenedLibrary, recording_id: UUID) -> None:
    opened.videos.mkdir()
    strange = opened.videos / f"{uuid4()}.1.journal"
    strange.write_bytes(os.urandom(5000))
    (opened.videos / "holiday.jpg").write_bytes(b"mine")
    clip_id = interrupted(opened, recording_id)
    path = opened.videos / segment_name(clip_id, 1)
    path.write_bytes(b"x" * 10 + path.read_bytes()[10:])
    found = recover_clips(opened)
    assert set(found.left) == {strange.name, path.name}
    assert len(list(opened.videos.iterdir())) == 3


def test_a_video_on_a_bad_piece_of_the_disk_keeps_no_other_one(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID, monkeypatch: pytest.MonkeyPatch
) -> None:
    bad, good = interrupted(opened, recording_id), interrupted(opened, recording_id, camera=2)
    read = JournalReader.records

    def fail(reader: JournalReader) -> Iterator[Record | Damage]:
        if reader.header.recording_id == bad:
            raise OSError(5, "Input/output error")
        yield from read(reader)

    monkeypatch.setattr(JournalReader, "records", fail)
    found = recover_clips(opened)
    assert [clip.id for clip in found.closed] == [good]
    assert found.left == {segment_name(bad, 1): "Input/output error"}
    assert (opened.videos / segment_name(bad, 1)).exists()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the child is a fork")
def test_a_kill_while_it_is_made_loses_no_more_than_its_last_moment(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID
) -> None:
    opened.library.suspend()  # a database is not shared with a child
    ready = opened.folder.parent / "ready"

    def make() -> None:
        writer = ClipWriter.create(opened, recording_id, OPENED_NS, 1, "", MODE, room=NO_ROOM_ASKED)
        for number in range(30):
            writer.add(frame(number), waits=True)
        while writer.status.synced_s <= 0.0 or writer.status.records < 32:
            pass
        ready.write_bytes(b"")
        os.kill(os.getpid(), 9)

    assert end_of_child(make) == -9
    assert ready.exists()
    recover_clips(opened)
    (clip,) = opened.library.clips.of_session(session_id)[recording_id]
    assert (clip.frames, clip.state) == (30, ClipState.RECOVERED)
