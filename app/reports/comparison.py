"""What changed between walks, visits or legs, and is that more than the measurement error?

Screen, report and files take their figures from here, so that no number is drawn that no table holds.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from enum import StrEnum
from functools import cached_property
from itertools import accumulate
from statistics import fmean

import numpy as np

from app.charts.cycles import is_mean_enough
from app.charts.stride_chart import StrideCurve
from app.recording_names import LETTERS, condition_letters
from app.reports.alignments import alignments_of
from app.reports.walk_figures import by_hand_in_words
from app.wording import joined, later, tr
from core.alignment import AlignmentChange
from core.body import Joint, Side
from core.chosen_strides import left_out_by_hand
from core.gait.cycles import POINTS, MeanCycle, mean_cycle
from core.gait.spatiotemporal import BothFeet, MeanAndSd, mean_and_sd
from core.gait.symmetry import symmetry_index_percent
from core.goals import NO_GOALS, AgreedGoals
from core.norms import MIN_STRIDES_FOR_MEAN
from core.results import Analysis, JointCalibration, RecordingAnalysis, ZeroKind
from core.samples import FloatArray, Recording, RecordingKind
from core.verdicts.measurement_error import ANGLE_PER_LAG_DEG_S, ComparisonKind, Difference, ErrorSource, compare
from core.verdicts.model import Assessment, Verdict, Verdicts, pooled, together
from core.verdicts.quantities import (
    CLASSES,
    EXCURSIONS_BY_COLUMN,
    WINDOWS,
    QuantityClass,
    assessment_of,
    assessment_of_both,
    both_sides,
    joint_of,
    raw_values,
    used_cycles,
)
from core.verdicts.stride_means import MeanOfStrides, mean_of_strides

ERROR_SOURCES = {
    ErrorSource.CHANCE: later("chance between strides"),
    ErrorSource.DRIFT: later("drift within a walk"),
    ErrorSource.CLOCK: later("the sensors' clocks"),
    ErrorSource.SPEED: later("another walking speed"),
    ErrorSource.WALKS: later("what walks differ by"),
    ErrorSource.STRAPS: later("strapping the sensors on"),
    ErrorSource.DAYS: later("what days differ by"),
    ErrorSource.EVENTS: later("events that come early or late"),
    ErrorSource.ZERO: later("the zero"),
}
PELVIS = "pelvis"
CADENCE = "cadence_steps_min"  # of both legs; of one, two steps in each of its strides


@dataclass(frozen=True, slots=True)
class Measure:
    """One figure that is compared; `column` is a quantity of strides, `kind` knee, ankle, hip, pelvis or empty.

    `is_of_walk`: both legs have the same, so it is told once, of both.
    """

    column: str
    name: str
    kind: str
    unit: str = "°"
    decimals: int = 1
    is_of_walk: bool = False

    @classmethod
    def of(cls, column: str) -> "Measure":
        """Any column of strides.csv; only an angle is a joint's."""
        is_angle = column.endswith("_deg")
        return cls(column, "", column.split("_")[0] if is_angle else "", "°" if is_angle else "%")

    def joint(self, side: Side) -> Joint | None:
        """Whose figure it is; None where it is no joint's."""
        return joint_of(self.column, side)

    @property
    def needs_height(self) -> bool:
        """Whether it says something only with a zero of the same kind."""
        return CLASSES.get(self.column) is QuantityClass.HEIGHT


