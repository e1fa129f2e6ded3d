"""Figures of timed tests in rows, for screen and paper alike: the attempts at one test, and the sections of one."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from app.summary.numbers_in_words import fixed, signed
from app.wording.timed_tests import name_of_part
from app.wording.translation import tr
from core.timed.found import TimedPart, TimedTest
from core.timed.measures import mean_of_attempts
from core.timed.protocols import TimedProtocol

MOST_LAPS = 12  # more do not fit; the table in the files has all


@dataclass(frozen=True, slots=True)
class TestColumn:
    """A figure of a test under its heading. `has_mean`: several attempts have one."""

    head: str
    value: Callable[[TimedTest], float]
    decimals: int
    has_mean: bool = True
    is_signed: bool = False

    def text(self, value: float) -> str:
        return (signed if self.is_signed else fixed)(value, self.decimals)


@dataclass(frozen=True, slots=True)
class Section:
    """A part of a test: its name, from when to when since the test's start, s, and its figures in words."""

    name: str
    start_s: float
    end_s: float
    texts: tuple[str, ...]
    is_marked: bool = False  # as the longest of its kind


@dataclass(frozen=True, slots=True)
class Sections:
    """The parts of one test under the headings of their figures. `has_strip`: when they were is worth a picture."""

    heads: tuple[str, ...]
    rows: tuple[Section, ...]
    has_strip: bool = False


def columns_of(protocol: TimedProtocol, tests: Sequence[TimedTest]) -> tuple[TestColumn, ...]:
    """The figures that attempts at a test are compared by; the tape's where one was used."""
    time = TestColumn(tr("Time, s"), lambda test: test.time_s, 1)
    distance = TestColumn(tr("Distance, m"), lambda test: test.distance_m, 1)
    speed = TestColumn(tr("Speed, m/s"), lambda test: test.speed_m_s, 2)
    cadence = TestColumn(tr("Steps/min"), lambda test: test.cadence_steps_min, 0)
    turns = TestColumn(tr("Turns"), lambda test: len(test.turns), 0, has_mean=False)
    tape = TestColumn(tr("Diff. to tape, m"), lambda test: test.tape_difference_m, 2, is_signed=True)
    if protocol is TimedProtocol.UP_AND_GO:
        return time, distance, turns
    if protocol is TimedProtocol.SIT_TO_STAND:
        return time, TestColumn(tr("Slowest rise, s"), _slowest_s, 2)
    if protocol is TimedProtocol.STAIRS:
        return time, cadence
    if protocol is TimedProtocol.TEN_METRES:
        has_tape = any(math.isfinite(test.tape_difference_m) for test in tests)
        return (time, speed, cadence, tape) if has_tape else (time, speed, cadence)
    return distance, speed, cadence, turns


def means_of(columns: Sequence[TestColumn], tests: Sequence[TimedTest]) -> list[str]:
    """The mean of each column over tests, empty where it has none."""
    means = [mean_of_attempts(map(one.value, tests)).mean if one.has_mean else math.nan for one in columns]
    return [one.text(mean) if one.has_mean else "" for one, mean in zip(columns, means, strict=True)]


def sections_of(test: TimedTest) -> Sections | None:
    """The parts of up and go, thirds and laps of a set time, rises, or strides on stairs; None where there are none."""
    if test.parts:
        rows = tuple(
            Section(name_of_part(one.part), *_since(test, one.start_s, one.end_s), (fixed(one.time_s, 2),))
            for one in test.parts
        )
        return Sections((tr("Duration, s"),), rows, has_strip=True)
    if test.definition.rises > 1 and test.rises:
        return _rises(test)
    if test.stairs and test.definition.duration_s is None:  # a set time has its thirds, with stairs or without
        return _stairs(test)
    if test.definition.duration_s is None or not test.thirds:
        return None
    rows = tuple(_walked(test, tr("Third {number}").format(number=k), one) for k, one in enumerate(test.thirds, 1))
    laps = test.laps[:MOST_LAPS] if len(test.laps) > 1 else ()
    rows += tuple(_walked(test, tr("Lap {number}").format(number=k), one) for k, one in enumerate(laps, 1))
    return Sections((tr("Time, s"), tr("Distance, m"), tr("Speed, m/s"), tr("Steps/min")), rows)


def _slowest_s(test: TimedTest) -> float:
    return max((rise.time_s for rise in test.rises), default=math.nan)


def _since(test: TimedTest, start_s: float, end_s: float) -> tuple[float, float]:
    return start_s - test.start_s, end_s - test.start_s


def _rises(test: TimedTest) -> Sections:
    longest = max(test.rises, key=lambda rise: rise.time_s)
    rows = tuple(
        Section(
            tr("Rise {number}").format(number=k),
            *_since(test, one.left_seat_s, one.upright_s),
            (fixed(one.left_seat_s - test.start_s, 1), fixed(one.time_s, 2)),
            is_marked=one is longest,
        )
        for k, one in enumerate(test.rises, 1)
    )
    return Sections((tr("Begins at, s"), tr("Duration, s")), rows, has_strip=True)


def _stairs(test: TimedTest) -> Sections:
    """Strides up and down apart, each kind with its number, its mean time and height."""
    rows = []
    for name, is_up in ((tr("Up"), True), (tr("Down"), False)):
        own = [one for one in test.stairs if one.is_up is is_up]
        if own:
            time_s = sum(one.end_s - one.start_s for one in own) / len(own)
            height_m = sum(abs(one.climb_m) for one in own) / len(own)
            begin_s, end_s = _since(test, min(one.start_s for one in own), max(one.end_s for one in own))
            rows.append(Section(name, begin_s, end_s, (str(len(own)), fixed(time_s, 2), fixed(100.0 * height_m, 0))))
    return Sections((tr("Strides"), tr("Mean duration, s"), tr("Mean height, cm")), tuple(rows))


def _walked(test: TimedTest, name: str, part: TimedPart) -> Section:
    begin_s, end_s = _since(test, part.start_s, part.end_s)
    figures = (
        fixed(end_s - begin_s, 1),
        fixed(part.distance_m, 1),
        fixed(part.speed_m_s, 2),
        fixed(part.cadence_steps_min, 0),
    )
    return Section(name, begin_s, end_s, figures)
