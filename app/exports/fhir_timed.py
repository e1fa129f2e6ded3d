"""A timed test as an Observation: its result, and what else was measured of it as components."""

import math

from app.exports.fhir_codes import NOT_PERFORMED, NOT_REPORTED, TESTS, Resource, code_of, quantity
from app.exports.figures import unit_of
from app.wording.timed_tests import name_of_test, reason_words
from app.wording.translation import capitalised
from core.body import Side
from core.results import RecordingAnalysis
from core.timed.found import NotMeasured, TimedTest
from core.timed.protocols import TimedProtocol
from core.verdicts.model import Verdict

# what a test is made for; a ten-metre walk, for a speed
RESULTS = {
    TimedProtocol.TEN_METRES: "speed_m_s",
    TimedProtocol.TWO_MINUTES: "distance_m",
    TimedProtocol.SIX_MINUTES: "distance_m",
}
OTHERS = ("time_s", "distance_m", "speed_m_s", "cadence_steps_min")
OF_PLACES = (NotMeasured.NO_FEET, NotMeasured.NO_THIGHS)  # no sensor was where it is measured


def test_observation(walk: RecordingAnalysis, test: TimedTest) -> tuple[Resource, list[str]]:
    """Give status, code, value and components of a test, and in sentences what is missing."""
    column = RESULTS.get(test.protocol, "time_s")
    value = getattr(test, column)
    reasons = [f"{capitalised(reason_words(reason))}." for reason in test.missing]
    code = code_of(f"timed_{str(test.protocol).replace(' ', '_')}_{column}", name_of_test(test.protocol))
    if test.protocol in TESTS:
        code = {**code, "coding": [TESTS[test.protocol], *code["coding"]]}
    found: Resource = {"status": _status(walk, test, column), "code": code}
    if math.isfinite(value):
        found["valueQuantity"] = quantity(value, unit_of(column))
    else:
        absent = NOT_PERFORMED if any(one in OF_PLACES for one in test.missing) else NOT_REPORTED
        found["dataAbsentReason"] = {"coding": [absent], **({"text": " ".join(reasons)} if reasons else {})}
    others = {name: getattr(test, name) for name in OTHERS if name != column}
    components: list[Resource] = [
        {"code": code_of(name), "valueQuantity": quantity(other, unit_of(name))}
        for name, other in others.items()
        if math.isfinite(other)
    ]
    for name, is_by_key in (("started_by", test.is_start_by_key), ("ended_by", test.is_end_by_key)):
        components.append({"code": code_of(name), "valueString": "key" if is_by_key else "motion"})
    return {**found, "component": components}, reasons


def _status(walk: RecordingAnalysis, test: TimedTest, column: str) -> str:
    """Final where nothing is missing and, of a distance that the feet give, no leg's distance is in doubt."""
    if any(one in OF_PLACES for one in test.missing) and not math.isfinite(getattr(test, column)):
        return "cancelled"
    is_taped = math.isfinite(test.tape_difference_m)
    doubted = [side for side in Side if walk.verdicts.leg(side).distance.verdict is not Verdict.READ]
    is_sure = column == "time_s" or is_taped or not doubted
    return "final" if is_sure and not test.missing else "preliminary"
