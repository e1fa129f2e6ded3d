"""Tests that videos of others are read in pieces by the limited process, and that bad ones are refused."""

import sys
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest
from av.audio.stream import AudioStream
from syrupy.assertion import SnapshotAssertion

from devices.files import limited_reader, video_file
from devices.files.answers import Array, BrokenAnswerError
from devices.files.child_tasks import video_piece
from devices.files.limited_reader import LimitedReader, LimitedReading
from devices.files.video_file import VideoPiece, details_of_piece, piece_from
from tests.devices.files.videos import FASTSTART, grey_of, level, middle_of, rotated, write_video
from tests.safety.file_fuzz import fuzz
from tests.safety.video_fuzz import videos
from tests.trials_of_files import refused

Edit = Callable[[bytes], bytes]


def numbers_of(piece: VideoPiece) -> list[int]:
    """Which frame each is, by its brightness."""
    levels = np.array([level(number) for number in range(55)])
    return [int(np.argmin(np.abs(levels - middle_of(jpeg)))) for jpeg in piece.jpegs]


def refusal(reading: LimitedReading, path: Path) -> str:
    stated = refused(reading.read_video, path, 0.0)
    assert stated.startswith(path.name)
    return stated


@pytest.mark.parametrize(
    ("name", "codec"), [("a.mp4", "libx264"), ("b.mov", "libx265"), ("c.mkv", "mpeg4"), ("d.webm", "libvpx-vp9")]
)
def test_a_video_comes_in_pieces_each_frame_once_at_its_time(
    shared_reading: LimitedReading, tmp_path: Path, name: str, codec: str
) -> None:
    path = write_video(tmp_path / name, 45, codec)
    numbers: list[int] = []
    times: list[float] = []
    from_s = 0.0
    while True:
        piece = shared_reading.read_video(path, from_s, 20)
        numbers += numbers_of(piece)
        times += piece.time_s.tolist()
        assert not piece.is_damaged
        if piece.is_end:
            break
        assert len(piece.jpegs) == 20
        from_s = times[-1] + 1e-3
    assert numbers == list(range(45))
    np.testing.assert_allclose(times, np.arange(45) / 30.0, atol=1.1e-3)  # some files count milliseconds
    assert (piece.width, piece.height) == (320, 180)
    assert piece.rate_hz == pytest.approx(30.0, rel=0.01)
    assert piece.length_s == pytest.approx(1.5, abs=0.05)


def test_a_large_video_is_scaled_down_and_one_held_upright_is_upright(
    shared_reading: LimitedReading, tmp_path: Path
) -> None:
    path = write_video(tmp_path / "a.mp4", 3, size=(1920, 1080))
    piece = shared_reading.read_video(path, 0.0)
    assert (piece.width, piece.height) == (1280, 720)
    assert grey_of(piece.jpegs[0]).shape == (720, 1280)
    corners = {}
    for turns in (1, 2, 3):
        (tmp_path / "b.mp4").write_bytes(rotated(path.read_bytes(), turns))
        piece = shared_reading.read_video(tmp_path / "b.mp4", 0.0)
        grey = grey_of(piece.jpegs[0])
        assert grey.shape == (piece.height, piece.width) == ((720, 1280) if turns == 2 else (1280, 720))
        places = {(y, x): int(grey[y, x]) for y in (5, -5) for x in (5, -5)}
        corners[turns] = max(places, key=lambda place: places[place])
    # the matrix (a b; c d) takes (x, y), y down, to (ax + cy, bx + dy): a quarter turn is clockwise
    assert corners == {1: (5, -5), 2: (-5, -5), 3: (-5, 5)}


