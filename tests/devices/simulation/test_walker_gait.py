"""Tests that the simulated patient walks as a human does, on feet that stay still on the floor."""

from itertools import pairwise

import numpy as np
import pytest

from core.body import Joint, Side, Site, ankle_of, knee_of
from core.prosthesis import NOT_STATED, AmputationLevel, FootKind, KneeKind, Prosthesis
from core.samples import FloatArray
from devices.simulation.walker import NO_ERRORS, Manner, SimulatedSession, Walk, WalkerSettings, simulate
from devices.simulation.walker_body import HEEL_M, TOE_M, make_leg, set_up
from devices.simulation.walker_gait import walk_leg
from devices.simulation.walker_plan import plan_walk
from devices.simulation.walker_prosthesis import AS_BUILT

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

SPEEDS = [0.3, 0.6, 1.19, 1.6, 2.0]
WORN = [
    Prosthesis(AmputationLevel.PARTIAL_FOOT),
    *(Prosthesis(AmputationLevel.TRANSTIBIAL, foot=foot) for foot in FootKind),
    *(Prosthesis(AmputationLevel.TRANSFEMORAL, knee) for knee in (KneeKind.POLYCENTRIC, KneeKind.LOCKED)),
]


def walked(speed_m_s: float = 1.19, seed: int = 0, strides: int = 6, **settings: object) -> SimulatedSession:
    walk = Walk(speed_m_s=speed_m_s, strides=strides)
    return simulate(WalkerSettings(seed=seed, errors=NO_ERRORS, recordings=(walk,), **settings))  # type: ignore[arg-type]  # fields of mixed types pass through by name


def mean_cycle(simulated: SimulatedSession, joint: Joint) -> FloatArray:
    """Degrees over 0-100 % of the steady strides, (101,)."""
    truth = simulated.truth.recordings["walk 1"]
    contacts = truth.feet[joint.side].events.initial_contact_s[1:-1]
    known = truth.joints[joint]
    strides = [np.interp(np.linspace(a, b, 101), known.time_s, known.angle_rad) for a, b in pairwise(contacts)]
    return np.rad2deg(np.mean(strides, axis=0))


@pytest.mark.parametrize("speed_m_s", SPEEDS)
def test_events_come_in_their_order(speed_m_s: float) -> None:
    for side, foot in walked(speed_m_s).truth.recordings["walk 1"].feet.items():
        e = foot.events
        assert len(e.initial_contact_s) == len(e.toe_off_s) == 6, side
        assert (e.full_contact_s > e.initial_contact_s + 0.05).all()
        assert (e.heel_rise_s[1:] > e.full_contact_s[:-1] + 0.05).all()
        assert (e.toe_off_s > e.heel_rise_s + 0.05).all()
        assert (e.initial_contact_s > e.toe_off_s + 0.2).all()
        stance = (e.toe_off_s[1:] - e.initial_contact_s[:-1]) / np.diff(e.initial_contact_s)
        assert ((stance > 0.54) & (stance < 0.70)).all()


def test_one_foot_is_always_on_the_floor_and_the_feet_alternate() -> None:
    feet = walked().truth.recordings["walk 1"].feet
    contacts = sorted((t, side) for side, foot in feet.items() for t in foot.events.initial_contact_s)
    assert all(a[1] is not b[1] for a, b in pairwise(contacts))
    off = {side: list(zip(f.events.toe_off_s, f.events.initial_contact_s, strict=True)) for side, f in feet.items()}
    assert all(a1 <= b0 or b1 <= a0 for a0, a1 in off[Side.LEFT] for b0, b1 in off[Side.RIGHT])


@pytest.mark.parametrize("speed_m_s", SPEEDS)
@pytest.mark.parametrize("fitted", [None, NOT_STATED, *WORN], ids=str)
def test_a_flat_foot_is_at_rest(speed_m_s: float, fitted: Prosthesis | None) -> None:
    side = None if fitted is None else Side.LEFT
    simulated = walked(speed_m_s, prosthetic_side=side, fitted=fitted or NOT_STATED)
    for side, foot in simulated.truth.recordings["walk 1"].feet.items():
        block = simulated.session.recordings[0].imu[Site(f"{side}_foot")]
        flat = zip(foot.events.full_contact_s[:-1], foot.events.heel_rise_s[1:], strict=True)
        for start, end in flat:
            still = (block.time_s > start + 0.005) & (block.time_s < end - 0.005)
            assert still.sum() > 4
            np.testing.assert_allclose(block.gyr_rad_s[still], 0.0, atol=1e-6)
            np.testing.assert_allclose(np.linalg.norm(block.acc_m_s2[still], axis=1), 9.81, atol=1e-4)
            during = (foot.time_s > start) & (foot.time_s < end)
            np.testing.assert_allclose(np.ptp(foot.ankle_path_m[during], axis=0), 0.0, atol=1e-6)
        landing = foot.events.full_contact_s[1]
        before = (block.time_s > landing - 0.06) & (block.time_s < landing - 0.02)
        assert np.linalg.norm(block.gyr_rad_s[before], axis=1).max() > 0.1


