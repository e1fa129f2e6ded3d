"""What is stated about a timed test, on the screen and on paper: its name, its result, what is missing and how sure it
is.

A sentence comes from what was measured: without a time no time is reported, without a tape nothing is compared with
one.
"""

import math

from app.wording.body import name_of
from app.wording.numbers import MINUS, clock
from app.wording.translation import figure_text, joined, later, short_figure, tr, tr_n, within_sentence
from core.timed.found import DistanceSource, NotMeasured, NotValid, PartOfUpAndGo, TimedTest
from core.timed.protocols import DEFINITIONS, KnownError, PlannedTest, TimedProtocol, course_of

RUN_IN_AND_OUT_M = 4.0
ALLOWED_PERCENT = 3.0  # more than that off the tape, the sensors' distance is not to be read
GRAVEST_FIRST = (
    *(NotValid.OTHER_TIME, NotValid.FEWER_RISES),
    *(NotValid.NO_RISE, NotValid.NO_TURN, NotValid.MORE_TURNS, NotValid.COURSE_SHORTER, NotValid.COURSE_LONGER),
    *(NotValid.NO_TURN_TO_SIT, NotValid.ELSEWHERE, NotValid.LAP_DIFFERS, NotValid.DISTANCE_DIFFERS),
)
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


def course_label(protocol: TimedProtocol) -> str:
    """What the length of a test's course is called; empty where it has none."""
    return {
        TimedProtocol.TEN_METRES: tr("Between the tapes"),
        TimedProtocol.TWO_MINUTES: tr("Lap"),
        TimedProtocol.SIX_MINUTES: tr("Lap"),
        TimedProtocol.UP_AND_GO: tr("Chair to cone"),
    }.get(protocol, "")


def instruction(planned: PlannedTest) -> str:
    """How a test is done, for who leads it."""
    course_m = course_of(planned) or 0.0
    return {
        TimedProtocol.TEN_METRES: tr(
            "A straight {whole} m: 2 m run-in, {course} m timed, 2 m run-out. Stand still for 1 s, then walk."
        ),
        TimedProtocol.TWO_MINUTES: tr("Stand still for 1 s, then walk to and fro for 2 minutes."),
        TimedProtocol.SIX_MINUTES: tr("Stand still for 1 s, then walk to and fro for 6 minutes."),
        TimedProtocol.UP_AND_GO: tr("Sit still. Rise, walk round the cone, walk back and sit down."),
        TimedProtocol.SIT_TO_STAND: tr("Sit still. Rise and sit down, until standing for the fifth time."),
        TimedProtocol.STAIRS: tr("Stand still for 1 s before the stairs, then climb up and down."),
    }[planned.protocol].format(whole=short_figure(course_m + RUN_IN_AND_OUT_M, 2), course=short_figure(course_m, 2))


def name_within_sentence(protocol: TimedProtocol) -> str:
    """The same amid a sentence; an up and go is written as a name."""
    name = name_of_test(protocol)
    return name if protocol is TimedProtocol.UP_AND_GO else within_sentence(name)


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


def name_of_part(part: PartOfUpAndGo) -> str:
    """A part of an up and go as it is called."""
    return {
        PartOfUpAndGo.RISE: tr("Rise"),
        PartOfUpAndGo.WALK_OUT: tr("Walk out"),
        PartOfUpAndGo.TURN: tr("Turn"),
        PartOfUpAndGo.WALK_BACK: tr("Walk back"),
        PartOfUpAndGo.TURN_TO_SIT: tr("Turn to sit"),
        PartOfUpAndGo.SIT: tr("Sit down"),
    }[part]


def not_valid_sentence(test: TimedTest) -> str:
    """Why a test is not the one that it is called, by the gravest reason; empty where nothing shows that."""
    if not test.not_valid:
        return ""
    first = min(test.not_valid, key=GRAVEST_FIRST.index)
    length = tr("{found} m from the chair to the turn, the course is {course} m")
    turns = tr("{turns} turns, the course has 2")
    if test.protocol is TimedProtocol.TEN_METRES:
        length = tr("{walked} m by the feet, {course} m between the tapes")
        turns = tr("turned round on the way")
    reason = {
        NotValid.COURSE_SHORTER: length,
        NotValid.COURSE_LONGER: length,
        NotValid.NO_RISE: tr("no rise from the chair"),
        NotValid.NO_TURN: tr("{walked} m walked without a turn, the course turns at {course} m"),
        NotValid.NO_TURN_TO_SIT: tr("no turn before sitting down"),
        NotValid.MORE_TURNS: turns,
        NotValid.ELSEWHERE: tr("seated elsewhere than at the start"),
        NotValid.LAP_DIFFERS: tr("laps of {found} m by the feet, {course} m entered"),
        NotValid.DISTANCE_DIFFERS: tr("{distance} m entered, {walked} m by the feet"),
        NotValid.OTHER_TIME: tr("timed for {time}, the test takes {whole}"),
        NotValid.FEWER_RISES: tr("{count} of {required} rises"),
    }[first]
    stated = reason.format(
        found=figure_text(test.course_found_m, ".1f"),
        course=short_figure(test.course_m, 2),
        walked=figure_text(test.sensor_distance_m, ".1f"),
        distance=short_figure(test.distance_m, 1),
        turns=sum(turn.is_about for turn in test.turns),
        time=clock(test.time_s),
        whole=clock(test.definition.duration_s or 0.0),
        count=len(test.rises),
        required=test.definition.rises,
    )
    return tr("Not valid: {reason}.").format(reason=stated)


