"""In the process of a camera: open it, take its frames, encode them and send them.

One thread takes each frame as it comes and notes its arrival; another encodes and sends. What the second cannot take in
time is left out and counted, so that nothing grows however long nobody reads. Where encoding takes too long, half of
the frames are left out, then the pictures are made half as large.
"""

import errno
import queue
import threading
from collections.abc import Callable, Iterator
from dataclasses import asdict, replace
from time import monotonic
from typing import IO

import av
from av.container import InputContainer
from av.device import enumerate_input_devices
from av.error import FFmpegError, InvalidDataError
from av.video.frame import VideoFrame
from av.video.stream import VideoStream

from devices.cameras.camera import (
    AVFOUNDATION,
    DSHOW,
    FILE,
    STAND_INS,
    V4L2,
    CameraInfo,
    CameraMode,
    CapturedFrame,
)
from devices.cameras.causes import ABSENT, BUSY, DENIED, GONE, UNUSABLE
from devices.cameras.jpeg import JpegEncoder, fitted
from devices.cameras.messages import ENDED, MODE, send_details, send_frame
from devices.clocks.host_clock import host_time_ns

MOST_WAITING = 8  # frames: a quarter of a second in which encoding may stand still
WINDOW_S = 2.0  # over which it is looked at whether encoding keeps up
MOST_BUSY = 0.8  # of that time; what is left out with less is left out by who does not read
ENDS_S = 0.4
NANOSECONDS = 1_000_000_000
BUFFER_BYTES = "67108864"  # DirectShow's own: its default holds one frame of a large camera

Encode = Callable[[VideoFrame], bytes]


class CannotOpenError(Exception):
    """A camera that does not open; `cause` is of `causes`."""

    def __init__(self, cause: str, detail: str) -> None:
        super().__init__(detail)
        self.cause = cause


class FrameTaking:
    """Sends the frames of one camera until it ends or `stopping` is set."""

    def __init__(
        self,
        info: CameraInfo,
        mode: CameraMode,
        stream: IO[bytes],
        encoder: Callable[[int, int], Encode] = lambda width, height: JpegEncoder(width, height).encode,
    ) -> None:
        self._info, self._asked, self._stream, self._encoder = info, mode, stream, encoder
        self.stopping = threading.Event()
        self._waiting: queue.Queue[tuple[int, int, int | None, VideoFrame] | None] = queue.Queue(MOST_WAITING)
        self._rate_hz, self._every = mode.rate_hz, 1  # of the camera, and which of its frames are sent
        self._left_out = 0
        self._ended = (GONE, "")
        self._reader = threading.Thread(target=self._take, name="camera", daemon=True)

    def run(self) -> None:
        """Send until the end."""
        self._reader.start()
        mode: CameraMode | None = None
        encode: Encode | None = None
        begun_s, busy_s = monotonic(), 0.0
        while (taken := self._waiting.get()) is not None and not self.stopping.is_set():
            number, arrival_ns, pts_ns, frame = taken
            if mode is None or encode is None:
                mode = self._first_mode(frame)
                encode = self._begin(mode)
                begun_s = monotonic()
            since_s = monotonic()
            jpeg = encode(frame)
            busy_s += monotonic() - since_s
            send_frame(self._stream, CapturedFrame(number, arrival_ns, pts_ns, jpeg))
            if (over_s := monotonic() - begun_s) >= WINDOW_S:
                slower = slower_mode(mode, self._asked, busy_s / over_s, self._left_out)
                if slower != mode:
                    self._every *= 2 if slower.rate_hz < mode.rate_hz else 1
                    mode, encode = slower, self._begin(slower)
                begun_s, busy_s, self._left_out = monotonic(), 0.0, 0
        if not self.stopping.is_set():
            cause, detail = self._ended
            send_details(self._stream, ENDED, {"cause": cause, "detail": detail})

    def stop(self) -> None:
        """Let the camera go, if it answers within a short while."""
        self.stopping.set()
        self._reader.join(ENDS_S)

    def _begin(self, mode: CameraMode) -> Encode:
        send_details(self._stream, MODE, asdict(mode))
        return self._encoder(mode.width, mode.height)

    def _first_mode(self, frame: VideoFrame) -> CameraMode:
        width, height = fitted(frame.width, frame.height, self._asked.width, self._asked.height)
        return CameraMode(width, height, self._rate_hz / self._every)

    def _take(self) -> None:
        """Take frames until there are no more: the thread of the camera."""
        try:
            container, stream = open_camera(self._info, self._asked)
            with container:
                # a camera that knows fewer rates than was asked for gives its own
                rate = stream.average_rate or stream.guessed_rate
                self._rate_hz = float(rate) if rate else self._asked.rate_hz
                self._every = max(1, round(self._rate_hz / self._asked.rate_hz))
                self._take_all(container, stream)
        except CannotOpenError as problem:
            self._ended = problem.cause, str(problem)
        except (FFmpegError, OSError, ValueError) as problem:
            self._ended = GONE, f"{type(problem).__name__}: {problem}"
        self._waiting.put(None)

    def _take_all(self, container: InputContainer, stream: VideoStream) -> None:
        pace = _Pace() if self._info.format in STAND_INS else None
        number = 0
        for arrival_ns, frame in _frames(container, stream):
            if self.stopping.is_set():
                return
            if frame is None:  # damaged on its way: it counts
                number += 1
                continue
            pts_ns = _pts_ns(frame)
            if pace is not None:
                pace.wait(pts_ns, self.stopping)
                arrival_ns = host_time_ns()
            if number % self._every == 0:
                try:
                    self._waiting.put_nowait((number, arrival_ns, pts_ns, frame))
                except queue.Full:
                    self._left_out += 1
            number += 1


