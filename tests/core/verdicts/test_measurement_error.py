"""Tests of the rule that calls a difference real. Every figure is worked out by hand, none is taken from the code."""

import math

import numpy as np
import pytest

from core.parameters import BY_COLUMN
from core.verdicts.measurement_error import Difference, Judgement, Mark, compare, whisker
from core.verdicts.model import NOT_MEASURED, READ, Assessment, GateReason, Verdict, assess
from core.verdicts.sigmas import HEALTHY_BETWEEN_LEGS, KINDS, SIGMAS, ComparisonKind, sigma_of
from core.verdicts.stride_means import MeanOfStrides, mean_of_strides

ATTACHED, LEGS = ComparisonKind.ATTACHED, ComparisonKind.LEGS
STRAPPINGS, VISITS = ComparisonKind.STRAPPINGS, ComparisonKind.VISITS
REPORTED = (READ, READ)


def sure(mean: float, n: int = 12) -> MeanOfStrides:
    """A mean of strides that are all alike: nothing but the table's figure makes an error."""
    return mean_of_strides(np.full(n, mean))


def difference(name: str, kind: ComparisonKind, one: float, other: float, n: int = 12) -> Difference:
    return compare(name, kind, sure(one, n), sure(other, n), REPORTED)


def test_one_mean_is_as_sure_as_its_strides_and_the_walks_parts() -> None:
    """59, 61, 59 ...: SD sqrt(10/9) = 1.05409; the correlation is negative, so 0.3 is taken.

    1.05409 / sqrt(10) x sqrt(1.3/0.7) = 0.33333 x 1.36277 = 0.45426. The halves are 59.8 and 60.2, the thirds of
    four, three and three 60, 59.667 and 60.333: no further apart than chance makes them.
    """
    found = mean_of_strides(np.array([59.0, 61.0] * 5))
    assert (found.mean, found.n) == (60.0, 10)
    assert found.sd == pytest.approx(1.05409, abs=1e-5)
    assert found.standard_error == pytest.approx(0.45426, abs=1e-5)
    assert found.drift == 0.0
    assert found.uncertainty == found.standard_error


def test_strides_that_follow_one_another_count_for_less() -> None:
    """Five of 55, then five of 65: products of adjacent ones 4 x 25 - 25 + 4 x 25 = 175 of 250, so r = 0.7.

    SD sqrt(250/9) = 5.27046; 5.27046 / sqrt(10) x sqrt(1.7/0.3) = 1.66667 x 2.38048 = 3.96746. Half of what the
    halves differ by is 5, of which chance makes sqrt(1.66667 x 3.96746): sqrt(25 - 6.61243) = 4.28807.
    """
    found = mean_of_strides(np.array([55.0] * 5 + [65.0] * 5))
    assert found.standard_error == pytest.approx(3.96746, abs=1e-4)
    assert found.drift == pytest.approx(4.28807, abs=1e-4)
    assert found.uncertainty == pytest.approx(5.84195, abs=1e-4)
    # a long ramp has 0.97 and is taken as 0.9: 29.0115 / 10 x sqrt(1.9/0.1) = 12.6458
    assert mean_of_strides(np.arange(100.0)).standard_error == pytest.approx(12.6458, abs=1e-3)


def test_a_walk_that_drifts_there_and_back_is_reported_by_its_thirds() -> None:
    """Four of 60, of 63 and of 60: both halves are 61. Of deviations -1 and 2 the squares sum to 24, adjacent ones to
    14.

    r = 0.58333; SE^2 = 24/11 / 12 x 1.58333/0.41667 = 0.69091; chance sqrt(0.18182 x 0.69091) = 0.35443.
    The thirds: 0.25 x 3^2 - 2.5 x 0.35443 = 1.36393.
    """
    assert mean_of_strides(np.repeat([60.0, 63.0, 60.0], 4)).drift == pytest.approx(1.16787, abs=1e-4)
    # six of 60 and of 62: r = 9/12, SE^2 = 0.09091 x 1.75/0.25 = 0.63636; 1 - sqrt(0.09091 x 0.63636) = 0.75948
    assert mean_of_strides(np.repeat([60.0, 62.0], 6)).drift == pytest.approx(0.87148, abs=1e-4)