@pytest.mark.parametrize("speed_m_s", SPEEDS)
def test_speed_is_what_was_asked_and_strides_are_where_the_feet_stand(speed_m_s: float) -> None:
    truth = walked(speed_m_s, strides=9).truth.recordings["walk 1"]
    assert abs(truth.speed_m_s / speed_m_s - 1.0) < 0.02
    for foot in truth.feet.values():
        flat = 0.5 * (foot.events.full_contact_s[:-1] + foot.events.heel_rise_s[1:])
        stood = np.stack([np.interp(flat, foot.time_s, foot.ankle_path_m[:, k]) for k in range(2)], axis=-1)
        np.testing.assert_allclose(stood, foot.footholds_m[1:-1], atol=1e-6)
        travelled = np.linalg.norm(foot.ankle_path_m[-1, :2] - foot.ankle_path_m[0, :2])
        np.testing.assert_allclose(foot.stride_lengths_m.sum(), travelled, rtol=1e-3)


def test_default_strides_are_1_28_m_and_vary_a_little() -> None:
    lengths = np.concatenate(
        [f.stride_lengths_m[1:-1] for s in range(4) for f in walked(seed=s).truth.recordings["walk 1"].feet.values()]
    )
    assert abs(lengths.mean() - 1.28) < 0.01
    assert 0.005 < lengths.std() < 0.05


def test_knee_and_ankle_have_human_curves() -> None:
    for seed in range(4):
        simulated = walked(seed=seed)
        for side in Side:
            knee, ankle = mean_cycle(simulated, knee_of(side)), mean_cycle(simulated, ankle_of(side))
            assert 13.0 < knee[5:31].max() < 20.0
            assert 10 < 5 + knee[5:31].argmax() < 18
            assert 55.0 < knee.max() < 68.0
            assert 70 <= knee.argmax() <= 75
            assert 0.0 < knee.min() < 5.0
            assert knee[15] - knee[40] > 8.0
            assert 10.0 < ankle.max() < 17.0
            assert -17.0 < ankle.min() < -10.0
            assert 35 <= ankle.argmax() <= 50
            assert 58 <= ankle.argmin() <= 70
            assert ankle[:15].min() < -4.0
            assert 2.0 < ankle[75:95].max() < 8.0


def test_the_legs_differ_a_little() -> None:
    simulated = walked()
    left, right = (mean_cycle(simulated, knee_of(side)) for side in Side)
    assert 0.3 < np.abs(left - right).max() < 10.0


def test_faster_walking_bends_the_knee_more() -> None:
    peaks = [mean_cycle(walked(v, strides=5), Joint.LEFT_KNEE) for v in (0.3, 0.8, 1.6)]
    assert peaks[0].max() < peaks[1].max() < peaks[2].max()
    assert peaks[0][5:31].max() < peaks[1][5:31].max() < peaks[2][5:31].max()


def test_a_prosthetic_ankle_moves_little() -> None:
    simulated = walked(prosthetic_side=Side.RIGHT)
    assert np.ptp(mean_cycle(simulated, Joint.RIGHT_ANKLE)) < 15.0
    assert np.ptp(mean_cycle(simulated, Joint.LEFT_ANKLE)) > 20.0
    assert mean_cycle(simulated, Joint.RIGHT_KNEE).max() > 50.0


def test_a_stiff_knee_hardly_bends() -> None:
    simulated = walked(stiff_knee_side=Side.LEFT)
    assert 8.0 < mean_cycle(simulated, Joint.LEFT_KNEE).max() < 22.0
    assert mean_cycle(simulated, Joint.RIGHT_KNEE).max() > 50.0


