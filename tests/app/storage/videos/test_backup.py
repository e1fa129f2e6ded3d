"""A backup has videos where they were asked for; one without states so of each, and has no key of theirs."""

from collections.abc import Callable
from pathlib import Path
from uuid import UUID

import pytest

from app.storage.backup import back_up, find_backups, restore
from app.storage.opened import OpenedLibrary, open_library
from app.storage.stored import ClipRefusedError, ClipState, StoredClip
from app.storage.videos.destroying import destroy_clip
from app.storage.videos.reader import open_clip
from app.storage.videos.recovery import recover_clips
from tests.quick_library import PASSPHRASE
from tests.videos import picture, plain_pieces

MakeVideo = Callable[..., StoredClip]


@pytest.fixture
def backups(tmp_path: Path) -> Path:
    (tmp_path / "backups").mkdir()
    return tmp_path / "backups"


def test_a_backup_with_videos_holds_them_and_its_list_states_so(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID, make_video: MakeVideo, backups: Path, tmp_path: Path
) -> None:
    clip = make_video(recording_id, 30)
    backup = back_up(opened, backups, with_videos=True)
    assert (backup.faults, backup.has_videos, backup.files) == ((), True, 4)
    assert [one.has_videos for one in find_backups(backups)] == [True]
    assert restore(backup.folder, tmp_path / "restored", opened.data_key, "hk") == ()
    with open_library(tmp_path / "restored", PASSPHRASE) as restored:
        (found,) = restored.library.clips.of_session(session_id)[recording_id]
        assert found == clip
        shown = open_clip(restored, found, "walk 1")
        assert [shown.pictures.jpeg(k) for k in range(30)] == [picture(k) for k in range(30)]
    assert list(plain_pieces([picture(k) for k in range(30)], tmp_path)) == []


def test_a_backup_without_videos_states_so_of_each_rather_than_that_it_is_faulty(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID, make_video: MakeVideo, backups: Path, tmp_path: Path
) -> None:
    clip = make_video(recording_id, 30)
    backup = back_up(opened, backups)
    assert (backup.faults, backup.has_videos, backup.files) == ((), False, 3)
    assert not [path for path in backup.folder.rglob("*") if str(clip.id) in path.name]
    assert restore(backup.folder, tmp_path / "restored", opened.data_key, "hk") == ()
    with open_library(tmp_path / "restored", PASSPHRASE) as restored:
        (found,) = restored.library.clips.of_session(session_id)[recording_id]
        assert (found.state, found.wrapped_key) == (ClipState.NOT_IN_BACKUP, None)
        with pytest.raises(ClipRefusedError, match="video of walk 1 is not in the backup"):
            open_clip(restored, found, "walk 1")
        assert recover_clips(restored).closed == []
        assert restored.library.clips.of_session(session_id)[recording_id] == (found,)
        assert restored.library.audit.verify().faults == ()
    assert opened.library.clips.of_session(session_id)[recording_id] == (clip,)
    assert len(open_clip(opened, clip, "walk 1").pictures) == 30


def test_what_the_library_lacks_of_its_videos_is_reported(
    opened: OpenedLibrary, recording_id: UUID, make_video: MakeVideo, backups: Path
) -> None:
    first, second = make_video(recording_id), make_video(recording_id, camera=2)
    (opened.videos / first.file).unlink()
    content = bytearray((opened.videos / second.file).read_bytes())
    content[700] ^= 1
    (opened.videos / second.file).write_bytes(content)
    faults = back_up(opened, backups, with_videos=True).faults
    assert sorted(faults) == sorted(
        [f"{first.file} is missing", f"{second.file} is not what it was when it was closed"]
    )
    for backup in find_backups(backups):
        assert backup.has_videos


def test_a_video_destroyed_amid_a_backup_is_left_out_and_ends_nothing(
    opened: OpenedLibrary, recording_id: UUID, make_video: MakeVideo, backups: Path
) -> None:
    first, second = sorted((make_video(recording_id), make_video(recording_id, camera=2)), key=lambda one: one.file)

    def report(_share: float, _what: str) -> None:
        if list(backups.rglob(first.file)):
            destroy_clip(opened, second.id)

    backup = back_up(opened, backups, report, with_videos=True)
    assert (backup.faults, backup.files) == ((), 4)
    assert not [path for path in backup.folder.rglob("*") if str(second.id) in path.name]