def test_stance_is_not_judged_between_legs_of_which_one_rolls_over_its_toe_off() -> None:
    rolls_on = assess([GateReason("toe_off", Verdict.CARE)])
    for name, kind, expected in (
        ("stance_percent", LEGS, Judgement.NO_PUBLISHED_FIGURE),
        ("swing_percent", LEGS, Judgement.NO_PUBLISHED_FIGURE),
        ("step_time_s", LEGS, Judgement.EXCEEDS_ERROR),
    ):
        for assessments in ((rolls_on, READ), (READ, rolls_on)):
            assert compare(name, kind, sure(70.0), sure(50.0), assessments).judgement is expected, name
        assert compare(name, kind, sure(70.0), sure(50.0), REPORTED).judgement is Judgement.EXCEEDS_ERROR, name


@pytest.mark.parametrize("kind", ComparisonKind)
def test_stance_of_a_leg_that_rolls_over_its_toe_off_is_compared_with_nothing(kind: ComparisonKind) -> None:
    rolls_on = assess([GateReason("toe_off", Verdict.CARE)])
    for name in ("stance_percent", "swing_percent"):
        found = compare(name, kind, sure(70.0), sure(50.0), (rolls_on, rolls_on))
        assert (found.is_reported, found.judgement) == (False, Judgement.NO_PUBLISHED_FIGURE)
        assert compare(name, kind, sure(70.0), sure(50.0), REPORTED).is_reported
    assert compare("knee_range_deg", kind, sure(70.0), sure(50.0), (rolls_on, rolls_on)).is_reported


def test_strides_that_are_not_known_do_not_count_and_one_has_no_spread() -> None:
    assert mean_of_strides(np.array([np.nan, 59.0, 61.0, np.nan])).n == 2
    one, none = mean_of_strides(np.array([60.0])), mean_of_strides(np.empty(0))
    assert (one.mean, one.n) == (60.0, 1)
    assert math.isnan(one.uncertainty)
    assert math.isnan(none.mean)


def test_what_the_axis_leaves_open_adds_to_it() -> None:
    found = mean_of_strides(np.array([59.0, 61.0] * 5), axis_error=0.8)
    assert found.uncertainty == pytest.approx(0.91997, abs=1e-5)  # sqrt(0.45426^2 + 0.8^2)
    assert "axis" in compare("knee_range_deg", LEGS, found, found, REPORTED).sources


def test_what_the_clocks_leave_open_adds_to_it() -> None:
    found = mean_of_strides(np.array([59.0, 61.0] * 5), clock_error=0.8)
    assert found.uncertainty == pytest.approx(0.91997, abs=1e-5)  # sqrt(0.45426^2 + 0.8^2)
    assert "clock" in compare("knee_range_deg", LEGS, found, found, REPORTED).sources


def test_the_error_of_a_difference_is_that_of_both_means_and_of_what_lies_between() -> None:
    """U^2 = 2 x 0.45426^2 + 2 x 1.0^2 = 2.41270; 1.96 x 1.55329 = 3.04444."""
    values = np.array([59.0, 61.0] * 5)
    found = compare("knee_range_deg", ATTACHED, mean_of_strides(values + 3.0), mean_of_strides(values), REPORTED)
    assert found.difference == pytest.approx(3.0)
    assert found.error == pytest.approx(3.04444, abs=1e-4)
    assert found.judgement is Judgement.INSIDE_ERROR
    more = compare("knee_range_deg", ATTACHED, mean_of_strides(values + 3.1), mean_of_strides(values), REPORTED)
    assert more.judgement is Judgement.EXCEEDS_ERROR
    less = compare("knee_range_deg", ATTACHED, mean_of_strides(values), mean_of_strides(values + 3.1), REPORTED)
    assert less.difference == pytest.approx(-3.1)
    assert less.judgement is Judgement.EXCEEDS_ERROR


def test_walks_of_twenty_strides_with_the_sensors_left_on_show_a_few_degrees_apart() -> None:
    """An SD of 2.5 deg, 2 points of stance, 0.05 m in 1.3 m: what may be missed is 6 deg, 3 points, 12 %."""
    noise = np.random.default_rng(1).normal(size=(2, 20))
    noise = (noise - noise.mean(axis=1, keepdims=True)) / noise.std(axis=1, ddof=1, keepdims=True)

    def error(name: str, mean: float, sd: float) -> float:
        one, other = (mean_of_strides(mean + sd * row) for row in noise)
        return compare(name, ATTACHED, one, other, REPORTED).error

    assert 2.7719 < error("knee_range_deg", 60.0, 2.5) < 6.0
    assert 1.5245 < error("stance_percent", 62.0, 2.0) < 3.2
    assert 0.0610 < error("stride_length_m", 1.3, 0.05) < 0.12 * 1.3


