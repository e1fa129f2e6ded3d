"""Walks of one condition, taken together. Their strides, and how far they can be trusted.

Walks of one pool (`app.summary.pooled_walks`) are one part of every comparison.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from functools import cached_property
from statistics import fmean

import numpy as np

from app.charts.cycles import is_mean_enough
from app.charts.stride_chart import StrideCurve
from app.summary.alignments import alignments_of
from app.summary.measures import Measure
from app.summary.pooled_walks import Pool, pool_letters, pools_of
from app.wording.body import side_name
from app.wording.dates import short_date
from app.wording.recordings import LETTERS
from app.wording.translation import tr
from core.alignment import AlignmentChange, condition_returned_to
from core.body import Joint, Side
from core.gait.chosen_strides import left_out_by_hand
from core.gait.cycles import POINTS, MeanCycle, mean_cycle
from core.gait.spatiotemporal import BothFeet, MeanAndSd, mean_and_sd
from core.gait.strides import Reason
from core.goals import NO_GOALS, AgreedGoals
from core.parameters import CADENCE, SPEED
from core.results import Analysis, JointCalibration, RecordingAnalysis, ZeroKind
from core.samples import FloatArray
from core.session import Recording, RecordingKind
from core.verdicts.measurement_error import ANGLE_PER_LAG_DEG_S
from core.verdicts.model import Assessment, Verdict, Verdicts, pooled, together
from core.verdicts.norms import MIN_STRIDES_FOR_MEAN
from core.verdicts.quantities import (
    EXCURSIONS_BY_COLUMN,
    WINDOWS,
    assessment_of,
    assessment_of_both,
    both_sides,
    joint_of,
    raw_values,
    used_cycles,
)
from core.verdicts.sigmas import ComparisonKind
from core.verdicts.stride_means import MeanOfStrides, mean_of_strides


@dataclass(frozen=True)
class Part:
    """One condition or walk, of this visit or another: its walks, whose strides are taken together.

    `attachment` numbers how often the sensors had been strapped on again before; equal numbers of one visit share it.
    `visit` numbers the visits of a comparison of several, and `day` is when that visit was, if that is known.
    `alignment` is what was changed at the prosthesis before it, and since which condition; `agreed` are the goals by
    its day. `is_apart`: it is of timed tests, or a walk towards a target, beside the walks of its condition.
    """

    letter: str
    name: str
    walks: tuple[RecordingAnalysis, ...]
    calibrated: Mapping[Joint, JointCalibration]
    attachment: int = 0
    visit: int = 0
    day: date | None = None
    alignment: AlignmentChange | None = None
    agreed: AgreedGoals = NO_GOALS
    is_apart: bool = False

    @property
    def sides(self) -> tuple[Side, ...]:
        return tuple(side for side in Side if any(side in walk.gait for walk in self.walks))

    @property
    def short_name(self) -> str:
        """As a chart's key has room for: the day of another visit, else its name."""
        return short_date(self.day) if self.day is not None else self.name

    @property
    def returned_to(self) -> str:
        """The condition that it is: its own, or the earlier one that the prosthesis was put back to before it."""
        return condition_returned_to(self.name, self.alignment)

    def is_again(self, other: "Part") -> bool:
        """Whether it is the condition of another part, which the prosthesis was put back to since."""
        is_same = (self.returned_to, self.attachment) == (other.returned_to, other.attachment)
        return self is not other and is_same

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Those with mean cycles."""
        has = {joint for walk in self.walks for gait in walk.gait.values() for joint in gait.cycles}
        return tuple(joint for joint in Joint if joint in has)

    @cached_property
    def verdicts(self) -> Verdicts:
        """Of every quantity the worst that one of its walks has."""
        return pooled(walk.verdicts for walk in self.walks)

    def assessment(self, side: Side, column: str) -> Assessment:
        return assessment_of(self.verdicts, side, "stride_time_s" if column == CADENCE else column)

    def values(self, side: Side, column: str) -> FloatArray:
        """Of the strides used of all walks (k,), degrees, percent, metres or seconds; none where not reported."""
        if column == CADENCE:
            return 120.0 / self.values(side, "stride_time_s")
        found = [
            raw_values(walk.gait[side], column)[walk.gait[side].strides.is_used]
            for walk in self.walks
            if side in walk.gait
        ]
        return np.concatenate(found) if found and self.assessment(side, column).is_reported else np.empty(0)

    @cached_property
    def _found_values(self) -> dict[tuple[Side, str], MeanAndSd]:
        return {}

    def value(self, side: Side, column: str) -> MeanAndSd:
        """Over the strides used of all walks; found once, for it is in every row that the part is in."""
        found = self._found_values.get((side, column))
        if found is None:
            found = self._found_values[side, column] = mean_and_sd(self.values(side, column))
        return found

    @cached_property
    def _found_means(self) -> dict[tuple[Side, str, bool], MeanOfStrides]:
        return {}

    def mean(self, side: Side, column: str, kind: ComparisonKind) -> MeanOfStrides:
        """The same with its uncertainty in a comparison of a kind; walks of one strapping share lags and axes."""
        is_shared = kind in (ComparisonKind.HALVES, ComparisonKind.ATTACHED)
        found = self._found_means.get((side, column, is_shared))
        if found is None:
            errors = (0.0, 0.0) if is_shared else (self._clock_error(side, column), self._axis_error(side, column))
            found = self._found_means[side, column, is_shared] = mean_of_strides(self.values(side, column), *errors)
        return found

    def _clock_error(self, side: Side, column: str) -> float:
        joint = joint_of(column, side)
        found = self.calibrated.get(joint) if joint is not None else None
        return ANGLE_PER_LAG_DEG_S * (found.lag_sd_s or 0.0) if found is not None else 0.0

    def _axis_error(self, side: Side, column: str) -> float:
        """What the axes of either part of a walk's data make of a joint's mean, root mean square of the walks."""
        joint = joint_of(column, side)
        if joint is None or not column.startswith(joint.kind):
            return 0.0
        name = f"{column.removesuffix('_deg')}_rad"
        halves = [walk.axis_halves[joint] for walk in self.walks if joint in walk.axis_halves]
        found = [one.spread[name] ** 2 for one in halves if name in one.spread]
        return math.degrees(math.sqrt(fmean(found))) if found else 0.0

    def strides_deg(self, joint: Joint) -> FloatArray:
        """The joint's angle over the strides used of all walks (k, 101), degrees, even where it may not be reported."""
        cycles = [used_cycles(walk, joint) for walk in self.walks if joint.side in walk.gait]
        return np.rad2deg(np.concatenate(cycles)) if cycles else np.empty((0, POINTS))

    def cycle(self, joint: Joint) -> MeanCycle:
        """Mean over the strides used of all walks, degrees; NaN throughout where its shape or sign is not reported."""
        return mean_cycle(self.strides_deg(joint) if self.is_drawn(joint) else np.empty((0, POINTS)))

    def curve(self, joint: Joint, *, is_about_mean: bool) -> StrideCurve:
        """A joint's mean cycle as charts show it; without its height where that adds nothing to the others'."""
        found, off = self.cycle(joint), self.value(joint.side, "stance_percent")
        return StrideCurve(
            self.letter,
            joint.side,
            angle_deg=found.mean - np.mean(found.mean) if is_about_mean else found.mean,
            toe_off_percent=off.mean if is_mean_enough(off.n) else math.nan,
            toe_off_label=self.letter,
            is_few=not is_mean_enough(found.n),
        )

    def is_measured(self, side: Side, column: str) -> bool:
        """Whether a column of strides.csv is of the leg itself, or of a joint or a pelvis that was measured."""
        joint = joint_of(column, side)
        if column.startswith("pelvis") and not self.has_pelvis:
            return False
        return side in self.sides and (joint is None or joint in self.joints)

    @property
    def has_pelvis(self) -> bool:
        return any(walk.pelvis is not None for walk in self.walks)

    def is_drawn(self, joint: Joint) -> bool:
        """Whether the joint's curve may be seen at all."""
        found = self.verdicts.joint(joint)
        return together((found.shape, found.sign)).is_reported

    def is_no_peak(self, side: Side, column: str) -> bool:
        """Whether the angle is known and only passes through where this peak is looked for."""
        joint = joint_of(column, side)
        if (
            joint is None
            or column not in {*WINDOWS, *EXCURSIONS_BY_COLUMN}
            or not self.assessment(side, column).is_reported
        ):
            return False
        return self.cycle(joint).n >= MIN_STRIDES_FOR_MEAN and not math.isfinite(self.value(side, column).mean)

    def of_both(self, name: str) -> float:
        """Cadence, double support or speed (the names of `BothFeet`), mean of the walks; NaN if one withholds it."""
        if not assessment_of_both(self.verdicts, name).is_reported:
            return math.nan
        known = [value for walk in self._both_of_walks if math.isfinite(value := getattr(walk, name))]
        return fmean(known) if known else math.nan

    @property
    def speed_m_s(self) -> float:
        """Walking speed, mean of the walks; NaN where it is not reported."""
        return self.of_both(SPEED)

    @cached_property
    def _both_of_walks(self) -> tuple[BothFeet, ...]:
        return tuple(map(both_sides, self.walks))

    def of_walk(self, column: str, kind: ComparisonKind) -> MeanOfStrides:
        """Speed or cadence of both legs, as sure as one leg's strides are: adjacent strides are alike."""
        value, one = self.of_both(column), self.mean(self.sides[0], column, kind)
        if not math.isfinite(value):
            return mean_of_strides(np.empty(0))
        share = value / one.mean
        of_one = (one.standard_error, one.drift, one.clock_error)
        return MeanOfStrides(value, share * one.sd, one.n, *(share * uncertainty for uncertainty in of_one))

    def assessment_of_walk(self, column: str) -> Assessment:
        """What may be stated about speed or cadence."""
        return assessment_of_both(self.verdicts, column)

    def figure(self, measure: Measure, side: Side) -> tuple[MeanAndSd, Verdict]:
        """A measure of one leg, or of the walk, and how far it can be trusted."""
        if measure.is_of_walk:
            found = self.of_walk(measure.column, ComparisonKind.VISITS)
            return MeanAndSd(found.mean, found.sd, found.n), self.assessment_of_walk(measure.column).verdict
        verdict = self.assessment(side, measure.column).verdict
        return self.value(side, measure.column), verdict if self.is_measured(
            side, measure.column
        ) else Verdict.NOT_MEASURED

    def is_toe_off_biased(self, side: Side) -> bool:
        return any(walk.gait[side].is_toe_off_biased for walk in self.walks if side in walk.gait)

    def stance_percent(self, side: Side) -> float:
        return self.value(side, "stance_percent").mean

    def strides(self, side: Side) -> int:
        return sum(int(np.count_nonzero(walk.gait[side].strides.is_used)) for walk in self.walks if side in walk.gait)

    def reasons(self, side: Side) -> Counter[Reason]:
        """Of how many strides each reason holds, those that are used among them."""
        return Counter(reason for walk in self.walks if side in walk.gait for reason in walk.gait[side].strides.reason)

    def left_out_by_hand(self, side: Side | None) -> int:
        """Of one side, or of both."""
        gaits = [walk.gait[one] for walk in self.walks for one in walk.gait if side in (None, one)]
        return sum(map(left_out_by_hand, gaits))

    def zero(self, joint: Joint) -> ZeroKind:
        if joint.is_hip:  # its frames come from standing, or there is none
            return ZeroKind.STANDING if joint in self.joints else ZeroKind.NONE
        return self.calibrated[joint].zero if joint in self.calibrated else ZeroKind.NONE


