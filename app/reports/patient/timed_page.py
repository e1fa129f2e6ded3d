"""The timed tests of a visit: each with its sentence and figures, how it went from third to third, and its error."""

import math

from app.exports.timed_csv import timed_walks
from app.reports.blocks import Block, Cell, Column, Row, figures, heading, note, paragraph, table
from app.reports.patient.trend_page import charts_of_tests
from app.summary.facts import Facts
from app.summary.numbers_in_words import NOTHING, dagger_note, fixed
from app.summary.plain_text import CONDITION_LENGTH, isolated, plain, typed
from app.summary.request import ReportRequest
from app.summary.visits import condition_in_words
from app.wording.recordings import name_in_words
from app.wording.timed_tests import (
    course_sentence,
    error_words,
    name_of_test,
    pauses_sentence,
    result_sentence,
    stairs_sentence,
    start_words,
    tape_sentence,
    why_sentence,
)
from app.wording.translation import figure_text, tr
from core.results import RecordingAnalysis
from core.timed.found import TimedPart, TimedTest
from core.timed.measures import COLUMNS
from core.timed.protocols import DEFINITIONS, TimedProtocol
from core.verdicts.attempts import error_between_visits

MOST_TESTS = 12  # of one page
MOST_LAPS = 16


def timed_page(request: ReportRequest, facts: Facts) -> list[Block]:
    """All timed tests of the visit, and their course over the visits; none where no walk was one."""
    walks = timed_walks(request.visit.analysis)[:MOST_TESTS]
    tests = [(walk, walk.timed) for walk in walks if walk.timed is not None]
    if not tests:
        return []
    protocols = list(dict.fromkeys(test.protocol for _, test in tests))
    blocks: list[Block] = [heading(tr("Timed tests")), _figures(request, tests)]
    for walk, test in tests:
        wording = [
            why_sentence(test),
            tape_sentence(test),
            stairs_sentence(test),
            course_sentence(test),
            pauses_sentence(test),
        ]
        reported = " ".join(filter(None, [result_sentence(test), *wording]))
        blocks.append(paragraph(f"{_name(request, walk)}: {reported}"))
    longest = [test for _, test in tests if test.definition.duration_s is not None and test.thirds]
    if longest:
        blocks += [heading(tr("During the test: {test}").format(test=name_of_test(longest[-1].protocol)), 2)]
        blocks += [_parts(longest[-1])]
    blocks += _course(request, facts)
    known = [_known(protocol) for protocol in protocols]
    errors = {error for _, test in tests for error in test.definition.errors}
    if any(not error.is_verified for error in errors):
        known.append(dagger_note())
    return [*blocks, note(" ".join(known))]


def _course(request: ReportRequest, facts: Facts) -> list[Block]:
    """What each test is made for over the visits, under the report's condition."""
    condition = request.visit.recording(request.shown).condition
    charts = charts_of_tests(request.course, condition, facts)
    if not charts:
        return []
    stated = typed(name_in_words(condition), CONDITION_LENGTH) if condition else condition_in_words("")
    wording = [tr("Condition: {condition}. Several attempts: mean shown.").format(condition=stated)]
    error = error_between_visits(COLUMNS[TimedProtocol.TEN_METRES])
    if TimedProtocol.TEN_METRES in charts:
        whisker = tr("Error bar: half the measurement error of a speed change. That error is {error} m/s.")
        wording.append(whisker.format(error=fixed(error, 2)))
    if set(charts) - {TimedProtocol.TEN_METRES}:
        wording.append(
            tr(
                "The measurement error is not known for distances in a set time and for chair tests. Changes "
                "in these tests are not judged."
            )
        )
    drawn = figures(list(charts.values()), columns=2)
    return [heading(tr("Progress by visit"), 2), note(" ".join(wording)), drawn]


def _name(request: ReportRequest, walk: RecordingAnalysis) -> str:
    return isolated(plain(str(request.visit.shown_names[walk.name])))


def _figures(request: ReportRequest, tests: list[tuple[RecordingAnalysis, TimedTest]]) -> Block:
    columns = [
        Column(tr("Walk"), "1fr", is_number=False),
        Column(tr("Test"), is_number=False),
        *(Column(title) for title in (tr("Time, s"), tr("Distance, m"), tr("Speed, m/s"), tr("Steps/min"))),
        *(Column(title) for title in (tr("Laps"), tr("Turns"), tr("Pauses"), tr("Diff. to tape, m"))),
    ]
    rows: list[Row] = []
    for walk, test in tests:
        apart_m = test.tape_difference_m
        rows.append(
            [
                _name(request, walk),
                name_of_test(test.protocol),
                Cell(_figure(test.time_s, 1), is_bold=True),
                _figure(test.distance_m, 1),
                _figure(test.speed_m_s, 2),
                _figure(test.cadence_steps_min, 0),
                str(len(test.laps)) if test.laps else NOTHING,
                str(len(test.turns)),
                str(len(test.pauses_s)),
                figure_text(apart_m, "+.2f") if math.isfinite(apart_m) else NOTHING,
            ]
        )
    return table(columns, rows, is_dense=True)


def _parts(test: TimedTest) -> Block:
    columns = [
        Column(tr("Part"), "1fr", is_number=False),
        *(Column(title) for title in (tr("From, s"), tr("To, s"), tr("Distance, m"))),
        *(Column(title) for title in (tr("Speed, m/s"), tr("Steps/min"))),
    ]
    rows = [_part(tr("Third {number}").format(number=k), one, test) for k, one in enumerate(test.thirds, 1)]
    laps = test.laps[:MOST_LAPS] if len(test.laps) > 1 else ()
    rows += [_part(tr("Lap {number}").format(number=k), one, test) for k, one in enumerate(laps, 1)]
    return table(columns, rows, is_dense=True)


def _part(name: str, part: TimedPart, test: TimedTest) -> Row:
    return [
        name,
        _figure(part.start_s - test.start_s, 1),
        _figure(part.end_s - test.start_s, 1),
        _figure(part.distance_m, 1),
        _figure(part.speed_m_s, 2),
        _figure(part.cadence_steps_min, 0),
    ]


def _known(protocol: TimedProtocol) -> str:
    """What starts a test and what is known of its error."""
    definition = DEFINITIONS[protocol]
    errors = " ".join(error_words(one) for one in definition.errors)
    return tr("{test}, start: {start}. {errors}").format(
        test=name_of_test(protocol), start=start_words(protocol), errors=errors
    )


def _figure(value: float, decimals: int) -> str:
    return figure_text(value, f".{decimals}f") if math.isfinite(value) else NOTHING