def test_what_goes_with_walking_speed_is_taken_out_of_a_change() -> None:
    """Stance 65 to 61 %, 0.9 to 1.1 m/s: -5 points per m/s make -1.0 of -4; -3.0 are left.

    Its error is 1.96 x sqrt(2 x 1.1^2 + (0.3 x 1.0)^2) = 1.96 x sqrt(2.51) = 3.10521; that of all of it is
    1.96 x sqrt(2) x 1.1 = 3.04904.
    """
    found = compare("stance_percent", VISITS, sure(61.0), sure(65.0), REPORTED, speeds_m_s=(1.1, 0.9))
    assert found.error == pytest.approx(3.04904, abs=1e-4)
    assert found.by_speed is not None
    assert found.by_speed.of_speed == pytest.approx(-1.0)
    assert found.by_speed.beyond == pytest.approx(-3.0)
    assert found.by_speed.error == pytest.approx(3.10521, abs=1e-4)
    assert found.by_speed.speed_change_m_s == pytest.approx(0.2)


def test_slow_people_repeat_less_well_and_change_more_with_speed() -> None:
    """Below 0.8 m/s 1.96 x sqrt(2) x 1.5 = 4.15779, and -18 points per m/s: 0.1 m/s make -1.8."""
    found = compare("stance_percent", VISITS, sure(61.0), sure(65.0), REPORTED, speeds_m_s=(0.6, 0.5))
    assert found.error == pytest.approx(4.15779, abs=1e-4)
    assert found.by_speed is not None
    assert found.by_speed.of_speed == pytest.approx(-1.8)


@pytest.mark.parametrize(
    ("name", "speeds"),
    [
        ("stance_percent", (1.004, 1.0)),  # both are written 1.00
        ("stance_percent", (math.nan, 1.0)),
        ("stride_time_s", (1.2, 1.0)),  # no slope is known
    ],
)
def test_nothing_goes_with_a_speed_that_is_the_same_or_not_known(name: str, speeds: tuple[float, float]) -> None:
    assert compare(name, VISITS, sure(61.0), sure(65.0), REPORTED, speeds_m_s=speeds).by_speed is None


def test_between_legs_nothing_goes_with_speed() -> None:
    assert compare("stance_percent", LEGS, sure(61.0), sure(65.0), REPORTED, speeds_m_s=(1.1, 0.9)).by_speed is None


def test_swing_changes_with_speed_the_other_way_than_stance() -> None:
    stance, swing = (
        compare(name, VISITS, sure(61.0), sure(65.0), REPORTED, speeds_m_s=(1.1, 0.9)).by_speed
        for name in ("stance_percent", "swing_percent")
    )
    assert stance is not None
    assert swing is not None
    assert stance.of_speed == -swing.of_speed


def test_every_absolute_angle_is_judged_as_a_height_and_every_movement_as_a_shape() -> None:
    """By what the columns are called, not by the table: at 60 deg 4.3 % of the mean are 2.58, 4 % 2.4.

    A knee's height needs 2.77186 x hypot(2.2, 2.4) = 9.02452, its shape 2.77186 x hypot(1.2, 2.58) = 7.88709; an
    ankle's 2.77186 x 4.5 = 12.47336 and 2.77186 x 3.3 = 9.14713. The knee's straightening, which people repeat less
    well, has 2.77186 x 2.4 = 6.65246.
    """
    heights = ["at_initial_contact", "peak_deg", "minimum", "terminal_extension", "plantarflexion", "dorsiflexion"]
    heights += ["at_mid_stance", "at_toe_off"]
    angles = [name for name in BY_COLUMN if name.endswith("_deg") and not name.startswith(("hip", "pelvis", "foot"))]
    angles.remove("shank_to_foot_in_swing_deg")  # with the sensors left on alone
    assert len(angles) > 20
    for name in angles:
        is_height = any(word in name for word in heights)
        height, shape = (12.47336, 9.14713) if name.startswith("ankle") else (9.02452, 7.88709)
        expected = 6.65246 if name == "knee_straightening_deg" else height if is_height else shape
        found = compare(name, VISITS, sure(60.0), sure(60.0), REPORTED)
        assert found.error == pytest.approx(expected, abs=1e-4), name


