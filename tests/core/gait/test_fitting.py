"""Tests that the measures for fitting are what they are stated to be.

Curves drawn by hand, and segments turned by hand.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.body import LEG_SITES, Segment, Side
from core.gait.fitting import foot_measures, inclination_measures, late_swing_of_knee
from core.gait.inclination import inclination, lean_about, tilt_by_speeding_up
from core.gait.strides import Reason, Strides
from core.samples import FloatArray
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings
from tests.simulated import analysis_of, session_of

LEFT = tuple(site for site in LEG_SITES if site.side is Side.LEFT)
PERCENT = np.arange(101.0)
TIME_S = np.linspace(0.0, 4.0, 401)


def drawn(*knots: tuple[float, float]) -> FloatArray:
    """One cycle (1, 101) of straight lines, degrees reported, rad given."""
    at, deg = np.array(knots).T
    return np.deg2rad(np.interp(PERCENT, at, deg))[None, :]


def two_strides() -> Strides:
    """From 1 to 2 s and from 2 to 3 s: full contact after 10 %, heel rise after 40 %, toe-off after 60 %."""
    start = np.array([1.0, 2.0])
    return Strides(
        start_s=start,
        full_contact_s=start + 0.1,
        heel_rise_s=start + 0.4,
        toe_off_s=start + 0.6,
        end_s=start + 1.0,
        length_m=np.ones(2),
        clearance_m=np.ones(2),
        climb_m=np.zeros(2),
        turn_rad=np.zeros(2),
        bout=np.zeros(2, dtype=np.int64),
        reason=(Reason.USED,) * 2,
    )


def test_a_knee_arrives_where_it_comes_within_three_degrees_of_its_straightest() -> None:
    # 60 at 70 %, 2 at 90 %: it falls by 2.9 deg in 1 %, so 5 deg are reached at 90 - 3 / 2.9 = 88.966 %
    found = late_swing_of_knee(drawn((0, 5), (50, 5), (70, 60), (90, 2), (100, 4)))
    assert np.rad2deg(found["knee_terminal_extension_rad"]) == pytest.approx([2.0])
    assert found["knee_extended_before_contact_percent"] == pytest.approx([11.034], abs=0.01)


def test_a_knee_that_straightens_up_to_the_contact_arrives_just_before_it() -> None:
    found = late_swing_of_knee(drawn((0, 5), (50, 5), (70, 60), (100, 0)))  # 2 deg in 1 %
    assert np.rad2deg(found["knee_terminal_extension_rad"]) == pytest.approx([0.0], abs=1e-9)
    assert found["knee_extended_before_contact_percent"] == pytest.approx([1.5], abs=0.01)


def test_a_locked_knee_and_a_missing_stride_have_no_late_swing() -> None:
    locked, known = drawn((0, 3), (100, 4)), drawn((0, 5), (50, 5), (70, 60), (90, 2), (100, 4))
    assert all(np.isnan(values).all() for values in late_swing_of_knee(locked).values())
    both = late_swing_of_knee(np.concatenate([known, np.full((1, 101), np.nan), known]))
    for values in both.values():
        assert np.isfinite(values).tolist() == [True, False, True]
    assert all(len(values) == 0 for values in late_swing_of_knee(np.empty((0, 101))).values())


def test_a_foot_is_flat_from_full_contact_to_heel_rise_and_its_heel_rises_up_to_mid_swing() -> None:
    # toes up 20 at contact, flat from 10 to 40 %, toes down 60 at 65 %; in late swing, toes down 70, is not its rise
    one = np.interp(np.arange(100), [0, 10, 40, 65, 75, 90, 99], [20, 0, 0, -60, -10, -70, 19])
    pitch = np.deg2rad(np.concatenate([np.tile(one, 4), one[:1]]))
    found = foot_measures(two_strides(), TIME_S, pitch)
    assert found["foot_flat_percent"] == pytest.approx([30.0, 30.0])
    assert np.rad2deg(found["foot_pitch_at_contact_rad"]) == pytest.approx([20.0, 20.0])
    assert np.rad2deg(found["foot_heel_rise_rad"]) == pytest.approx([60.0, 60.0])


def test_without_a_pitch_only_the_foots_times_are_known() -> None:
    found = foot_measures(two_strides(), TIME_S, np.full(len(TIME_S), np.nan))
    assert found["foot_flat_percent"] == pytest.approx([30.0, 30.0])
    assert np.isnan(found["foot_pitch_at_contact_rad"]).all()
    assert np.isnan(found["foot_heel_rise_rad"]).all()


def test_the_shanks_rockers_add_up_to_its_turn_and_a_gap_takes_one_stride_alone() -> None:
    leaning = np.deg2rad(np.tile(np.interp(np.arange(100), [0, 10, 40, 60, 100], [-20, -8, 12, 35, -20]), 5)[:401])
    gap = leaning.copy()
    gap[150] = np.nan
    found = inclination_measures(two_strides(), TIME_S, {Segment.SHANK: gap, Segment.THIGH: leaning})
    expected = {
        "shank_heel_rocker_rad": 12.0,
        "shank_over_flat_foot_rad": 20.0,
        "shank_forefoot_rocker_rad": 23.0,
        "shank_at_initial_contact_rad": -20.0,
        "shank_at_mid_stance_rad": -8.0 + 20.0 * 2 / 3,  # at 30 %
        "shank_at_toe_off_rad": 35.0,
    }
    for name, deg in expected.items():
        assert np.isnan(found[name][0]), name
        assert np.rad2deg(found[name][1]) == pytest.approx(deg), name
    assert np.rad2deg(found["thigh_at_mid_stance_rad"]) == pytest.approx([-8.0 + 20.0 * 2 / 3] * 2)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("sign", [1, -1])
def test_an_inclination_is_forward_of_standing_however_the_sensor_is_mounted(seed: int, sign: int) -> None:
    """Axes of a segment: x forward, y left, z up; a knee's axis in clinical sign points to the left."""
    mounting = Rotation.random(rng=np.random.default_rng(seed))
    stood_deg, walked_deg = 4.0, np.array([-25.0, 4.0, 0.0, 40.0])

    def up(lean_deg: FloatArray) -> FloatArray:
        """The vertical in sensor axes of a segment that leans forward, in any compass direction."""
        turned = Rotation.from_euler("Z", 77.0, degrees=True) * Rotation.from_euler(
            "Y", lean_deg[:, None], degrees=True
        )
        return (turned * mounting).inv().apply([0.0, 0.0, 1.0])

    axis = mounting.inv().apply([0.0, 1.0, 0.0]) * sign
    standing_up = 9.81 * up(np.array([stood_deg]))[0]
    found = inclination(lean_about(axis, up(walked_deg)), axis, standing_up, sign)
    assert np.rad2deg(found) == pytest.approx(walked_deg - stood_deg, abs=1e-6)


