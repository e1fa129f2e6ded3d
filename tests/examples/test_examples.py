"""Every example runs as its page states, prints what is true of a simulated patient, and uses public names alone."""

import array
import ast
import os
import re
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from core.body import Joint, Side, Site
from devices.clocks.host_clock import host_time_ns
from devices.simulation.walker import SimulatedSession
from tests.example_sessions import frames_of_new_sensor, last_block, write_counted_lines
from tests.examples import (
    analyse_a_folder,
    events_of_one_foot,
    live_from_a_port,
    new_file_format,
    new_sensor,
    published_method,
)

HERE = Path(__file__).parent
SCRIPTS = sorted(set(HERE.glob("*.py")) - set(HERE.glob("test_*.py")) - {HERE / "conftest.py"})
WALK, STRIDES = "walk 1", 6
SPEED = 10  # seconds of the emulated sensor per second of the test
FOR_EVER_S = 1e6
G_M_S2 = 9.80665


class FastClock:
    """The host's clock, SPEED times as fast, until somebody ends the time."""

    def __init__(self) -> None:
        self._begin_ns = host_time_ns()
        self._ended_ns = 0

    def __call__(self) -> int:
        return self._begin_ns + SPEED * (host_time_ns() - self._begin_ns) + self._ended_ns

    def end(self) -> None:
        self._ended_ns = round(1e9 * FOR_EVER_S)


def numbers(printed: str, pattern: str) -> list[float]:
    return [float(found) for found in re.findall(pattern, printed)]


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_an_example_is_a_page_and_imports_public_names_alone(script: Path) -> None:
    source = script.read_text(encoding="utf-8")
    assert source.count("\n") <= 72
    assert f"python -m tests.examples.{script.stem} " in source
    ours = [node.module for node in ast.walk(ast.parse(source)) if isinstance(node, ast.ImportFrom) and node.module]
    assert {module for module in ours if module.split(".")[0] in {"app", "core", "devices"}} <= {"core", "devices"}


def test_there_are_seventeen_examples() -> None:
    assert len(SCRIPTS) == 17


def test_a_folder_is_analysed(simulated: SimulatedSession, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    analyse_a_folder.main(folder)
    printed = capsys.readouterr().out
    truth = simulated.truth.recordings[WALK].joints
    for joint in (Joint.LEFT_KNEE, Joint.LEFT_ANKLE):
        (range_deg,) = numbers(printed, rf"{WALK}, {joint}: range ([\d.]+) deg, sd [\d.]+ deg")
        low, high = np.rad2deg(np.percentile(truth[joint].angle_rad, [2, 98]))
        assert range_deg == pytest.approx(high - low, abs=1.0)


def test_the_published_method_finds_the_range_of_a_knee(
    simulated: SimulatedSession, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    published_method.main(folder)
    (range_deg,) = numbers(capsys.readouterr().out, r"range ([\d.]+) deg")
    true_rad = simulated.truth.recordings[WALK].joints[Joint.LEFT_KNEE].angle_rad
    assert range_deg == pytest.approx(np.rad2deg(np.ptp(true_rad)), abs=3.0)


def test_files_of_a_new_format_become_a_session(
    simulated: SimulatedSession, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, site in {"thigh": Site.LEFT_THIGH, "shank": Site.LEFT_SHANK}.items():
        write_counted_lines(last_block(simulated, site), tmp_path / f"{name}.csv")
    session = tmp_path / "session"
    new_file_format.main(tmp_path / "thigh.csv", tmp_path / "shank.csv", session)
    count = len(last_block(simulated, Site.LEFT_THIGH)) - 3
    assert capsys.readouterr().out.splitlines() == [
        f"left_thigh: {count} samples, 3 missing",
        f"left_shank: {count} samples, 3 missing",
        f"written to {session}",
    ]


def test_a_new_sensor_is_understood_and_its_losses_are_counted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "bytes"
    file.write_bytes(frames_of_new_sensor())  # what is damaged is lost as well
    new_sensor.main(file)
    counts, last = capsys.readouterr().out.splitlines()
    assert counts == "297 received, 3 lost, 1 damaged"
    assert numbers(last, r"-?\d+\.\d*") == pytest.approx([2.99, -0.05, 0.0, 0.0, 0.0, 9.81])


def test_every_stride_of_one_foot_is_found(
    simulated: SimulatedSession, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    events_of_one_foot.main(folder)
    *strides, swings = capsys.readouterr().out.splitlines()
    truth = simulated.truth.recordings[WALK].feet[Side.LEFT]
    contacts_s = truth.events.initial_contact_s
    assert swings.startswith(f"{len(contacts_s)} swings")
    np.testing.assert_allclose([float(line.split()[0]) for line in strides], np.diff(contacts_s), atol=0.05)
    lengths_m = numbers("\n".join(strides), r"([\d.]+) m\b")
    assert np.mean(lengths_m[1:-1]) == pytest.approx(1.28, abs=0.1)


@pytest.fixture
def port(simulated: SimulatedSession) -> Iterator[tuple[str, FastClock]]:
    """A pseudo-terminal that sends the foot's samples as they come due. None is lost; time ends when all are read."""
    if sys.platform == "win32":
        pytest.skip("there are no pseudo-terminals")
    import fcntl
    import termios
    import tty

    block, clock = last_block(simulated, Site.LEFT_FOOT), FastClock()
    rows = np.column_stack([1000 * block.time_s, np.rad2deg(block.gyr_rad_s), block.acc_m_s2 / G_M_S2])
    own, theirs = os.openpty()
    tty.setraw(theirs)
    is_over = threading.Event()

    def send() -> None:
        begin_ns = clock()
        for time_ms, *values in rows.tolist():
            while clock() < begin_ns + 1e6 * time_ms and not is_over.wait(0.002):
                pass
            if is_over.is_set():
                return
            os.write(own, f"{time_ms:.0f},{','.join(f'{value:.4f}' for value in values)}\r\n".encode())

        unread = array.array("i", [1])
        while unread[0] and not is_over.wait(0.05):
            fcntl.ioctl(theirs, termios.FIONREAD, unread)
        is_over.wait(0.1)  # what was read last is decoded
        clock.end()

    sending = threading.Thread(target=send)
    sending.start()
    yield os.ttyname(theirs), clock
    is_over.set()
    termios.tcflush(theirs, termios.TCIFLUSH)  # lets a full terminal's writer go
    sending.join()
    os.close(own)
    os.close(theirs)


@pytest.mark.endurance
def test_events_come_live_from_a_port(
    simulated: SimulatedSession, port: tuple[str, FastClock], capsys: pytest.CaptureFixture[str]
) -> None:
    place, clock = port
    live_from_a_port.main(place, FOR_EVER_S, clock)
    *events, cadence = capsys.readouterr().out.splitlines()
    contacts = [event for event in events if event.startswith("initial_contact")]
    assert len(contacts) >= STRIDES - 1  # it walks before and after its whole strides as well
    stride_s = np.median(np.diff(simulated.truth.recordings[WALK].feet[Side.LEFT].events.initial_contact_s))
    (steps_min,) = numbers(cadence, r"cadence ([\d.]+) steps/min")
    assert steps_min == pytest.approx(120.0 / stride_s, rel=0.05)
