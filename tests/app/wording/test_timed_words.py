"""What is stated about a timed test: each sentence where it must come, and where it must not."""

import math
import re
from dataclasses import replace

import pytest

from app.wording.timed_tests import (
    course_sentence,
    end_words,
    error_words,
    instruction,
    name_of_test,
    not_valid_sentence,
    pauses_sentence,
    planned_words,
    reason_words,
    remedy_sentence,
    result_sentence,
    slowest_sentence,
    source_sentence,
    stairs_sentence,
    tape_sentence,
    why_sentence,
)
from app.wording.translation import use_language
from core.body import Side, Site
from core.timed.found import DistanceSource, NotMeasured, NotValid, Rise, Silence, StairStride, TimedPart, TimedTest
from core.timed.protocols import DEFINITIONS, KnownError, PlannedTest, TimedProtocol

TEN = TimedTest(TimedProtocol.TEN_METRES, 3.0, 11.9, False, False, 10.0, 10.0, 105.0, (), (), (), (), (), (), ())
TWO = replace(
    TEN,
    protocol=TimedProtocol.TWO_MINUTES,
    end_s=123.0,
    distance_m=132.4,
    sensor_distance_m=132.4,
    thirds=tuple(TimedPart(0.0, 40.0, metres, metres / 40.0, 100.0) for metres in (48.0, 44.0, 40.4)),
)


def test_the_result_is_what_the_test_is_made_for() -> None:
    assert result_sentence(TEN) == "10-metre walk: 1.12 m/s, 8.9 s."
    assert result_sentence(TWO) == "2-minute walk: 132 m, 1.10 m/s."
    chair = replace(TEN, protocol=TimedProtocol.SIT_TO_STAND, distance_m=math.nan)
    assert result_sentence(chair) == "5 × sit to stand: 8.9 s."
    assert result_sentence(replace(TWO, distance_m=math.nan)) == "2-minute walk: distance not measured."
    assert result_sentence(replace(TEN, end_s=math.nan)) == "10-metre walk: time not measured."


def test_what_is_missing_is_stated_with_its_reason_and_nothing_else_is() -> None:
    assert why_sentence(TEN) == ""
    silent = replace(
        TWO, distance_m=math.nan, missing=(NotMeasured.SILENT,), silences=(Silence(Site.LEFT_FOOT, 50.0, 55.0),)
    )
    assert why_sentence(silent).startswith("Distance not reported: the L foot sensor had no signal ")
    assert "from 50.0 to 55.0 s" in why_sentence(silent)
    taped = replace(silent, protocol=TimedProtocol.TEN_METRES, distance_m=10.0, is_end_by_key=True)
    assert why_sentence(taped).startswith("Sensor distance not reported: the L foot sensor had no signal ")
    unfinished = replace(TEN, end_s=math.nan, missing=(NotMeasured.NOT_FINISHED,))
    assert why_sentence(unfinished) == "Time not reported: the recording ended before the test was finished."
    assert len({reason_words(one) for one in NotMeasured}) == len(NotMeasured)


@pytest.mark.parametrize(("own_m", "is_allowed"), [(10.3, True), (9.71, True), (10.31, False), (9.6, False)])
def test_the_tape_is_compared_where_a_key_reported_where_it_is(own_m: float, is_allowed: bool) -> None:
    keyed = replace(TEN, is_end_by_key=True, sensor_distance_m=own_m)
    assert f"{own_m:.2f} m, {own_m - 10.0:+.2f} m compared with the tape (10.00 m)" in tape_sentence(keyed)
    assert ("Check the position of the tape" in tape_sentence(keyed)) is not is_allowed
    assert tape_sentence(replace(keyed, is_end_by_key=False)) == ""
    assert tape_sentence(replace(keyed, sensor_distance_m=math.nan)) == ""
    assert tape_sentence(replace(TWO, is_end_by_key=True)) == ""  # no tape is its end


def test_pauses_and_the_course_are_reported_where_there_are_any() -> None:
    assert pauses_sentence(TWO) == ""
    assert pauses_sentence(replace(TWO, pauses_s=((10.0, 13.0),))) == "1 pause, 3.0 s."
    assert pauses_sentence(replace(TWO, pauses_s=((10.0, 13.0), (20.0, 21.5)))) == "2 pauses, 4.5 s in total."
    assert course_sentence(TWO) == "Speed: 1.20 m/s in the first third, 1.01 m/s in the last third."
    assert course_sentence(replace(TWO, thirds=())) == ""
    unknown = replace(TWO.thirds[2], speed_m_s=math.nan)
    assert course_sentence(replace(TWO, thirds=(*TWO.thirds[:2], unknown))) == ""
    assert course_sentence(replace(TEN, thirds=TWO.thirds)) == ""