def test_a_video_that_breaks_off_gives_what_is_whole(shared_reading: LimitedReading, tmp_path: Path) -> None:
    content = write_video(tmp_path / "a.mp4", 120, options=FASTSTART).read_bytes()
    (tmp_path / "cut.mp4").write_bytes(content[: len(content) * 2 // 3])
    piece = shared_reading.read_video(tmp_path / "cut.mp4", 0.0)
    assert piece.is_end
    assert piece.is_damaged
    assert 20 < len(piece.jpegs) < 110
    assert piece.length_s == pytest.approx(4.0, abs=0.05)
    assert numbers_of(piece) == [number % 55 for number in range(len(piece.jpegs))]
    whole = shared_reading.read_video(tmp_path / "a.mp4", 0.0)
    assert (len(whole.jpegs), whole.is_end, whole.is_damaged) == (120, True, False)


@pytest.mark.parametrize("name", ["a.mkv", "b.mp4"])
def test_sound_that_goes_on_after_the_pictures_damages_nothing(
    shared_reading: LimitedReading, tmp_path: Path, name: str
) -> None:
    piece = shared_reading.read_video(write_video(tmp_path / name, 45, sound_s=4.5), 0.0)
    assert (len(piece.jpegs), piece.is_end, piece.is_damaged) == (45, True, False)


def encrypted(content: bytes) -> bytes:
    assert content.count(b"avc1") >= 1
    assert content.count(b"btrt") == 1
    return content.replace(b"avc1", b"encv").replace(b"btrt", b"sinf")


UNUSABLE: dict[str, Edit] = {
    "nothing": lambda content: b"",
    "zeros": lambda content: b"\0" * 5000,
    "a list of other files": lambda content: b"#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\n/etc/passwd\n",
    "another list of other files": lambda content: b"ffconcat version 1.0\nfile a.mp4\n",
    "no index": lambda content: content.replace(b"moov", b"moof"),
    "encrypted": encrypted,
}


def test_what_is_no_usable_video_is_refused(
    shared_reading: LimitedReading, tmp_path: Path, snapshot: SnapshotAssertion
) -> None:
    content = write_video(tmp_path / "a.mp4").read_bytes()
    found = {}
    for case, edit in UNUSABLE.items():
        (tmp_path / "bad.mp4").write_bytes(edit(content))
        found[case] = refusal(shared_reading, tmp_path / "bad.mp4")
        assert len(shared_reading.read_video(tmp_path / "a.mp4", 0.0).jpegs) == 45
    assert found == snapshot


def test_a_video_of_an_hour_is_refused(shared_reading: LimitedReading, tmp_path: Path) -> None:
    path = write_video(tmp_path / "a.mp4", 4, rate=Fraction(1, 900))
    stated = "this video is longer than 30 minutes. Cut the part with the walk out of it and import that."
    assert stated in refusal(shared_reading, path)


def test_a_file_with_sound_alone_is_refused(shared_reading: LimitedReading, tmp_path: Path) -> None:
    with av.open(str(tmp_path / "a.mp4"), "w") as container:
        stream = container.add_stream("aac", rate=44100)
        assert isinstance(stream, AudioStream)
        stream.layout = "mono"
        sound = av.AudioFrame.from_ndarray(np.zeros((1, 1024), np.float32), format="fltp", layout="mono")
        sound.sample_rate = 44100
        container.mux(stream.encode(sound))
        container.mux(stream.encode(None))
    assert "this file has no pictures. Choose a video." in refusal(shared_reading, tmp_path / "a.mp4")


def test_a_video_that_is_too_large_is_refused_before_it_is_opened(
    shared_reading: LimitedReading, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_video(tmp_path / "a.mp4")
    monkeypatch.setattr(limited_reader, "MOST_VIDEO_BYTES", 1000)
    assert "more than a recording should need" in refusal(shared_reading, path)
    assert video_file.MOST_VIDEO_BYTES == 4_000_000_000


def test_a_video_that_takes_too_long_is_refused_and_the_next_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_video(tmp_path / "a.mp4")
    reader = LimitedReader()
    try:
        with monkeypatch.context() as patched:
            patched.setattr(limited_reader, "PIECE_S", 0.0)
            assert "takes longer" in refusal(LimitedReading(reader, lambda: None), path)
        assert len(LimitedReading(reader, lambda: None).read_video(path, 0.0).jpegs) == 45
    finally:
        reader.close()


def test_without_the_library_a_video_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "devices.files.video_frames", None)
    asked = {"path": str(tmp_path / "a.mp4"), "where": "a.mp4", "from_s": 0.0, "most_frames": 9}
    assert refused(video_piece, asked, []) == (
        "a.mp4: videos cannot be read: a software library is missing. Install gaitwright[video]."
    )


PIECE = VideoPiece(np.array([0.0, 0.1]), (b"\xff\xd8a\xff\xd9", b"\xff\xd8b\xff\xd9"), True, False, 4, 2, 30.0, np.nan)


def test_a_piece_comes_back_as_it_was_sent() -> None:
    arrays: list[Array] = []
    back = piece_from(details_of_piece(PIECE, arrays), arrays)
    assert back.jpegs == PIECE.jpegs
    np.testing.assert_array_equal(back.time_s, PIECE.time_s)
    assert np.isnan(back.length_s)
    assert replace(back, time_s=PIECE.time_s, length_s=PIECE.length_s) == PIECE


@pytest.mark.parametrize(
    "broken",
    [
        replace(PIECE, time_s=np.array([0.1, 0.1])),
        replace(PIECE, time_s=np.array([0.0, np.nan])),
        replace(PIECE, time_s=np.array([0.0])),
        replace(PIECE, time_s=np.array([0, 1])),
        replace(PIECE, jpegs=(b"GIF89a", b"\xff\xd8b\xff\xd9")),
        replace(PIECE, jpegs=(b"", b"\xff\xd8b\xff\xd9")),
        replace(PIECE, width=100_000),
        replace(PIECE, width=0),
        replace(PIECE, rate_hz=np.inf),
        replace(PIECE, rate_hz=-1.0),
    ],
)
def test_a_piece_of_another_shape_is_no_answer(broken: VideoPiece) -> None:
    arrays: list[Array] = []
    with pytest.raises(BrokenAnswerError):
        piece_from(details_of_piece(broken, arrays), arrays)
    with pytest.raises(BrokenAnswerError):
        piece_from({}, arrays)


@pytest.mark.parametrize("name", videos())
def test_a_spoilt_video_is_read_or_refused(name: str, shared_reader: LimitedReader) -> None:
    found = fuzz(videos()[name], 5, 3, shared_reader)  # `python -m tests.safety.video_fuzz` reads hundreds
    assert found.faults == []
    assert found.count["read"] > 0
    assert found.count["refused"] > 0
