"""Facts that all pages need of a walk's condition. Its means, what may not be reported, the cited groups beside it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from app.charts.cycles import is_mean_enough
from app.summary.agreed import agreed_with
from app.summary.comparison import first_and_second
from app.summary.conditions import Part, parts_of
from app.summary.course_lanes import CourseVisit
from app.summary.goals import GoalFigure, of_part
from app.summary.numbers_in_words import Band
from app.summary.reference_bands import age_and_height, bands_of, sides_with_band
from app.summary.request import AnalysedVisit
from app.summary.walk_figures import Figure, band_of_peak, peak_place, side_cycle, time_distance_figures
from app.wording.body import side_name
from app.wording.translation import tr
from core.body import Joint, JointKind, Side
from core.gait.cycles import POINTS
from core.gait.spatiotemporal import MeanAndSd, mean_and_sd
from core.prosthesis import JointNature
from core.results import JointCalibration, RecordingAnalysis, SideGait
from core.samples import FloatArray
from core.verdicts.model import Assessment, Verdict, Verdicts
from core.verdicts.norms import Bands, ReferenceCurves, ReferenceValues, height_offset_deg, peak_away_sd
from core.verdicts.quantities import WINDOWS, assessment_of, peak_percent

KINDS = (JointKind.KNEE, JointKind.ANKLE)  # that every report covers


@dataclass(frozen=True, eq=False)
class Facts:
    """One condition of one visit, by one of its walks: every figure, curve and verdict is of the walks of `part`.

    What only one recording has, as when each stride was, is that of `walk`. `chosen` are the walks that are looked at
    together: where two of them are of one condition, each counts alone. `course` are the patient's visits in order of
    time, this one the last; the changes since then are findings of this one.
    """

    visit: AnalysedVisit
    walk: RecordingAnalysis
    chosen: tuple[str, ...] = ()
    course: tuple[CourseVisit, ...] = ()

    @property
    def gait(self) -> Mapping[Side, SideGait]:
        return self.walk.gait

    @property
    def affected(self) -> Side | None:
        return self.visit.analysis.affected_side

    @property
    def first_and_second(self) -> tuple[Side, Side]:
        """The side that symmetry starts from, and the other: affected before sound, else left before right."""
        return first_and_second(self.affected)

    @property
    def is_prosthetic(self) -> bool:
        return self.visit.session.patient.prosthetic_side in {*Side, "both"}

    @property
    def is_simulated(self) -> bool:
        return self.visit.analysis.is_simulated

    @cached_property
    def calibrated(self) -> Mapping[Joint, JointCalibration]:
        return self.visit.analysis.calibrated_for(self.walk)

    @property
    def verdicts(self) -> Verdicts:
        return self.part.verdicts

    @cached_property
    def part(self) -> Part:
        """The condition as it appears in every comparison."""
        return part_of(self.visit, self.walk.name, self.chosen)

    @cached_property
    def goals(self) -> tuple[GoalFigure, ...]:
        """What had been agreed by the walk's day, and how its condition compares with it."""
        return of_part(self.part)

    @property
    def reported_goals(self) -> tuple[GoalFigure, ...]:
        """Those that may be judged as reached or not: agreed before the walk's day."""
        return tuple(one for one in self.goals if one.goal in self.part.agreed.reported)

    @property
    def condition(self) -> str:
        """Under which condition was walked, as it was typed, or the one that it is again; empty: none was stated."""
        recordings = self.visit.session.recordings
        return next((one.returned_to for one in recordings if one.name == self.walk.name), "")

    @property
    def speed_m_s(self) -> float:
        return self.part.of_both("speed_m_s")

    @cached_property
    def bands(self) -> Bands:
        return bands_of(self.part, age_and_height(self.visit.session))

    @property
    def curves_group(self) -> ReferenceCurves | None:
        """Band [1]; None where nobody of this age and speed is in it, or neither leg may be compared with it."""
        return self.bands.curves if self.sides_with_band else None

    @property
    def values_group(self) -> ReferenceValues | None:
        """Band [2]; None as of band [1]."""
        return self.bands.values if self.sides_with_band else None

    @cached_property
    def sides_with_band(self) -> frozenset[Side]:
        """Legs that may be compared with other people's."""
        return sides_with_band(self.part)

    @cached_property
    def time_distance(self) -> dict[str, Figure]:
        """Rows of time and distance by column, without the band where its group walked at another speed."""
        return {row.column: row for row in time_distance_figures(self.part, self.values_group, self.sides_with_band)}

    def strides(self, side: Side) -> int:
        return self.part.strides(side)

    def counted(self, side: Side) -> str:
        """Head a side's column, with its strides where it was measured."""
        if side not in self.gait:
            return tr("Left") if side is Side.LEFT else tr("Right")
        stated = tr("Left, n = {count}") if side is Side.LEFT else tr("Right, n = {count}")
        return stated.format(count=self.strides(side))

    def is_measured(self, joint: Joint) -> bool:
        return joint in self.part.joints

    def is_worn(self, side: Side, column: str) -> bool:
        """Whether a column of strides.csv is of the leg itself, or of a joint that was measured."""
        return self.part.is_measured(side, column)

    @property
    def kinds(self) -> tuple[JointKind, ...]:
        """The kinds of joints that are reported, from the trunk down: hips where one was measured."""
        return (JointKind.HIP, *KINDS) if self.has_joint(JointKind.HIP) else KINDS

    def has_joint(self, kind: str) -> bool:
        return any(self.is_measured(joint_of(kind, side)) for side in Side)

    def assessment(self, side: Side, column: str) -> Assessment:
        """What may be stated about a column of strides.csv."""
        return assessment_of(self.verdicts, side, column)

    def has_no_zero(self, kind: str) -> bool:
        """Whether a height of either leg's joint means nothing: both curves are then drawn about their own mean."""
        joints = [joint_of(kind, side) for side in Side]
        reported = [self.verdicts.joint(joint) for joint in joints if self.is_measured(joint)]
        return any(found.shape.is_reported and not found.height.is_reported for found in reported)

    def value(self, side: Side, column: str) -> MeanAndSd:
        """Mean and SD of one column of strides.csv over the strides used."""
        return self.part.value(side, column)

    def is_no_peak(self, side: Side, column: str) -> bool:
        """Whether the angle is known and only passes through where this peak is looked for."""
        return self.part.is_no_peak(side, column)

    def peak_percent(self, side: Side, column: str) -> MeanAndSd:
        """When in the stride a peak comes, as each stride of peaks.csv has it."""
        if column not in WINDOWS or side not in self.gait:
            return MeanAndSd(math.nan, math.nan, 0)
        walks = [walk for walk in self.part.walks if side in walk.gait]
        found = [peak_percent(walk, side, column)[walk.gait[side].strides.is_used] for walk in walks]
        return mean_and_sd(np.concatenate(found))

    def measured_curve_deg(self, side: Side, kind: str) -> FloatArray:
        """The mean over the strides used (101,) as it was measured, with or without a zero; NaN from too few."""
        joint = joint_of(kind, side)
        if not self.is_measured(joint):
            return np.full(POINTS, np.nan)
        found = self.part.cycle(joint)
        return found.mean if is_mean_enough(found.n) else np.full(POINTS, np.nan)

    def mean_curve_deg(self, side: Side, kind: str) -> FloatArray:
        """The same (101,), about its own mean where there is no zero."""
        curve_deg = self.measured_curve_deg(side, kind)
        return curve_deg - np.mean(curve_deg) if self.has_no_zero(kind) else curve_deg

    def strides_deg(self, side: Side, kind: str) -> FloatArray:
        """Every stride used that is known, (k, 101), as `mean_curve_deg` has their mean, or would with more of them."""
        joint = joint_of(kind, side)
        found = self.verdicts.joint(joint)
        reasons = (*found.shape.reasons, *found.sign.reasons)
        are_few = {one.gate for one in reasons if one.verdict is Verdict.NOT_REPORTED} == {"strides"}
        if not self.is_measured(joint) or not ((found.shape.is_reported and found.sign.is_reported) or are_few):
            return np.empty((0, POINTS))
        strides_deg = side_cycle(self.part, joint).strides_deg
        if self.has_no_zero(kind) and len(strides_deg):
            strides_deg = strides_deg - np.mean(strides_deg)
        return strides_deg

    def band(self, column: str) -> Band | None:
        """1 SD about the mean of band [1] for a joint's column of strides.csv, where its source has it."""
        group = self.curves_group
        if group is None:
            return None
        kind, rest, window = _parts_of(column)
        return band_of_peak(group, kind, rest, window)

    def offset_deg(self, side: Side, kind: str) -> float:
        """How much higher than band [1] a leg's curve lies as a whole; NaN where that is not to be reported."""
        group, joint = self.curves_group, joint_of(kind, side)
        if joint.is_hip:  # the group's zero is that of the pelvis's markers
            return math.nan
        if group is None or side not in self.sides_with_band or not self.verdicts.joint(joint).height.is_reported:
            return math.nan
        return height_offset_deg(self.part.cycle(joint).mean, group.mean_and_sd_deg(kind)[0])

    def away_sd(self, side: Side, column: str) -> float:
        """How many SD a peak lies from band [1] laid at the curve's height; NaN where that is not judged."""
        group, value, (kind, rest, window) = self.curves_group, self.value(side, column), _parts_of(column)
        if group is None or self.bands.are_curves_of_other_ages or side not in self.sides_with_band:
            return math.nan
        at = peak_place(group, kind, rest, window)
        if at is None or not is_mean_enough(value.n) or not math.isfinite(value.mean):
            return math.nan
        curve_deg = self.part.cycle(joint_of(kind, side)).mean
        return peak_away_sd(value.mean, curve_deg, group.mean_and_sd_deg(kind), at, kind)

    def group_range_deg(self, kind: str) -> float | None:
        """The range of band [1]'s mean curve, which has no SD."""
        group = self.curves_group
        if group is None:
            return None
        return float(np.ptp(group.mean_and_sd_deg(kind)[0]))


