"""Live events of a foot whose pitch rate is drawn with straight lines and a power law, so that its events are known."""

from collections.abc import Sequence

import numpy as np
import pytest

from core.gait.live import FootEvent, LiveEvent, LiveEvents
from core.gait.live_motion import LiveMotion, speeds_of, way_of_m
from core.gait.phases import Phase
from core.samples import FloatArray

STRIDE_S = 1.1
STANDING_S = 2.003  # no event falls on a sample
FALL = 0.28  # s after the heel rise the foot no longer turns toes down

Foot = tuple[FloatArray, FloatArray, FloatArray]  # time, angular rate and specific force in axes forward, left, up
Down = tuple[float, float, float, float, float]  # begin, peak, end, s; peak, rebound, rad/s
LOADING: Down = (0.60, 0.62, 0.72, 4.0, 0.0)


def turning_rad_s(t: FloatArray, down: Down) -> FloatArray:
    """Toes-up rate of one step whose heel rises at 0: 5 rad/s down at 0.20 s, then up until the toes come `down`.

    They may rebound for 0.1 s.
    """
    begin, peak, end, load, rebound = down
    rate = np.zeros_like(t)
    shown = (t > 0.0) & (t <= 0.2)
    rate[shown] = -5.0 * (t[shown] / 0.2) ** 1.75
    shown = (t > 0.2) & (t <= FALL)
    rate[shown] = -5.0 * (FALL - t[shown]) / (FALL - 0.2)
    shown = (t > begin) & (t <= peak)
    rate[shown] = -load * (t[shown] - begin) / (peak - begin)
    shown = (t > peak) & (t <= end)
    rate[shown] = -load * ((end - t[shown]) / (end - peak)) ** 1.75
    rate[(t > end) & (t <= end + 0.1)] = rebound
    fallen_rad = 5.0 * (0.2 / 2.75 + 0.04) + load * ((peak - begin) / 2.0 + (end - peak) / 2.75) - 0.1 * rebound
    shown = (t > FALL) & (t <= begin)
    rate[shown] = 0.5 * np.pi * fallen_rad / (begin - FALL) * np.sin(np.pi * (t[shown] - FALL) / (begin - FALL))
    return rate


def walking_foot(rate_hz: float, downs: Sequence[Down], arrives_s: float = 0.62) -> Foot:
    """1.2 m forward in each step, from 0.15 s after its heel rise to `arrives_s`."""
    times_s = np.arange(0.0, STANDING_S + STRIDE_S * len(downs) + 1.0, 1.0 / rate_hz)
    fine_s = np.arange(0.0, times_s[-1] + 1e-3, 5e-4)
    rises_s = STANDING_S + STRIDE_S * np.arange(len(downs))
    rate, fine_rad_s = (
        sum((turning_rad_s(t - at, down) for at, down in zip(rises_s, downs, strict=True)), np.zeros_like(t))
        for t in (times_s, fine_s)
    )
    pitch = np.interp(times_s, fine_s, 5e-4 * np.cumsum(fine_rad_s))
    lasts_s = arrives_s - 0.15
    u = np.clip((times_s[:, None] - rises_s - 0.15) / lasts_s, 0.0, 1.0)
    forward = np.sum(72.0 * u * (1.0 - u) * (1.0 - 2.0 * u), axis=1) / lasts_s**2
    zero = np.zeros_like(rate)
    along, up = np.cos(pitch), np.sin(pitch)
    force = np.stack([forward * along + 9.81 * up, zero, 9.81 * along - forward * up], axis=1)
    return times_s, np.stack([zero, -rate, zero], axis=1), force


def after_rise_s(reported: Sequence[LiveEvent], event: FootEvent) -> FloatArray:
    """When each event of one kind was, in s after the heel rise that was drawn."""
    at_s = np.array([one.time_s for one in reported if one.event is event])
    return (at_s - STANDING_S + 0.2) % STRIDE_S - 0.2


@pytest.mark.parametrize("rate_hz", [60.0, 100.0, 200.0])
def test_every_event_is_where_it_was_drawn(rate_hz: float) -> None:
    """A rate that grows with the power 1.75 of time begins where it was zero; the others lie on straight lines."""
    reported = LiveEvents().update(*walking_foot(rate_hz, [LOADING] * 4))
    assert [one.event for one in reported] == 4 * [
        FootEvent.HEEL_RISE,
        FootEvent.TOE_OFF,
        FootEvent.INITIAL_CONTACT,
        FootEvent.FULL_CONTACT,
    ]
    step_s = 1.0 / rate_hz
    np.testing.assert_allclose(after_rise_s(reported, FootEvent.HEEL_RISE), 0.0, atol=0.003)
    # at 88 % of the peak as it was sampled, which is up to a sample beside the one that was drawn
    np.testing.assert_allclose(after_rise_s(reported, FootEvent.TOE_OFF), 0.2 + 0.12 * 0.08, atol=0.2 * step_s + 0.002)
    np.testing.assert_allclose(after_rise_s(reported, FootEvent.INITIAL_CONTACT), 0.60 + 0.69 * 0.02, atol=0.6 * step_s)
    np.testing.assert_allclose(after_rise_s(reported, FootEvent.FULL_CONTACT), 0.72, atol=0.004)


def test_cadence_of_strides_of_1100_ms() -> None:
    live = LiveEvents()
    live.update(*walking_foot(100.0, [LOADING] * 4))
    assert live.cadence_steps_min == pytest.approx(2 * 60.0 / STRIDE_S, abs=0.2)


