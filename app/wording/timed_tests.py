"""What is stated about a timed test, on the screen and on paper: its name, its result, what is missing and how sure it
is.

A sentence comes from what was measured: without a time no time is reported, without a tape nothing is compared with
one.
"""

import math

from app.wording.body import name_of
from app.wording.numbers import clock
from app.wording.translation import figure_text, joined, later, tr, tr_n
from core.timed.found import NotMeasured, TimedTest
from core.timed.protocols import DEFINITIONS, KnownError, PlannedTest, TimedProtocol

ALLOWED_PERCENT = 3.0  # more than that off the tape, the sensors' distance is not to be read
DAGGER = "\N{DAGGER}"
TIMES = "\N{MULTIPLICATION SIGN}"


def name_of_test(protocol: TimedProtocol) -> str:
    """What a test is called."""
    return {
        TimedProtocol.TEN_METRES: tr("10-metre walk"),
        TimedProtocol.TWO_MINUTES: tr("2-minute walk"),
        TimedProtocol.SIX_MINUTES: tr("6-minute walk"),
        TimedProtocol.UP_AND_GO: tr("Timed Up and Go"),
        TimedProtocol.SIT_TO_STAND: tr("5 {times} sit to stand").format(times=TIMES),
        TimedProtocol.STAIRS: tr("Stairs"),
    }[protocol]


def planned_words(planned: PlannedTest | None) -> str:
    """Which test a walk is, with the instants of its keys: "10-metre walk, key at the start: 3.2 s"."""
    if planned is None:
        return tr("no test")
    stated = [name_of_test(planned.protocol)]
    if planned.start_key_s is not None:
        stated.append(tr("start key pressed at {at:.1f} s").format(at=planned.start_key_s))
    if planned.end_key_s is not None:
        stated.append(tr("end key pressed at {at:.1f} s").format(at=planned.end_key_s))
    return ", ".join(stated)


def start_words(protocol: TimedProtocol) -> str:
    """What starts the clock where no key does."""
    if protocol is TimedProtocol.TEN_METRES:
        return tr("after standing still for 1 s and walking 2 m")
    if DEFINITIONS[protocol].is_from_chair:
        return tr("when the thighs leave the seat")
    return tr("first step after standing still for 1 s")


def end_words(protocol: TimedProtocol) -> str:
    """What ends it where no key does."""
    return {
        TimedProtocol.TEN_METRES: tr("10 m further on, by the sensors"),
        TimedProtocol.TWO_MINUTES: tr("after 2:00 min"),
        TimedProtocol.SIX_MINUTES: tr("after 6:00 min"),
        TimedProtocol.UP_AND_GO: tr("seated again"),
        TimedProtocol.SIT_TO_STAND: tr("standing for the fifth time"),
        TimedProtocol.STAIRS: tr("when the last step ends"),
    }[protocol]


def reason_words(reason: NotMeasured) -> str:
    """Why something is missing, as a clause."""
    return {
        NotMeasured.NO_FEET: tr("no foot sensor was worn"),
        NotMeasured.NO_THIGHS: tr(
            "no thigh sensor had a continuous signal, or the patient did not stand still before the test"
        ),
        NotMeasured.NO_START: tr("the patient did not stand still for 1 s before the first step"),
        NotMeasured.NO_RISE: tr("no rise from the chair was detected"),
        NotMeasured.NOT_FINISHED: tr("the recording ended before the test was finished"),
        NotMeasured.SILENT: tr("a foot sensor had no signal"),
    }[reason]


def seconds(value: float) -> str:
    """A time as it is written: "8.9 s", "2:00"."""
    return clock(value) if value >= 100.0 else f"{figure_text(value, '.1f')} s"


def result_sentence(test: TimedTest) -> str:
    """The one sentence of a test: its name and what it is made for."""
    name = name_of_test(test.protocol)
    if not math.isfinite(test.time_s):
        return tr("{test}: time not measured.").format(test=name)
    stated = []
    if test.definition.duration_s is not None and math.isfinite(test.distance_m):
        stated = [f"{test.distance_m:.0f} m", f"{figure_text(test.speed_m_s, '.2f')} m/s"]
    elif test.protocol is TimedProtocol.TEN_METRES and math.isfinite(test.speed_m_s):
        stated = [f"{figure_text(test.speed_m_s, '.2f')} m/s", f"{figure_text(test.time_s, '.1f')} s"]
    elif test.definition.duration_s is None:
        stated = [f"{figure_text(test.time_s, '.1f')} s"]
    if not stated:
        return tr("{test}: distance not measured.").format(test=name)
    return tr("{test}: {figures}.").format(test=name, figures=", ".join(stated))


