"""Jumps of a clock are distinguished from losses and from pauses by what the other sensors did meanwhile."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from core.body import Site
from core.samples import FloatArray, ImuBlock
from core.session import Recording, RecordingKind, Session
from core.signal.clock_jumps import ClockJump, jump_of, spans_of
from core.verdicts.quality import look_at
from devices.files.session_folder import read_session

WALK_S = np.arange(0.0, 20.0, 0.01)


def without(start_s: float, end_s: float, time_s: FloatArray = WALK_S) -> FloatArray:
    return time_s[(time_s <= start_s) | (time_s >= end_s)]


def jumped(after_s: float, by_s: float) -> FloatArray:
    return WALK_S + by_s * (after_s < WALK_S)


def jump(own: FloatArray, *others: FloatArray) -> ClockJump | None:
    return jump_of(spans_of(own), [spans_of(one) for one in others])


@pytest.mark.parametrize("by_s", [1.5, 7.0, 30.0, 10_800.0])
def test_a_clock_that_jumps_while_the_others_go_on_is_found(by_s: float) -> None:
    found = jump(jumped(15.0, by_s), WALK_S)
    assert found is not None
    assert found.after_s == pytest.approx(15.0)
    assert found.by_s == pytest.approx(by_s + 0.01)
    assert jump(WALK_S, jumped(15.0, by_s)) is None


@pytest.mark.parametrize(
    ("own", "others"),
    [
        (without(5.0, 15.0), [WALK_S]),  # out of reach
        (without(5.0, 15.0), [without(5.0, 15.0)]),  # a pause
        (jumped(10.0, 10_800.0), [jumped(10.0, 10_800.0)]),  # a pause for lunch
        (jumped(10.0, 10_800.0), []),  # nothing reports
        (without(12.0, 17.0), [WALK_S[:1200]]),  # back for a while when the other was off
        (without(5.0, 5.9), [WALK_S[:500]]),
        (np.empty(0), [WALK_S]),
        (WALK_S, [np.empty(0)]),
    ],
    ids=["loss", "pause", "long pause", "alone", "one ended", "short", "empty", "other empty"],
)
def test_losses_and_pauses_are_no_jumps(own: FloatArray, others: Sequence[FloatArray]) -> None:
    assert jump(own, *others) is None


def session(**times: FloatArray) -> Session:
    chance = np.random.default_rng(1)
    imu = {
        Site(site): ImuBlock(
            site, time_s, chance.normal(size=(len(time_s), 3)), chance.normal(9.8, 1, (len(time_s), 3))
        )
        for site, time_s in times.items()
    }
    return Session((Recording("walk 1", RecordingKind.WALKING, "walk_1", imu),))


def test_a_site_whose_clock_jumps_is_named_and_left_out_and_one_out_of_reach_is_not() -> None:
    found = look_at(session(left_thigh=WALK_S, left_shank=jumped(9.0, 10_800.0)))
    named = [(one.where, one.numbers) for one in found.findings if one.key == "clock_jumps"]
    assert named == [("walk 1, left_shank", {"jump_s": 10_800.01, "after_s": 9.0})]
    assert found.unusable == {("walk 1", Site.LEFT_SHANK)}
    lossy = look_at(session(left_thigh=WALK_S, left_shank=without(5.0, 15.0)))
    assert "clock_jumps" not in {one.key for one in lossy.findings}


@pytest.mark.parametrize("number", range(1, 7))
def test_no_real_recording_is_called_a_jump(test_data: Callable[[str], Path], number: int) -> None:
    """As it is; where all pause; where one is out of reach."""
    for recording in read_session(test_data(f"stroke_treadmill/stroke{number:02d}")).recordings:
        times_s = [block.time_s for block in recording.imu.values()]
        paused_s = [without(30.0, 50.0, time_s) for time_s in times_s]
        for seen_s in (times_s, paused_s, [paused_s[0], *times_s[1:]]):
            for at, own_s in enumerate(seen_s):
                assert jump(own_s, *seen_s[:at], *seen_s[at + 1 :]) is None
