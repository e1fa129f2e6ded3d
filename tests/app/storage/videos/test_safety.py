"""Videos that are killed leave no picture in the clear and cost the walk nothing: a few here, many by the script."""

import os
from dataclasses import replace
from pathlib import Path
from uuid import UUID

import pytest

from app.storage.opened import OpenedLibrary
from app.storage.videos.reader import open_clip
from app.storage.videos.writer import ClipWriter
from tests.safety.video_kills import WAYS, in_the_clear, kill_videos, picture
from tests.videos import MODE, NO_ROOM_ASKED, OPENED_NS, Frame

needs_posix = pytest.mark.skipif(os.name == "nt", reason="SIGKILL, fork and limits of files are POSIX's")


@needs_posix
def test_of_videos_that_are_killed_no_picture_is_in_the_clear_and_the_walk_is_whole(tmp_path: Path) -> None:
    found = kill_videos(tmp_path, seed=1, rounds=len(WAYS))
    assert found.faults == []
    assert all(found.count[way] for way in WAYS)


@needs_posix
@pytest.mark.endurance
def test_a_minute_of_kills_leaves_no_picture_in_the_clear(tmp_path: Path) -> None:
    assert kill_videos(tmp_path, seed=2, seconds=60).faults == []


def test_a_picture_in_the_clear_would_be_found(opened: OpenedLibrary, recording_id: UUID, tmp_path: Path) -> None:
    for place, data_key in (("sealed", opened.data_key), ("open", None)):
        into = replace(opened, data_key=data_key, folder=tmp_path / place)
        into.folder.mkdir()
        (into.folder / "library-id").write_bytes((opened.folder / "library-id").read_bytes())
        writer = ClipWriter.create(into, recording_id, OPENED_NS, 1 + (data_key is None), "", MODE, room=NO_ROOM_ASKED)
        for number in range(3):
            writer.add(Frame(OPENED_NS, None, picture(number, 1)))
        stored = writer.stop()
        assert stored is not None
        found = list(in_the_clear([into.folder]))
        assert found == ([] if data_key else [into.videos / stored.file])
        shown = open_clip(into, stored, "walk 1").pictures  # the demonstration's library, too, shows its videos
        assert [shown.jpeg(k) for k in range(3)] == [picture(k, 1) for k in range(3)]