# the error of two means that are sure: 2.77186 = 1.96 x sqrt(2), times sigma. Means are 60, or 1 s, m and m/s;
# a knee of 60 deg has hypot(1.2, 2.58) = 2.84542 and hypot(2.2, 2.4) = 3.25576. Between legs no more than what 95 of
# 100 healthy people differ by. None: not judged.
TABLE = {
    (ATTACHED, "knee_range_deg"): 2.77186,
    (ATTACHED, "ankle_range_deg"): 2.77186,
    (ATTACHED, "knee_swing_peak_deg"): 3.32623,
    (ATTACHED, "ankle_stance_dorsiflexion_deg"): 3.32623,
    (ATTACHED, "stance_percent"): 1.52452,
    (ATTACHED, "stride_time_s"): 0.06098,
    (ATTACHED, "step_time_s"): 0.06098,
    (ATTACHED, "speed_m_s"): 0.12473,
    (ATTACHED, "stride_length_m"): 0.06098,
    (ATTACHED, "foot_pitch_at_contact_deg"): 1.38593,
    (ATTACHED, "foot_heel_rise_deg"): 2.49467,
    (ATTACHED, "foot_flat_percent"): 11.08743,
    (LEGS, "knee_range_deg"): 7.88709,
    (LEGS, "ankle_range_deg"): 6.2,
    (LEGS, "knee_straightening_deg"): 2.8,
    (LEGS, "ankle_push_off_plantarflexion_deg"): 10.4,
    (LEGS, "stance_percent"): 3.04904,
    (LEGS, "foot_pitch_at_contact_deg"): 5.54372,
    (LEGS, "foot_heel_rise_deg"): 8.5,
    (LEGS, "step_time_s"): 0.04989,
    (LEGS, "stride_time_s"): None,
    (LEGS, "speed_m_s"): None,
    (LEGS, "stride_length_m"): None,
    (STRAPPINGS, "knee_range_deg"): 7.88709,
    (STRAPPINGS, "stance_percent"): 3.04904,
    (STRAPPINGS, "speed_m_s"): 0.18017,
    (VISITS, "knee_range_deg"): 7.88709,
    (VISITS, "ankle_range_deg"): 9.14713,
    (VISITS, "knee_swing_peak_deg"): 9.02452,
    (VISITS, "stance_percent"): 3.04904,
    (VISITS, "stride_time_s"): 0.07484,
    (VISITS, "speed_m_s"): 0.18017,
    (VISITS, "stride_length_m"): 0.12473,
    (VISITS, "foot_pitch_at_contact_deg"): 5.54372,
    (VISITS, "foot_heel_rise_deg"): 8.86995,
    (VISITS, "foot_flat_percent"): 13.30492,
    (ATTACHED, "clearance_m"): None,
    (VISITS, "knee_swing_peak_percent"): None,
}
UNVERIFIED = {(VISITS, "ankle_range_deg"), (LEGS, "step_time_s")}


@pytest.mark.parametrize(("kind", "name"), list(TABLE))
def test_the_errors_are_those_of_the_table(kind: ComparisonKind, name: str) -> None:
    expected = TABLE[kind, name]
    mean = 1.0 if name.endswith(("_s", "_m", "m_s")) else 60.0
    found = compare(name, kind, sure(mean), sure(mean), REPORTED)
    if expected is None:
        assert found.judgement is Judgement.NO_PUBLISHED_FIGURE
        assert math.isnan(found.error)
        assert found.difference == 0.0
        return
    assert found.error == pytest.approx(expected, abs=1e-5)
    assert found.is_unverified is ((kind, name) in UNVERIFIED)
    assert found.judgement is Judgement.INSIDE_ERROR


def test_halves_of_one_walk_differ_by_nothing_but_chance_and_drift() -> None:
    values = np.array([59.0, 61.0] * 5)
    found = compare("knee_range_deg", ComparisonKind.HALVES, mean_of_strides(values), mean_of_strides(values), REPORTED)
    assert found.error == pytest.approx(1.25914, abs=1e-4)  # 1.96 x sqrt(2) x 0.45426
    assert found.sources == ("chance", "drift")
    assert not found.is_unverified


