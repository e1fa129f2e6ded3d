"""What is stated about a timed test: each sentence where it must come, and where it must not."""

import math
import re
from dataclasses import replace

import pytest
from syrupy.assertion import SnapshotAssertion

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


UP = replace(
    TEN, protocol=TimedProtocol.UP_AND_GO, course_m=3.0, course_found_m=6.6, sensor_distance_m=13.34, distance_m=13.34
)


SILENT = replace(
    TWO, distance_m=math.nan, missing=(NotMeasured.SILENT,), silences=(Silence(Site.LEFT_FOOT, 50.0, 55.0),)
)
KEYED = replace(TEN, is_end_by_key=True)
TYPED = replace(TWO, distance_source=DistanceSource.TYPED, course_m=20.0, sensor_distance_m=131.6)
STRIDES = tuple(StairStride(Side.LEFT, 0.0, 1.5, climb_m) for climb_m in (0.3, 0.3, -0.3))
RISES = tuple(Rise(3.0 * k, 3.0 * k + lasts_s) for k, lasts_s in enumerate((1.1, 1.4, 1.2)))
CHAIR = replace(TEN, protocol=TimedProtocol.SIT_TO_STAND, distance_m=math.nan)
OF_UNKNOWN_SPEED = replace(TWO.thirds[2], speed_m_s=math.nan)
TESTS = {
    "10 metres": TEN,
    "not finished": replace(TEN, end_s=math.nan, missing=(NotMeasured.NOT_FINISHED,)),
    "10 metres have no thirds": replace(TEN, thirds=TWO.thirds),
    "2 minutes": TWO,
    "2 minutes, distance unknown": replace(TWO, distance_m=math.nan),
    "2 minutes, a sensor was silent": SILENT,
    "10 metres, a sensor was silent": replace(
        SILENT, protocol=TimedProtocol.TEN_METRES, distance_m=10.0, is_end_by_key=True
    ),
    "one pause": replace(TWO, pauses_s=((10.0, 13.0),)),
    "two pauses": replace(TWO, pauses_s=((10.0, 13.0), (20.0, 21.5))),
    "without thirds": replace(TWO, thirds=()),
    "a third of unknown speed": replace(TWO, thirds=(*TWO.thirds[:2], OF_UNKNOWN_SPEED)),
    "laps entered": TYPED,
    "laps entered, sensors without a distance": replace(TYPED, sensor_distance_m=math.nan),
    **{f"tape 10 m, sensors {own_m} m": replace(KEYED, sensor_distance_m=own_m) for own_m in (10.3, 9.71, 10.31, 9.6)},
    "tape, sensors without a distance": replace(KEYED, sensor_distance_m=math.nan),
    "no tape is the end of 2 minutes": replace(TWO, is_end_by_key=True),
    "stairs": replace(TEN, protocol=TimedProtocol.STAIRS, stairs=STRIDES),
    "a chair": CHAIR,
    "the slowest of several rises": replace(CHAIR, rises=RISES),
    "of one rise there is no slowest": replace(CHAIR, rises=RISES[:1]),
    "up and go": replace(UP, rises=RISES[:1]),
    **{f"not valid: {reason}": replace(UP, not_valid=(reason,)) for reason in NotValid},
    "no turn is graver than a longer course": replace(
        UP, not_valid=(NotValid.COURSE_LONGER, NotValid.NO_TURN, NotValid.ELSEWHERE)
    ),
    "no rise is graver than a longer course": replace(UP, not_valid=(NotValid.COURSE_LONGER, NotValid.NO_RISE)),
}
SENTENCES = (
    *(result_sentence, why_sentence, tape_sentence, pauses_sentence, course_sentence),
    *(stairs_sentence, not_valid_sentence, remedy_sentence, source_sentence, slowest_sentence),
)


def test_each_sentence_is_stated_where_it_must_come_and_nowhere_else(snapshot: SnapshotAssertion) -> None:
    stated = {
        case: {of.__name__: sentence for of in SENTENCES if (sentence := of(test))} for case, test in TESTS.items()
    }
    assert stated == snapshot
    assert len({reason_words(one) for one in NotMeasured}) == len(NotMeasured)


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
