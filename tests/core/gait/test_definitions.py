"""Tests that the figures of gait are computed as they are defined.

Windows, scores and limits, written out or counted by hand.
"""

from dataclasses import replace

import numpy as np
import pytest

from core.body import Side, Site
from core.gait.cycles import excursion_of_cycles, find_peak
from core.gait.events import FootEvents
from core.gait.phases import PHASES, phases_at
from core.gait.shank import gait_of_shank
from core.gait.strides import Reason, strides_of
from core.gait.symmetry import curve_difference, gait_variable_score
from core.parameters import ANKLE_WINDOWS, EXCURSIONS, KNEE_WINDOWS, Excursion
from core.samples import FloatArray
from core.signal.robust import robust_sd
from devices.simulation.walker import Standing, Walk, WalkerSettings
from tests.core.gait.feet import foot_of
from tests.core.gait.test_strides import events_at
from tests.core.standing import bias_of
from tests.simulated import simulation_of

PERCENT = np.arange(101.0)
WINDOWS = [  # joint, peak, first and last percent of the stride, whether it is a maximum
    ("knee", "knee_loading_peak", 5, 30, True),
    ("knee", "knee_stance_minimum", 25, 60, False),
    ("knee", "knee_swing_peak", 55, 90, True),
    ("ankle", "ankle_loading_plantarflexion", 0, 20, False),
    ("ankle", "ankle_stance_dorsiflexion", 20, 60, True),
    ("ankle", "ankle_push_off_plantarflexion", 50, 80, False),
    ("ankle", "ankle_swing_dorsiflexion", 70, 95, True),
]

EXTREMES = {  # percent of the stride between which an excursion has its highest and its lowest angle
    "knee_while_loading": ((5, 30), (0, 0)),
    "knee_straightening": ((5, 30), (25, 60)),
    "knee_stance_to_swing": ((55, 90), (25, 60)),
    "ankle_heel_rocker": ((0, 0), (0, 20)),
    "ankle_rocker": ((20, 60), (0, 20)),
    "ankle_push_off": ((20, 60), (50, 80)),
    "ankle_toes_lifted": ((70, 95), (50, 80)),
}
KNEE_DEG = np.interp(PERCENT, [0, 15, 40, 72, 100], [4.0, 19.0, 6.0, 64.0, 4.0])
ANKLE_DEG = np.interp(PERCENT, [0, 8, 46, 63, 84, 100], [-1.0, -6.0, 12.0, -14.0, 3.0, -1.0])
SIZES_DEG = {  # counted on the corners of these curves
    "knee_while_loading": 15.0,
    "knee_straightening": 13.0,
    "knee_stance_to_swing": 58.0,
    "ankle_heel_rocker": 5.0,
    "ankle_rocker": 18.0,
    "ankle_push_off": 26.0,
    "ankle_toes_lifted": 17.0,
}


def curve(peak_at: float, sign: float) -> FloatArray:
    """One stride (1, 101) that leaves 10 towards `sign` at one percent only."""
    return (10.0 + sign * 8.0 * np.exp(-(((PERCENT - peak_at) / 4.0) ** 2)))[None]


@pytest.mark.parametrize(("joint", "name", "first", "last", "is_maximum"), WINDOWS)
def test_a_peak_counts_within_its_part_of_the_stride_only(
    joint: str, name: str, first: int, last: int, is_maximum: bool
) -> None:
    (window,) = (w for w in (KNEE_WINDOWS if joint == "knee" else ANKLE_WINDOWS) if w.name == name)
    sign = 1.0 if is_maximum else -1.0
    for percent in range(101):
        peak = find_peak(curve(percent, sign), window)
        if first < percent < last:  # at the edge, the angle only passes through
            assert (peak.percent[0], peak.value[0]) == (percent, pytest.approx(10.0 + 8.0 * sign))
        else:
            assert np.isnan(peak.percent[0])
            assert np.isnan(peak.value[0])


def test_every_peak_has_its_window() -> None:
    assert [w.name for w in (*KNEE_WINDOWS, *ANKLE_WINDOWS)] == [name for _, name, *_ in WINDOWS]


def test_every_excursion_has_its_two_extremes() -> None:
    found = {}
    for one in EXCURSIONS:
        high, low = ((w.first, w.last) if w is not None else (0, 0) for w in (one.high, one.low))
        found[one.name] = high, low
        assert one.high is None or one.high.is_maximum
        assert one.low is None or not one.low.is_maximum
    assert found == EXTREMES


@pytest.mark.parametrize("excursion", EXCURSIONS, ids=lambda one: one.name)
def test_an_excursion_needs_no_zero_and_is_none_on_a_mirrored_curve(excursion: Excursion) -> None:
    angle = (KNEE_DEG if excursion.name.startswith("knee") else ANKLE_DEG)[None].repeat(3, axis=0)
    for offset in (-7.0, 0.0, 7.0):
        found = excursion_of_cycles(angle + offset, excursion)
        np.testing.assert_allclose(found, SIZES_DEG[excursion.name], atol=1e-9)
    assert not np.any(np.abs(excursion_of_cycles(-angle, excursion) - SIZES_DEG[excursion.name]) < 1.0)


