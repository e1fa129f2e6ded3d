"""Tests that a camera's frames come as they were taken, none invented, and that whatever ends it is reported."""

import io
import os
import signal
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from av.video.frame import VideoFrame

from devices.cameras.camera import V4L2, CameraInfo, CameraMode, CapturedFrame
from devices.cameras.capture import SILENT_S, Capture
from devices.cameras.causes import ABSENT, BUSY, CRASHED, DENIED, GONE, MISSING, SILENT, UNUSABLE, lost
from devices.cameras.messages import (
    FRAME,
    FRAME_HEAD,
    HEAD,
    MODE,
    BrokenMessageError,
    cause_of,
    frame_of,
    mode_of,
    receive,
    send_frame,
)
from devices.cameras.taking import CannotOpenError, FrameTaking, open_camera, slower_mode
from devices.clocks.host_clock import host_time_ns
from devices.own_process import Process
from tests.devices.cameras.stand_ins import BRIGHT, DARK, Taken, brightness, flashing_video, pictures
from tests.waiting import wait_for

Begin = Callable[..., tuple[Capture, Taken]]
SMALL = CameraMode(320, 240, 30.0)
HALF = 0.5 * (DARK + BRIGHT)
needs_signals = pytest.mark.skipif(os.name == "nt", reason="signals")


def state(taken: Taken) -> str:
    (end,) = taken.ends
    return str(end)


@pytest.mark.parametrize(("codec", "name"), [("mjpeg", "a.mkv"), ("libvpx-vp9", "b.mkv"), ("libx264", "c.mp4")])
def test_flashes_come_out_at_their_frames_and_no_frame_is_invented(
    begin: Begin, tmp_path: Path, codec: str, name: str
) -> None:
    flashes = {3, 4, 17, 29}
    before_ns = host_time_ns()
    _, taken = begin(flashing_video(tmp_path / name, 30, flashes, codec), SMALL)
    wait_for(lambda: bool(taken.ends))
    numbers = taken.numbers
    assert numbers  # a busy machine leaves some out
    assert numbers == sorted(set(numbers))
    assert numbers[-1] <= 29
    bright = {frame.number for frame in taken.frames if brightness(frame.jpeg) > HALF}
    assert bright == flashes & set(numbers)
    arrivals_ns = [frame.arrival_ns for frame in taken.frames]
    assert arrivals_ns == sorted(arrivals_ns)
    assert before_ns < arrivals_ns[0]
    assert arrivals_ns[-1] < host_time_ns()
    stamps_ns = {frame.number: frame.pts_ns for frame in taken.frames}
    assert all(pts_ns == pytest.approx(number / 30 * 1e9, abs=1e6) for number, pts_ns in stamps_ns.items())
    # it is played at its own pace: no frame before its time
    late_ns = [frame.arrival_ns - (frame.pts_ns or 0) for frame in taken.frames]
    assert min(late_ns) > late_ns[0] - 1e6
    assert taken.modes[0] == SMALL
    assert "Video was disconnected" in state(taken)


def test_the_mode_is_what_the_camera_gives_within_what_was_asked(begin: Begin) -> None:
    one, taken = begin(pictures("1280x720", rate=60), CameraMode(640, 640, 30.0))
    wait_for(lambda: len(taken.frames) > 3)
    assert taken.modes[0] == CameraMode(640, 360, 30.0)
    assert one.mode == taken.modes[-1]
    assert {number % 2 for number in taken.numbers} == {0}  # 60 frames a second were asked to be 30


def test_a_stopped_capture_leaves_no_process_and_reports_no_end(begin: Begin) -> None:
    one, taken = begin(pictures())
    wait_for(lambda: len(taken.frames) > 2)
    one.stop()
    assert one.process.returncode == 0  # it let its camera go
    count = len(taken.frames)
    one.stop()
    assert (taken.ends, len(taken.frames)) == ([], count)


def test_a_capture_may_be_stopped_before_its_camera_is_open(begin: Begin) -> None:
    one, taken = begin(pictures())
    one.stop()
    assert one.process.poll() is not None
    assert taken.ends == []


def test_a_capture_may_be_stopped_by_who_takes_its_frames() -> None:
    begun: list[Capture] = []
    stopped = threading.Event()

    def stop(_: CapturedFrame) -> None:
        wait_for(lambda: bool(begun))
        begun[0].stop()
        stopped.set()

    ends: list[object] = []
    begun.append(Capture(pictures(), SMALL, stop, ends.append))
    assert stopped.wait(60.0)
    wait_for(lambda: begun[0].process.poll() is not None)
    assert ends == []


@needs_signals
def test_a_killed_process_is_reported(begin: Begin) -> None:
    one, taken = begin(pictures())
    wait_for(lambda: len(taken.frames) > 2)
    os.kill(one.process.pid, signal.SIGKILL)
    wait_for(lambda: bool(taken.ends))
    assert state(taken) == str(lost(CRASHED, one.info))


