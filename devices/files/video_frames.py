"""In the limited process: decode a piece of a video, and encode its frames as JPEGs."""

import math
from collections.abc import Iterator
from pathlib import Path

import av
import numpy as np
from av.container import InputContainer
from av.error import FFmpegError
from av.video.codeccontext import VideoCodecContext
from av.video.frame import VideoFrame
from av.video.stream import VideoStream

from devices.cameras.jpeg import JpegEncoder, fitted
from devices.files.refusal import FileRefusedError
from devices.files.video_file import MOST_FRAMES, MOST_RATE_HZ, MOST_SIDE, MOST_VIDEO_S, VideoPiece

# what phones, tablets and cameras write; other formats of FFmpeg open further files, or the network
OPENS = {"format_whitelist": "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm", "protocol_whitelist": "file"}
MOST_PIXELS = 8192 * 8192
MICROSECONDS = 1_000_000
ENDS_EARLY_S = 1.0  # a video that ends so much before its stated length is cut
# ISO/IEC 14496-12: an encrypted track and its protection; they are described at either end of a file
ENCRYPTED_MARKS = (b"encv", b"sinf")
DESCRIBED_BYTES = 4_000_000
EQUAL_S = 1e-6
QUARTER_TURN_DEG = 90


def read_piece(path: Path, where: str, from_s: float, most_frames: int) -> VideoPiece:
    """The frames at `from_s` and after it, at most `most_frames`; raises FileRefusedError."""
    if _is_encrypted(path):
        raise FileRefusedError(where, "this video is encrypted", "Choose a copy without copy protection")
    try:
        container = av.open(str(path), "r", options=OPENS)
    except (FFmpegError, ValueError) as problem:
        raise _no_video(where) from problem
    with container:
        stream = _stream_of(container, where)
        length_s = _length_s(container, stream)
        if length_s > MOST_VIDEO_S:
            raise _too_long(where)
        return _VideoReading(where, container, stream, length_s).piece(from_s, min(most_frames, MOST_FRAMES))


def _is_encrypted(path: Path) -> bool:
    with path.open("rb") as file:
        described = file.read(DESCRIBED_BYTES)
        file.seek(-min(DESCRIBED_BYTES, path.stat().st_size), 2)
        described += file.read(DESCRIBED_BYTES)
    return all(mark in described for mark in ENCRYPTED_MARKS)


def _no_video(where: str) -> FileRefusedError:
    return FileRefusedError(where, "this file cannot be read as a video", "Choose an MP4, MOV, MKV or WebM file")


def _too_long(where: str) -> FileRefusedError:
    return FileRefusedError(
        where,
        "this video is longer than {most} minutes",
        "Cut the part with the walk out of it and import that",
        most=round(MOST_VIDEO_S / 60.0),
    )


def _stream_of(container: InputContainer, where: str) -> VideoStream:
    if not container.streams.video:
        raise FileRefusedError(where, "this file has no pictures", "Choose a video")
    stream = container.streams.video[0]
    context: VideoCodecContext | None = stream.codec_context  # None: compressed in a way that is not known
    if context is None or context.width <= 0 or context.height <= 0 or context.width * context.height > MOST_PIXELS:
        raise _no_video(where)
    context.thread_count = 1
    context.options = {"max_pixels": str(MOST_PIXELS)}
    return stream


def _length_s(container: InputContainer, stream: VideoStream) -> float:
    if stream.duration is not None and stream.time_base is not None:
        stated = float(stream.duration * stream.time_base)
    else:
        stated = math.nan if container.duration is None else container.duration / MICROSECONDS
    return stated if stated > 0.0 else math.nan


class _VideoReading:
    """One video, from its beginning or from a key frame."""

    def __init__(self, where: str, container: InputContainer, stream: VideoStream, length_s: float) -> None:
        self._where, self._container, self._stream, self._length_s = where, container, stream, length_s
        rate = stream.average_rate or stream.guessed_rate
        rate_hz = float(rate) if rate else math.nan
        self._rate_hz = rate_hz if 0.0 < rate_hz <= MOST_RATE_HZ else math.nan
        begins = stream.start_time
        self._begins_s = 0.0 if begins is None or stream.time_base is None else float(begins * stream.time_base)
        self._is_damaged = False
        self._states_length = stream.duration is not None  # of its pictures; else the longest track's is known alone
        self._encoder: JpegEncoder | None = None

    def piece(self, from_s: float, most_frames: int) -> VideoPiece:
        times: list[float] = []
        jpegs: list[bytes] = []
        is_end = True
        for time_s, frame in self._frames(from_s):
            if len(times) == most_frames:
                is_end = False
                break
            if times and time_s <= times[-1]:
                continue  # two pictures at one time: the first is shown
            if time_s > MOST_VIDEO_S:
                raise _too_long(self._where)
            times.append(time_s)
            jpegs.append(self._encoded(frame))
        last_s = times[-1] if times else from_s
        is_cut = is_end and self._states_length and last_s < self._length_s - ENDS_EARLY_S
        if not times and from_s <= 0.0:
            raise _no_video(self._where)
        size = (self._encoder.width, self._encoder.height) if self._encoder is not None else (2, 2)
        is_damaged = is_end and (self._is_damaged or is_cut)
        return VideoPiece(np.array(times), tuple(jpegs), is_end, is_damaged, *size, self._rate_hz, self._length_s)

    def _frames(self, from_s: float) -> Iterator[tuple[float, VideoFrame]]:
        """Frames and their times, until the first that is damaged."""
        try:
            if from_s > 0.0:
                self._container.seek(int((from_s + self._begins_s) * MICROSECONDS), backward=True)
            for frame in self._container.decode(self._stream):
                if frame.is_corrupt or frame.time is None:
                    self._is_damaged = True
                    return
                if (time_s := frame.time - self._begins_s) >= from_s - EQUAL_S:
                    yield time_s, frame
        except (FFmpegError, ValueError, OverflowError):
            self._is_damaged = True

    def _encoded(self, frame: VideoFrame) -> bytes:
        """The frame upright, with square pixels, of the size of the first."""
        turns = round(frame.rotation / QUARTER_TURN_DEG) % 4
        shape = self._stream.sample_aspect_ratio
        wide = frame.width * (float(shape) if shape else 1.0)
        if self._encoder is None:
            upright = (wide, frame.height) if turns % 2 == 0 else (frame.height, wide)
            size = fitted(max(2, round(upright[0])), max(2, round(upright[1])), MOST_SIDE, MOST_SIDE)
            self._encoder = JpegEncoder(*size)
        if turns:
            width, height = self._encoder.width, self._encoder.height
            lying = (width, height) if turns % 2 == 0 else (height, width)
            pixels = frame.reformat(width=lying[0], height=lying[1], format="rgb24").to_ndarray()
            upright_pixels = np.ascontiguousarray(np.rot90(pixels, turns)).astype(np.uint8, copy=False)
            frame = VideoFrame.from_ndarray(upright_pixels, format="rgb24")
        return self._encoder.encode(frame)