MEASURES = (
    Measure("knee_stance_to_swing_deg", later("Knee, stance to swing"), "knee"),
    Measure("knee_while_loading_deg", later("Knee while loading"), "knee"),
    Measure("knee_swing_peak_deg", later("Knee swing peak"), "knee"),
    Measure("knee_range_deg", later("Knee range"), "knee"),
    Measure("ankle_push_off_deg", later("Ankle push-off"), "ankle"),
    Measure("ankle_rocker_deg", later("Ankle rocker"), "ankle"),
    Measure("ankle_range_deg", later("Ankle range"), "ankle"),
    Measure("hip_range_deg", later("Hip range"), "hip"),
    Measure("hip_extension_peak_deg", later("Hip, most extended"), "hip"),
    Measure("pelvis_obliquity_range_deg", later("Pelvis, obliquity range"), "pelvis"),
    Measure("pelvis_drop_deg", later("Pelvis drop in swing"), "pelvis"),
    Measure("stance_percent", later("Stance time, % of stride"), "", "%"),
    Measure("stride_length_m", later("Stride length, m"), "", "m", 2),
    Measure("speed_m_s", later("Walking speed, m/s"), "", "m/s", 2, is_of_walk=True),
    Measure(CADENCE, later("Cadence, steps/min"), "", "steps/min", 0, is_of_walk=True),
)

FITTED = (  # those of `core.verdicts.fitting` that the bench names where they are larger than their error
    Measure("knee_terminal_extension_deg", later("Knee, straightest in swing"), "knee"),
    Measure("knee_extended_before_contact_percent", later("Knee straight before contact"), "", "%"),
    Measure("foot_heel_rise_deg", later("Heel rise"), ""),
    Measure("foot_pitch_at_contact_deg", later("Foot pitch at contact"), ""),
    Measure("foot_flat_percent", later("Foot flat, % of stride"), "", "%"),
    Measure("shank_over_flat_foot_deg", later("Shank over the flat foot"), ""),
)


def sources_in_words(differences: Iterable[Difference]) -> str:
    """What the errors of some differences contain, each once."""
    found = {source for one in differences for source in one.sources}
    return joined([tr(words) for source, words in ERROR_SOURCES.items() if source in found])


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
    WITHHELD = "withheld"


