"""Changes between walks, visits or legs, and whether they are more than the measurement error.

Screen, report and files take their figures from here, so that no number is drawn that no table holds.
"""

import math
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

from app.summary.conditions import Part
from app.summary.measures import MEASURES, Measure
from core.body import Joint, Side
from core.gait.spatiotemporal import MeanAndSd
from core.gait.symmetry import symmetry_index_percent
from core.results import ZeroKind
from core.verdicts.measurement_error import Difference, compare
from core.verdicts.model import Assessment, Verdict
from core.verdicts.norms import MIN_STRIDES_FOR_MEAN
from core.verdicts.sigmas import ComparisonKind


class Contrast(StrEnum):
    """What is compared with what."""

    CONDITIONS = "conditions"
    VISITS = "visits"
    SIDES = "sides"
    CHOSEN = "chosen"  # any conditions of any visits


class Reservation(StrEnum):
    """Why a figure is not compared at all."""

    NONE = ""
    NOT_MEASURED = "not_measured"
    OTHER_ZERO = "other_zero"
    NOT_REPORTED = "withheld"


@dataclass(frozen=True)
class Compared:
    """One figure of one part beside that of the part everything is compared with."""

    measure: Measure
    side: Side
    part: Part
    against: Part
    value: MeanAndSd
    other: MeanAndSd
    difference: Difference
    reservation: Reservation

    @property
    def is_reported(self) -> bool:
        return self.reservation is Reservation.NONE and self.difference.is_reported

    @property
    def exceeds(self) -> bool:
        return self.is_reported and self.difference.exceeds


@dataclass(frozen=True)
class Comparison:
    """`parts` in the order of time; each is compared with `parts[base]`."""

    kind: Contrast
    parts: tuple[Part, ...]
    base: int = 0
    is_simulated: bool = False

    @property
    def against(self) -> Part:
        return self.parts[self.base]

    @property
    def others(self) -> tuple[Part, ...]:
        return tuple(part for k, part in enumerate(self.parts) if k != self.base)

    def base_of(self, part: Part) -> Part:
        """Give a part's base: a former walk like it, else what its alignment changed from, else that of all."""
        if self.kind is not Contrast.CONDITIONS:
            return self.against
        before = self.parts[: self.parts.index(part)]
        since = part.alignment.since if part.alignment is not None else ""
        first = (other for other in before if part.is_again(other))
        return next(first, next((other for other in reversed(before) if other.name == since), self.against))

    @property
    def sides(self) -> tuple[Side, ...]:
        return tuple(side for side in Side if any(side in part.sides for part in self.parts))

    @property
    def joints(self) -> tuple[Joint, ...]:
        return tuple(joint for joint in Joint if any(joint in part.joints for part in self.parts))

    @property
    def is_one_attachment(self) -> bool:
        """Whether the sensors stayed on from the first walk to the last."""
        return all(map(self.is_same_attachment, self.others))

    @cached_property
    def has_one_zero_throughout(self) -> bool:
        """Whether the heights of all joints can be compared."""
        return all(map(self.has_one_zero, self.joints))

    @property
    def latest(self) -> Part | None:
        """The last part but the one that all are compared with; None where that is alone."""
        return self.others[-1] if self.others else None

    @property
    def changes(self) -> tuple[Compared, ...]:
        """Give the changes shown, by sentences and table alike: to the latest visit, else of all parts."""
        return tuple(row for row in self.rows if self.kind is not Contrast.VISITS or row.part is self.latest)

    @cached_property
    def rows(self) -> tuple[Compared, ...]:
        """Every measure of each side of each part but the one that all are compared with."""
        return tuple(
            self._row(measure, side, part)
            for measure in MEASURES
            for side in (self.sides[:1] if measure.is_of_walk else self.sides)
            for part in self.others
        )

    def first_readable(self, measure: Measure, side: Side) -> Part:
        """The part that a measure is compared with: of visits, if the base cannot be read, the next that can."""
        if self.kind in (Contrast.VISITS, Contrast.CHOSEN):
            for part in self.parts[self.base :]:
                found, verdict = part.figure(measure, side)
                if found.n and verdict in (Verdict.READ, Verdict.CARE):
                    return part
        return self.against

    def _row(self, measure: Measure, side: Side, part: Part) -> Compared:
        against = self.first_readable(measure, side)
        if part is against:
            against = self.against  # which cannot be read, so that there is no difference
        return (
            self.compare_walks(measure, part, against)
            if measure.is_of_walk
            else self.compare(measure, side, part, against)
        )

    def is_same_attachment(self, part: Part, against: Part | None = None) -> bool:
        """Whether the sensors stayed on between a part and `against`, None: the one that all are compared with."""
        other = against or self.against
        same = (part.visit, part.attachment) == (other.visit, other.attachment)
        return self.kind is not Contrast.VISITS and same

    def has_one_zero(self, joint: Joint) -> bool:
        """Whether all parts that have the joint measured its height from the same kind of zero, and from one."""
        kinds = {part.zero(joint) for part in self.parts if joint in part.joints}
        return len(kinds) == 1 and ZeroKind.NONE not in kinds

    def error_kind(self, part: Part, against: Part | None = None) -> ComparisonKind:
        """What lies between a part and `against`, None: the one that all are compared with."""
        other = against or self.against
        if self.kind is Contrast.VISITS or part.visit != other.visit:
            return ComparisonKind.VISITS
        return ComparisonKind.ATTACHED if self.is_same_attachment(part, other) else ComparisonKind.STRAPPINGS

    def compare(self, measure: Measure, side: Side, part: Part, against: Part | None = None) -> Compared:
        """A measure of one leg against that of `against`, None: of the part that all are compared with."""
        other = against or self.against
        kind, column, pair = self.error_kind(part, other), measure.column, (part, other)
        means = [one.mean(side, column, kind) for one in pair]
        assessments = tuple(one.assessment(side, column) for one in pair)
        return Compared(
            measure,
            side,
            part,
            other,
            part.value(side, column),
            other.value(side, column),
            compare(
                *(column, kind, means[0], means[1], assessments),
                speeds_m_s=(part.speed_m_s, other.speed_m_s),
                is_chosen_before=part.agreed.is_chosen(column, (side,)),
            ),
            self._reservation(measure, side, pair, assessments),
        )

    def compare_walks(self, measure: Measure, part: Part, against: Part) -> Compared:
        """A measure of both legs together."""
        kind, column, side = self.error_kind(part, against), measure.column, self.sides[0]
        one, other = (of.of_walk(column, kind) for of in (part, against))
        assessments = part.assessment_of_walk(column), against.assessment_of_walk(column)
        reservation = Reservation.NONE if one.n and other.n else Reservation.NOT_MEASURED
        if any(found.verdict is Verdict.NOT_REPORTED for found in assessments):
            reservation = Reservation.NOT_REPORTED
        is_chosen = part.agreed.is_chosen(column, Side)
        speeds = part.speed_m_s, against.speed_m_s
        difference = compare(column, kind, one, other, assessments, speeds_m_s=speeds, is_chosen_before=is_chosen)
        values = (part.figure(measure, side)[0], against.figure(measure, side)[0])
        return Compared(measure, side, part, against, *values, difference, reservation)

    def _reservation(
        self, measure: Measure, side: Side, pair: tuple[Part, Part], assessments: tuple[Assessment, ...]
    ) -> Reservation:
        joint = measure.joint(side)
        if not all(one.is_measured(side, measure.column) for one in pair):
            return Reservation.NOT_MEASURED
        if joint is not None and measure.needs_height and not self.has_one_zero(joint):
            return Reservation.OTHER_ZERO
        if not all(found.is_reported for found in assessments):
            return Reservation.NOT_REPORTED
        return Reservation.NONE if all(one.value(side, measure.column).n for one in pair) else Reservation.NOT_MEASURED