def why_sentence(test: TimedTest) -> str:
    """What is missing, and why; empty where nothing is."""
    if not test.missing:
        return ""
    reasons = [
        tr("the {site} sensor had no signal from {start:.1f} to {end:.1f} s").format(
            site=name_of(one.site), start=one.start_s, end=one.end_s
        )
        for one in test.silences
    ]
    reasons += [reason_words(one) for one in test.missing if one is not NotMeasured.SILENT]
    if not math.isfinite(test.time_s):
        return tr("Time not reported: {reason}.").format(reason=joined(reasons))
    if math.isfinite(test.distance_m):
        return tr("Sensor distance not reported: {reason}.").format(reason=joined(reasons))
    return tr("Distance not reported: {reason}.").format(reason=joined(reasons))


def tape_sentence(test: TimedTest) -> str:
    """How the sensors' distance compares with the tape's; empty where no key marked where the tape is."""
    apart_m = test.tape_difference_m
    if not math.isfinite(apart_m):
        return ""
    share = 100.0 * apart_m / test.distance_m
    reported = tr("The sensors measured {own:.2f} m, {apart:+.2f} m compared with the tape ({tape:.2f} m)").format(
        own=test.sensor_distance_m, apart=apart_m, tape=test.distance_m
    )
    if round(abs(share), 6) <= ALLOWED_PERCENT:
        return tr("{reported}; within the 3 % limit.").format(reported=reported)
    return tr("{reported}; beyond the 3 % limit. Check the position of the tape.").format(reported=reported)


def pauses_sentence(test: TimedTest) -> str:
    """How often and how long the patient stood still; empty where nobody did."""
    if not test.pauses_s:
        return ""
    total_s = sum(end - start for start, end in test.pauses_s)
    reported = tr_n("{count} pause, {total:.1f} s.", "{count} pauses, {total:.1f} s in total.", len(test.pauses_s))
    return reported.format(count=len(test.pauses_s), total=total_s)


def stairs_sentence(test: TimedTest) -> str:
    """How many strides led up and down, and how long they took; empty where none did."""
    stated = []
    for is_up, words in (
        (True, tr("strides up: {count}, mean duration {time:.2f} s")),
        (False, tr("strides down: {count}, mean duration {time:.2f} s")),
    ):
        times_s = [one.end_s - one.start_s for one in test.stairs if one.is_up is is_up]
        if times_s:
            stated.append(words.format(count=len(times_s), time=sum(times_s) / len(times_s)))
    return (
        tr("Strides on stairs are excluded from the means of walking: {strides}.").format(strides="; ".join(stated))
        if stated
        else ""
    )


def course_sentence(test: TimedTest) -> str:
    """How the speed changed from the first to the last third of a test of a set time; empty where it is not known."""
    speeds = [one.speed_m_s for one in test.thirds]
    if test.definition.duration_s is None or len(speeds) < 2 or not all(math.isfinite(one) for one in speeds):
        return ""
    return tr("Speed: {first:.2f} m/s in the first third, {last:.2f} m/s in the last third.").format(
        first=speeds[0], last=speeds[-1]
    )


MEASURED = {  # what the sources of errors measured, by their words in files
    "six minutes by sensors in insoles": later("6-minute walk, insole sensors"),
    "six minutes by a rater": later("6-minute walk, human rater"),
}


def error_words(error: KnownError) -> str:
    """What is known of the error of one quantity, with its source; what was not verified has a dagger."""
    mark = "" if error.is_verified else DAGGER
    most, least = figure_text(error.high, "g"), figure_text(error.low, "g")
    span = tr("up to {most}").format(most=most) if error.low == 0.0 else f"{least}\N{EN DASH}{most}"
    what = {
        "distance_m": tr("Distance error: {span} m{mark}, {source}."),
        "distance_percent": tr("Distance error: {span} %{mark}, {source}."),
        "time_s": tr("Time error: {span} s{mark}, {source}."),
    }[error.quantity]
    return what.format(span=span, mark=mark, source=_source_words(error))


def _source_words(error: KnownError) -> str:
    """The source of an error: of a paper what was measured, and the paper as it is cited."""
    if error.courses:
        return tr("worst of {count} simulated runs").format(count=error.courses)
    return ", ".join(filter(None, [tr(MEASURED[error.how]) if error.how else "", error.paper]))
