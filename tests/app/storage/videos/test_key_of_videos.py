"""A change of the library's key wraps the keys of videos again, in their rows and in their files."""

from collections.abc import Callable
from uuid import UUID

import pytest

from app.storage.key_change import change_data_key
from app.storage.opened import OpenedLibrary, open_library
from app.storage.stored import ClipRefusedError, LibraryError, StoredClip
from app.storage.videos.reader import open_clip, read_clip
from app.storage.videos.writer import ClipWriter
from app.system.progress import nobody
from tests.quick_library import PASSPHRASE
from tests.videos import MODE, NO_ROOM_ASKED, OPENED_NS, frame, picture

MakeVideo = Callable[..., StoredClip]


def test_videos_open_with_the_new_key_and_no_more_with_the_old_one(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID, make_video: MakeVideo
) -> None:
    clip = make_video(recording_id)
    old, written = opened.data_key, (opened.videos / clip.file).read_bytes()
    change_data_key(opened, ["hk"], nobody)
    with open_library(opened.folder, PASSPHRASE) as again:
        (found,) = again.library.clips.of_session(session_id)[recording_id]
        assert found.wrapped_key != clip.wrapped_key
        contents = read_clip(again.videos / found.file, found.id, again.data_key)  # by the header alone
        assert (contents.frames, contents.report.sha256) == (10, found.sha256)
        assert open_clip(again, found, "walk 1").pictures.jpeg(3) == picture(3)
        stranger = OpenedLibrary(again.library, again.folder, old)
        with pytest.raises(ClipRefusedError, match="damaged and cannot be opened"):
            open_clip(stranger, found, "walk 1")
        assert (again.videos / found.file).read_bytes() != written


def test_the_key_is_not_changed_while_a_video_is_being_made(opened: OpenedLibrary, recording_id: UUID) -> None:
    writer = ClipWriter.create(opened, recording_id, OPENED_NS, 1, "", MODE, room=NO_ROOM_ASKED)
    writer.add(frame(0))
    with pytest.raises(LibraryError, match="video is being recorded"):
        change_data_key(opened, ["hk"], nobody)
    assert writer.stop() is not None
    change_data_key(opened, ["hk"], nobody)