def test_without_standing_the_differences_of_an_inclination_hold() -> None:
    axis, lean = np.array([0.0, 1.0, 0.0]), np.deg2rad([-20.0, np.nan, 5.0, 30.0])
    found = inclination(lean, axis, None, 1)
    assert np.rad2deg(found[3] - found[0]) == pytest.approx(50.0)
    assert np.isnan(found[1])


@pytest.mark.parametrize("turn_rad", [0.0, np.pi, -0.5 * np.pi])
def test_a_rigid_foot_has_one_angle_to_its_shank_from_the_first_stride_to_the_last(turn_rad: float) -> None:
    """Getting going, turning and stopping tilt the filter's vertical by degrees; the foot is as it was set."""
    walk = Walk(strides=24, turn_rad=turn_rad)
    recordings = (Standing(), FreeMotion(), walk)
    settings = WalkerSettings(seed=3, sites=LEFT, recordings=recordings, prosthetic_side=Side.LEFT)
    gait = analysis_of(session_of(settings)).recordings[-1].gait[Side.LEFT]
    angles_deg = np.rad2deg(gait.parameters["shank_to_foot_in_swing_rad"])
    used = angles_deg[gait.strides.is_used]
    assert len(used) >= 15
    assert np.abs(used - np.median(used)).max() < 1.0


def test_nothing_tilts_the_vertical_of_who_walks_all_the_time() -> None:
    """A recording that begins and ends in the midst of a walk."""
    start = np.arange(0.2, 20.0)
    strides = replace(
        two_strides(),
        **{name: start + by for name, by in (("start_s", 0.0), ("full_contact_s", 0.1), ("heel_rise_s", 0.4))},
        **{name: start + by for name, by in (("toe_off_s", 0.6), ("end_s", 1.0))},
        **{name: np.full(20, value) for name, value in (("length_m", 1.3), ("clearance_m", 0.1))},
        **{name: np.zeros(20) for name in ("climb_m", "turn_rad")},
        bout=np.zeros(20, dtype=np.int64),
        reason=(Reason.USED,) * 20,
    )
    time_s = np.linspace(0.0, 20.5, 2051)
    assert tilt_by_speeding_up(strides, time_s) == pytest.approx(np.zeros(2051), abs=1e-6)
    late_s = time_s - 5.0  # five seconds of standing before
    assert np.rad2deg(tilt_by_speeding_up(strides, late_s)).max() > 1.0


def test_strides_without_a_known_length_tilt_nothing() -> None:
    strides = replace(two_strides(), length_m=np.full(2, np.nan))
    assert not tilt_by_speeding_up(strides, TIME_S).any()
