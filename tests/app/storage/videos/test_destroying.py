"""Deleted videos open no more; withdrawn consent, old age and their walk's end destroy them; a kill changes nothing."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from uuid import UUID

import pytest

from app.storage.journal.destroying import destroy_file
from app.storage.journal.header import IDENTITY, NO_KEY, WRAPPED_BYTES, JournalHeader
from app.storage.opened import OpenedLibrary
from app.storage.retention import destroy_overdue, destroy_recording
from app.storage.stored import ClipRefusedError, ClipState, StoredClip
from app.storage.videos import destroying
from app.storage.videos.destroying import destroy_clip, finish_destroying, withdraw_consent
from app.storage.videos.reader import open_clip, read_clip
from app.storage.videos.recovery import recover_clips
from app.storage.videos.retention import USUAL_DAYS, VIDEO_DAYS, destroy_overdue_clips, video_days
from app.storage.videos.writer import ClipWriter
from app.workers.library_opening import tidy
from tests.app.storage.later import Later, go_on, later, timed
from tests.videos import MODE, NO_ROOM_ASKED, OPENED_NS, frame, walk

MakeVideo = Callable[..., StoredClip]


__all__ = ["later", "timed"]  # fixtures


def test_a_video_that_is_deleted_is_gone_at_once_and_its_walk_stays(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID, make_video: MakeVideo
) -> None:
    first, second = make_video(recording_id), make_video(recording_id, camera=2)
    copy = (opened.videos / first.file).read_bytes()
    shown = open_clip(opened, first, "walk 1")
    destroy_clip(opened, first.id)
    assert opened.library.clips.of_session(session_id) == {recording_id: (second,)}
    assert [path.name for path in opened.videos.iterdir()] == [second.file]
    with pytest.raises(OSError, match="No such file"):
        shown.pictures.jpeg(0)
    (opened.videos / first.file).write_bytes(copy)  # an older copy keeps its key: a backup
    assert read_clip(opened.videos / first.file, first.id, opened.data_key).frames == 10
    destroy_clip(opened, first.id)  # again is no fault
    assert opened.library.recordings.find(recording_id) is not None


def test_the_key_is_overwritten_before_the_file_goes(
    opened: OpenedLibrary, recording_id: UUID, make_video: MakeVideo, monkeypatch: pytest.MonkeyPatch
) -> None:
    clip = make_video(recording_id)
    gone: list[bytes] = []
    monkeypatch.setattr(Path, "unlink", lambda path: gone.append(path.read_bytes()))
    destroy_clip(opened, clip.id)
    (left,) = gone
    assert left[IDENTITY.size : IDENTITY.size + WRAPPED_BYTES] == NO_KEY
    assert JournalHeader.parsed(left, "").is_key_destroyed


class KilledError(Exception):
    """What is raised in place of a kill."""


@pytest.mark.parametrize("at", ["destroy_file", "forget"])
@pytest.mark.parametrize("how", ["deleted", "withdrawn"])
def test_a_kill_amid_destroying_is_gone_on_with_at_the_next_start(
    opened: OpenedLibrary,
    session_id: UUID,
    recording_id: UUID,
    patient_id: UUID,
    make_video: MakeVideo,
    monkeypatch: pytest.MonkeyPatch,
    at: str,
    how: str,
) -> None:
    clips = [make_video(recording_id), make_video(recording_id, camera=2)]

    def killed(*_: object) -> None:
        raise KilledError

    place = (
        "app.storage.videos.destroying.destroy_file" if at == "destroy_file" else "app.storage.videos.rows.Clips.forget"
    )
    with monkeypatch.context() as patched:
        patched.setattr(place, killed)
        work = (
            partial(destroy_clip, opened, clips[0].id)
            if how == "deleted"
            else partial(withdraw_consent, opened, patient_id)
        )
        with pytest.raises(KilledError):
            work()
    left = opened.library.clips.of_session(session_id)
    assert left == ({recording_id: (clips[1],)} if how == "deleted" else {})  # out of sight at once
    assert finish_destroying(opened) == (1 if how == "deleted" else 2)
    kept = [clips[1].file] if how == "deleted" else []
    assert [path.name for path in opened.videos.iterdir()] == kept
    assert recover_clips(opened).left == {}
    assert finish_destroying(opened) == 0


def test_withdrawn_consent_destroys_all_videos_of_this_patient_at_once_and_one_that_is_being_made(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID, patient_id: UUID, make_video: MakeVideo
) -> None:
    make_video(recording_id)
    running = ClipWriter.create(
        opened, walk(opened, session_id, "walk 2").id, OPENED_NS, 1, "", MODE, room=NO_ROOM_ASKED
    )
    running.add(frame(0))
    assert withdraw_consent(opened, patient_id) == 2
    running.add(frame(1))
    assert running.stop() is None
    assert list(opened.videos.iterdir()) == []
    assert opened.library.clips.known() == frozenset()
    with pytest.raises(ClipRefusedError, match="has not agreed"):
        make_video(recording_id)
    opened.library.clips.give_consent(patient_id)
    make_video(recording_id)


def test_videos_of_a_walk_that_is_destroyed_go_before_it(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID, make_video: MakeVideo
) -> None:
    make_video(recording_id)
    recording = opened.library.recordings.find(recording_id)
    assert recording is not None
    destroy_recording(opened, recording)
    assert list(opened.videos.iterdir()) == list(opened.recordings.iterdir()) == []
    assert opened.library.clips.known() == frozenset()
    destroy_recording(opened, recording)


@pytest.mark.parametrize("is_patient", [False, True])
def test_a_deleted_session_or_patient_takes_its_videos_along_and_restored_keeps_them(
    timed: OpenedLibrary,
    session_id: UUID,
    recording_id: UUID,
    patient_id: UUID,
    make_video: MakeVideo,
    later: Later,
    is_patient: bool,
) -> None:
    clip = make_video(recording_id)
    library = timed.library
    library.sessions.delete(library.sessions.get(session_id))
    go_on(timed, later, 20)
    library.sessions.restore(library.sessions.get(session_id))
    go_on(timed, later, 40)
    assert destroy_overdue(timed, later) == 0
    assert library.clips.of_session(session_id) == {recording_id: (clip,)}
    if is_patient:
        library.patients.delete(library.patients.get(patient_id))
    else:
        library.sessions.delete(library.sessions.get(session_id))
    go_on(timed, later, 71)
    assert destroy_overdue(timed, later) == 1
    assert list(timed.videos.iterdir()) == []
    assert library.clips.known() == frozenset()
    assert library.audit.verify().faults == ()


def test_a_merged_patients_videos_go_with_the_one_who_stays(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID, patient_id: UUID, make_video: MakeVideo
) -> None:
    clip = make_video(recording_id)
    library = opened.library
    kept = library.patients.create(replace(library.patients.get(patient_id).details, code="P-2"))
    kept = library.patients.merge(kept, library.patients.get(patient_id))
    assert library.clips.of_session(session_id) == {recording_id: (clip,)}
    assert withdraw_consent(opened, kept.id) == 1
    assert list(opened.videos.iterdir()) == []


def test_a_video_is_destroyed_after_its_days_and_the_walk_stays(
    timed: OpenedLibrary, session_id: UUID, recording_id: UUID, make_video: MakeVideo, later: Later
) -> None:
    make_video(recording_id)
    go_on(timed, later, 364.9)
    assert destroy_overdue_clips(timed, later) == 0
    go_on(timed, later, 365.1)
    assert destroy_overdue_clips(timed, later) == 1
    assert list(timed.videos.iterdir()) == []
    assert timed.library.recordings.find(recording_id) is not None
    assert destroy_overdue_clips(timed, later) == 0


def test_what_is_no_number_of_days_is_the_usual_one(opened: OpenedLibrary) -> None:
    for setting in ("soon", -5, True):
        opened.library.settings.put(VIDEO_DAYS, setting)
        assert video_days(opened) == USUAL_DAYS == 365


@pytest.mark.parametrize(("setting", "after_days"), [(30, 31), (0, None)])
def test_the_library_states_for_how_long(
    timed: OpenedLibrary,
    recording_id: UUID,
    make_video: MakeVideo,
    later: Later,
    setting: int,
    after_days: float | None,
) -> None:
    make_video(recording_id)
    timed.library.settings.put(VIDEO_DAYS, setting)
    go_on(timed, later, (after_days or 500) - 2)
    assert destroy_overdue_clips(timed, later) == 0
    if after_days is not None:
        go_on(timed, later, after_days)
        assert destroy_overdue_clips(timed, later) == 1


@pytest.mark.parametrize("days", [400, 4000])
def test_a_clock_that_was_set_ahead_destroys_no_video(
    timed: OpenedLibrary, recording_id: UUID, make_video: MakeVideo, later: Later, days: float
) -> None:
    make_video(recording_id)
    for ahead in (days, days + 0.1, days + 2):
        later.days = ahead
        timed.library.log_in("hk")
        assert destroy_overdue_clips(timed, later) == 0


def test_a_video_that_is_being_made_is_not_overdue(timed: OpenedLibrary, recording_id: UUID, later: Later) -> None:
    writer = ClipWriter.create(timed, recording_id, OPENED_NS, 1, "", MODE, room=NO_ROOM_ASKED)
    writer.add(frame(0))
    go_on(timed, later, 400)
    assert destroy_overdue_clips(timed, later) == 0  # it is being recorded
    stored = writer.stop()
    assert stored is not None
    assert stored.state is ClipState.CLOSED
    assert destroy_overdue_clips(timed, later) == 1


def test_a_file_that_another_program_holds_keeps_no_other_video(
    opened: OpenedLibrary,
    session_id: UUID,
    recording_id: UUID,
    patient_id: UUID,
    make_video: MakeVideo,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    held, _ = make_video(recording_id), make_video(recording_id, camera=2)
    unlink = Path.unlink

    def refuse(path: Path) -> None:
        if path.name == held.file:
            raise PermissionError(13, "another program has it open")
        unlink(path)

    with monkeypatch.context() as patched:
        patched.setattr(Path, "unlink", refuse)
        with pytest.raises(PermissionError):
            withdraw_consent(opened, patient_id)
    assert [path.name for path in opened.videos.iterdir()] == [held.file]
    assert JournalHeader.parsed((opened.videos / held.file).read_bytes(), "").is_key_destroyed
    assert opened.library.clips.of_session(session_id) == {}
    assert finish_destroying(opened) == 1
    assert list(opened.videos.iterdir()) == []


def test_a_video_whose_file_another_program_holds_keeps_no_other_one(
    timed: OpenedLibrary, recording_id: UUID, make_video: MakeVideo, later: Later, monkeypatch: pytest.MonkeyPatch
) -> None:
    held = min((make_video(recording_id), make_video(recording_id, camera=2)), key=lambda one: one.file)

    def refused(path: Path) -> None:
        if path.name == held.file:
            raise PermissionError(13, "held", str(path))
        destroy_file(path)

    monkeypatch.setattr(destroying, "destroy_file", refused)
    go_on(timed, later, 366)
    with pytest.raises(PermissionError):
        destroy_overdue_clips(timed, later)
    assert [path.name for path in timed.videos.iterdir()] == [held.file]
    tidy(timed)  # as at every start: it goes on all the same
    monkeypatch.undo()
    tidy(timed)
    assert list(timed.videos.iterdir()) == []
    assert timed.library.clips.known() == frozenset()
