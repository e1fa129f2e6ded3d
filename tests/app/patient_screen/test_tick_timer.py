"""Ticks by a timer against a clock that the test moves: no drift, no burst, none twice, none after it stopped."""

from collections.abc import Iterator

import pytest
from pytestqt.qtbot import QtBot

from app.patient_screen.tick_timer import LATE_S, TickTimer


class Clock:
    def __init__(self) -> None:
        self.now_s = 1000.0
        self.ticks_s: list[float] = []

    def tick(self) -> None:
        self.ticks_s.append(self.now_s - 1000.0)


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def timer(qtbot: QtBot, clock: Clock) -> Iterator[TickTimer]:
    timer = TickTimer(now_s=lambda: clock.now_s, tick=clock.tick)
    yield timer
    timer.stop()


def test_timers_that_are_late_each_time_do_not_add_up(timer: TickTimer, clock: Clock) -> None:
    timer.start(120)
    for k in range(1, 1201):  # ten minutes, looked at 1 to 20 ms late
        clock.now_s = 1000.0 + 0.5 * k + 0.001 + 0.019 * (k % 7) / 6
        timer.look()
    assert len(clock.ticks_s) == 1201
    assert all(0.0 <= at_s - 0.5 * k <= 0.021 for k, at_s in enumerate(clock.ticks_s))


def test_looking_too_early_or_twice_ticks_once(timer: TickTimer, clock: Clock) -> None:
    timer.start(60)
    for at_s in (0.0, 0.4, 0.999, 1.0, 1.001, 1.5):
        clock.now_s = 1000.0 + at_s
        timer.look()
    assert clock.ticks_s == [0.0, 1.0]


def test_what_the_program_was_too_busy_for_is_left_out_and_the_next_is_in_time(timer: TickTimer, clock: Clock) -> None:
    timer.start(60)
    for at_s in (3.0 + LATE_S + 0.01, 4.0):
        clock.now_s = 1000.0 + at_s
        timer.look()
    assert clock.ticks_s == [0.0, 4.0]


def test_another_rate_waits_for_a_whole_period_after_the_latest_tick(timer: TickTimer, clock: Clock) -> None:
    timer.start(60)
    clock.now_s += 0.2
    timer.start(120)
    for at_s in (0.2, 0.49, 0.5, 1.0):
        clock.now_s = 1000.0 + at_s
        timer.look()
    assert clock.ticks_s == [0.0, 0.5, 1.0]


def test_it_is_silent_once_stopped_and_begins_again(timer: TickTimer, clock: Clock) -> None:
    timer.start(60)
    timer.stop()
    clock.now_s += 5.3
    timer.look()
    assert clock.ticks_s == [0.0]
    timer.start(100)
    assert clock.ticks_s == [0.0, pytest.approx(5.3)]


def test_it_ticks_by_itself(qtbot: QtBot) -> None:
    ticks: list[int] = []
    timer = TickTimer(tick=lambda: ticks.append(1))
    timer.start(200)
    qtbot.waitUntil(lambda: len(ticks) >= 2)
    timer.stop()