@dataclass(frozen=True)
class Part:
    """One condition or walk, of this visit or another: its walks, whose strides are taken together.

    `attachment` numbers how often the sensors had been strapped on anew before; equal numbers of one visit share it.
    `visit` numbers the visits of a comparison of several, and `day` is when that visit was, if that is known.
    `alignment` is what was changed at the prosthesis before it, and since which condition; `agreed` are the goals by
    its day.
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

    @property
    def sides(self) -> tuple[Side, ...]:
        return tuple(side for side in Side if any(side in walk.gait for walk in self.walks))

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
        """Of the strides used of all walks (k,), degrees, percent, metres or seconds; none where withheld."""
        if column == CADENCE:
            return 120.0 / self.values(side, "stride_time_s")
        found = [
            raw_values(walk.gait[side], column)[walk.gait[side].strides.is_used]
            for walk in self.walks
            if side in walk.gait
        ]
        return np.concatenate(found) if found and self.assessment(side, column).is_told else np.empty(0)

    @cached_property
    def _found_values(self) -> dict[tuple[Side, str], MeanAndSd]:
        return {}

    def value(self, side: Side, column: str) -> MeanAndSd:
        """Over the strides used of all walks; found once, for it stands in every row that the part is in."""
        found = self._found_values.get((side, column))
        if found is None:
            found = self._found_values[side, column] = mean_and_sd(self.values(side, column))
        return found

    @cached_property
    def _found_means(self) -> dict[tuple[Side, str, float], MeanOfStrides]:
        return {}

    def mean(self, side: Side, column: str, kind: ComparisonKind) -> MeanOfStrides:
        """The same with its uncertainty in a comparison of a kind; walks of one strapping share their lags."""
        joint = joint_of(column, side)
        lag_sd_s = (self.calibrated[joint].lag_sd_s or 0.0) if joint and joint in self.calibrated else 0.0
        is_shared = kind in (ComparisonKind.HALVES, ComparisonKind.ATTACHED)
        clock_error = 0.0 if is_shared else ANGLE_PER_LAG_DEG_S * lag_sd_s
        found = self._found_means.get((side, column, clock_error))
        if found is None:
            found = mean_of_strides(self.values(side, column), clock_error)
            self._found_means[side, column, clock_error] = found
        return found

    def cycle(self, joint: Joint) -> MeanCycle:
        """Mean over the strides used of all walks, degrees; NaN throughout where its shape or sign is withheld."""
        found = self.verdicts.joint(joint)
        cycles = [used_cycles(walk, joint) for walk in self.walks if joint.side in walk.gait]
        if not cycles or not together((found.shape, found.sign)).is_told:
            return mean_cycle(np.empty((0, POINTS)))
        return mean_cycle(np.rad2deg(np.concatenate(cycles)))

    def curve(self, joint: Joint, *, is_about_mean: bool) -> StrideCurve:
        """A joint's mean cycle as charts show it; without its height where that says nothing beside the others'."""
        found, off = self.cycle(joint), self.value(joint.side, "stance_percent")
        return StrideCurve(
            self.letter,
            joint.side,
            angle_deg=found.mean - np.mean(found.mean) if is_about_mean else found.mean,
            toe_off_percent=off.mean if is_mean_enough(off.n) else math.nan,
            toe_off_label=self.letter,
            is_few=not is_mean_enough(found.n),
        )

    def is_measured(self, side: Side, measure: Measure) -> bool:
        joint = measure.joint(side)
        if measure.kind == PELVIS and all(walk.pelvis is None for walk in self.walks):
            return False
        return side in self.sides and (joint is None or joint in self.joints)

    def is_drawn(self, joint: Joint) -> bool:
        """Whether the joint's curve may be seen at all."""
        found = self.verdicts.joint(joint)
        return together((found.shape, found.sign)).is_told

    def is_no_peak(self, side: Side, column: str) -> bool:
        """Whether the angle is known and only passes through where this peak is looked for."""
        joint = Measure.of(column).joint(side)
        if (
            joint is None
            or column not in {*WINDOWS, *EXCURSIONS_BY_COLUMN}
            or not self.assessment(side, column).is_told
        ):
            return False
        return self.cycle(joint).n >= MIN_STRIDES_FOR_MEAN and not math.isfinite(self.value(side, column).mean)

    def of_both(self, name: str) -> float:
        """Cadence, double support or speed (the names of `BothFeet`), mean of the walks; NaN if one withholds it."""
        if not assessment_of_both(self.verdicts, name).is_told:
            return math.nan
        known = [value for walk in self._both_of_walks if math.isfinite(value := getattr(walk, name))]
        return fmean(known) if known else math.nan

    @cached_property
    def _both_of_walks(self) -> tuple[BothFeet, ...]:
        return tuple(map(both_sides, self.walks))

    def of_walk(self, column: str, kind: ComparisonKind) -> MeanOfStrides:
        """Speed or cadence of both legs, as sure as one leg's strides are: neighbours step alike."""
        value, one = self.of_both(column), self.mean(self.sides[0], column, kind)
        if not math.isfinite(value):
            return mean_of_strides(np.empty(0))
        share = value / one.mean
        of_one = (one.standard_error, one.drift, one.clock_error)
        return MeanOfStrides(value, share * one.sd, one.n, *(share * uncertainty for uncertainty in of_one))

    def assessment_of_walk(self, column: str) -> Assessment:
        """What may be said of speed or cadence."""
        return assessment_of_both(self.verdicts, column)

    def figure(self, measure: Measure, side: Side) -> tuple[MeanAndSd, Verdict]:
        """A measure of one leg, or of the walk, and how far it can be trusted."""
        if measure.is_of_walk:
            found = self.of_walk(measure.column, ComparisonKind.VISITS)
            return MeanAndSd(found.mean, found.sd, found.n), self.assessment_of_walk(measure.column).verdict
        verdict = self.assessment(side, measure.column).verdict
        return self.value(side, measure.column), verdict if self.is_measured(side, measure) else Verdict.NOT_MEASURED

    def is_toe_off_biased(self, side: Side) -> bool:
        return any(walk.gait[side].is_toe_off_biased for walk in self.walks if side in walk.gait)

    def stance_percent(self, side: Side) -> float:
        return self.value(side, "stance_percent").mean

    def strides(self, side: Side) -> int:
        return sum(int(np.count_nonzero(walk.gait[side].strides.is_used)) for walk in self.walks if side in walk.gait)

    def left_out_by_hand(self, side: Side | None) -> int:
        """Of one side, or of both."""
        gaits = [walk.gait[one] for walk in self.walks for one in walk.gait if side in (None, one)]
        return sum(map(left_out_by_hand, gaits))

    def zero(self, joint: Joint) -> ZeroKind:
        if joint.is_hip:  # its frames come from standing, or there is none
            return ZeroKind.STANDING if joint in self.joints else ZeroKind.NONE
        return self.calibrated[joint].zero if joint in self.calibrated else ZeroKind.NONE


