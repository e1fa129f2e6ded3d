"""Means of one parameter by group, with sessions as what is counted.

A session with ten walks is one session, and so is one of which both legs are in the group: the walks of a session and
side are averaged first, then its sides, and what is left is one value per session and group. Of these are the mean, the
standard deviation (n - 1) and the 95 % interval of the mean, mean ± t(0.975, n - 1) sd / √n. Under three sessions there
is a mean and nothing else. A value counts only if its status allows and it is a number; what is left out is counted.

No group is stated to differ from another here. Two sessions of one person count as two, which makes the interval too
narrow: so the people are counted beside them. A bias that all sessions share (knees read larger than in optical
laboratories) is not in the interval.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from enum import StrEnum
from typing import Any

from scipy.special import stdtrit

from app.cohort.study.parameter_table import ERROR, STATUS, VIEW, ParameterTable, quoted_name
from devices.files.refusal import FileRefusedError

LEAST_SESSIONS = 3  # with a spread
TWO_SIDED_95 = 0.975
CHILDREN_UNDER = 18  # no band of adults holds for them
AGE_EDGES = (CHILDREN_UNDER, 40, 60, 80)  # years
SPEED_EDGES = (0.4, 0.8, 1.2, 1.6)  # m/s, equal steps
SPEED = "walk_speed_m_s"  # of the walk, so that both legs are in one band
SIMULATED = "is_simulated"
BOTH, LEG_SIDES = "both", ("left", "right")
NOT_STATED = ""
LEGS = ("prosthetic", "affected", "other", "neither")
REPORTED, REPORTED_WITH_CARE = ("read",), ("read", "care")


class Grouping(StrEnum):
    """What sessions can be grouped by; never by session or walk, which would reveal single people."""

    CONDITION = "condition"
    DEVICE = "device"
    AGE = "age"
    SPEED = "speed"
    SIDE = "side"
    LEG = "leg"
    ALL = "all"


REQUIRED: Mapping[Grouping, tuple[str, ...]] = {  # columns without which a table cannot be grouped so
    Grouping.CONDITION: ("condition",),
    Grouping.DEVICE: ("device",),
    Grouping.AGE: ("age_years",),
    Grouping.SPEED: (SPEED, SPEED + STATUS),
    Grouping.SIDE: (),
    Grouping.LEG: ("is_affected", "is_prosthetic"),
    Grouping.ALL: (),
}


@dataclass(frozen=True, slots=True)
class GroupQuestion:
    """`measure` is a parameter of the table; the two last say what is counted beside what can simply be read."""

    measure: str
    grouping: Grouping
    has_care: bool = False
    has_simulated: bool = False


@dataclass(frozen=True, slots=True)
class GroupRow:
    """One group. What is not known is NaN.

    `group`: a condition or device as typed; `left`; `prosthetic`; a band by its lower edge ("18", "0.4", the first
    "0"); empty: not stated, or a speed that cannot be read.
    `sessions`, `patients`, `walks`: those with a value that counts; no patients where one of the sessions does not name
    its own.
    `mean`, `sd`, `standard_error`, `half_interval`: of the sessions' values, in the unit that the measure's name ends
    with; sd, standard error and half of the 95 % interval are NaN under three sessions.
    `withheld`, `with_care`, `not_measured`: walks of one side that are left out for this.
    """

    group: str
    sessions: int
    patients: int
    walks: int
    mean: float
    sd: float
    standard_error: float
    half_interval: float
    value_error: float  # median measurement error (95 %) of the mean of one walk and side
    withheld: int
    with_care: int
    not_measured: int
    sessions_without: int  # sessions of the group without any value that counts

    @property
    def has_interval(self) -> bool:
        return math.isfinite(self.half_interval)

    @property
    def interval(self) -> tuple[float, float]:
        """Give the 95 % interval of the mean in the measure's unit; NaN without one."""
        return self.mean - self.half_interval, self.mean + self.half_interval


@dataclass(frozen=True, slots=True)
class GroupAnswer:
    """The groups in their order, those without a value too.

    `sessions` and `patients` count each once, however many groups it is in (no patients where a session does not name
    its own); `simulated` of them are simulated, and `simulated_left_out` sessions are not among them for being so.
    """

    question: GroupQuestion
    rows: tuple[GroupRow, ...]
    sessions: int
    patients: int
    simulated: int
    simulated_left_out: int

    @property
    def reported(self) -> tuple[GroupRow, ...]:
        """The groups with a mean."""
        return tuple(row for row in self.rows if row.sessions)

    @property
    def is_overlapping(self) -> bool:
        """Whether a session is in several groups, as with several conditions; their means then share people."""
        return sum(row.sessions for row in self.rows) > self.sessions


def measures_of(table: ParameterTable) -> tuple[str, ...]:
    """Give the parameters that can be asked for; raises FileRefusedError if there is none."""
    if not table.measures:
        raise FileRefusedError(
            table.where,
            "no parameter in this table has a status column",
            "Choose the parameters.parquet written by gaitwright batch",
        )
    return table.measures