@pytest.mark.parametrize(
    ("kind", "name", "sources"),
    [
        (ATTACHED, "knee_swing_peak_deg", ("chance", "drift", "walk_to_walk")),
        (LEGS, "knee_range_deg", ("chance", "drift", "strapping")),
        (LEGS, "knee_swing_peak_deg", ("chance", "drift", "strapping", "zero")),
        (LEGS, "stance_percent", ("chance", "drift", "event_bias")),
        (STRAPPINGS, "stance_percent", ("chance", "drift", "walk_to_walk", "strapping")),
        (VISITS, "knee_swing_peak_deg", ("chance", "drift", "walk_to_walk", "strapping", "day", "zero")),
    ],
)
def test_an_error_states_what_it_contains(kind: ComparisonKind, name: str, sources: tuple[str, ...]) -> None:
    assert difference(name, kind, 60.0, 60.0).sources == sources


def test_a_change_needs_more_for_a_sentence_and_one_with_a_goal_does_not() -> None:
    """Of an ankle: with the sensors left on the error is 2.772, and 1.75 of it 4.851."""

    def reported(apart: float, kind: ComparisonKind = ATTACHED, *, is_goal: bool = False) -> tuple[bool, bool]:
        name = "ankle_range_deg"
        found = compare(name, kind, sure(30.0 + apart), sure(30.0), REPORTED, is_chosen_before=is_goal)
        assert (found.mark is Mark.ERROR) is found.exceeds
        return found.exceeds, found.is_worth_a_sentence

    assert reported(2.7) == (False, False)
    assert reported(4.8) == (True, False)
    assert reported(4.9) == (True, True)
    assert reported(-4.9) == (True, True)
    assert reported(2.8, is_goal=True) == (True, True)
    assert reported(2.7, is_goal=True) == (False, False)
    # 9.14713 between visits and strappings; 1.25 of it 11.434, 1.5 of it 13.721
    assert reported(11.4, VISITS) == (True, False)
    assert reported(11.5, VISITS) == (True, True)
    assert reported(13.7, STRAPPINGS) == (True, False)
    assert reported(13.8, STRAPPINGS) == (True, True)


def test_legs_need_more_than_healthy_people_differ_by() -> None:
    """Stance: an error of 3.049 and a limit of 4.0; a goal changes nothing of it."""

    def marked(apart: float, *, is_goal: bool = False) -> tuple[Mark, bool]:
        found = compare("stance_percent", LEGS, sure(60.0 + apart), sure(60.0), REPORTED, is_chosen_before=is_goal)
        assert found.healthy == pytest.approx(4.0)
        return found.mark, found.is_worth_a_sentence

    assert marked(3.0) == (Mark.NONE, False)
    assert marked(3.1) == (Mark.ERROR, False)
    assert marked(3.9, is_goal=True) == (Mark.ERROR, False)
    assert marked(4.1) == (Mark.HEALTHY, True)
    assert marked(-4.1) == (Mark.HEALTHY, True)


def test_unsure_legs_need_more_than_the_healthy_limit() -> None:
    """sqrt(4.0^2 + 1.96^2 x 2 x 0.45426^2) = sqrt(16 + 1.58544) = 4.19350."""
    values = np.array([59.0, 61.0] * 5)
    one, other = mean_of_strides(values + 4.1), mean_of_strides(values)
    found = compare("stance_percent", LEGS, one, other, REPORTED)
    assert found.healthy == pytest.approx(4.19350, abs=1e-4)
    assert found.mark is Mark.ERROR


def test_whatever_is_beyond_healthy_people_is_beyond_error() -> None:
    """Else a mark would say more than the interval: attachment cannot part legs by more than it does healthy ones."""
    for name, limit in HEALTHY_BETWEEN_LEGS.items():
        for mean in (5.0, 30.0, 65.0):
            found = compare(name, LEGS, sure(mean + limit + 0.01), sure(mean), REPORTED)
            assert found.mark is Mark.HEALTHY, name
            low, high = found.interval
            assert low > 0.0, name
            assert found.difference - low == pytest.approx(high - found.difference)


def test_an_ankle_between_legs_makes_a_sentence_and_between_visits_it_keeps_its_dagger() -> None:
    legs = compare("ankle_range_deg", LEGS, sure(35.0), sure(25.0), REPORTED)
    assert (legs.mark, legs.is_worth_a_sentence, legs.is_unverified) == (Mark.HEALTHY, True, False)
    visits = compare("ankle_range_deg", VISITS, sure(36.5), sure(25.0), REPORTED)
    assert (visits.is_worth_a_sentence, visits.is_unverified) == (True, True)


