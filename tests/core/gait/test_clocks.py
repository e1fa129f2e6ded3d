"""Tests of whether it is known that both legs' sensors report one time. It is not reported where it is not."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from core.analysis import analyse
from core.body import Joint, Side, Site
from core.gait.clocks import ClockGate, ClockTie, LegClocks, LegSteps, leg_clocks, stamps_residual_s
from core.results import RecordingAnalysis
from core.samples import FloatArray, SensorInfo
from core.session import Session
from core.verdicts.gates import clocks_verdict
from core.verdicts.model import Verdict
from devices.simulation.walker import Standing, Walk, WalkerSettings
from tests.simulated import session_of

FEET = (Site.LEFT_FOOT, Site.RIGHT_FOOT)
RNG = np.random.default_rng(3)
Walked = tuple[Session, RecordingAnalysis]


@pytest.fixture(scope="module")
def walked() -> Walked:
    session = session_of(WalkerSettings(seed=4, recordings=(Standing(), Walk(strides=10)), sites=FEET))
    return session, analyse(session).recordings[0]


def usual(walk: RecordingAnalysis, side: Side, name: str) -> float:
    gait = walk.gait[side]
    return float(np.nanmedian(gait.parameters[name][gait.strides.is_used]))


def clocks_of(
    walked: Walked, clocks: tuple[str, str] = ("", ""), lags_s: Mapping[Joint, float] | None = None, late_s: float = 0.0
) -> LegClocks:
    """Of the walk, its sensors named `clocks`, the right foot's steps moved by `late_s`."""
    session, walk = walked
    reported = {site: SensorInfo(clock=clock) for site, clock in zip(FEET, clocks, strict=True)}
    later_s = {Side.LEFT: -late_s, Side.RIGHT: late_s}
    steps = {
        side: LegSteps(
            Site(f"{side}_foot"),
            usual(walk, side, "step_time_s") + later_s[side],
            usual(walk, side, "stance_percent"),
        )
        for side in Side
    }
    return leg_clocks(replace(session, sensors=reported), session.recordings[1], steps, lags_s or {})


def test_sensors_of_one_clock_are_read(walked: Walked) -> None:
    found = clocks_of(walked, ("receiver 1", "receiver 1"))
    assert (found.tie, found.gate, clocks_verdict(found)) == (ClockTie.ONE_CLOCK, ClockGate.RESIDUAL, Verdict.READ)
    assert (found.value, found.limit) == (0.0, 0.005)
    assert found.step_share_percent == pytest.approx(50.0, abs=2.0)
    assert found.stance_difference_percent == pytest.approx(0.0, abs=2.0)


@pytest.mark.parametrize("clocks", [("", ""), ("receiver 1", ""), ("receiver 1", "receiver 2")])
def test_clocks_that_nothing_ties_are_not_reported(walked: Walked, clocks: tuple[str, str]) -> None:
    found = clocks_of(walked, clocks)
    assert (found.tie, found.gate, clocks_verdict(found)) == (ClockTie.UNKNOWN, ClockGate.UNKNOWN, Verdict.NOT_REPORTED)
    assert np.isnan(found.value)


@pytest.mark.parametrize(
    ("lag_s", "verdict"), [(0.0049, Verdict.READ), (0.005, Verdict.NOT_REPORTED), (-0.012, Verdict.NOT_REPORTED)]
)
def test_a_lag_inside_a_leg_speaks_against_any_clock(walked: Walked, lag_s: float, verdict: Verdict) -> None:
    found = clocks_of(walked, ("a", "a"), {Joint.LEFT_KNEE: 0.001, Joint.RIGHT_ANKLE: lag_s})
    assert clocks_verdict(found) is verdict
    if verdict is Verdict.NOT_REPORTED:
        assert (found.gate, found.value, found.limit) == (ClockGate.LAG, abs(lag_s), 0.005)


def test_uneven_steps_of_even_stances_are_two_clocks(walked: Walked) -> None:
    found = clocks_of(walked, ("a", "a"), late_s=-0.06)
    assert (found.gate, clocks_verdict(found), found.limit) == (ClockGate.STEP_SHARE, Verdict.NOT_REPORTED, 5.0)
    assert found.value == found.step_share_percent > 55.0
    assert clocks_verdict(clocks_of(walked, ("a", "a"), late_s=-0.03)) is Verdict.READ
    limping = LegClocks(ClockTie.ONE_CLOCK, 0.0, 0.0, 60.0, -4.0)
    assert clocks_verdict(limping) is Verdict.READ


@pytest.mark.parametrize(
    ("residual_s", "verdict", "limit_s"),
    [(0.004, Verdict.READ, 0.005), (0.006, Verdict.CARE, 0.005), (0.021, Verdict.NOT_REPORTED, 0.020)],
)
def test_the_residual_decides(residual_s: float, verdict: Verdict, limit_s: float) -> None:
    found = LegClocks(ClockTie.HOST_CLOCK, residual_s, 0.0, float("nan"), float("nan"))
    assert (clocks_verdict(found), found.value, found.limit) == (verdict, residual_s, limit_s)


def even(step_s: float, n: int = 6000, start_s: float = 0.0) -> FloatArray:
    return start_s + step_s * np.arange(n)


def test_stamps_made_of_the_number_of_the_sample_prove_nothing() -> None:
    assert np.isnan(stamps_residual_s(even(0.01), even(0.01)))
    assert np.isnan(stamps_residual_s(even(1.0 / 60.0), even(1.0 / 60.0)))
    assert np.isnan(stamps_residual_s(even(0.01)[::7], even(0.01)[3:]))
    assert np.isnan(stamps_residual_s(even(0.01, 50), even(0.01, 50)))


def test_stamps_that_are_irregular_together_are_one_receivers() -> None:
    jittered = even(0.01) + RNG.uniform(-0.003, 0.003, size=6000)
    assert stamps_residual_s(jittered, jittered) == 0.0
    assert stamps_residual_s(jittered, jittered[RNG.uniform(size=6000) > 0.02]) < 0.0005
    drifting = even(0.01 * (1.0 + 30e-6))
    assert stamps_residual_s(drifting, drifting) == 0.0


def test_rates_of_their_own_between_common_ends_were_fitted_to_one_clock() -> None:
    one, other = even(0.01 * (1.0 + 30e-6), start_s=3.412), even(0.01 * (1.0 - 20e-6), start_s=3.405)
    assert stamps_residual_s(one, other) < 0.0001
    rough = other + RNG.uniform(-0.002, 0.002, size=6000)
    assert stamps_residual_s(one, rough) == pytest.approx(0.004 / np.sqrt(12.0), rel=0.1)
    assert np.isnan(stamps_residual_s(one, other + 2.0))
    assert np.isnan(stamps_residual_s(one - one[0], other - other[0]))