def groupings_of(table: ParameterTable) -> tuple[Grouping, ...]:
    """What this table can be grouped by."""
    return tuple(one for one in Grouping if all(column in table.columns for column in REQUIRED[one]))


def answer(table: ParameterTable, question: GroupQuestion) -> GroupAnswer:
    """Answer the page's question; raises FileRefusedError where the table lacks a column for it."""
    if question.measure not in table.measures:
        raise FileRefusedError(
            table.where,
            "the table has no parameter {name} with a status column",
            "Choose another measure",
            name=question.measure,
        )
    for column in REQUIRED[question.grouping]:
        if column not in table.columns:
            raise FileRefusedError(
                table.where, "the table has no column {name}", "Choose another grouping", name=column
            )
    sides = _sides(table, question.measure)
    found = list(table.found(_sql(table, question, sides)).rows)
    patients, sessions, simulated = next(((row[3], *row[-2:]) for row in found if row[0]), (0, 0, 0))
    rows = [_row(row) for row in found if not row[0]]
    ordered = tuple(sorted(rows, key=lambda row: _place(question.grouping, row.group)))
    return GroupAnswer(question, ordered, sessions, patients, simulated, _simulated_left_out(table, question))


def table_of(found: GroupAnswer) -> tuple[list[str], Iterable[list[str | int | float | None]]]:
    """Give the groups as a table: its columns, and a row for each group, None where something is not known."""
    question = found.question
    asked: list[str | int | float | None] = [
        question.measure,
        question.grouping.value,
        "read and care" if question.has_care else "read",
        "yes" if found.simulated else "no",
    ]
    own = [one.name for one in fields(GroupRow) if one.name != "half_interval"]
    header = ["measure", "grouped_by", "included", "holds_simulated", *own, "interval_95_low", "interval_95_high"]
    header[header.index("with_care")] = "with_care_left_out"

    def rows() -> Iterable[list[str | int | float | None]]:
        for row in found.rows:
            values = [getattr(row, name) for name in own] + list(row.interval)
            yield asked + [None if isinstance(one, float) and not math.isfinite(one) else one for one in values]

    return header, rows()


def _sides(table: ParameterTable, measure: str) -> tuple[str, str]:
    """Which rows contain this parameter: those of the legs, else those of both together, as of cadence."""
    reported = f"SELECT DISTINCT side FROM {VIEW} WHERE {quoted_name(measure)} IS NOT NULL"
    found = {side for (side,) in table.found(reported).rows}
    return (BOTH, BOTH) if found == {BOTH} else LEG_SIDES


def _simulated_left_out(table: ParameterTable, question: GroupQuestion) -> int:
    if SIMULATED not in table.columns or question.has_simulated:
        return 0
    ((count,),) = table.found(f"SELECT count(DISTINCT session) FROM {VIEW} WHERE {SIMULATED}").rows
    return int(count)


def _sql(table: ParameterTable, question: GroupQuestion, sides: tuple[str, str]) -> str:
    """The question as SQL: a row per group, and one for all."""
    first, second = sides
    other = f"avg(value) FILTER (is_used AND side = '{second}')" if second != first else "NULL::DOUBLE"
    return f"""
        WITH {_every_value(table, question, sides)},
        of_walk AS (
            SELECT
                grp, session, walk, any_value(patient) AS patient, bool_or(is_simulated) AS is_simulated,
                avg(value) FILTER (is_used AND side = '{first}') AS one, {other} AS other,
                bool_or(is_used) AS is_used,
                count_if(NOT is_used AND status = 'withheld') AS withheld,
                count_if(NOT is_used AND status = 'care') AS care,
                count_if(NOT is_used AND status NOT IN ('withheld', 'care')) AS not_measured
            FROM every GROUP BY grp, session, walk
        ),
        of_session AS (
            SELECT
                grp, session, any_value(patient) AS patient, bool_or(is_simulated) AS is_simulated,
                avg(one) AS first, avg(other) AS second,
                coalesce((first + second) / 2, first, second) AS value,
                count_if(is_used) AS walks, sum(withheld) AS withheld, sum(care) AS care,
                sum(not_measured) AS not_measured
            FROM of_walk GROUP BY grp, session
        ),
        figures AS (
            SELECT
                grouping(grp) = 1 AS is_all, grp, count(value) AS sessions,
                CASE WHEN count(value) = count(patient) FILTER (value IS NOT NULL)
                    THEN count(DISTINCT patient) FILTER (value IS NOT NULL) ELSE 0 END AS patients,
                sum(walks) AS walks, avg(value) AS mean, stddev_samp(value) AS sd, sum(withheld) AS withheld,
                sum(care) AS care, sum(not_measured) AS not_measured, count_if(value IS NULL) AS without,
                count(DISTINCT session) FILTER (value IS NOT NULL) AS distinct_sessions,
                count(DISTINCT session) FILTER (value IS NOT NULL AND is_simulated) AS simulated
            FROM of_session GROUP BY GROUPING SETS ((grp), ())
        ),
        errors AS (SELECT grp, median(error) AS error FROM every WHERE is_used GROUP BY grp)
        SELECT is_all, grp, sessions, patients, walks, mean, sd, error, withheld, care, not_measured, without,
            distinct_sessions, simulated
        FROM figures LEFT JOIN errors USING (grp)
    """