def not_compared_sentence(test: TimedTest) -> str:
    """What was timed of a test that is not valid, and that nothing is made of it."""
    return tr("{result} Not compared, and in no mean.").format(result=result_sentence(test))


def remedy_sentence(test: TimedTest) -> str:
    """What to do about a test that is not valid; empty where it is."""
    if not test.not_valid:
        return ""
    repeat = tr("Repeat the test on a course of {course} m, or enter the length that was laid out.")
    return {
        NotValid.COURSE_SHORTER: repeat,
        NotValid.COURSE_LONGER: repeat,
        NotValid.NO_RISE: tr("Repeat the test, seated at the start."),
        NotValid.NO_TURN: tr("Repeat the test: round the cone and back to the chair."),
        NotValid.NO_TURN_TO_SIT: tr("Repeat the test: turn round before sitting down."),
        NotValid.MORE_TURNS: tr("Repeat the test without further turns."),
        NotValid.ELSEWHERE: tr("Repeat the test: back to the chair that it began from."),
        NotValid.LAP_DIFFERS: tr("Check the length of the lap."),
        NotValid.DISTANCE_DIFFERS: tr("Check the laps, their length and the rest."),
        NotValid.OTHER_TIME: tr("Repeat the test for its whole time."),
        NotValid.FEWER_RISES: tr("Repeat the test with all rises."),
    }[min(test.not_valid, key=GRAVEST_FIRST.index)].format(course=short_figure(test.course_m, 2))


def source_sentence(test: TimedTest) -> str:
    """Where the distance of a set time is from; empty of any other test, and without a distance."""
    if test.definition.duration_s is None or not math.isfinite(test.distance_m):
        return ""
    stated = {
        DistanceSource.TYPED: tr("Distance: laps entered, {lap} m each"),
        DistanceSource.FOUND_LAPS: tr("Distance: laps detected, {lap} m each"),
    }.get(test.distance_source, tr("Distance: foot sensors"))
    stated = stated.format(lap=short_figure(test.course_m, 2))
    if test.distance_source is DistanceSource.FEET or not math.isfinite(test.sensor_distance_m):
        return f"{stated}."
    feet = figure_text(test.sensor_distance_m, ".0f")
    return tr("{source}; the foot sensors measured {feet} m.").format(source=stated, feet=feet)


def sentences_of(test: TimedTest) -> list[str]:
    """All that is stated of a test behind its result, in order; what does not hold of it is left out."""
    stated = (
        why_sentence(test),
        source_sentence(test),
        tape_sentence(test),
        slowest_sentence(test),
        stairs_sentence(test),
        course_sentence(test),
        pauses_sentence(test),
    )
    return [one for one in stated if one]


def slowest_sentence(test: TimedTest) -> str:
    """Which of several rises took longest; empty where there are not several."""
    if test.definition.rises < 2 or len(test.rises) < 2:
        return ""
    number, slowest = max(enumerate(test.rises, 1), key=lambda one: one[1].time_s)
    return tr("Slowest rise: number {number}, {time} s.").format(number=number, time=figure_text(slowest.time_s, ".2f"))


def start_words(protocol: TimedProtocol) -> str:
    """What starts the clock where no key does."""
    if protocol is TimedProtocol.TEN_METRES:
        return tr("after standing still for 1 s and walking 2 m")
    if DEFINITIONS[protocol].is_from_chair:
        return tr("when the thighs leave the seat")
    return tr("first step after standing still for 1 s")


def end_words(planned: PlannedTest) -> str:
    """What ends it where no key does."""
    further = tr("{course} m further on, by the sensors").format(course=short_figure(course_of(planned) or 0.0, 2))
    return {
        TimedProtocol.TEN_METRES: further,
        TimedProtocol.TWO_MINUTES: tr("after 2:00 min"),
        TimedProtocol.SIX_MINUTES: tr("after 6:00 min"),
        TimedProtocol.UP_AND_GO: tr("seated again"),
        TimedProtocol.SIT_TO_STAND: tr("standing for the fifth time"),
        TimedProtocol.STAIRS: tr("when the last step ends"),
    }[planned.protocol]


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
        if math.isfinite(test.course_m) and test.course_m != test.definition.length_m:
            stated.append(f"{short_figure(test.course_m, 2)} m")
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
    reported = reported.replace("-", MINUS)
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
    """How many strides led up and down, which no mean of walking holds; empty where none did."""
    up, down = (sum(one.is_up is is_up for one in test.stairs) for is_up in (True, False))
    if not test.stairs:
        return ""
    return tr("Strides on stairs: {up} up, {down} down; excluded from the means of walking.").format(up=up, down=down)


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
