"""Findings that a reader of page one alone has to know.

There are at most three, larger than their error, and one caveat.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import IntEnum

from app.summary import quality
from app.summary.comparison import Compared, Comparison, Contrast, compare_legs
from app.summary.facts import KINDS, Facts, joint_of, role
from app.summary.interval_words import evidence, interval_words
from app.summary.measure_sentences import (
    Reported,
    change_sentence,
    leg_beside_leg,
    unit_and_decimals,
    who_of_role,
)
from app.summary.numbers_in_words import band_in_figures, fixed, signed
from app.summary.panels import HEIGHTS, peak_name
from app.summary.plain_text import CONDITION_LENGTH, typed
from app.summary.trend_lines import all_lines, walked_visits
from app.wording.body import name_of
from app.wording.dates import date
from app.wording.measures import name_in_sentence
from app.wording.recordings import name_in_words
from app.wording.translation import capitalised, later, tr
from core.body import Joint, Side
from core.parameters import (
    ANKLE_RANGE,
    BETWEEN_LEGS,
    BY_COLUMN,
    KNEE,
    KNEE_RANGE,
    PUSH_OFF,
    SPEED,
    STANCE,
    QuantityClass,
)
from core.results import ZeroKind
from core.timed.measures import PROTOCOLS
from core.verdicts.measurement_error import Difference, least_error
from core.verdicts.model import Verdict
from core.verdicts.quantities import joint_of as joint_of_column
from core.verdicts.sigmas import ComparisonKind

MAX_FINDINGS = 3
BANDS_ON_PAPER = later("reference [1]"), later("reference [2]")  # with the numbers of the sources on its last page
BANDS_ON_SCREEN = later("reference"), later("reference")
MAX_AWAY_SD = 2.0  # of a band: what lies nearer is inside of it
MAX_OFFSET_DEG = 10.0  # laboratories differ by 7 deg in the height of their curves, a standing zero by 3 deg


class Since(IntEnum):
    """What a finding is compared with; that which is reported first is least."""

    CHOSEN = 0
    LAST_VISIT = 1
    FIRST_VISIT = 2
    NOTHING = 3
    """Of this visit alone: the legs, and the bands."""


class Rank(IntEnum):
    """Which kind of finding is reported first."""

    SHAPE = 0
    TIMING = 1
    BETWEEN = 2
    DISTANCE = 3
    HEIGHT = 4


_RANKS = {
    QuantityClass.SHAPE: Rank.SHAPE,
    QuantityClass.PEAK_TIME: Rank.SHAPE,
    QuantityClass.EXCURSION: Rank.SHAPE,
    QuantityClass.TIMING: Rank.TIMING,
    QuantityClass.BETWEEN: Rank.BETWEEN,
    QuantityClass.DISTANCE: Rank.DISTANCE,
    QuantityClass.HEIGHT: Rank.HEIGHT,
}
FAMILIES = {KNEE_RANGE: KNEE, ANKLE_RANGE: PUSH_OFF}
LEAST_CERTAIN = ("ankle_toes_lifted_deg",)  # attached again it differs by 3 deg, and simulated healthy legs by more
STATED_BETWEEN_LEGS = tuple(  # each leg has a zero of its own, so no height is among them
    column
    for column in BETWEEN_LEGS
    if column not in LEAST_CERTAIN and BY_COLUMN[column].rests_on is not QuantityClass.HEIGHT
)
FIRST_OF_ALIKE = (KNEE, "knee_while_loading_deg", STANCE, SPEED)
Topic = tuple[Joint | Side | None, Rank | None, bool]
"""A joint, or a leg and a kind of figure, with the direction: of each, one finding is reported."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """A finding that may be reported; `ratio` is how many times it is as large as what it has to exceed.

    `stated` is its sentence, `evidence` a second one that states what it exceeds, where the first does not. `column` is
    the measure's, empty where it is a band's.
    """

    rank: Rank
    ratio: float
    topics: tuple[Topic, ...]
    stated: str
    evidence: str = ""
    column: str = ""
    since: Since = Since.NOTHING
    is_agreed: bool = False
    is_of_other_side: bool = False

    @property
    def weight(self) -> tuple[Since, bool, Rank, bool, float, int]:
        """What is reported first is least: goals, the kind, the affected side, the ratio, then the measure."""
        among = FIRST_OF_ALIKE.index(self.column) if self.column in FIRST_OF_ALIKE else len(FIRST_OF_ALIKE)
        ratio = -round(self.ratio, 1)
        return self.since, not self.is_agreed, self.rank, self.is_of_other_side, ratio, among


def printed_findings(facts: Facts, comparison: Comparison | None) -> list[Candidate]:
    """The findings that are reported on paper, the weightiest first."""
    return ranked_findings(facts, comparison, BANDS_ON_PAPER)


def ranked_findings(facts: Facts, comparison: Comparison | None, bands: tuple[str, str]) -> list[Candidate]:
    """Rank findings: changes first, then kind, then ratio to the error; one per joint and direction."""
    candidates = [
        *_changes(facts, comparison),
        *_since_visits(facts),
        *_between_legs(facts),
        *_beyond_band(facts, bands),
        *_heights(facts),
    ]
    reported: list[Candidate] = []
    known: set[Topic] = set()
    for candidate in sorted(_without_family(candidates), key=lambda one: one.weight):
        if known.isdisjoint(candidate.topics):
            reported.append(candidate)
        known.update(candidate.topics)
    return reported[:MAX_FINDINGS]


def _without_family(candidates: list[Candidate]) -> list[Candidate]:
    """A range and the excursion that makes most of it are one movement: the excursion is reported."""
    movements = {topic for one in candidates if one.column in FAMILIES.values() for topic in one.topics}
    return [one for one in candidates if not (one.column in FAMILIES and movements.intersection(one.topics))]


def unsure_sentence(column: str, found: Difference) -> str:
    """What tables mark and no finding reports: named, so that legs are not called similar above its mark."""
    unit, decimals = unit_and_decimals(column)
    stated = tr("{measure} differs by {size}, {likely}; it depends most on how sensors are attached.")
    size, likely = fixed(abs(found.difference), decimals) + unit, interval_words(column, found)
    return stated.format(measure=capitalised(name_in_sentence(column)), size=size, likely=likely)


def _changes(facts: Facts, comparison: Comparison | None) -> Iterator[Candidate]:
    """What differs from the first part. A height is a finding only where both parts share one zero."""
    for row in comparison.rows if comparison is not None else ():
        is_height = (
            row.measure.needs_height
            and comparison is not None
            and not comparison.is_same_attachment(row.part, row.against)
        )
        if row.is_reported and row.difference.is_worth_a_sentence and not is_height:
            column, found = row.measure.column, row.difference
            topic = _topic(None if row.measure.is_of_walk else row.side, column, found.difference > 0)
            stated = _changed(facts, comparison, row)
            side = None if row.measure.is_of_walk else row.side
            yield _change(facts, column, side, found, stated, topic, Since.CHOSEN)


def _since_visits(facts: Facts) -> Iterator[Candidate]:
    """What has changed since the last visit under this condition, and since the first, by the course's judgement."""
    walked = walked_visits(facts.course, facts.condition)
    for line in all_lines(facts.course, facts.condition, facts.part.agreed):
        for since, found, at in (
            (Since.LAST_VISIT, line.since_last, line.before),
            (Since.FIRST_VISIT, line.since_first, line.first),
        ):
            if found is None or not found.is_worth_a_sentence:
                continue
            values = {one.visit: one.value for one in line.values}
            day = tr("on {day}").format(day=date(walked[at].day))
            now, before = Reported(tr("in this visit"), line.values[-1].value), Reported(day, values[at])
            who = "" if line.side is None else who_of_role(facts, line.side, line.column)
            stated = change_sentence(line.column, who, found.difference, now, before)
            topic = _topic(line.side, line.column, found.difference > 0)
            yield _change(facts, line.column, line.side, found, stated, topic, since)