def conditions_of(
    analysis: Analysis, recordings: Sequence[Recording], prefix: str = "", agreed: AgreedGoals = NO_GOALS
) -> tuple[Part, ...]:
    """Give a session's condition parts, tests and target walks only where alone; arguments as `parts_of`."""
    parts = parts_of(analysis, recordings, prefix, agreed)
    walked = {(part.name, part.attachment) for part in parts if not part.is_apart}
    return tuple(part for part in parts if not part.is_apart or (part.name, part.attachment) not in walked)


def parts_of(
    analysis: Analysis, recordings: Sequence[Recording], prefix: str = "", agreed: AgreedGoals = NO_GOALS
) -> tuple[Part, ...]:
    """Give the walks with strides, pooled by condition; walks without one stay single, named as recorded.
    `recordings`: in time order; `prefix`: before each letter; letters of parts without strides are skipped.
    """
    pools, letters, changed = pools_of(recordings), pool_letters(recordings), alignments_of(recordings)
    others = iter(letter for letter in LETTERS if letter not in letters.values())  # of walks not in `recordings`
    found: dict[Pool, list[RecordingAnalysis]] = {}
    for walk in _walks(analysis):
        found.setdefault(pools.get(walk.name, Pool(walk.name)), []).append(walk)
    parts = [
        Part(
            prefix + letter,
            pool.condition,
            tuple(walks),
            analysis.calibrated_for(walks[0]),
            pool.attachment,
            alignment=changed.get(pool.condition),
            agreed=agreed,
            is_apart=bool(pool.apart),
        )
        for pool, walks in found.items()
        if (letter := letters[pool] if pool in letters else next(others, ""))
    ]
    return tuple(parts)


def _walks(analysis: Analysis) -> list[RecordingAnalysis]:
    return [
        recording
        for recording in analysis.recordings
        if recording.kind is RecordingKind.WALKING
        and any(gait.strides.is_used.any() for gait in recording.gait.values())
    ]


def left_out_of_parts(parts: Sequence[Part]) -> str:
    """Which strides of what is compared were left out by hand; empty where none was."""
    reported = [(part.letter, by_hand_in_words(walk)) for part in parts for walk in part.walks]
    return " ".join(f"{letter}: {words}" for letter, words in reported if words)


def by_hand_in_words(*walks: RecordingAnalysis) -> str:
    """How many strides of which side a person has left out; empty where none was."""
    stated = []
    for side in Side:
        gaits = [walk.gait[side] for walk in walks if side in walk.gait]
        if count := sum(map(left_out_by_hand, gaits)):
            reported = tr("{count} of {of} {side} strides excluded by hand.")
            stated.append(reported.format(count=count, of=sum(len(g.strides) for g in gaits), side=side_name(side)))
    return " ".join(stated)