def test_a_touch_that_was_not_enough_for_a_landing_is_reported_once_the_foot_lies_flat() -> None:
    """Half as hard as usual, and the foot still slides on at half its greatest speed; what follows is rest."""
    touch: Down = (0.56, 0.58, 0.61, 1.9, 0.1)
    reported = LiveEvents().update(*walking_foot(100.0, [LOADING, LOADING, LOADING, touch], arrives_s=0.72))
    contacts_s = after_rise_s(reported, FootEvent.INITIAL_CONTACT)
    assert len(contacts_s) == 4
    assert contacts_s[3] == pytest.approx(0.56 + 0.69 * 0.02, abs=0.006)
    last = next(one for one in reversed(reported) if one.event is FootEvent.INITIAL_CONTACT)
    assert last.reported_s - last.time_s > 0.1
    assert after_rise_s(reported, FootEvent.FULL_CONTACT)[3] == pytest.approx(0.61, abs=0.02)


def test_way_and_speed_of_a_foot_whose_velocity_crept() -> None:
    """Four samples 0.1 s apart: 0, 1, 2 and 0 m/s forward, and 0 to 0.3 m/s sideways that was never there."""
    travelled = [(2.0 + 0.1 * k, (v, 0.1 * k, 0.0)) for k, v in enumerate((0.0, 1.0, 2.0, 0.0))]
    assert way_of_m(travelled) == pytest.approx(0.3)  # 0.05 + 0.15 + 0.1
    np.testing.assert_allclose(speeds_of(travelled), [(2.0, 0.0), (2.1, 1.0), (2.2, 2.0), (2.3, 0.0)], atol=1e-12)


def test_a_shaken_foot_shows_the_vertical_in_five_seconds() -> None:
    """It lay level, then a force of 6 m/s2 stays across; of the tilt that this means, 1 - 1/e is seen in 5 s.

    The direction of gravity, of length g, turns at rate f sin(angle left) / (g tau) towards a force f of 11.5 m/s2.
    """
    motion, step_s = LiveMotion(None), 0.005
    for k in range(200):
        motion.add(k * step_s, step_s, (0.0, 0.0, 0.0), (0.0, 0.0, 9.81), 0.1)
    assert motion.speed_m_s == 0.0
    speed_m_s = np.zeros(2)
    force = np.array([6.0, 9.81])
    left_rad = np.arctan2(6.0, 9.81)
    for k in range(200, 1000):
        motion.add(k * step_s, step_s, (0.0, 0.0, 0.0), (6.0, 0.0, 9.81), 0.1)
        tilt = np.arctan2(6.0, 9.81) - left_rad
        speed_m_s += step_s * (force - 9.81 * np.array([np.sin(tilt), np.cos(tilt)]))
        left_rad -= step_s * np.hypot(6.0, 9.81) * np.sin(left_rad) / (9.81 * 5.0)
    assert motion.calm_s == 0.0
    # for its first 20 ms the foot is still taken to be calm
    assert motion.speed_m_s == pytest.approx(float(np.linalg.norm(speed_m_s)), rel=0.03)


def test_a_foot_is_in_swing_between_toe_off_and_contact() -> None:
    live = LiveEvents()
    times_s, gyr, acc = walking_foot(100.0, [LOADING] * 3)
    shown: dict[Phase, list[float]] = {}
    for k in range(len(times_s)):
        live.update(times_s[k : k + 1], gyr[k : k + 1], acc[k : k + 1])
        if times_s[k] > STANDING_S + STRIDE_S:
            shown.setdefault(live.phase, []).append((times_s[k] - STANDING_S) % STRIDE_S)
    assert 0.21 < min(shown[Phase.SWING]) < 0.31
    assert 0.61 < max(shown[Phase.SWING]) < 0.71


@pytest.mark.parametrize(("usual_steps", "contrary_steps"), [(0, 1), (2, 2), (5, 2)])
def test_two_steps_to_the_contrary_turn_the_toes_round_and_one_if_none_agreed(
    usual_steps: int, contrary_steps: int
) -> None:
    """A foot that leaves the floor forward, toes down, lifts its toes about its right, until swings say otherwise."""
    motion = LiveMotion(None)
    times_s, gyr, acc = walking_foot(100.0, [LOADING])
    axis = None
    for k in range(1, len(times_s)):
        motion.add(times_s[k], 0.01, tuple(gyr[k]), tuple(acc[k]), 0.18)
        axis = motion.find_axis()
        if axis is not None:
            break
    assert axis == pytest.approx((0.0, -1.0, 0.0), abs=1e-6)
    motion.rest()

    def is_turned_by(toes_down_rad_s: float) -> bool:
        """A step of half a second, as fast as steps are, down to stance again."""
        for k in range(50):
            forward_m_s2 = 40.0 if k < 10 else 0.0
            toes_down = (0.0, toes_down_rad_s * np.cos(np.pi * k / 49), 0.0)
            motion.add(0.0, 0.01, toes_down, (forward_m_s2, 0.0, 9.81), 0.18)
        motion.rest()
        return motion.has_turned_round

    assert [is_turned_by(2.0) for _ in range(usual_steps)] == [False] * usual_steps
    assert [is_turned_by(-2.0) for _ in range(contrary_steps)] == [False] * (contrary_steps - 1) + [True]
    assert motion.pitch_axis == pytest.approx((0.0, 1.0, 0.0), abs=1e-6)
    assert not is_turned_by(-2.0)