@dataclass(frozen=True, slots=True)
class SideRow:
    """One figure of both legs: the first (affected, or left) less the second; symmetry where it means something."""

    measure: Measure
    first: MeanAndSd
    second: MeanAndSd
    verdicts: tuple[Verdict, Verdict]
    difference: Difference
    symmetry_percent: float

    @property
    def is_reported(self) -> bool:
        return self.difference.is_reported

    @property
    def exceeds(self) -> bool:
        return self.is_reported and self.difference.exceeds


def first_and_second(affected: Side | None) -> tuple[Side, Side]:
    """Affected against sound where that is known, else left against right."""
    return (Side.RIGHT, Side.LEFT) if affected is Side.RIGHT else (Side.LEFT, Side.RIGHT)


def compare_sides(part: Part, sides: tuple[Side, Side]) -> tuple[SideRow, ...]:
    """Every measure that was taken of both legs, as `first_and_second` orders them; empty with one leg."""
    first, second = sides
    rows = []
    for measure in MEASURES:
        if measure.is_of_walk or not all(part.is_measured(side, measure.column) for side in sides):
            continue
        one, other = part.value(first, measure.column), part.value(second, measure.column)
        is_biased = not measure.kind and any(map(part.is_toe_off_biased, sides))
        has_index = not measure.needs_height and not is_biased and min(one.n, other.n) >= MIN_STRIDES_FOR_MEAN
        symmetry = symmetry_index_percent(one.mean, other.mean) if has_index else math.nan
        verdicts = (part.assessment(first, measure.column).verdict, part.assessment(second, measure.column).verdict)
        rows.append(SideRow(measure, one, other, verdicts, compare_legs(part, measure.column, sides), symmetry))
    return tuple(rows)


def compare_legs(part: Part, column: str, sides: tuple[Side, Side]) -> Difference:
    """A column of the first leg less that of the second."""
    one, other = (part.mean(side, column, ComparisonKind.LEGS) for side in sides)
    assessments = tuple(part.assessment(side, column) for side in sides)
    is_chosen = part.agreed.is_chosen(column, sides)
    speeds = part.speed_m_s, part.speed_m_s
    return compare(column, ComparisonKind.LEGS, one, other, assessments, speeds_m_s=speeds, is_chosen_before=is_chosen)