@pytest.mark.parametrize("speed_m_s", SPEEDS)
@pytest.mark.parametrize("kind", ["sound", "stiff", NOT_STATED, *WORN], ids=str)
def test_heel_and_toe_never_pass_through_the_floor(speed_m_s: float, kind: str | Prosthesis) -> None:
    is_worn = isinstance(kind, Prosthesis)
    settings = WalkerSettings(
        seed=5,
        prosthetic_side=Side.LEFT if is_worn else None,
        fitted=kind if isinstance(kind, Prosthesis) else NOT_STATED,
        stiff_knee_side=Side.LEFT if kind == "stiff" else None,
    )
    time_s = np.arange(-250, 20000) / 1000.0
    walk = Walk(speed_m_s=speed_m_s, strides=3)
    rng = np.random.default_rng(5)
    leg = set_up(make_leg(settings, Side.LEFT), AS_BUILT)
    plan = plan_walk(walk, time_s, Side.LEFT, {side: make_leg(settings, side).foot for side in Side}, rng)
    motion = walk_leg(leg, plan, time_s, np.zeros((len(time_s), 2)), rng)
    foot, ankle = motion.rotations[2], motion.origins_m[2]
    lowest = ankle[:, 2] + np.minimum(foot @ HEEL_M, foot @ TOE_M)[:, 2]
    # a knee of several axes lets the foot down by a quarter of a millimetre as it straightens
    assert lowest.min() > (-5e-4 if leg.is_polycentric else -1e-9)
    for off, on in zip(motion.events.toe_off_s, motion.events.initial_contact_s, strict=True):
        middle = (time_s > off + 0.3 * (on - off)) & (time_s < off + 0.7 * (on - off))
        assert lowest[middle].min() > 0.01


def test_the_walk_starts_and_ends_standing_still() -> None:
    walk = Walk(standing_before_s=1.0, standing_after_s=1.0)
    recording = simulate(WalkerSettings(errors=NO_ERRORS, recordings=(walk,))).session.recordings[0]
    for block in recording.imu.values():
        speed = np.linalg.norm(block.gyr_rad_s, axis=1)
        for still in (block.time_s < 0.8, block.time_s > block.time_s[-1] - 0.8):
            assert speed[still].max() < 0.05
        assert speed.max() > 2.0


def test_a_turn_ends_in_another_direction() -> None:
    for turn_rad in (np.pi / 2, -np.pi / 2, np.pi):
        walk = Walk(strides=10, turn_rad=turn_rad)
        simulated = simulate(WalkerSettings(errors=NO_ERRORS, recordings=(walk,)))
        holds = simulated.truth.recordings["walk 1"].feet[Side.LEFT].footholds_m
        first, last = holds[2] - holds[1], holds[-2] - holds[-3]
        turned = np.arctan2(first[0] * last[1] - first[1] * last[0], first @ last)
        assert abs((turned - turn_rad + np.pi) % (2 * np.pi) - np.pi) < 0.1


def test_every_recording_starts_at_a_compass_direction_of_its_own() -> None:
    walks = tuple(Walk(f"walk {k}", strides=3) for k in range(6))
    recordings = simulate(WalkerSettings(recordings=walks)).truth.recordings.values()
    ways = [np.subtract(*r.feet[Side.LEFT].footholds_m[[-1, 0]]) for r in recordings]
    headings = np.sort([np.arctan2(w[1], w[0]) for w in ways])
    assert np.ptp(headings) > 1.0


@pytest.mark.parametrize("manner", [Manner.SHUFFLING, Manner.TOES])
@pytest.mark.parametrize("speed_m_s", [0.3, 0.8, 1.19])
def test_a_shuffling_foot_and_one_on_its_toes_stand_still_and_stay_above_the_floor(
    manner: Manner, speed_m_s: float
) -> None:
    settings = WalkerSettings()
    walk = Walk(speed_m_s=speed_m_s, strides=6, manner=manner)
    time_s = np.arange(0.0, 16.0, 0.001)
    plan = plan_walk(walk, time_s, Side.LEFT, {}, np.random.default_rng(1))
    leg = make_leg(settings, Side.LEFT)
    motion = walk_leg(leg, plan, time_s, np.zeros((len(time_s), 2)), np.random.default_rng(2))
    foot, ankle_m = motion.rotations[2], motion.origins_m[2]
    heel_m, toe_m = (ankle_m + foot @ point_m for point_m in (HEEL_M, TOE_M))
    assert min(heel_m[:, 2].min(), toe_m[:, 2].min()) > -1e-6
    for on, flat, rise, off in zip(
        motion.events.initial_contact_s[:-1],
        motion.events.full_contact_s[:-1],
        motion.events.heel_rise_s[1:],
        motion.events.toe_off_s[1:],
        strict=True,
    ):
        here = (time_s > flat) & (time_s < rise)
        np.testing.assert_allclose(np.ptp(ankle_m[here], axis=0), 0.0, atol=1e-6)
        assert (heel_m[here, 2] > 0.05).all() if manner is Manner.TOES else (heel_m[here, 2] < 1e-6).all()
        rolls = (time_s > (on if manner is Manner.TOES else rise)) & (time_s < off)
        np.testing.assert_allclose(toe_m[rolls, 2], 0.0, atol=1e-6)
