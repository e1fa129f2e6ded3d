"""The values of strides as they happen, from curves and events written by hand; whole walks in the long run."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.analysis import analyse
from core.body import Side, knee_of
from core.gait.live import FootEvent, LiveEvent
from core.gait.phases import Phase
from core.live.angle import AngleSamples
from core.live.foot_pitch import FootPitch, FootStrike
from core.live.orientation import OrientedSamples
from core.live.stride_values import StrideValue, StrideValues
from core.live.walking import LiveFoot, LiveJoint, LiveWalk, WalkingState
from core.samples import FloatArray
from core.targets import TargetMeasure
from devices.simulation.walker import FreeMotion, Standing, Tissue, Walk, WalkerSettings, simulate
from tests.core.cut_blocks import in_blocks
from tests.core.standing import live_sensors

STEP_S = 0.01
OFF, ON = FootEvent.TOE_OFF, FootEvent.INITIAL_CONTACT


def angles(time_s: FloatArray, angle_deg: FloatArray) -> AngleSamples:
    ticks = np.rint(time_s / STEP_S).astype(np.int64)
    return AngleSamples(ticks, time_s, np.deg2rad(angle_deg), np.zeros(len(time_s)))


def swing_deg(time_s: FloatArray, peak_deg: float = 60.0, peak_s: float = 0.2) -> FloatArray:
    """A knee that bends to its peak 0.2 s after the start and straightens again."""
    return peak_deg * np.exp(-(((time_s - peak_s) / 0.12) ** 2))


def foot(*events: LiveEvent, strikes: tuple[FootStrike, ...] = ()) -> LiveFoot:
    return LiveFoot(events, (), Phase.SWING, math.nan, 0, strikes)


def event(kind: FootEvent, time_s: float, delay_s: float = 0.05) -> LiveEvent:
    return LiveEvent(kind, time_s, time_s + delay_s)


def reported_by_knee(angle_deg: FloatArray, time_s: FloatArray, block: int = 3) -> list[StrideValue]:
    """Of a left knee whose foot leaves at 0.05 s and lands at 0.5 s, in blocks of so many samples."""
    values, found = StrideValues(), list[StrideValue]()
    events = [event(OFF, 0.05), event(ON, 0.5)]
    for a in range(0, len(time_s), block):
        part = slice(a, a + block)
        until_s = float(time_s[part][-1])
        due, events = [e for e in events if e.reported_s <= until_s], [e for e in events if e.reported_s > until_s]
        joint = LiveJoint(angles(time_s[part], angle_deg[part]), False)
        found += values.update(WalkingState({knee_of(Side.LEFT): joint}, {Side.LEFT: foot(*due)}))
    return [one for one in found if one.measure is TargetMeasure.KNEE_SWING_PEAK]


TIME_S = np.arange(0.0, 0.7, STEP_S)


@pytest.mark.parametrize("block", [1, 3, 1000])
def test_a_knees_peak_is_reported_once_as_soon_as_it_has_passed(block: int) -> None:
    (reported,) = reported_by_knee(swing_deg(TIME_S), TIME_S, block)
    assert reported.value == pytest.approx(60.0)
    assert reported.event_s == pytest.approx(0.2)
    assert reported.reported_s == pytest.approx(0.23)  # 2 degrees of this curve are passed 22 ms after its peak
    assert reported.side is Side.LEFT


def test_a_knee_that_hardly_falls_is_reported_when_the_foot_lands() -> None:
    (reported,) = reported_by_knee(np.full(len(TIME_S), 11.0), TIME_S)
    assert reported.value == pytest.approx(11.0)
    assert reported.reported_s == pytest.approx(0.55)


def test_a_swing_whose_angle_is_not_known_throughout_has_no_value() -> None:
    angle_deg = swing_deg(TIME_S)
    angle_deg[15] = np.nan
    assert reported_by_knee(angle_deg, TIME_S) == []
    silent = (TIME_S < 0.1) | (TIME_S > 0.17)
    assert reported_by_knee(swing_deg(TIME_S)[silent], TIME_S[silent]) == []
    late = swing_deg(TIME_S)
    late[-5:] = np.nan  # after the foot has landed
    assert len(reported_by_knee(late, TIME_S)) == 1


def values_of(events: Sequence[tuple[Side, LiveEvent]], measure: TargetMeasure) -> list[StrideValue]:
    values, found = StrideValues(), list[StrideValue]()
    for side, one in events:
        feet = {each: foot(*((one,) if each is side else ())) for each in Side}
        found += values.update(WalkingState({}, feet))
    return [one for one in found if one.measure is measure]


def test_stances_are_reported_in_percent_of_the_other_legs_latest() -> None:
    left, right = Side.LEFT, Side.RIGHT
    walk = [(left, event(ON, 0.0)), (right, event(ON, 0.5)), (left, event(OFF, 0.6)), (right, event(OFF, 1.25))]
    walk += [(left, event(ON, 1.0)), (left, event(OFF, 1.66))]
    walk.sort(key=lambda one: one[1].reported_s)
    one, two = values_of(walk, TargetMeasure.STANCE_RATIO)
    assert (one.side, two.side) == (right, left)
    assert one.value == pytest.approx(100 * 0.75 / 0.6)
    assert two.value == pytest.approx(100 * 0.66 / 0.75)


def test_a_stance_before_a_pause_is_compared_with_nothing() -> None:
    left, right = Side.LEFT, Side.RIGHT
    walk = [(right, event(ON, 0.0)), (right, event(OFF, 0.6)), (left, event(ON, 9.0)), (left, event(OFF, 9.6))]
    assert values_of(walk, TargetMeasure.STANCE_RATIO) == []


def test_cadence_is_two_steps_over_the_stride_that_has_ended_and_none_over_a_pause() -> None:
    contacts = [(Side.LEFT, event(ON, at_s)) for at_s in (0.0, 1.2, 2.2, 7.0, 8.0)]
    assert [one.value for one in values_of(contacts, TargetMeasure.CADENCE)] == pytest.approx([100.0, 120.0, 120.0])


def oriented(pitch_rad: FloatArray, time_s: FloatArray, mounting: Rotation) -> tuple[OrientedSamples, FloatArray]:
    """A foot that walks along x and pitches about its y, toes up positive, and its axis in sensor axes."""
    turned = Rotation.from_rotvec(np.outer(-pitch_rad, [0.0, 1.0, 0.0])) * mounting
    q = turned.as_quat(scalar_first=True)
    rate = np.gradient(pitch_rad, time_s)
    axis = mounting.inv().apply([0.0, -1.0, 0.0])
    gyr = rate[:, None] * axis
    ticks = np.arange(len(time_s))
    signals = np.concatenate([q, gyr, np.zeros((len(time_s), 3))], axis=1)
    return OrientedSamples(ticks, time_s, signals, np.ones(len(time_s), dtype=bool)), axis


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("lands_deg", [22.0, 0.0, -8.0])
def test_a_foots_pitch_at_contact_is_against_its_own_flat_stance_in_any_mounting(seed: int, lands_deg: float) -> None:
    time_s = np.arange(0.0, 2.0, STEP_S)
    known_s, known_deg = [0.0, 0.6, 0.8, 1.2, 1.5, 2.0], [0.0, 0.0, -50.0, lands_deg + 5.0, lands_deg, lands_deg]
    slope = np.deg2rad(3.0)  # of the floor, or of a foot that does not stand level
    samples, axis = oriented(
        slope + np.deg2rad(np.interp(time_s, known_s, known_deg)), time_s, Rotation.random(rng=seed)
    )
    (strike,) = FootPitch().update(time_s, samples, [event(OFF, 0.8), event(ON, 1.5)], axis)
    assert np.rad2deg(strike.pitch_rad) == pytest.approx(lands_deg, abs=0.1)
    assert strike.time_s == 1.5


def test_a_foot_that_was_never_quiet_or_whose_axis_is_unknown_has_no_pitch() -> None:
    time_s = np.arange(0.0, 2.0, STEP_S)
    restless, axis = oriented(0.2 * np.sin(2 * np.pi * 4.0 * time_s), time_s, Rotation.identity())
    walk = [event(OFF, 0.8), event(ON, 1.5)]
    quiet, _ = oriented(np.zeros(len(time_s)), time_s, Rotation.identity())
    assert FootPitch().update(time_s, quiet, walk, axis) != ()
    assert FootPitch().update(time_s, restless, walk, axis) == ()
    assert FootPitch().update(time_s, quiet, walk, None) == ()
    assert FootPitch().update(time_s, quiet, [event(ON, 1.5)], axis) == ()  # nobody knows when it left


@pytest.mark.endurance
@pytest.mark.parametrize(("seed", "tissue", "rate_hz"), [(3, Tissue.SOFT, 200.0), (4, Tissue.RIGID, 100.0)])
def test_the_values_of_a_walk_are_those_of_the_bones(seed: int, tissue: Tissue, rate_hz: float) -> None:
    recordings = (Standing(), FreeMotion(), Walk("walk 1", strides=14, standing_before_s=2.0))
    made = simulate(WalkerSettings(seed=seed, rate_hz=rate_hz, tissue=tissue, recordings=recordings))
    live = LiveWalk(live_sensors(made.session), analyse(made.session).calibrations[-1].joints)
    walk, values = made.session.recordings[-1], StrideValues()
    reported: list[StrideValue] = []
    for blocks in in_blocks(walk.imu, 0.03):
        reported += values.update(live.update(blocks))
    truth = made.truth.recordings["walk 1"]
    legs = made.moved[2].legs
    for side in Side:
        knee, events = truth.joints[knee_of(side)], truth.feet[side].events
        standing_deg = math.degrees(knee.standing_rad)
        peaks = [one for one in reported if one.side is side and one.measure is TargetMeasure.KNEE_SWING_PEAK]
        strikes = [one for one in reported if one.side is side and one.measure is TargetMeasure.FOOT_STRIKE]
        assert len(peaks) >= len(events.initial_contact_s) - 1
        for off_s, on_s in zip(events.toe_off_s[1:-1], events.initial_contact_s[1:-1], strict=True):
            in_swing = (knee.time_s > off_s) & (knee.time_s < on_s)
            (peak,) = [one for one in peaks if off_s - 0.1 < one.event_s < on_s + 0.05]
            assert peak.value == pytest.approx(math.degrees(knee.angle_rad[in_swing].max()) - standing_deg, abs=3.0)
            assert peak.reported_s - peak.event_s < 0.08
            (strike,) = [one for one in strikes if abs(one.event_s - on_s) < 0.1]
            pitch = foot_pitch_deg(legs[side].rotations[2], legs[side].time_s, strike.event_s)
            assert strike.value == pytest.approx(pitch, abs=4.0)


def foot_pitch_deg(rotations: FloatArray, time_s: FloatArray, at_s: float) -> float:
    """How far the true foot's inclination at an instant differs from that of standing, toes up positive."""
    at = int(np.searchsorted(time_s, at_s))
    forward = np.array([1.0, 0.0, 0.0])
    return math.degrees(math.asin((rotations[at] @ forward)[2]) - math.asin((rotations[0] @ forward)[2]))
