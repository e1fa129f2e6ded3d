"""Videos stay in the library: no export holds a frame, no session that goes elsewhere brings one along."""

from collections.abc import Iterator
from pathlib import Path
from uuid import UUID

import pytest

from app.exports.exports import NEEDED, Format, export_from_library
from app.storage.clinic.joining import new_station
from app.storage.clinic.moving import move_to_server
from app.storage.exchange import import_session, session_with_samples
from app.storage.layout import VIDEOS
from app.storage.opened import OpenedLibrary
from app.storage.stored import LibraryError
from app.storage.videos.writer import ClipWriter
from app.system.progress import nobody
from core.session import RecordingKind
from devices.decoders import DECODERS
from devices.files.session_folder import read_session, write_session
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings
from tests.app.storage.library.folder_export import write_folder
from tests.quick_library import quick_library
from tests.simulated import analysis_of, session_of
from tests.videos import MODE, NO_ROOM_ASKED, OPENED_NS, frame, picture, plain_pieces

FRAMES = 20


@pytest.fixture
def with_videos(tmp_path: Path) -> Iterator[tuple[OpenedLibrary, UUID]]:
    """A library with one simulated visit, whose walk has a video from two cameras."""
    session = session_of(WalkerSettings(seed=2, recordings=(Standing(), FreeMotion(), Walk(strides=6))))
    with quick_library(tmp_path / "library") as opened:
        imported = import_session(opened, session, nobody, "DEMO-1", room=NO_ROOM_ASKED)
        opened.library.clips.give_consent(imported.patient.id)
        visit = opened.library.sessions.get(imported.session_id)
        (walk,) = (one for one in visit.recordings if one.details.kind is RecordingKind.WALKING)
        for camera in (1, 2):
            writer = ClipWriter.create(opened, walk.id, OPENED_NS, camera, "", MODE, room=NO_ROOM_ASKED)
            for number in range(FRAMES):
                writer.add(frame(number, camera), waits=True)
            assert writer.stop() is not None
        yield opened, imported.session_id


def pictures() -> list[bytes]:
    return [picture(number, camera) for camera in (1, 2) for number in range(FRAMES)]


def test_what_is_searched_for_would_be_found(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"before" + picture(3, 1)[500:] + b"after")
    (tmp_path / "b").write_bytes(b"nothing")
    assert list(plain_pieces(pictures(), tmp_path)) == ["a"]


def test_no_export_of_a_session_holds_a_video(with_videos: tuple[OpenedLibrary, UUID], tmp_path: Path) -> None:
    opened, session_id = with_videos
    out = tmp_path / "out"
    out.mkdir()
    formats = [one for one in Format if one not in NEEDED]
    for is_identified in (False, True):
        into = out / str(is_identified)
        into.mkdir()
        export_from_library(
            opened, session_id, formats, into, DECODERS, nobody, is_identified=is_identified, analysed=analysis_of
        )
        write_folder(opened, session_id, into / "session", DECODERS, is_identified=is_identified)
    sealed = [path.read_bytes() for path in opened.videos.iterdir()]
    written = [path for path in out.rglob("*") if path.is_file()]
    assert len(written) > 20
    assert list(plain_pieces(pictures(), out)) == []
    assert not [path for path in written if any(one[200:240] in path.read_bytes() for one in sealed)]
    assert not [path for path in written if path.suffix.lower() in (".jpg", ".jpeg", ".mp4", ".journal")]


def test_a_session_that_goes_to_another_library_goes_without_its_videos(
    with_videos: tuple[OpenedLibrary, UUID], tmp_path: Path
) -> None:
    opened, session_id = with_videos
    session = session_with_samples(opened, opened.library.sessions.get(session_id), DECODERS, nobody)
    write_session(session, tmp_path / "session")
    with quick_library(tmp_path / "other") as other:
        there = import_session(other, read_session(tmp_path / "session"), nobody, "DEMO-1", room=NO_ROOM_ASKED)
        assert other.library.clips.of_session(there.session_id) == {}
        assert not other.library.clips.consent(there.patient.id).is_given
        assert not (other.folder / VIDEOS).exists()


def test_a_library_with_videos_is_not_moved_to_a_clinics_server(
    with_videos: tuple[OpenedLibrary, UUID], tmp_path: Path
) -> None:
    opened, session_id = with_videos
    with pytest.raises(LibraryError, match="contains videos"):
        move_to_server(opened, new_station("postgresql://nobody@localhost/none", str(tmp_path)), nobody)
    assert len(opened.library.clips.of_session(session_id)) == 1
