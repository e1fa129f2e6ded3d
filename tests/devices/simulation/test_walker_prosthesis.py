"""Tests that settings of a simulated prosthesis move the leg as geometry demands, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from core.body import Side
from core.samples import FloatArray
from devices.simulation.walker import (
    AS_BUILT,
    DEMONSTRATION,
    ProsthesisSetting,
    SimulatedSession,
    Standing,
    Walk,
    WalkerSettings,
    simulate,
)
from devices.simulation.walker_motion import LegMotion

STRIDES = 5


def walked(setting: ProsthesisSetting, prosthetic: Side | None = Side.LEFT) -> SimulatedSession:
    walk = Walk(strides=STRIDES, prosthesis=setting)
    return simulate(WalkerSettings(seed=3, prosthetic_side=prosthetic, recordings=(Standing(), walk)))


def leg_of(made: SimulatedSession, side: Side = Side.LEFT) -> LegMotion:
    return made.moved[-1].legs[side]


def at(leg: LegMotion, values: FloatArray, instants_s: FloatArray) -> FloatArray:
    return np.rad2deg(np.interp(instants_s, leg.time_s, values))


def lean(leg: LegMotion) -> FloatArray:
    """Of the shank, forward positive; the path is straight."""
    way = leg.footholds_m[-1] - leg.footholds_m[0]
    along = leg.rotations[1, :, :2, 2] @ (way / np.hypot(*way))
    return np.asarray(np.arcsin(along))


def swings(leg: LegMotion) -> list[slice]:
    events = leg.events
    return [
        slice(*np.searchsorted(leg.time_s, (off, events.initial_contact_s[events.initial_contact_s > off][0])))
        for off in events.toe_off_s
    ]


BUILT = leg_of(walked(AS_BUILT))
MIDDLE_S = 0.35 * BUILT.events.toe_off_s + 0.65 * BUILT.events.initial_contact_s


def test_what_nobody_set_changes_nothing() -> None:
    set_so = ProsthesisSetting(plantar_deg=4.0, back_mm=10.0, stop_deg=3.0)
    nobody, other = walked(AS_BUILT, None), walked(set_so, None)
    for mine, its in zip(nobody.session.recordings, other.session.recordings, strict=True):
        for site, block in mine.imu.items():
            np.testing.assert_array_equal(block.gyr_rad_s, its.imu[site].gyr_rad_s)
            np.testing.assert_array_equal(block.acc_m_s2, its.imu[site].acc_m_s2)


def test_the_sound_leg_does_not_react() -> None:
    """People's does: what is modelled is geometry alone."""
    one, other = (
        walked(setting).moved[-1].legs[Side.RIGHT] for setting in (AS_BUILT, ProsthesisSetting(4.0, 10.0, 5.0, 3.0))
    )
    np.testing.assert_array_equal(one.rotations, other.rotations)


def test_a_plantarflexed_foot_points_down_in_swing_lands_flatter_and_rises_sooner() -> None:
    leg = leg_of(walked(ProsthesisSetting(plantar_deg=4.0)))
    np.testing.assert_allclose(
        at(leg, leg.angles.ankle, MIDDLE_S) - at(BUILT, BUILT.angles.ankle, MIDDLE_S), -4.0, atol=0.4
    )
    on = BUILT.events.initial_contact_s[:-1]
    np.testing.assert_allclose(at(leg, lean(leg), on) - at(BUILT, lean(BUILT), on), 0.0, atol=0.5)
    np.testing.assert_allclose(at(leg, leg.angles.ankle, on) - at(BUILT, BUILT.angles.ankle, on), -4.0, atol=1.0)
    assert (leg.events.full_contact_s < BUILT.events.full_contact_s)[:-1].all()  # the last lands flat as it is
    later_s = leg.events.heel_rise_s - BUILT.events.heel_rise_s
    np.testing.assert_allclose(later_s, -np.deg2rad(4.0) * 0.86 / 1.19, rtol=0.04)
    np.testing.assert_array_equal(leg.events.toe_off_s, BUILT.events.toe_off_s)


def test_a_dorsiflexed_foot_does_the_opposite() -> None:
    leg = leg_of(walked(ProsthesisSetting(plantar_deg=-4.0)))
    np.testing.assert_allclose(
        at(leg, leg.angles.ankle, MIDDLE_S) - at(BUILT, BUILT.angles.ankle, MIDDLE_S), 4.0, atol=0.4
    )
    assert (leg.events.heel_rise_s > BUILT.events.heel_rise_s).all()
    assert (leg.events.heel_rise_s < leg.events.toe_off_s).all()