def _between_legs(facts: Facts) -> Iterator[Candidate]:
    """What differs between the legs."""
    if len(facts.gait) < len(Side):
        return
    first, second = facts.first_and_second
    for column in STATED_BETWEEN_LEGS:
        found = compare_legs(facts.part, column, (first, second))
        if not (found.is_reported and found.is_worth_a_sentence):
            continue
        is_more = found.difference > 0
        topics = (_topic(first, column, is_more), _topic(second, column, not is_more))
        stated = leg_beside_leg(facts, column, found)
        shown = evidence(column, found)
        is_agreed = facts.part.agreed.is_chosen(column, (first, second))
        yield Candidate(_rank(column), found.ratio, topics, stated, shown, column, is_agreed=is_agreed)


def _beyond_band(facts: Facts, bands: tuple[str, str]) -> Iterator[Candidate]:
    """Peaks more than 2 SD from band [1] laid at their curve's height; time and distance, from band [2]."""
    for side, column in _peaks(facts):
        away, band, kind = facts.away_sd(side, column), facts.band(column), column.split("_")[0]
        if not abs(away) > MAX_AWAY_SD or band is None:
            continue
        offset = facts.offset_deg(side, kind)
        pattern = (
            tr(
                "{joint} {peak}: {value}°, more than 2\N{NO-BREAK SPACE}SD below the {group} ({band}° at the "
                "curve's level)."
            )
            if away < 0
            else tr(
                "{joint} {peak}: {value}°, more than 2\N{NO-BREAK SPACE}SD above the {group} ({band}° at the "
                "curve's level)."
            )
        )
        stated = pattern.format(
            joint=capitalised(name_of(joint_of(kind, side))),
            group=tr(bands[0]),
            peak=tr("at initial contact") if "initial_contact" in column else peak_name(column),
            value=fixed(facts.value(side, column).mean, 1),
            band=band_in_figures((band[0] + offset, band[1] + offset), 1),
        )
        yield Candidate(Rank.SHAPE, abs(away) / MAX_AWAY_SD, (_topic(side, column, away > 0),), stated)
    for column in ("stance_percent", "stride_length_m"):
        figure = facts.time_distance[column]
        for side in (one for one in facts.first_and_second if one in facts.sides_with_band and one in figure.sides):
            value = facts.value(side, column)
            if figure.judged_band is None or not math.isfinite(value.mean):
                continue
            low, high = figure.judged_band
            away = (value.mean - (low + high) / 2) / ((high - low) / 2)
            if abs(away) > MAX_AWAY_SD:
                unit, decimals = unit_and_decimals(column)
                pattern = (
                    tr(
                        "{measure}, {side}: {value}, more than 2\N{NO-BREAK SPACE}SD below the {group} "
                        "({band} with measurement error)."
                    )
                    if away < 0
                    else tr(
                        "{measure}, {side}: {value}, more than 2\N{NO-BREAK SPACE}SD above the {group} "
                        "({band} with measurement error)."
                    )
                )
                stated = pattern.format(
                    measure=capitalised(name_in_sentence(column)),
                    side=role(facts, side),
                    group=tr(bands[1]),
                    value=fixed(value.mean, decimals) + unit,
                    band=band_in_figures(figure.judged_band, decimals) + unit,
                )
                rank = _rank(column)
                yield Candidate(rank, abs(away) / MAX_AWAY_SD, (_topic(side, column, away > 0),), stated)


