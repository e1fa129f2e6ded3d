"""What do all pages need to know of one walk? Its means, what may not be told, which cited groups stand beside it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from app.reports.comparison import Part, first_and_second
from app.reports.patient_report.numbers_in_words import Band
from app.reports.patient_report.request import Visit
from app.reports.reference_bands import reference_curves, time_distance_classes
from app.reports.summary import summarise
from app.reports.walk_figures import (
    Figure,
    band_of_peak,
    doubt_of,
    is_mean_enough,
    side_cycle,
    strides_used,
    time_distance_figures,
)
from app.wording import side_name, tr
from core.body import Joint, Side, ankle_of, knee_of
from core.gait.cycles import POINTS
from core.gait.spatiotemporal import BothFeet, MeanAndSd, mean_and_sd
from core.norms import MAX_SPEED_DIFFERENCE_M_S, ReferenceCurves, ReferenceValues
from core.results import JointCalibration, RecordingAnalysis, SideGait
from core.samples import FloatArray
from core.verdicts.quantities import WINDOWS, both_sides, mean_curve, peak_percent

KINDS = ("knee", "ankle")
ADULT_FROM_YEARS = 18  # every band there is was measured on adults


@dataclass(frozen=True, slots=True, eq=False)
class _Bands:
    curves: ReferenceCurves | None
    values: ReferenceValues | None


@dataclass(frozen=True, eq=False)
class Facts:
    """One walk of one visit."""

    visit: Visit
    walk: RecordingAnalysis

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
        spans = (span for span in self.visit.analysis.calibrations if self.walk.name in span.walks)
        return {joint: found for span in spans for joint, found in span.joints.items()}

    @cached_property
    def _alone(self) -> Part:
        """The walk as it would stand in a comparison."""
        return Part("", self.walk.name, (self.walk,), self.calibrated)

    @cached_property
    def summary(self) -> dict[str, Any]:
        """The walk as `summary.json` has it."""
        return summarise(self.visit.analysis)["walks"][self.walk.name]

    @cached_property
    def feet(self) -> BothFeet:
        return both_sides(self.walk)

    @cached_property
    def _bands(self) -> _Bands:
        age = self._age_years
        if age is not None and age < ADULT_FROM_YEARS:
            return _Bands(None, None)
        group = time_distance_figures(self.walk, self.feet, time_distance_classes())[1]
        is_near = group is not None and abs(group.speed_m_s - self.feet.speed_m_s) <= MAX_SPEED_DIFFERENCE_M_S
        return _Bands(reference_curves(), group if is_near else None)

    @property
    def curves_group(self) -> ReferenceCurves | None:
        """Band [1]; None where nobody of this age is in it."""
        return self._bands.curves

    @property
    def values_group(self) -> ReferenceValues | None:
        """Band [2]; None where nobody of this age or speed is in it."""
        return self._bands.values

    @property
    def _age_years(self) -> int | None:
        born, year = self.visit.session.patient.birth_year, self.visit.session.started[:4]
        return int(year) - born if born is not None and year.isdigit() else None

    @cached_property
    def time_distance(self) -> dict[str, Figure]:
        """Rows of time and distance by name, without the band where its group walked at another speed."""
        return {row.name: row for row in time_distance_figures(self.walk, self.feet, time_distance_classes())[0]}

    def strides(self, side: Side) -> int:
        return strides_used(self.gait[side]) if side in self.gait else 0

    def counted(self, side: Side) -> str:
        """Head a side's column, with its strides where it was measured."""
        if side not in self.gait:
            return tr("Left") if side is Side.LEFT else tr("Right")
        said = tr("Left, n = {count}") if side is Side.LEFT else tr("Right, n = {count}")
        return said.format(count=self.strides(side))

    def is_measured(self, joint: Joint) -> bool:
        return joint.side in self.gait and joint in self.gait[joint.side].cycles

    def has_joint(self, kind: str) -> bool:
        return any(self.is_measured(joint_of(kind, side)) for side in Side)

    def doubt(self, joint: Joint) -> str | None:
        """Why no angle of this joint may be told; None where it may."""
        return doubt_of(self.walk, joint) if self.is_measured(joint) else None

    def has_no_zero(self, kind: str) -> bool:
        """Whether a height of either leg's joint says nothing: both curves are then drawn about their own mean."""
        joints = [joint_of(kind, side) for side in Side]
        told = [self.walk.verdicts.joint(joint) for joint in joints if self.is_measured(joint)]
        return any(found.shape.is_told and not found.height.is_told for found in told)

    def value(self, side: Side, column: str) -> MeanAndSd:
        """Mean and SD of one column of strides.csv over the strides used."""
        return self._alone.value(side, column)

    def is_no_peak(self, side: Side, column: str) -> bool:
        """Whether the angle is known and only passes through where this peak is looked for."""
        return self._alone.is_no_peak(side, column)

    def peak_percent(self, side: Side, column: str) -> MeanAndSd:
        """When in the stride a peak comes, as each stride of peaks.csv has it."""
        if column not in WINDOWS or side not in self.gait:
            return MeanAndSd(math.nan, math.nan, 0)
        return mean_and_sd(peak_percent(self.walk, side, column)[self.gait[side].strides.is_used])

    def mean_curve_deg(self, side: Side, kind: str) -> FloatArray:
        """The mean over the strides used (101,), about its own mean where there is no zero; NaN from too few."""
        joint = joint_of(kind, side)
        if not self.is_measured(joint):
            return np.full(POINTS, np.nan)
        found = mean_curve(self.walk, joint)
        if not is_mean_enough(found.n):
            return np.full(POINTS, np.nan)
        curve_deg = np.rad2deg(found.mean)
        return curve_deg - np.mean(curve_deg) if self.has_no_zero(kind) else curve_deg

    def strides_deg(self, side: Side, kind: str) -> FloatArray:
        """Every stride used that is known, (k, 101), as `mean_curve_deg` has their mean."""
        joint = joint_of(kind, side)
        found = self.walk.verdicts.joint(joint)
        if not self.is_measured(joint) or not (found.shape.is_told and found.sign.is_told):
            return np.empty((0, POINTS))
        strides_deg = side_cycle(self.walk, joint).strides_deg
        if self.has_no_zero(kind) and len(strides_deg):
            strides_deg = strides_deg - np.mean(strides_deg)
        return strides_deg

    def mean_stride_sd_deg(self, side: Side, kind: str) -> MeanAndSd:
        """The SD between strides, averaged over the stride."""
        joint = joint_of(kind, side)
        if not self.is_measured(joint):
            return MeanAndSd(math.nan, math.nan, 0)
        found = mean_curve(self.walk, joint)
        return MeanAndSd(math.degrees(float(np.mean(found.sd))), math.nan, found.n)

    def band(self, column: str) -> Band | None:
        """1 SD about the group's mean for one column of strides.csv: band [2] of the swing peak, else [1]."""
        if self.is_band_two(column) and self.values_group is not None:
            value = self.values_group.values["peak_knee_flexion_swing"]
            return value.mean - value.sd, value.mean + value.sd
        group = self.curves_group
        if group is None or column.endswith("_range_deg"):
            return None
        kind, rest = column.split("_", 1)
        return band_of_peak(group, kind, rest, WINDOWS[column].name if column in WINDOWS else None)

    def is_band_two(self, column: str) -> bool:
        return column == "knee_swing_peak_deg" and self.values_group is not None

    def group_range_deg(self, kind: str) -> float | None:
        """The range of band [1]'s mean curve, which has no SD."""
        group = self.curves_group
        if group is None:
            return None
        return float(np.ptp(group.knee_mean_deg if kind == "knee" else group.ankle_mean_deg))


def joint_of(kind: str, side: Side) -> Joint:
    return knee_of(side) if kind == "knee" else ankle_of(side)


def role(facts: Facts, side: Side) -> str:
    """Name a side with what is known of it, inside a sentence: "right (prosthetic)"."""
    patient = facts.visit.session.patient
    if patient.prosthetic_side in (side, "both"):
        return tr("{side} (prosthetic)").format(side=side_name(side))
    if patient.affected_side in (side, "both"):
        return tr("{side} (affected)").format(side=side_name(side))
    return side_name(side)
