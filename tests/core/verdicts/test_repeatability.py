"""A clinic's own error figures: found within their limits, refused of too few people, used only where chosen."""

import json
import math
from collections.abc import Iterator

import numpy as np
import pytest

from core.body import Side
from core.parameters import KNEE_RANGE, SPEED, STANCE, QuantityKind
from core.verdicts.measurement_error import Mark, compare
from core.verdicts.model import READ
from core.verdicts.own_figures import (
    MIN_PEOPLE,
    Between,
    OwnEstimate,
    OwnFigures,
    OwnSigma,
    figures_from_json,
    figures_from_text,
    figures_in_json,
)
from core.verdicts.repeatability import Strapping, TooFewPeopleError, repeatability_of
from core.verdicts.sigmas import PUBLISHED, SIGMAS, ComparisonKind, healthy_between_legs, in_use, sigma_of, using
from core.verdicts.stride_means import MeanOfStrides
from tests.benchmarks.repeatability import coverage, person

COLUMNS = {QuantityKind.STANCE: (STANCE,), QuantityKind.KNEE_SHAPE: (KNEE_RANGE, "knee_while_loading_deg")}
LEGS, STRAPPINGS, VISITS = ComparisonKind.LEGS, ComparisonKind.STRAPPINGS, ComparisonKind.VISITS


def study(people: int, factor: float = 1.0, seed: int = 1, times: int = 2) -> OwnFigures:
    rng = np.random.default_rng(seed)
    return repeatability_of([person(COLUMNS, factor, 20, rng, times) for _ in range(people)])


def own(factor: float, between: Between = Between.STRAPPINGS, healthy: float = 4.0) -> OwnFigures:
    return OwnFigures(
        20,
        between,
        {kind: OwnSigma(OwnEstimate(factor, factor, factor, 20), 60.0, 1.0) for kind in QuantityKind},
        {STANCE: OwnEstimate(healthy, healthy, healthy, 20)},
        ("2026-11-10", "2026-11-12"),
    )


def strapping(left: float, right: float, u: float = 0.2, n: int = 20, **more: str) -> Strapping:
    means = {side: MeanOfStrides(mean, 1.0, n, u, 0.0) for side, mean in zip(Side, (left, right), strict=True)}
    return Strapping({(side, STANCE): mean for side, mean in means.items()}, {}, 1.2, **more)


@pytest.fixture(autouse=True)
def _published_again() -> Iterator[None]:
    yield
    assert in_use() is PUBLISHED


def test_the_limits_hold_the_true_figures_of_drawn_clinics() -> None:
    found = coverage(COLUMNS, clinics=40, people=20, n=20, seed=4)
    assert {"stance", "knee_shape", f"between legs: {STANCE}"} <= set(found)
    assert {name: share for name, share in found.items() if share < 0.85} == {}


def test_limits_that_leave_out_the_chance_of_strides_would_miss_the_true_figures() -> None:
    """With four times the error of a mean that its strides had, what is left is too small: the test can fail."""
    means = [
        [strapping(60 + d, 60 - d, u=0.8), strapping(60 - d, 60 + d, u=0.8)] for d in (0.4, 0.6, 0.5, 0.7, 0.3, 0.5)
    ]
    sure = [
        [strapping(60 + d, 60 - d, u=0.0), strapping(60 - d, 60 + d, u=0.0)] for d in (0.4, 0.6, 0.5, 0.7, 0.3, 0.5)
    ]
    one, other = (repeatability_of(people).sigmas[QuantityKind.STANCE].factor for people in (means, sure))
    assert one.value == 0.0 < other.value


def test_the_figure_is_the_root_mean_square_of_what_attachments_differ_by_less_chance() -> None:
    apart = (1.0, -2.0, 0.5, 1.5, -0.7)
    people = [[strapping(60 + d, 60), strapping(60, 60 - d)] for d in apart]
    square = sum(d * d for d in apart) / len(apart) / 2 - 0.2**2
    found = repeatability_of(people)
    assert found.sigmas[QuantityKind.STANCE].sigma.value == pytest.approx(math.sqrt(square))
    legs = 1.96 * math.sqrt(sum(d * d for d in apart) / len(apart) - 2 * 0.2**2)
    assert found.healthy[STANCE].value == pytest.approx(legs)


def test_fewer_than_five_people_are_refused_and_fewer_than_ten_are_preliminary() -> None:
    with pytest.raises(TooFewPeopleError) as refusal:
        study(MIN_PEOPLE - 1)
    assert refusal.value.people == 4
    assert study(MIN_PEOPLE).is_preliminary
    assert not study(10).is_preliminary


def test_people_who_came_once_or_walked_too_few_strides_do_not_count() -> None:
    five = [[strapping(60 + d, 60), strapping(60, 60 - d)] for d in (1.0, -2.0, 0.5, 1.5, -0.7)]
    once, few = [strapping(50, 70)], [strapping(50, 70, n=9), strapping(70, 50, n=9)]
    assert repeatability_of(five).sigmas == repeatability_of([*five, once]).sigmas
    assert repeatability_of([*five, few]).sigmas[QuantityKind.STANCE].factor.people == 5
    other = [strapping(50, 70, condition="slow"), strapping(70, 50, condition="fast")]
    assert repeatability_of([*five, other]).people == 5


def test_a_third_attachment_makes_the_limits_closer() -> None:
    two, three = (study(12, times=times).sigmas[QuantityKind.STANCE].factor for times in (2, 3))
    assert three.high / three.low < two.high / two.low


