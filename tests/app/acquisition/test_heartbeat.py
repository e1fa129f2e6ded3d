"""A standstill of the process is distinguished from a disk that is late, and sleep from being stopped."""

import signal

import pytest

from app.acquisition.heartbeat import STOOD_S, Heartbeat
from tests.safety.standstill import faults_of, stop_once


class Clocks:
    def __init__(self) -> None:
        self.now_s, self.clock_s, self.running_s = 0.0, 100.0, 7.0
        self.lost = {"a": 0}
        self.heartbeat = Heartbeat(
            lambda: self.now_s, lambda: dict(self.lost), lambda: self.clock_s, lambda: self.running_s
        )

    def go_on(self, seconds: float, asleep_s: float = 0.0) -> None:
        self.now_s, self.clock_s = self.now_s + seconds, self.clock_s + seconds
        self.running_s += seconds - asleep_s
        self.heartbeat.beat()


def test_a_process_that_beats_has_not_stood_still() -> None:
    clocks = Clocks()
    for _ in range(50):
        clocks.go_on(0.3)
    assert clocks.heartbeat.standstills == ()
    assert clocks.heartbeat.awake_s() == pytest.approx(15.0)


@pytest.mark.parametrize("asleep_s", [0.0, 19.5])
def test_a_standstill_is_reported_with_what_was_lost_before_it(asleep_s: float) -> None:
    clocks = Clocks()
    clocks.lost["a"] = 3
    clocks.go_on(0.1)
    clocks.lost["a"] = 9  # counted by a reader that was woken before the heart
    clocks.go_on(20.0, asleep_s)
    clocks.go_on(0.1)
    (standstill,) = clocks.heartbeat.standstills
    assert standstill.began_s == pytest.approx(0.1)
    assert standstill.lasted_s == pytest.approx(20.0)
    assert standstill.was_asleep is (asleep_s > 0)
    assert standstill.lost_before == {"a": 3}
    assert clocks.heartbeat.awake_s() == pytest.approx(0.2 + STOOD_S)


def test_before_the_first_beat_after_it_a_standstill_counts_no_more_than_after() -> None:
    clocks = Clocks()
    clocks.now_s = clocks.clock_s = 120.0
    assert clocks.heartbeat.awake_s() == STOOD_S


@pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="no signals to stop a process by")
@pytest.mark.endurance
def test_a_recording_whose_process_was_stopped_blames_no_disk_and_counts_what_was_lost() -> None:
    """Longer and more often: tests/safety/standstill.py."""
    reported = stop_once(4.0)
    assert faults_of(reported, 4.0) == []
    assert reported["lost"]  # terminals hold a second or two