def test_a_foot_set_back_lets_the_shank_lean_forward_in_stance() -> None:
    leg = leg_of(walked(ProsthesisSetting(back_mm=20.0)))
    middle_s = 0.5 * (BUILT.events.full_contact_s[:-1] + BUILT.events.heel_rise_s[1:])
    more = at(leg, lean(leg), middle_s) - at(BUILT, lean(BUILT), middle_s)
    np.testing.assert_allclose(more, np.rad2deg(0.020 / 0.86), rtol=0.1)  # of a leg of that length
    np.testing.assert_allclose(np.diff(leg.footholds_m, axis=0)[1:-1], np.diff(BUILT.footholds_m, axis=0)[1:-1])


def test_a_stop_that_comes_sooner_is_never_passed() -> None:
    leg = leg_of(walked(ProsthesisSetting(stop_deg=5.0)))
    walking = slice(*np.searchsorted(leg.time_s, (leg.events.toe_off_s[0], leg.events.toe_off_s[-1])))
    assert np.rad2deg(leg.angles.knee[walking].min()) == pytest.approx(6.5, abs=0.1)
    assert np.rad2deg(BUILT.angles.knee[walking].min()) < 3.0
    bent = np.rad2deg(BUILT.angles.knee[walking]) > 20.0
    np.testing.assert_allclose(leg.angles.knee[walking][bent], BUILT.angles.knee[walking][bent], atol=1e-9)


def test_resistances_move_the_peaks_and_when_the_knee_is_straight() -> None:
    slow, high, firm = (
        leg_of(walked(one))
        for one in (
            ProsthesisSetting(extension=2.0),
            ProsthesisSetting(swing_flexion_deg=6.0),
            ProsthesisSetting(stance_flexion=0.3),
        )
    )
    for span in swings(BUILT):
        peak = BUILT.angles.knee[span].max()
        assert high.angles.knee[span].max() - peak == pytest.approx(np.deg2rad(6.0), abs=np.deg2rad(0.4))
        assert slow.angles.knee[span].max() == pytest.approx(peak, abs=np.deg2rad(0.5))
        late = slice(span.start + int(0.85 * (span.stop - span.start)), span.stop)
        assert slow.angles.knee[late].mean() > BUILT.angles.knee[late].mean() + np.deg2rad(3.0)
    for on, flat in zip(BUILT.events.initial_contact_s[:-1], BUILT.events.toe_off_s[1:], strict=True):
        loading = slice(*np.searchsorted(BUILT.time_s, (on, 0.5 * (on + flat))))
        assert firm.angles.knee[loading].max() < BUILT.angles.knee[loading].max() - np.deg2rad(7.0)


def test_a_longer_pylon_is_a_longer_shank() -> None:
    leg = leg_of(walked(ProsthesisSetting(height_mm=20.0)))
    for one, length_m in ((BUILT, 0.0), (leg, 0.020)):
        shank_m = np.linalg.norm(one.origins_m[1, 0] - one.origins_m[2, 0])
        assert shank_m - np.linalg.norm(BUILT.origins_m[1, 0] - BUILT.origins_m[2, 0]) == pytest.approx(length_m)


def test_a_resistance_below_nought_is_refused() -> None:
    with pytest.raises(ValueError, match="extension is 0"):
        ProsthesisSetting(extension=0.0)


def test_walks_before_are_as_they_were() -> None:
    """What is set before the second walk is not in the first."""
    walks = (Walk("walk 1", strides=3), Walk("walk 2", strides=3, prosthesis=ProsthesisSetting(plantar_deg=4.0)))
    as_built = (walks[0], replace(walks[1], prosthesis=AS_BUILT))
    settings = replace(DEMONSTRATION, prosthetic_side=Side.RIGHT)
    one, other = (simulate(replace(settings, recordings=(Standing(), *both))).session for both in (walks, as_built))
    site = next(site for site in one.recordings[1].imu if site.side is Side.RIGHT and site.segment.value == "foot")
    np.testing.assert_array_equal(one.recordings[1].imu[site].gyr_rad_s, other.recordings[1].imu[site].gyr_rad_s)
    assert np.abs(one.recordings[2].imu[site].gyr_rad_s - other.recordings[2].imu[site].gyr_rad_s).max() > 0.05