def left_out_of_parts(parts: Sequence[Part]) -> str:
    """Which strides of what is compared were left out by hand; empty where none was."""
    told = [(part.letter, by_hand_in_words(walk)) for part in parts for walk in part.walks]
    return " ".join(f"{letter}: {words}" for letter, words in told if words)


@dataclass(frozen=True)
class Compared:
    """One figure of one part beside that of the part everything is told against."""

    measure: Measure
    side: Side
    part: Part
    against: Part
    value: MeanAndSd
    other: MeanAndSd
    difference: Difference
    reservation: Reservation

    @property
    def is_told(self) -> bool:
        return self.reservation is Reservation.NONE and self.difference.is_told

    @property
    def exceeds(self) -> bool:
        return self.is_told and self.difference.exceeds


@dataclass(frozen=True)
class Comparison:
    """`parts` in the order of time; each is told against `parts[base]`."""

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
        """What a part is told against: the condition that its alignment was changed from, else that of all.

        Where sensors were strapped on anew a condition may be there twice: the latest before the part counts.
        """
        since = part.alignment.since if part.alignment is not None and self.kind is Contrast.CONDITIONS else ""
        before = self.parts[: self.parts.index(part)]
        return next((other for other in reversed(before) if other.name == since), self.against)

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
        """The last part but the one told against; None where it stands alone."""
        return self.others[-1] if self.others else None

    @property
    def changes(self) -> tuple[Compared, ...]:
        """What the screen tells: between visits the change to the latest, else the changes of all parts.

        Its sentences and its table speak of these alone, so that no sentence says what the table does not show.
        """
        return tuple(row for row in self.rows if self.kind is not Contrast.VISITS or row.part is self.latest)

    @cached_property
    def rows(self) -> tuple[Compared, ...]:
        """Every measure of each side of each part but the one told against."""
        return tuple(
            self._row(measure, side, part)
            for measure in MEASURES
            for side in (self.sides[:1] if measure.is_of_walk else self.sides)
            for part in self.others
        )

    def first_readable(self, measure: Measure, side: Side) -> Part:
        """The part that a measure is told against: of visits, if the base cannot be read, the next that can."""
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
        """Whether the sensors stayed on between a part and `against`, None: the one that all are told against."""
        other = against or self.against
        same = (part.visit, part.attachment) == (other.visit, other.attachment)
        return self.kind is not Contrast.VISITS and same

    def has_one_zero(self, joint: Joint) -> bool:
        """Whether all parts that have the joint measured its height from the same kind of zero, and from one."""
        kinds = {part.zero(joint) for part in self.parts if joint in part.joints}
        return len(kinds) == 1 and ZeroKind.NONE not in kinds

    def error_kind(self, part: Part, against: Part | None = None) -> ComparisonKind:
        """What lies between a part and `against`, None: the one that all are told against."""
        other = against or self.against
        if self.kind is Contrast.VISITS or part.visit != other.visit:
            return ComparisonKind.VISITS
        return ComparisonKind.ATTACHED if self.is_same_attachment(part, other) else ComparisonKind.STRAPPINGS

    def compare(self, measure: Measure, side: Side, part: Part, against: Part | None = None) -> Compared:
        """A measure of one leg against that of `against`, None: of the part that all are told against."""
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
                speed_apart_m_s=_speed_apart_m_s(part, other),
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
        if any(found.verdict is Verdict.WITHHELD for found in assessments):
            reservation = Reservation.WITHHELD
        is_chosen = part.agreed.is_chosen(column, Side)
        difference = compare(column, kind, one, other, assessments, is_chosen_before=is_chosen)
        values = (part.figure(measure, side)[0], against.figure(measure, side)[0])
        return Compared(measure, side, part, against, *values, difference, reservation)

    def _reservation(
        self, measure: Measure, side: Side, pair: tuple[Part, Part], assessments: tuple[Assessment, ...]
    ) -> Reservation:
        joint = measure.joint(side)
        if not all(one.is_measured(side, measure) for one in pair):
            return Reservation.NOT_MEASURED
        if joint is not None and measure.needs_height and not self.has_one_zero(joint):
            return Reservation.OTHER_ZERO
        if not all(found.is_told for found in assessments):
            return Reservation.WITHHELD
        return Reservation.NONE if all(one.value(side, measure.column).n for one in pair) else Reservation.NOT_MEASURED