class _Pace:
    """Lets a test picture or a video give its frames when they are due."""

    def __init__(self) -> None:
        self._begun: tuple[int, int] | None = None

    def wait(self, pts_ns: int | None, stopping: threading.Event) -> None:
        if pts_ns is None:
            return
        if self._begun is None:
            self._begun = pts_ns, host_time_ns()
        due_ns = self._begun[1] + pts_ns - self._begun[0]
        stopping.wait(max(0, due_ns - host_time_ns()) / NANOSECONDS)


def slower_mode(mode: CameraMode, asked: CameraMode, busy: float, left_out: int) -> CameraMode:
    """The mode in which encoding keeps up: half the rate, then half the size.

    `busy` is the share of the time that went into encoding, `left_out` how many frames came meanwhile and found no
    place. Both are needed: frames are left out, too, where nobody reads them.
    """
    if busy < MOST_BUSY or left_out == 0:
        return mode
    if mode.rate_hz > 0.75 * asked.rate_hz:
        return replace(mode, rate_hz=mode.rate_hz / 2)
    if mode.width > 0.75 * asked.width or mode.height > 0.75 * asked.height:
        width, height = fitted(mode.width, mode.height, mode.width // 2, mode.height // 2)
        return replace(mode, width=width, height=height)
    return mode


def open_camera(info: CameraInfo, mode: CameraMode) -> tuple[InputContainer, VideoStream]:
    """Open a camera in the mode, or in one of its own where it does not know that; raises CannotOpenError."""
    first: FFmpegError | OSError | ValueError | None = None
    for options in _ways(info.format, mode):
        try:
            container = av.open(info.place, format=None if info.format == FILE else info.format, options=options)
        except (FFmpegError, OSError, ValueError) as problem:
            first = first or problem
            continue
        if not container.streams.video:
            container.close()
            raise CannotOpenError(UNUSABLE, "it has no pictures")
        stream = container.streams.video[0]
        stream.codec_context.thread_count = 1  # threads would hold frames back
        return container, stream
    assert first is not None  # there is always a way
    raise CannotOpenError(_cause(first), f"{type(first).__name__}: {first}") from first


def _ways(format_name: str, mode: CameraMode) -> list[dict[str, str]]:
    """Options to try in turn. Pictures that the camera compresses come first: others are too many for its cable."""
    size = {"video_size": f"{mode.width}x{mode.height}", "framerate": f"{mode.rate_hz:g}"}
    if format_name == V4L2:
        return [{**size, "input_format": "mjpeg"}, size, {}]
    if format_name == DSHOW:
        buffer = {"rtbufsize": BUFFER_BYTES}
        return [{**size, **buffer, "vcodec": "mjpeg"}, {**size, **buffer}, buffer]
    if format_name == AVFOUNDATION:
        return [size, {"framerate": f"{mode.rate_hz:g}"}, {}]
    return [{}]


def _cause(problem: Exception) -> str:
    match problem:
        case FileNotFoundError():
            return ABSENT
        case PermissionError():
            return DENIED
        case OSError(errno=errno.ENODEV | errno.ENXIO):
            return ABSENT
        case OSError(errno=errno.EBUSY | errno.EIO):  # DirectShow answers EIO where another program has the camera
            return BUSY
    return UNUSABLE


def _frames(container: InputContainer, stream: VideoStream) -> Iterator[tuple[int, VideoFrame | None]]:
    """When each frame came, and it; None in the place of one that was damaged."""
    for packet in container.demux(stream):
        arrival_ns = host_time_ns()
        try:
            frames = packet.decode()
        except InvalidDataError:
            yield arrival_ns, None
            continue
        for frame in frames:
            yield arrival_ns, frame


def _pts_ns(frame: VideoFrame) -> int | None:
    if frame.pts is None or frame.time_base is None:
        return None
    return int(frame.pts * frame.time_base * NANOSECONDS)


def listed_cameras(format_name: str) -> list[CameraInfo]:
    """The cameras that the system's own list has, on Windows and macOS."""
    found = []
    for one in enumerate_input_devices(format_name):
        name = one.description or one.name
        if "video" not in one.media_types or (format_name == AVFOUNDATION and name.startswith("Capture screen")):
            continue
        place = f"video={one.name}" if format_name == DSHOW else one.name
        found.append(CameraInfo(name, place, format_name))
    return found