def _heights(facts: Facts) -> Iterator[Candidate]:
    for side in facts.gait:
        for kind in KINDS:
            offset = facts.offset_deg(side, kind)
            if abs(offset) > MAX_OFFSET_DEG:
                stated = tr(
                    "{joint}: the whole curve is {offset}° from the reference. Check the standing reference first."
                ).format(joint=capitalised(name_of(joint_of(kind, side))), offset=signed(offset, 1))
                topics: tuple[Topic, ...] = ((joint_of(kind, side), Rank.HEIGHT, offset > 0),)
                yield Candidate(Rank.HEIGHT, abs(offset) / MAX_OFFSET_DEG, topics, stated)


def caveat(facts: Facts, comparison: Comparison | None) -> list[str]:
    """The one that weighs most: the gravest of what is not reported, else speed, else height."""
    if not_reported := quality.caveats(facts, (Verdict.NOT_REPORTED,)):
        return not_reported[:1]
    speeds = _speeds_apart(comparison)
    if speeds:
        return [tr("Speed {speeds} m/s: part of a difference may be due to speed.").format(speeds=speeds)]
    if any(found.zero is ZeroKind.STANDING for found in facts.calibrated.values()):
        return [
            tr(
                "Angles are measured from the patient's standing posture. That posture shifts the whole curve "
                "up or down."
            )
        ]
    return []