@needs_signals
def test_a_camera_that_falls_silent_is_reported_and_its_process_ended(
    begin: Begin, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("devices.cameras.capture.LEAVES_S", 0.1)  # it is stopped, and cannot
    one, taken = begin(pictures(), silent_s=SILENT_S)
    wait_for(lambda: len(taken.frames) > 2)
    os.kill(one.process.pid, signal.SIGSTOP)
    wait_for(lambda: bool(taken.ends))
    assert state(taken) == str(lost(SILENT, one.info))
    assert one.process.poll() is not None


@needs_signals
def test_a_camera_that_never_answers_is_reported(begin: Begin, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "camera")  # nobody writes to it: opening waits for ever
    one, taken = begin(CameraInfo("Camera", str(tmp_path / "camera"), "file"), SMALL, opens_s=0.5)
    wait_for(lambda: bool(taken.ends))
    assert state(taken) == str(lost(SILENT, one.info))
    one.stop()


def test_a_camera_that_is_unplugged_is_reported(begin: Begin) -> None:
    _, taken = begin(pictures(rest=":duration=0.3"))
    wait_for(lambda: bool(taken.ends))
    assert len(taken.frames) > 2
    assert state(taken) == "Test camera was disconnected. Check its cable, then start the camera again."


@pytest.mark.skipif(sys.platform != "linux", reason="cameras of Linux")
def test_a_camera_that_is_not_there_is_reported(begin: Begin) -> None:
    one, taken = begin(CameraInfo("Webcam", "/dev/video99", V4L2))
    wait_for(lambda: bool(taken.ends))
    assert state(taken) == str(lost(ABSENT, one.info))


@pytest.mark.parametrize(
    ("problem", "cause"),
    [
        (OSError(16, "Device or resource busy"), BUSY),
        (OSError(5, "Input/output error"), BUSY),
        (PermissionError(13, "Permission denied"), DENIED),
        (OSError(19, "No such device"), ABSENT),
        (ValueError("no such input format"), UNUSABLE),
    ],
)
def test_why_a_camera_does_not_open_is_named(problem: Exception, cause: str, monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[dict[str, str]] = []

    def refuse(_place: str, format: str, options: dict[str, str]) -> None:
        tried.append(options)
        raise problem

    monkeypatch.setattr("av.open", refuse)
    with pytest.raises(CannotOpenError) as refused:
        open_camera(CameraInfo("Webcam", "/dev/video0", V4L2), CameraMode())
    assert refused.value.cause == cause
    assert tried[0]["input_format"] == "mjpeg"
    assert tried[-1] == {}


def test_garbage_in_the_place_of_a_video_is_reported(begin: Begin, tmp_path: Path) -> None:
    (tmp_path / "a.mkv").write_bytes(np.random.default_rng(1).bytes(20_000))
    one, taken = begin(CameraInfo("Camera", str(tmp_path / "a.mkv"), "file"))
    wait_for(lambda: bool(taken.ends))
    assert state(taken) == str(lost(UNUSABLE, one.info))
    assert taken.frames == []


@pytest.mark.parametrize(
    "sent",
    [
        HEAD.pack(FRAME, 4) + b"1234",
        HEAD.pack(FRAME, FRAME_HEAD.size + 4) + FRAME_HEAD.pack(0, 1, 2) + b"GIF8",
        HEAD.pack(b"?", 0),
        HEAD.pack(MODE, 2) + b"{}",
        HEAD.pack(MODE, 2) + b"}{",
        HEAD.pack(FRAME, 4_000_000_000),
        b"Traceback (most recent call last):",
    ],
)
def test_a_process_that_sends_garbage_is_ended(sent: bytes, monkeypatch: pytest.MonkeyPatch, begin: Begin) -> None:
    def start(*_: str) -> Process:
        program = f"import sys; sys.stdout.buffer.write({sent!r}); sys.stdout.flush(); sys.stdin.read()"
        if sent.startswith(b"Trace"):  # or it waits for the rest of a message
            program = program.replace("; sys.stdin.read()", "")
        return Process([sys.executable, "-c", program], stdin=-1, stdout=-1)

    monkeypatch.setattr("devices.cameras.capture.start_process", start)
    one, taken = begin(pictures())
    wait_for(lambda: bool(taken.ends))
    assert state(taken) == str(lost(CRASHED, one.info))
    assert taken.frames == []
    assert one.process.poll() is not None


def test_frames_that_nobody_reads_are_left_out_and_counted() -> None:
    may_go_on, blocked = threading.Event(), threading.Event()
    frames: list[CapturedFrame] = []
    ends: list[object] = []

    def take(frame: CapturedFrame) -> None:
        frames.append(frame)
        if len(frames) == 3:
            blocked.set()
            assert may_go_on.wait(60.0)

    one = Capture(pictures(rate=100), CameraMode(320, 240, 100.0), take, ends.append)
    try:
        assert blocked.wait(60.0)
        begun_ns = host_time_ns()
        # the pipe holds some frames and the process a few; three seconds of frames find no place in them
        wait_for(lambda: host_time_ns() - begun_ns > 3_000_000_000)
        assert one.process.poll() is None
        may_go_on.set()
        wait_for(lambda: bool(frames) and frames[-1].arrival_ns > begun_ns + 3_000_000_000)
        gaps = np.diff([frame.number for frame in frames])
        assert gaps.min() == 1
        assert gaps.max() > 100
        # what is in between was taken as it came, and not made late
        times_s = np.array([frame.arrival_ns for frame in frames]) * 1e-9
        widest = int(np.argmax(gaps))
        assert times_s[widest + 1] - times_s[widest] == pytest.approx(gaps[widest] / 100.0, rel=0.2)
        assert ends == []
    finally:
        may_go_on.set()
        one.stop()


def test_a_computer_that_is_too_slow_halves_the_rate_then_the_size() -> None:
    asked = CameraMode(1280, 720, 30.0)
    half = slower_mode(asked, asked, busy=0.95, left_out=10)
    assert half == CameraMode(1280, 720, 15.0)
    quarter = slower_mode(half, asked, busy=0.95, left_out=10)
    assert quarter == CameraMode(640, 360, 15.0)
    assert slower_mode(quarter, asked, busy=0.95, left_out=10) == quarter
    assert slower_mode(asked, asked, busy=0.3, left_out=10) == asked  # nobody reads
    assert slower_mode(asked, asked, busy=0.95, left_out=0) == asked


def test_the_mode_in_force_is_sent_where_encoding_is_slow(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("devices.cameras.taking.WINDOW_S", 0.3)
    stream = io.BytesIO()
    begun: list[tuple[int, int]] = []
    taking: list[FrameTaking] = []

    def slow_encoder(width: int, height: int) -> Callable[[VideoFrame], bytes]:
        begun.append((width, height))
        if len(begun) == 3:
            taking[0].stopping.set()

        def encode(_: VideoFrame) -> bytes:
            threading.Event().wait(0.1)  # slower than even half the rate
            return b"\xff\xd8\xff\xd9"

        return encode

    taking.append(FrameTaking(pictures(), SMALL, stream, slow_encoder))
    taking[0].run()
    taking[0].stop()
    stream.seek(0)
    messages = []
    while True:
        try:
            messages.append(receive(stream))
        except EOFError:
            break
    modes = [mode_of(content) for kind, content in messages if kind == MODE]
    assert modes == [SMALL, CameraMode(320, 240, 15.0), CameraMode(160, 120, 15.0)]
    second = [kind for kind, _ in messages].index(MODE, 1)
    numbers = [frame_of(content, -1).number for kind, content in messages[second:] if kind == FRAME]
    later = [number for number in numbers if number > numbers[0] + 16]  # what waited was taken at the full rate
    assert {number % 2 for number in later} <= {0}


def test_a_frame_comes_back_as_it_was_sent_and_half_of_one_does_not() -> None:
    frame = CapturedFrame(7, 123, None, b"\xff\xd8 \xff\xd9")
    stream = io.BytesIO()
    send_frame(stream, frame)
    whole = stream.getvalue()
    kind, content = receive(io.BytesIO(whole))
    assert (kind, frame_of(content, 6)) == (FRAME, frame)
    with pytest.raises(BrokenMessageError):
        frame_of(content, 7)  # a frame that came already
    with pytest.raises(EOFError):
        receive(io.BytesIO(whole[:-1]))
    with pytest.raises(BrokenMessageError):
        cause_of(b"[]")


def test_a_missing_library_is_named_by_the_process(
    monkeypatch: pytest.MonkeyPatch, begin: Begin, tmp_path: Path
) -> None:
    (tmp_path / "av.py").write_text("raise ImportError('no such library')")
    monkeypatch.syspath_prepend(str(tmp_path))
    _, taken = begin(pictures())
    wait_for(lambda: bool(taken.ends))
    assert state(taken) == "Cameras cannot be used: a software library is missing. Install gaitwright[video]."


def test_each_end_names_the_camera_and_what_to_do() -> None:
    camera = CameraInfo("Webcam {0}", "", V4L2)
    stated = [str(lost(cause, camera)) for cause in (ABSENT, BUSY, CRASHED, DENIED, GONE, SILENT, UNUSABLE)]
    assert len(set(stated)) == len(stated)
    assert all("Webcam {0}" in one for one in stated)
    assert "library" in str(lost(MISSING, camera))
    assert str(lost("unheard of", camera)) == str(lost(CRASHED, camera))
