"""The patient's course over the visits under one condition: what has changed, and whether beyond its error."""

import datetime
import math
from collections.abc import Sequence

from app.charts.drawing import Picture
from app.reports.blocks import Block, Cell, Column, Row, bullets, figures, heading, note, table
from app.reports.patient.trend_chart import trend_chart
from app.summary.course_lanes import CourseVisit
from app.summary.facts import Facts
from app.summary.goals import goal_mark, goal_sentence, in_course
from app.summary.interval_words import evidence, interval_in_figures
from app.summary.measure_sentences import Reported, change_sentence, unit_and_decimals, who_of_role
from app.summary.numbers_in_words import NOTHING, dagger_note, fixed, in_brief, signed
from app.summary.plain_text import CONDITION_LENGTH, shortened, typed
from app.summary.trend_lines import TrendLine, all_lines, trend_columns, trend_lines, walked_visits
from app.summary.visits import condition_in_words
from app.wording.dates import date, short_date
from app.wording.measures import least_span, name_with_unit
from app.wording.recordings import name_in_words
from app.wording.translation import tr
from core.body import Side
from core.goals import Goal, GoalOf
from core.parameters import SPEED
from core.timed.measures import COLUMNS, PROTOCOLS
from core.timed.protocols import TimedProtocol

MOST_COLUMNS = 6  # of visits in the table: the first, and the latest
MOST_SENTENCES = 3
MOST_GOALS = 5  # in sentences; all of them are in goals.csv
BY_LENGTH = 16


def trend_page(visits: Sequence[CourseVisit], condition: str, facts: Facts) -> list[Block]:
    """Make a page of trends; none under two visits with a value. `visits` in time order, the report's last."""
    walked = walked_visits(visits, condition)
    agreed = facts.part.agreed
    columns = trend_columns(agreed)
    shown = [line for line in all_lines(visits, condition, agreed) if len(line.reported) > 1]
    if not shown:
        return []
    days = [visit.day for visit in walked]
    title = tr("Progress over {count} visits, {first} to {last}").format(
        count=len(walked), first=date(days[0]), last=date(days[-1])
    )
    stated = typed(name_in_words(condition), CONDITION_LENGTH) if condition else condition_in_words("")
    wording = [
        tr("Condition: {condition}. Sensors reattached at each visit.").format(condition=stated),
        tr("Error bar: half the measurement error of a change. Bars that do not overlap show a change beyond error."),
        tr("The time axis is to scale. Gap: value not reported at that visit."),
    ]
    if without := len(visits) - len(walked):
        wording.append(
            tr("Visits not shown (no walk in this condition, or not calculated): {count}.").format(count=without)
        )
    return [
        heading(title),
        note(" ".join(wording)),
        bullets([*_sentences(shown, facts, len(walked)), *_goals(walked, condition, facts)]),
        figures([_chart(column, shown, days, facts) for column in columns if _of(shown, column)], columns=2),
        heading(tr("Values"), level=2),
        _table(shown, len(walked)),
        note(_below(shown)),
    ]


def charts_of_tests(visits: Sequence[CourseVisit], condition: str, facts: Facts) -> dict[TimedProtocol, Picture]:
    """One for each timed test that two visits and more have under a condition."""
    walked, columns = walked_visits(visits, condition), tuple(COLUMNS.values())
    lines = trend_lines(walked, condition, columns, facts.part.agreed)
    shown, days = [line for line in lines if len(line.reported) > 1], [visit.day for visit in walked]
    return {PROTOCOLS[column]: _chart(column, shown, days, facts) for column in columns if _of(shown, column)}


def _goals(walked: Sequence[CourseVisit], condition: str, facts: Facts) -> list[str]:
    """Each goal that was agreed before this visit: at which visit it was first reached, and if it is met now."""
    wording = []
    for goal in facts.part.agreed.reported:
        parts = [(number, visit) for number, visit in enumerate(walked, start=1) if visit.day > goal.agreed]
        found = [
            (number, in_course(goal, part))
            for number, visit in parts
            if visit.course is not None and (part := visit.course.condition(condition)) is not None
        ]
        if not found or not (now := goal_sentence(found[-1][1])):
            continue
        first = next((number for number, one in found if one.standing.is_reached), None)
        if first is not None and found[-1][1].standing.is_reached and first != found[-1][0]:
            now = f"{now} {tr('First reached at visit {number}.').format(number=first)}"
        wording.append(now)
    return wording[:MOST_GOALS]


def _of(lines: Sequence[TrendLine], column: str) -> list[TrendLine]:
    return [line for line in lines if line.column == column]