def test_a_limit_is_answered_in_how_many_of_ten_measurements_it_holds() -> None:
    """8 deg with an error of 7.90149 (S = 4.03137): at least 5 deg with Phi(3/4.03137) = Phi(0.74416) = 0.7716."""
    found = compare("knee_range_deg", VISITS, sure(64.0), sure(56.0), REPORTED)
    sigma = 1.96 * math.hypot(math.hypot(1.2, 2.752), math.hypot(1.2, 2.408))
    assert found.error == pytest.approx(sigma)
    assert found.share_of_at_least(5.0) == pytest.approx(0.7716, abs=1e-3)
    assert found.share_of_at_least(8.0) == pytest.approx(0.5)
    assert math.isnan(compare("clearance_m", VISITS, sure(0.1), sure(0.2), REPORTED).share_of_at_least(0.05))


def test_every_sigma_has_a_source_with_its_people() -> None:
    found = [sigma for table in SIGMAS.values() for sigma in table.values()]
    assert len(found) > 40
    for sigma in found:
        assert sigma.source.text
        assert sigma.source.people
        # of two, nobody counted the people in what can be read
        has_people = sigma.source.n > 0 or "another laboratory" in sigma.source.people
        assert has_people or not sigma.is_verified
    assert {KINDS[name] for name in HEALTHY_BETWEEN_LEGS} <= set(SIGMAS[LEGS])


def test_under_ten_strides_nothing_is_judged_and_under_three_nothing_is_reported() -> None:
    nine = compare("knee_range_deg", LEGS, sure(60.0, 10), sure(30.0, 9), REPORTED)
    assert (nine.difference, nine.judgement) == (30.0, Judgement.TOO_FEW_STRIDES)
    assert math.isnan(nine.error)
    assert not nine.is_worth_a_sentence
    assert difference("knee_range_deg", LEGS, 60.0, 30.0, 10).judgement is Judgement.EXCEEDS_ERROR
    for n in (0, 1, 2):
        few = compare("knee_range_deg", LEGS, sure(60.0), sure(30.0, n), REPORTED)
        assert (few.judgement, few.is_reported) == (Judgement.TOO_FEW_STRIDES, False)
    assert difference("knee_range_deg", LEGS, 60.0, 30.0, 3).is_reported


@pytest.mark.parametrize("gone", [Assessment(Verdict.NOT_REPORTED), NOT_MEASURED])
def test_what_is_not_reported_has_no_difference(gone: Assessment) -> None:
    for pair in ((gone, READ), (READ, gone)):
        found = compare("knee_range_deg", LEGS, sure(60.0), sure(30.0), pair)
        assert found.judgement is Judgement.NOT_REPORTED
        assert not found.is_reported
        assert math.isnan(found.error)
        assert not found.is_worth_a_sentence
        assert found.ratio == 0.0
    assert compare("knee_range_deg", LEGS, sure(60.0), sure(30.0), (READ, Assessment(Verdict.CARE))).exceeds


def test_a_ratio_is_how_many_errors_a_difference_is_large() -> None:
    assert difference("ankle_range_deg", LEGS, 37.4, 25.0).ratio == pytest.approx(2.0)
    assert difference("speed_m_s", LEGS, 1.4, 1.0).ratio == 0.0


def test_whiskers_that_lie_apart_differ_by_more_than_the_error() -> None:
    assert whisker("knee_range_deg", VISITS, sure(60.0)) == pytest.approx(3.94355, abs=1e-4)
    assert whisker("stride_length_m", ATTACHED, sure(1.3)) == pytest.approx(0.5 * 2.77186 * 0.022, abs=1e-5)
    assert whisker("stance_percent", VISITS, sure(60.0), 0.5) == pytest.approx(0.5 * 4.15779, abs=1e-4)
    values = np.array([59.0, 61.0] * 5)
    one = mean_of_strides(values)
    reach = whisker("knee_range_deg", ATTACHED, one)
    assert reach == pytest.approx(1.52222, abs=1e-4)  # half of the 3.04444 above
    for apart in (2 * reach - 0.01, 2 * reach + 0.01):
        found = compare("knee_range_deg", ATTACHED, mean_of_strides(values + apart), one, REPORTED)
        assert found.exceeds == (apart > 2 * reach)


def test_there_is_no_whisker_where_there_is_no_spread_or_no_figure() -> None:
    assert math.isnan(whisker("knee_range_deg", LEGS, sure(60.0, 9)))
    assert math.isnan(whisker("clearance_m", ATTACHED, sure(0.1)))
    assert sigma_of("stride_time_s", LEGS) is None