@pytest.mark.parametrize(("passing", "is_known"), [(1, True), (2, False)])
def test_an_excursion_is_none_where_half_of_the_strides_pass_through_its_extreme(passing: int, is_known: bool) -> None:
    loading = next(one for one in EXCURSIONS if one.name == "knee_while_loading")
    angle = KNEE_DEG[None].repeat(4, axis=0)
    angle[:passing] = PERCENT  # rises through the whole window
    assert np.isfinite(excursion_of_cycles(angle, loading)).all() == is_known


def test_a_stride_that_is_not_known_has_no_excursion_and_takes_none_from_the_others() -> None:
    angle = ANKLE_DEG[None].repeat(3, axis=0)
    angle[1] = np.nan
    push_off = next(one for one in EXCURSIONS if one.name == "ankle_push_off")
    np.testing.assert_allclose(excursion_of_cycles(angle, push_off), [26.0, np.nan, 26.0], atol=1e-9)


def test_curves_differ_by_their_mean_absolute_distance_and_score_by_the_root_mean_square() -> None:
    """Apart by 4 over 25 of 101 points, in turns above and below: 100 / 101, and the root of 400 / 101."""
    other = np.zeros(101)
    other[10:35] = 4.0 * (-1.0) ** np.arange(25)
    assert curve_difference(np.zeros(101), other) == pytest.approx(0.9900990099)
    assert gait_variable_score(np.zeros(101), other) == pytest.approx(1.9900743804)


def test_a_robust_spread_is_that_of_normal_values_and_takes_no_middle_off() -> None:
    assert robust_sd(np.array([-3.0, 1.0, -1.0, 2.0, 2.0])) == pytest.approx(2.9652)
    values = np.random.default_rng(4).normal(0.0, 5.0, 20_000)
    assert robust_sd(values) == pytest.approx(5.0, rel=0.02)


def walk(length_m: FloatArray, stride_s: FloatArray | None = None) -> FootEvents:
    """A foot's events of straight strides of these lengths, and a contact before the first."""
    times = np.full(len(length_m), 1.1) if stride_s is None else stride_s
    contact = 1.0 + np.concatenate([[0.0], np.cumsum(times)])
    return events_at(contact, np.concatenate([[length_m[0]], length_m]))


@pytest.mark.parametrize(("odd_m", "is_outlier"), [(1.21, False), (1.25, True), (0.79, False), (0.75, True)])
def test_a_stride_is_unlike_the_others_beyond_four_robust_standard_deviations(odd_m: float, is_outlier: bool) -> None:
    """Half of the strides lie 0.04 m from the middle of 1 m and more: 4 x 1.4826 x 0.04 = 0.237 m."""
    length_m = np.tile([1.0, 1.04, 1.0, 0.96], 6)
    length_m[:4] = length_m[-4:] = [1.04, 0.96, 1.04, 0.96]
    length_m[12] = odd_m
    reason = strides_of([walk(length_m)]).reason
    assert reason[12] is (Reason.OUTLIER if is_outlier else Reason.USED)
    assert all(r is Reason.USED for k, r in enumerate(reason) if k != 12)


@pytest.mark.parametrize(("odd_s", "is_outlier"), [(1.11, False), (1.13, True), (0.89, False), (0.87, True)])
def test_even_strides_may_differ_by_an_eighth(odd_s: float, is_outlier: bool) -> None:
    """Where the others are all alike, a stride may take 12 % more or less."""
    stride_s = np.ones(16)
    stride_s[8] = odd_s
    assert (strides_of([walk(np.ones(16), stride_s)]).reason[8] is Reason.OUTLIER) == is_outlier


def test_with_a_shank_alone_swing_is_swing_and_stance_unknown() -> None:
    site = Site.RIGHT_SHANK
    made = simulation_of(WalkerSettings(sites=(site,), recordings=(Standing(), Walk())))
    standing, moving = made.session.recordings
    found = gait_of_shank(foot_of(moving.imu[site], bias_of(standing.imu[site])))
    events = made.truth.recordings[moving.name].feet[Side.RIGHT].events
    mid_swing = 0.5 * (events.toe_off_s + events.initial_contact_s)[1:-1]
    mid_stance = 0.5 * (events.initial_contact_s[1:-1] + events.toe_off_s[2:])
    assert len(mid_swing) >= 6
    assert {str(PHASES[k]) for k in phases_at(mid_swing, [found])} == {"swing"}
    assert {str(PHASES[k]) for k in phases_at(mid_stance, [found])} == {""}


def test_with_a_foot_the_phases_follow_its_events() -> None:
    """The events of each stride of `walk`: contact at 0, full contact 0.1, heel rise 0.4 and toe-off 0.68 of 1.1 s."""
    events = walk(np.ones(4))
    since_s = np.array([0.05, 0.2, 0.5, 0.8])
    for number in range(1, 4):
        named = phases_at(1.0 + 1.1 * number + since_s, [events])
        assert [str(PHASES[k]) for k in named] == ["loading", "foot_flat", "pre_swing", "swing"]
    unknown = np.full(len(events), np.nan)
    without = replace(events, heel_rise_s=unknown, full_contact_s=unknown, is_from_shank=True)
    assert [str(PHASES[k]) for k in phases_at(2.1 + since_s, [without])] == ["", "", "", "swing"]
