"""Videos as phones and cameras write them, made by FFmpeg: each frame's brightness states its number."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from av.audio.stream import AudioStream
from av.codec.context import CodecContext
from av.container import OutputContainer
from av.video.codeccontext import VideoCodecContext
from av.video.stream import VideoStream
from numpy.typing import NDArray

MILLISECOND = Fraction(1, 1000)
SOUND_HZ = 48_000
FASTSTART = {"movflags": "faststart"}  # the description comes before the pictures


def level(number: int) -> int:
    return 20 + 4 * (number % 55)


def write_video(
    path: Path,
    frames: int = 45,
    codec: str = "libx264",
    size: tuple[int, int] = (320, 180),
    options: dict[str, str] | None = None,
    rate: Fraction | int = 30,
    times_ms: Sequence[int] | None = None,
    sound_s: float = 0.0,
) -> Path:
    """A video with a white corner at the top left; at its rate, unless `times_ms` states when each frame was taken."""
    width, height = size
    with av.open(str(path), "w", options=options or {}) as container:
        stream = container.add_stream(codec, rate=rate)
        assert isinstance(stream, VideoStream)
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        stream.codec_context.gop_size = 15
        stream.codec_context.bit_rate = 4_000_000
        if times_ms is not None:
            stream.codec_context.time_base = MILLISECOND
        if sound_s:
            _write_silence(container, sound_s)
        for number in range(frames):
            picture = np.full((height, width, 3), level(number), np.uint8)
            picture[: height // 4, : width // 4] = 255
            frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
            if times_ms is not None:
                frame.pts, frame.time_base = times_ms[number], MILLISECOND
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    return path


def _write_silence(container: OutputContainer, seconds: float) -> None:
    stream = container.add_stream("aac", rate=SOUND_HZ)
    assert isinstance(stream, AudioStream)
    for begin in range(0, round(seconds * SOUND_HZ), 1024):
        frame = av.AudioFrame.from_ndarray(np.zeros((1, 1024), np.float32), format="fltp", layout="mono")
        frame.sample_rate, frame.pts, frame.time_base = SOUND_HZ, begin, Fraction(1, SOUND_HZ)
        container.mux(stream.encode(frame))
    container.mux(stream.encode(None))


def rotated(content: bytes, quarter_turns: int) -> bytes:
    """The MP4 with another matrix in its track's header, as a phone writes that was held upright."""
    identity = b"".join(number.to_bytes(4, "big", signed=True) for number in _matrix(0))
    assert content.count(identity) == 2  # of the movie and of the track
    place = content.rindex(identity)
    turned = b"".join(number.to_bytes(4, "big", signed=True) for number in _matrix(quarter_turns))
    return content[:place] + turned + content[place + len(turned) :]


def _matrix(quarter_turns: int) -> tuple[int, ...]:
    one = 1 << 16
    cos, sin = ((one, 0), (0, one), (-one, 0), (0, -one))[quarter_turns % 4]
    return (cos, sin, 0, -sin, cos, 0, 0, 0, 1 << 30)


def grey_of(jpeg: bytes) -> NDArray[np.uint8]:
    decoder = CodecContext.create("mjpeg", "r")
    assert isinstance(decoder, VideoCodecContext)
    (frame,) = [*decoder.decode(av.Packet(jpeg)), *decoder.decode(None)]
    return np.asarray(frame.to_ndarray(format="gray"), np.uint8)


def middle_of(jpeg: bytes) -> float:
    grey = grey_of(jpeg)
    return float(grey[grey.shape[0] // 2, grey.shape[1] // 2])
