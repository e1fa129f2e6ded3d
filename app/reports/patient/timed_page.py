"""The timed tests of a visit: each with its sentence, figures and parts, whether it is valid, and its error."""

from app.exports.timed_csv import timed_walks
from app.reports.blocks import Block, Cell, Column, Row, figures, heading, note, paragraph, table
from app.reports.patient.trend_page import charts_of_tests
from app.summary.course_lanes import LaneKind, lanes
from app.summary.course_words import changes_since_in_words
from app.summary.facts import Facts
from app.summary.numbers_in_words import DAGGER, NOTHING, dagger_note, fixed, signed
from app.summary.plain_text import CONDITION_LENGTH, isolated, plain, typed
from app.summary.request import ReportRequest
from app.summary.timed_tables import Section, sections_of
from app.summary.timed_words import (
    MCID,
    MDC,
    name_of_population,
    populations_of,
    published_rows,
    span_in_words,
    unread_note,
)
from app.summary.visits import condition_in_words
from app.wording.measures import short_unit
from app.wording.recordings import name_in_words
from app.wording.timed_tests import (
    error_words,
    name_of_test,
    not_compared_sentence,
    not_valid_sentence,
    result_sentence,
    sentences_of,
    start_words,
)
from app.wording.translation import tr
from core.results import RecordingAnalysis
from core.timed.found import TimedTest
from core.timed.measures import COLUMNS
from core.timed.protocols import DEFINITIONS, TimedProtocol
from core.verdicts.attempts import error_between_visits
from core.verdicts.published_changes import Population

MOST_TESTS = 12  # of one page
MOST_BESIDE = 4  # attempts at one test
TIME = 2  # their column


def timed_page(request: ReportRequest, facts: Facts) -> list[Block]:
    """All timed tests of the visit, and their course over the visits; none where no walk was one."""
    walks = timed_walks(request.visit.analysis)[:MOST_TESTS]
    tests = [(walk, walk.timed) for walk in walks if walk.timed is not None]
    if not tests:
        return []
    protocols = list(dict.fromkeys(test.protocol for _, test in tests))
    blocks: list[Block] = [heading(tr("Timed tests")), _figures(request, tests)]
    for walk, test in tests:
        first = [result_sentence(test)] if test.is_valid else [not_valid_sentence(test), not_compared_sentence(test)]
        blocks.append(paragraph(f"{_name(request, walk)}: {' '.join([*first, *sentences_of(test)])}"))
    blocks += _course(request, facts)
    for protocol in protocols:
        blocks += _parts([(_name(request, walk), test) for walk, test in tests if test.protocol is protocol])
    known = [_known(protocol) for protocol in protocols]
    errors = {error for _, test in tests for error in test.definition.errors}
    if any(not error.is_verified for error in errors):
        known.append(dagger_note())
    return [*blocks, note(" ".join(known))]


def _course(request: ReportRequest, facts: Facts) -> list[Block]:
    """What each test is made for over the visits, under the report's condition."""
    condition = facts.condition
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
    published = _published(list(charts), populations_of(facts.visit.session.patient))
    changed = [paragraph(words) for protocol in charts if (words := _change(request, condition, protocol))]
    return [heading(tr("Progress by visit"), 2), *changed, note(" ".join(wording)), drawn, *published]


def _change(request: ReportRequest, condition: str, protocol: TimedProtocol) -> str:
    """By how much a test's figure differs from the last visit and the first one, and whether beyond error."""
    goals = request.visit.session.patient.goals
    (lane,) = lanes(request.course, condition, goals, (LaneKind(COLUMNS[protocol]),))
    changed = changes_since_in_words(lane, request.course)
    return f"{name_of_test(protocol)}: {changed}" if changed else ""


def _published(protocols: list[TimedProtocol], populations: tuple[Population, ...]) -> list[Block]:
    """What others published about changes of these tests, with their sources."""
    rows: list[Row] = []
    sources: dict[str, None] = {}
    for protocol in protocols:
        for population, *found in published_rows(protocol, populations):
            unit = short_unit(COLUMNS[protocol]).strip()
            rows.append([name_of_test(protocol), name_of_population(population), unit, *map(span_in_words, found)])
            sources |= dict.fromkeys(source for one in found if one is not None for source in one.sources)
    if not rows:
        return []
    columns = [Column(tr("Test"), is_number=False), Column(tr("Patients"), "1fr", is_number=False)]
    columns += [Column(tr("Unit"), is_number=False), Column(MDC), Column(MCID)]
    explained = tr("MDC: least change beyond measurement error. MCID: least change that matters to patients. Sources:")
    daggers = [unread_note()] if any(DAGGER in cell for row in rows for cell in row if isinstance(cell, str)) else []
    cited = note(" ".join([f"{explained} {'; '.join(sources)}.", *daggers]))
    return [heading(tr("Published least changes"), 2), table(columns, rows, is_dense=True), cited]


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
        name = _name(request, walk)
        stated = [
            name if test.is_valid else tr("{walk}, not valid").format(walk=name),
            name_of_test(test.protocol),
            fixed(test.time_s, 1),
            fixed(test.distance_m, 1),
            fixed(test.speed_m_s, 2),
            fixed(test.cadence_steps_min, 0),
            str(len(test.laps)) if test.laps else NOTHING,
            str(len(test.turns)),
            str(len(test.pauses_s)),
            signed(test.tape_difference_m, 2),
        ]
        rows.append(
            [Cell(one, is_bold=k == TIME and test.is_valid, is_grey=not test.is_valid) for k, one in enumerate(stated)]
        )
    return table(columns, rows, is_dense=True)


def _parts(tests: list[tuple[str, TimedTest]]) -> list[Block]:
    """The parts of one kind of test: durations of all attempts side by side, of others the latest one's figures."""
    divided = [(name, test, sections) for name, test in tests if (sections := sections_of(test)) is not None]
    if not divided:
        return []
    name, test, sections = divided[-1]
    title = heading(tr("{test}: sections").format(test=name_of_test(test.protocol)), 2)
    columns = [Column("", "1fr", is_number=False)]
    if not sections.has_strip:
        columns = [Column(name, "1fr", is_number=False), *map(Column, sections.heads)]
        return [title, table(columns, [[one.name, *one.texts] for one in sections.rows], is_dense=True)]
    shown = divided[-MOST_BESIDE:]
    columns += [Column(tr("{walk}, s").format(walk=name)) for name, _, _ in shown]
    longest = max((found.rows for _, _, found in shown), key=len)
    rows: list[Row] = []
    for k, one in enumerate(longest):
        of_attempts = [(test, found.rows[k] if k < len(found.rows) else None) for _, test, found in shown]
        rows.append([one.name, *(_duration(part, is_grey=not test.is_valid) for test, part in of_attempts)])
    return [title, table(columns, rows, is_dense=True)]


def _duration(part: Section | None, *, is_grey: bool) -> Cell:
    """How long a part took, the longest of its kind in bold."""
    if part is None:
        return Cell(NOTHING, is_grey=is_grey)
    return Cell(part.texts[-1], is_bold=part.is_marked, is_grey=is_grey)


def _known(protocol: TimedProtocol) -> str:
    """What starts a test and what is known of its error."""
    definition = DEFINITIONS[protocol]
    errors = " ".join(error_words(one) for one in definition.errors)
    return tr("{test}, start: {start}. {errors}").format(
        test=name_of_test(protocol), start=start_words(protocol), errors=errors
    )