def _every_value(table: ParameterTable, question: GroupQuestion, sides: tuple[str, str]) -> str:
    """The rows that are asked about, by group, each with whether it counts."""
    measure, columns = question.measure, table.columns
    counted = ", ".join(f"'{status}'" for status in (REPORTED_WITH_CARE if question.has_care else REPORTED))
    simulated = f"coalesce({SIMULATED}, false)" if SIMULATED in columns else "false"
    error = quoted_name(measure + ERROR) if measure + ERROR in columns else "NULL::DOUBLE"
    patient = "nullif(patient::VARCHAR, '')" if "patient" in columns else "NULL::VARCHAR"
    kept = "true" if question.has_simulated else f"NOT {simulated}"
    before, joined = "", ""
    if question.grouping is Grouping.LEG:  # a leg is the other one only where its session has an affected one
        has_one = "bool_or(coalesce(is_affected, false) OR coalesce(is_prosthetic, false)) AS has_one"
        before = f"legs AS (SELECT session, {has_one} FROM {VIEW} GROUP BY session),"
        joined = "LEFT JOIN legs USING (session)"
    return f"""{before} every AS (
            SELECT *, status IN ({counted}) AND coalesce(isfinite(value), false) AS is_used
            FROM (
                SELECT session, walk, side, {_group(question.grouping)} AS grp, {quoted_name(measure)} AS value,
                    {error} AS error, coalesce({quoted_name(measure + STATUS)}, '') AS status,
                    {patient} AS patient, {simulated} AS is_simulated
                FROM {VIEW} {joined} WHERE side IN {sides} AND {kept}
            )
        )"""


def _group(grouping: Grouping) -> str:
    """The name of a row's group, as SQL."""
    match grouping:
        case Grouping.CONDITION | Grouping.DEVICE:
            return f"coalesce(trim({grouping.value}::VARCHAR), '{NOT_STATED}')"
        case Grouping.AGE:
            return _band("age_years::DOUBLE", AGE_EDGES)
        case Grouping.SPEED:
            reported = " OR ".join(f"{SPEED}{STATUS} = '{status}'" for status in REPORTED_WITH_CARE)
            return _band(f"(CASE WHEN {reported} THEN {SPEED} END)", SPEED_EDGES)
        case Grouping.SIDE:
            return f"coalesce(side::VARCHAR, '{NOT_STATED}')"
        case Grouping.LEG:
            return f"""CASE WHEN is_prosthetic THEN '{LEGS[0]}' WHEN is_affected THEN '{LEGS[1]}'
                WHEN has_one THEN '{LEGS[2]}' WHEN is_affected IS NULL AND is_prosthetic IS NULL THEN '{NOT_STATED}'
                ELSE '{LEGS[3]}' END"""
        case Grouping.ALL:
            return "'all'"


def _band(value: str, edges: tuple[float, ...]) -> str:
    """The band of a value by its lower edge, which belongs to it."""
    steps = " ".join(f"WHEN {value} >= {edge} THEN '{edge:g}'" for edge in reversed(edges))
    return f"CASE WHEN {value} IS NULL OR NOT isfinite({value}) THEN '{NOT_STATED}' {steps} ELSE '0' END"


def _row(found: tuple[Any, ...]) -> GroupRow:
    _, group, n, patients, walks, mean, sd, error, withheld, care, not_measured, without, *_ = found
    spread = _number(sd) if n >= LEAST_SESSIONS else math.nan
    standard_error = spread / math.sqrt(n) if n else math.nan
    half = float(stdtrit(n - 1, TWO_SIDED_95)) * standard_error if n >= LEAST_SESSIONS else math.nan
    figures = (_number(mean), spread, standard_error, half, _number(error))
    return GroupRow(str(group), n, patients, int(walks), *figures, int(withheld), int(care), int(not_measured), without)


def _number(value: object) -> float:
    return float(value) if isinstance(value, float) else math.nan


def _place(grouping: Grouping, group: str) -> tuple[bool, float, str]:
    """Bands and legs in their own order, what was typed by the alphabet, what is not stated last."""
    if grouping in (Grouping.AGE, Grouping.SPEED) and group != NOT_STATED:
        return False, float(group), ""
    if grouping is Grouping.LEG and group in LEGS:
        return False, LEGS.index(group), ""
    return group == NOT_STATED, 0.0, group.casefold()