def test_strides_on_stairs_are_reported_apart_where_there_are_some() -> None:
    assert stairs_sentence(TEN) == ""
    strides = tuple(StairStride(Side.LEFT, 0.0, 1.5, climb_m) for climb_m in (0.3, 0.3, -0.3))
    reported = stairs_sentence(replace(TEN, protocol=TimedProtocol.STAIRS, stairs=strides))
    assert reported == "Strides on stairs: 2 up, 1 down; excluded from the means of walking."


def test_an_error_that_was_not_verified_has_a_dagger() -> None:
    assert error_words(KnownError("time_s", 0.0, 0.2, paper="us", is_verified=True)) == "Time error: up to 0.2 s, us."
    assert error_words(KnownError("distance_m", 16.0, 39.0, paper="a paper")) == "Distance error: 16–39 m†, a paper."
    every = [error_words(one) for known in DEFINITIONS.values() for one in known.errors]
    assert all(every)


def test_a_planned_test_is_reported_with_its_keys() -> None:
    assert planned_words(None) == "no test"
    assert planned_words(PlannedTest(TimedProtocol.TEN_METRES)) == "10-metre walk"
    keyed = PlannedTest(TimedProtocol.TEN_METRES, 3.0, 12.25)
    assert planned_words(keyed) == "10-metre walk, start key pressed at 3.0 s, end key pressed at 12.2 s"
    assert len({name_of_test(one) for one in TimedProtocol}) == len(TimedProtocol)


def test_the_known_errors_are_reported_in_german_with_a_comma() -> None:
    use_language("de")
    try:
        every = " ".join(error_words(one) for known in DEFINITIONS.values() for one in known.errors)
    finally:
        use_language("en")
    assert not re.search(r"\b(worst|simulated|minutes|rater)\b", every)
    assert "bis zu 1,2 %, schlechtester von 60 simulierten Durchgängen" in every


@pytest.mark.parametrize("protocol", TimedProtocol)
def test_how_a_test_is_done_and_ends_names_the_course_as_it_was_entered(protocol: TimedProtocol) -> None:
    own = instruction(PlannedTest(protocol)), end_words(PlannedTest(protocol))
    assert all(own)
    assert "{" not in "".join(own)
    if protocol is TimedProtocol.TEN_METRES:
        assert own[0].startswith("A straight 14 m: 2 m run-in, 10 m timed")
        six = PlannedTest(protocol, course_m=6.0)
        assert instruction(six).startswith("A straight 10 m: 2 m run-in, 6 m timed")
        assert end_words(six) == "6 m further on, by the sensors"


UP = replace(
    TEN, protocol=TimedProtocol.UP_AND_GO, course_m=3.0, course_found_m=6.6, sensor_distance_m=13.34, distance_m=13.34
)


@pytest.mark.parametrize(
    ("reasons", "sentence"),
    [
        ((NotValid.COURSE_LONGER,), "Not valid: 6.6 m from the chair to the turn, the course is 3 m."),
        (
            (NotValid.COURSE_LONGER, NotValid.NO_TURN, NotValid.ELSEWHERE),
            "Not valid: 13.3 m walked without a turn, the course turns at 3 m.",
        ),
        ((NotValid.COURSE_LONGER, NotValid.NO_RISE), "Not valid: no rise from the chair."),
        ((), ""),
    ],
)
def test_a_test_that_is_not_valid_is_stated_by_its_gravest_reason(reasons: tuple[NotValid, ...], sentence: str) -> None:
    test = replace(UP, not_valid=reasons)
    assert not_valid_sentence(test) == sentence
    assert bool(remedy_sentence(test)) is bool(reasons)


@pytest.mark.parametrize("reason", NotValid)
def test_every_reason_has_its_words_and_what_to_do(reason: NotValid) -> None:
    test = replace(UP, not_valid=(reason,))
    assert not_valid_sentence(test).startswith("Not valid: ")
    assert "{" not in not_valid_sentence(test) + remedy_sentence(test)
    assert remedy_sentence(test)


def test_the_source_of_a_distance_is_stated_of_a_set_time_alone() -> None:
    assert source_sentence(TWO) == "Distance: foot sensors."
    typed = replace(TWO, distance_source=DistanceSource.TYPED, course_m=20.0, sensor_distance_m=131.6)
    assert source_sentence(typed) == "Distance: laps entered, 20 m each; the foot sensors measured 132 m."
    assert source_sentence(replace(typed, sensor_distance_m=math.nan)) == "Distance: laps entered, 20 m each."
    assert source_sentence(replace(TWO, distance_m=math.nan)) == ""
    assert source_sentence(UP) == ""


def test_the_slowest_of_several_rises_is_named() -> None:
    rises = tuple(Rise(3.0 * k, 3.0 * k + lasts_s) for k, lasts_s in enumerate((1.1, 1.4, 1.2)))
    five = replace(TEN, protocol=TimedProtocol.SIT_TO_STAND, rises=rises)
    assert slowest_sentence(five) == "Slowest rise: number 2, 1.40 s."
    assert slowest_sentence(replace(five, rises=rises[:1])) == ""
    assert slowest_sentence(replace(UP, rises=rises[:1])) == ""