def _chart(column: str, lines: Sequence[TrendLine], days: Sequence[datetime.date], facts: Facts) -> Picture:
    _, decimals = unit_and_decimals(column)
    drawn = {line.side: line.values for line in _of(lines, column)}
    held = [goal for goal in facts.part.agreed.of(column) if goal.of is not GoalOf.BETWEEN]
    goals = [(goal.value, _agreed_in_words(goal)) for goal in held]
    least = least_span(column) if column in PROTOCOLS else 0.0
    return trend_chart(
        name_with_unit(column), decimals, days, drawn, is_simulated=facts.is_simulated, goals=goals, least_span=least
    )


def _agreed_in_words(goal: Goal) -> str:
    """A goal and when it was agreed, by whom."""
    by = f", {typed(shortened(goal.by, BY_LENGTH), BY_LENGTH)}" if goal.by else ""
    return tr("{goal}, agreed {day}").format(goal=goal_mark(goal), day=short_date(goal.agreed)) + by


def _sentences(lines: Sequence[TrendLine], facts: Facts, visits: int) -> list[str]:
    """The changes since the first visit that are large enough for a sentence, the largest against its error first."""
    first, _ = facts.first_and_second
    worth = [
        line
        for line in lines
        if line.since_first is not None and line.since_first.is_worth_a_sentence and line.side in (None, first)
    ]
    if not worth:
        judged = [line.since_first for line in lines if line.since_first is not None and line.since_first.is_judged]
        if not judged:
            return [tr("No change could be judged.")]
        if any(one.exceeds for one in judged):
            wording = tr(
                "No change is far enough beyond measurement error to be listed here. The table marks every "
                "change beyond error."
            )
            return [wording]
        return [tr("All judged changes are within measurement error.")]
    ordered = sorted(worth, key=lambda line: -line.since_first.ratio if line.since_first is not None else 0.0)
    reported = {_movement(line): line for line in reversed(ordered)}  # of each the largest
    return [_sentence(line, facts, visits) for line in ordered if reported[_movement(line)] is line][:MOST_SENTENCES]


def _movement(line: TrendLine) -> tuple[str, Side | None]:
    """What is reported only once: speed is one, in a timed test or out of it."""
    return (SPEED if line.column.endswith(SPEED) else line.column), line.side


def _sentence(line: TrendLine, facts: Facts, visits: int) -> str:
    found, last = line.since_first, line.values[-1]
    assert found is not None  # those without one are not reported
    unit, decimals = unit_and_decimals(line.column)
    first = next(one for one in line.values if one.visit == line.first)
    now, before = (tr("at visit {visit}").format(visit=number) for number in (visits, line.first + 1))
    who = "" if line.side is None else who_of_role(facts, line.side, line.column)
    changed = change_sentence(
        line.column, who, found.difference, Reported(now, last.value), Reported(before, first.value)
    )
    wording = f"{changed} {evidence(line.column, found)}"
    since = line.since_last
    if since is None or line.before == line.first:
        return wording
    if not since.is_judged:
        return wording
    words = tr("Since visit {number} {change}, likely {interval}.")
    change, interval = signed(since.difference, decimals) + unit, interval_in_figures(line.column, since)
    return f"{wording} {words.format(number=line.before + 1, change=change, interval=interval)}"


def _table(lines: Sequence[TrendLine], visits: int) -> Block:
    shown = list(range(visits)) if visits <= MOST_COLUMNS else [0, *range(visits - MOST_COLUMNS + 1, visits)]
    columns = [
        Column(tr("Measure"), "1fr", is_number=False),
        Column("", is_number=False),
        *(Column(str(visit + 1)) for visit in shown),
        Column(tr("since previous")),
        Column(tr("since first")),
        Column(tr("likely between")),
        Column(tr("judged since first"), is_number=False),
    ]
    rows: list[Row] = []
    for line in lines:
        _, decimals = unit_and_decimals(line.column)
        values = {one.visit: one.value for one in line.values}
        cells: list[Cell | str] = [name_with_unit(line.column), line.side.letter if line.side is not None else ""]
        for visit in shown:
            is_not_reported = visit in values and not math.isfinite(values[visit])
            cells.append(tr("not reported") if is_not_reported else fixed(values.get(visit, math.nan), decimals))
        found, since = line.since_first, line.since_last
        is_reported = found is not None and found.is_reported
        cells.append(signed(since.difference, decimals) if since is not None and line.before != line.first else NOTHING)
        if found is None or not is_reported:
            rows.append([*cells, NOTHING, NOTHING, NOTHING])
            continue
        cells += [
            Cell(signed(found.difference, decimals), is_bold=found.exceeds),
            interval_in_figures(line.column, found),
            Cell(in_brief(found), is_bold=found.exceeds),
        ]
        rows.append(cells)
    return table(columns, rows, is_dense=True)


def _below(lines: Sequence[TrendLine]) -> str:
    wording = [
        tr(
            "Absolute angles are not included: each visit has its own standing reference. “First” is the "
            "first visit with a reported value."
        )
    ]
    if any(line.since_first is not None and line.since_first.is_unverified for line in lines):
        wording.append(dagger_note())
    return " ".join(wording)