def part_of(visit: AnalysedVisit, name: str, chosen: Sequence[str] = ()) -> Part:
    """All walks of this one's condition; this one alone where several of them are chosen."""
    letter, agreed = _letter_of(visit, name), agreed_with(visit.session)
    for part in parts_of(visit.analysis, visit.session.recordings, agreed=agreed):
        names = {walk.name for walk in part.walks}
        if name in names:
            is_alone = len(names.intersection(chosen)) > 1
            return replace(part, letter=letter, walks=(visit.walk(name),)) if is_alone else part
    walk = visit.walk(name)
    return Part(letter, visit.condition_of(name) or name, (walk,), visit.analysis.calibrated_for(walk), agreed=agreed)


def _letter_of(visit: AnalysedVisit, name: str) -> str:
    shown = visit.shown_names.get(name)
    return shown.letter if shown is not None else ""


def _parts_of(column: str) -> tuple[str, str, str | None]:
    """A joint's column of strides.csv as its kind, the rest of its name, and the window of its peak."""
    kind, rest = column.split("_", 1)
    return kind, rest, WINDOWS[column].name if column in WINDOWS else None


def joint_of(kind: str, side: Side) -> Joint:
    return JointKind(kind).of(side)


def role(facts: Facts, side: Side, joint: Joint | None = None) -> str:
    """Name a side with what is known of it, or of its `joint`, inside a sentence: "right (prosthetic)"."""
    patient = facts.visit.session.patient
    is_own = joint is not None and patient.nature_of(joint) is JointNature.OWN
    if side in patient.prosthetic_sides and not is_own:
        return tr("{side} (prosthetic)").format(side=side_name(side))
    if patient.affected_side in (side, "both"):
        return tr("{side} (affected)").format(side=side_name(side))
    return side_name(side)