def test_a_study_is_of_days_only_if_nobody_came_twice_on_one() -> None:
    apart = (1.0, -2.0, 0.5, 1.5, -0.7)
    days = [[strapping(60 + d, 60, day="2026-11-10"), strapping(60, 60 - d, day="2026-11-12")] for d in apart]
    same = [[strapping(60 + d, 60, day="2026-11-10"), strapping(60, 60 - d, day="2026-11-10")] for d in apart]
    found = repeatability_of(days)
    assert (found.between, found.days) == (Between.DAYS, ("2026-11-10", "2026-11-12"))
    assert repeatability_of([*days, *same]).between is Between.STRAPPINGS
    assert (
        repeatability_of([[strapping(60 + d, 60), strapping(60, 60 - d)] for d in apart]).between is Between.STRAPPINGS
    )


def test_differences_are_judged_by_the_figures_in_use_and_then_as_published_again() -> None:
    one, other = MeanOfStrides(64.0, 1.0, 20, 0.1, 0.0), MeanOfStrides(60.5, 1.0, 20, 0.1, 0.0)

    def exceeds() -> bool:
        return compare(STANCE, STRAPPINGS, one, other, (READ, READ)).exceeds

    assert exceeds()
    with using(own(2.0).figures):
        assert not exceeds()
        assert in_use().study is not None
    assert exceeds()


def test_the_own_limit_between_legs_decides_the_mark() -> None:
    one, other = MeanOfStrides(64.0, 1.0, 20, 0.1, 0.0), MeanOfStrides(59.0, 1.0, 20, 0.1, 0.0)

    def mark() -> Mark:
        return compare(STANCE, LEGS, one, other, (READ, READ)).mark

    assert mark() is Mark.HEALTHY
    with using(own(1.0, healthy=6.0).figures):
        assert mark() is Mark.ERROR


def test_a_study_of_one_day_does_not_lower_what_lies_between_visits() -> None:
    def between(kind: ComparisonKind) -> float:
        sigma = sigma_of(STANCE, kind)
        assert sigma is not None
        return sigma.of(60.0, 1.2)

    with using(own(0.8).figures):
        assert between(VISITS) == pytest.approx(1.1)
        assert between(STRAPPINGS) == pytest.approx(0.8 * 1.1)
    with using(own(0.8, Between.DAYS).figures):
        assert between(VISITS) == pytest.approx(0.8 * 1.1)
    with using(own(2.0).figures):
        assert between(VISITS) == pytest.approx(2.2)


def test_a_study_that_shows_nothing_beyond_chance_is_not_taken_for_one_that_shows_nothing() -> None:
    """Judged by half of the upper limit, where few people leave more open; of 20 people by the figures as they are."""
    nothing = OwnEstimate(0.0, 0.0, 1.6, 5)
    few = OwnFigures(5, Between.DAYS, {QuantityKind.STANCE: OwnSigma(nothing, 60.0, 1.1)}, {STANCE: nothing})
    with using(few.figures):
        sigma = sigma_of(STANCE, VISITS)
        assert sigma is not None
        assert sigma.of(60.0, 1.2) == pytest.approx(0.8 * 1.1)
        assert healthy_between_legs(STANCE) == pytest.approx(0.8)
    many = study(20).sigmas[QuantityKind.STANCE].factor
    assert many.judged_by == many.value


def test_attaching_again_never_counts_for_less_than_leaving_on_nor_slow_walks_for_less_than_published() -> None:
    with using(own(0.0, Between.DAYS).figures):
        sigma = sigma_of(STANCE, VISITS)
        assert sigma is not None
        assert sigma.of(60.0, 1.2) == pytest.approx(SIGMAS[ComparisonKind.ATTACHED][QuantityKind.STANCE].constant)
        assert sigma.of(60.0, 0.5) == pytest.approx(1.5)


def test_an_excursion_of_8_degrees_and_one_of_60_keep_their_own_sizes() -> None:
    with using(own(2.0, Between.DAYS).figures):
        sigma = sigma_of(KNEE_RANGE, VISITS)
        assert sigma is not None
        assert (sigma.of(8.0), sigma.of(60.0)) == pytest.approx((2 * math.hypot(1.2, 0.344), 2 * math.hypot(1.2, 2.58)))


def test_what_no_study_found_stays_as_published() -> None:
    with using(study(6).figures):
        assert sigma_of("foot_heel_rise_deg", VISITS) == PUBLISHED.sigmas[VISITS][QuantityKind.HEEL_RISE]
        assert sigma_of(SPEED, VISITS) == PUBLISHED.sigmas[VISITS][QuantityKind.SPEED]
        assert in_use().sigmas[ComparisonKind.ATTACHED] is PUBLISHED.sigmas[ComparisonKind.ATTACHED]


def test_the_file_gives_back_what_was_found() -> None:
    found = study(12)
    again = figures_from_text(json.dumps(figures_in_json(found), allow_nan=False))
    stance = QuantityKind.STANCE
    assert again.sigmas[stance].sigma == pytest.approx(found.sigmas[stance].sigma)
    assert (set(again.sigmas), again.people, again.between) == (set(found.sigmas), 12, Between.STRAPPINGS)
    assert again.healthy == found.healthy


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("format",), "gaitwright-analysis/1"),
        (("people",), 4),
        (("people",), True),
        (("between",), "years"),
        (("sigmas",), None),
        (("sigmas", "stance", "sigma"), math.nan),
        (("sigmas", "stance", "sigma"), -1.0),
        (("sigmas", "stance", "sigma"), "1.1"),
        (("sigmas", "stance", "low"), 900.0),
        (("sigmas", "stance", "published"), 0.0),
        (("between_legs", STANCE), {}),
    ],
)
def test_a_file_that_is_none_is_refused(path: tuple[str, ...], value: object) -> None:
    content = figures_in_json(study(12))
    place = content
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    with pytest.raises(ValueError, match=r"figure|people|Between|gaitwright-repeat"):
        figures_from_json(content)