def _speeds_apart(comparison: Comparison | None) -> str:
    """The speeds of what is compared, where one differs from the first by more than its error."""
    if comparison is None:
        return ""
    speeds = {part.letter: part.of_both("speed_m_s") for part in comparison.parts}
    first = speeds[comparison.against.letter]
    if not all(map(math.isfinite, speeds.values())):
        return ""
    for part in comparison.others:
        error = _speed_error(comparison.error_kind(part), (first + speeds[part.letter]) / 2)
        if abs(speeds[part.letter] - first) > error:
            return ", ".join(f"{letter}: {fixed(speed, 2)}" for letter, speed in speeds.items())
    return ""


def _speed_error(kind: ComparisonKind, mean_m_s: float) -> float:
    """What lies between two walks makes of the error of their speeds' difference."""
    error = least_error(SPEED, kind, mean_m_s)[0]
    return error if math.isfinite(error) else math.inf


def _changed(facts: Facts, comparison: Comparison | None, row: Compared) -> str:
    """One figure of one part beside that of the first."""
    is_visits = comparison is not None and comparison.kind is Contrast.VISITS
    names = (typed(name_in_words(part.name), CONDITION_LENGTH) for part in (row.part, row.against))
    now, before = (tr("in {part}").format(part=name) for name in names)
    if is_visits:
        now, before = tr("in this visit"), tr("in the earlier visit")
    side = None if row.measure.is_of_walk else row.side
    reported = Reported(now, row.value.mean), Reported(before, row.other.mean)
    who = "" if side is None else who_of_role(facts, side, row.measure.column)
    return change_sentence(row.measure.column, who, row.difference.difference, *reported)


def _change(
    facts: Facts, column: str, side: Side | None, found: Difference, stated: str, topic: Topic, since: Since
) -> Candidate:
    return Candidate(
        *(_rank(column), found.ratio, (topic,), stated, evidence(column, found), column, since),
        is_agreed=facts.part.agreed.is_chosen(column, tuple(Side) if side is None else (side,)),
        is_of_other_side=facts.affected not in (None, side) and side is not None,
    )


def _peaks(facts: Facts) -> Iterable[tuple[Side, str]]:
    return [
        (side, column)
        for side in facts.gait
        for kind in KINDS
        if facts.is_measured(joint_of(kind, side))
        for column in HEIGHTS[kind]
    ]


def _topic(side: Side | None, column: str, is_more: bool) -> Topic:
    joint = joint_of_column(column, side) if side is not None else None
    return (joint, None, is_more) if joint is not None else (side, _rank(column), is_more)


def _rank(column: str) -> Rank:
    if column in PROTOCOLS:
        return Rank.TIMING if column.endswith("_s") and not column.endswith("_m_s") else Rank.DISTANCE
    return _RANKS[BY_COLUMN[column].rests_on]
