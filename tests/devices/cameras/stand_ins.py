"""Cameras for tests: FFmpeg's test pictures, and short videos that flash at known frames."""

from collections.abc import Collection
from pathlib import Path

import av
import numpy as np
from av.codec.context import CodecContext
from av.video.codeccontext import VideoCodecContext
from av.video.stream import VideoStream

from devices.cameras.camera import FILE, TEST_PICTURE, CameraInfo, CameraLostError, CameraMode, CapturedFrame

DARK, BRIGHT = 20, 230


def pictures(size: str = "320x240", rate: int = 30, rest: str = "") -> CameraInfo:
    return CameraInfo("Test camera", f"testsrc2=size={size}:rate={rate}{rest}", TEST_PICTURE)


def flashing_video(
    path: Path, frames: int, flashes: Collection[int], codec: str = "mjpeg", rate: int = 30
) -> CameraInfo:
    """Write a dark video that is bright at these frames, as a camera."""
    with av.open(path, "w") as container:
        stream = container.add_stream(codec, rate=rate)
        assert isinstance(stream, VideoStream)
        stream.width, stream.height = 320, 240
        stream.pix_fmt = "yuvj420p" if codec == "mjpeg" else "yuv420p"
        for number in range(frames):
            grey = np.full((240, 320, 3), BRIGHT if number in flashes else DARK, np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(grey, format="rgb24")))
        container.mux(stream.encode(None))
    return CameraInfo("Video", str(path), FILE)


def brightness(jpeg: bytes) -> float:
    decoder = CodecContext.create("mjpeg", "r")
    assert isinstance(decoder, VideoCodecContext)
    (frame,) = [*decoder.decode(av.Packet(jpeg)), *decoder.decode(None)]
    return float(frame.to_ndarray(format="gray").mean())


class Taken:
    """What a capture called."""

    def __init__(self) -> None:
        self.frames: list[CapturedFrame] = []
        self.modes: list[CameraMode] = []
        self.ends: list[CameraLostError] = []

    @property
    def numbers(self) -> list[int]:
        return [frame.number for frame in self.frames]