def _speed_apart_m_s(one: Part, other: Part) -> float:
    """By how much the walks' speeds differ; 0 where one is not known."""
    speeds = [part.of_both("speed_m_s") for part in (one, other)]
    return abs(speeds[0] - speeds[1]) if all(map(math.isfinite, speeds)) else 0.0


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
    def is_told(self) -> bool:
        return self.difference.is_told

    @property
    def exceeds(self) -> bool:
        return self.is_told and self.difference.exceeds


def first_and_second(affected: Side | None) -> tuple[Side, Side]:
    """Affected against sound where that is known, else left against right."""
    return (Side.RIGHT, Side.LEFT) if affected is Side.RIGHT else (Side.LEFT, Side.RIGHT)


def compare_sides(part: Part, sides: tuple[Side, Side]) -> tuple[SideRow, ...]:
    """Every measure that was taken of both legs, as `first_and_second` orders them; empty with one leg."""
    first, second = sides
    rows = []
    for measure in MEASURES:
        if measure.is_of_walk or not all(part.is_measured(side, measure) for side in sides):
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
    return compare(column, ComparisonKind.LEGS, one, other, assessments, is_chosen_before=is_chosen)


def conditions_of(
    analysis: Analysis, recordings: Sequence[Recording], prefix: str = "", agreed: AgreedGoals = NO_GOALS
) -> tuple[Part, ...]:
    """The walks of one session that have strides: those of the same condition and attachment together.

    Walks without a condition stay by themselves, named as recorded. Each has the letter of its condition in the
    session, as its walks are called everywhere: where a condition has no strides, its letter is left out.

    Parameters
    ----------
    recordings
        Those of the session, in order of time, whose conditions and attachments count.
    prefix
        Stands before each letter.
    agreed
        The goals by the session's day.
    """
    found: dict[tuple[str, int], list[RecordingAnalysis]] = {}
    told = {
        recording.name: (recording.condition, attachment)
        for recording, attachment in zip(
            recordings, accumulate(recording.is_restrapped_before for recording in recordings), strict=True
        )
    }
    for walk in _walks(analysis):
        condition, at = told.get(walk.name, ("", 0))
        found.setdefault((condition or walk.name, at), []).append(walk)
    letters, changed = condition_letters(recordings), alignments_of(recordings)
    others = iter(letter for letter in LETTERS if letter not in letters.values())  # of walks nobody has told of
    parts = [
        Part(
            prefix + letter,
            name,
            tuple(walks),
            analysis.calibrated_for(walks[0]),
            at,
            alignment=changed.get(name),
            agreed=agreed,
        )
        for (name, at), walks in found.items()
        if (letter := letters[walks[0].name] if walks[0].name in letters else next(others, ""))
    ]
    return tuple(parts)


def _walks(analysis: Analysis) -> list[RecordingAnalysis]:
    return [
        recording
        for recording in analysis.recordings
        if recording.kind is RecordingKind.WALKING
        and any(gait.strides.is_used.any() for gait in recording.gait.values())
    ]
