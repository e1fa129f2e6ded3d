"""The figures of a walk and the verdict that each rests on; values per stride, empty where not reported."""

import math
from dataclasses import dataclass, replace

import numpy as np

from core.body import Joint, Side, ankle_of, hip_of, knee_of
from core.gait.cycles import POINTS, MeanCycle, cycles_of, find_peak, mean_cycle
from core.gait.spatiotemporal import BothFeet, MeanAndSd, both_feet, mean_and_sd
from core.gait.strides import strides_of
from core.parameters import (
    ANKLE_WINDOWS,
    BY_COLUMN,
    EXCURSIONS,
    KNEE_WINDOWS,
    SPEED,
    ParameterFile,
    QuantityClass,
    columns_of,
)
from core.results import RecordingAnalysis, SideGait
from core.samples import FloatArray
from core.verdicts.model import NOT_MEASURED, Assessment, Verdict, Verdicts, together

PARAMETERS = columns_of(ParameterFile.STRIDES)
FITTING = columns_of(ParameterFile.FITTING)  # what they mean: core.verdicts.fitting
OF_HIPS = columns_of(ParameterFile.PELVIS)
EXCURSIONS_BY_COLUMN = {f"{excursion.name}_deg": excursion for excursion in EXCURSIONS}  # those of peaks.csv
SEGMENTS = ("shank", "thigh")
SHANK_TO_FOOT = "shank_to_foot_in_swing_deg"
ABDUCTION = ("hip_abduction", "hip_adduction")
OF_BOTH = (*columns_of(ParameterFile.WALK), SPEED)
WINDOWS = {f"{window.name}_deg": window for window in (*KNEE_WINDOWS, *ANKLE_WINDOWS)}


@dataclass(frozen=True, slots=True)
class SideMean:
    """A figure of one leg over the strides used, and whether it may be reported. NaN where it is not reported."""

    found: MeanAndSd
    assessment: Assessment


def joint_of(name: str, side: Side) -> Joint | None:
    """Give the joint of a column's angle; thigh and shank count as knee, None for time, distance, foot alone."""
    of_kind = {"hip": hip_of, "knee": knee_of, "ankle": ankle_of, "shank": knee_of, "thigh": knee_of}
    found = of_kind.get(name.split("_")[0])
    return found(side) if found is not None else None


def assessment_of(verdicts: Verdicts, side: Side, name: str) -> Assessment:
    """What may be stated about one column of strides.csv, peaks.csv or fitting.csv."""
    joint, required = joint_of(name, side), BY_COLUMN[name].rests_on
    if name.startswith("pelvis"):  # over strides, which the foot's events bound
        of_pelvis = verdicts.pelvis_tilt if name == "pelvis_tilt_range_deg" else verdicts.pelvis
        return together((of_pelvis, verdicts.leg(side).timing))
    if name.startswith(ABDUCTION):
        found = verdicts.joint(hip_of(side))
        of_hip = found.shape if required is QuantityClass.SHAPE else together((found.height, found.sign))
        return together((of_hip, verdicts.abduction.get(side, NOT_MEASURED)))
    if joint is not None:
        found = verdicts.joint(joint)
        if name.startswith(SEGMENTS):  # read at events of the foot
            parts = (found.height if required is QuantityClass.HEIGHT else found.shape, found.sign)
            of_foot = (verdicts.leg(side).distance,) if name == SHANK_TO_FOOT else ()  # its pitch too
            return together((*parts, verdicts.leg(side).timing, *of_foot))
        if required is QuantityClass.SHAPE:
            return found.shape
        return together((found.height if required is QuantityClass.HEIGHT else found.shape, found.sign))
    if required is QuantityClass.BETWEEN:
        return together((verdicts.between, verdicts.leg(side).timing))
    leg = verdicts.leg(side)
    return leg.distance if required is QuantityClass.DISTANCE else leg.timing


def assessment_of_both(verdicts: Verdicts, name: str) -> Assessment:
    """Give what may be stated about cadence, double support and speed, by the legs that were measured."""
    legs = [verdicts.leg(side) for side in Side if side in verdicts.legs]
    if not legs:
        return together([verdicts.leg(Side.LEFT).timing])
    if name == "speed_m_s":
        return together(leg.distance for leg in legs)
    timing = together(leg.timing for leg in legs)
    if name == "double_support_percent" and (len(legs) < len(Side) or timing.verdict is not Verdict.READ):
        is_one = len(legs) < len(Side)
        return replace(timing, verdict=Verdict.NOT_MEASURED if is_one else Verdict.NOT_REPORTED)
    return timing


def raw_values(gait: SideGait, name: str) -> FloatArray:
    """Give a column of strides.csv (k,), angles in degrees, whatever may be stated; NaN where not known."""
    values = gait.parameters.get(name.removesuffix("_deg") + "_rad" if name.endswith("_deg") else name)
    if values is None:
        return np.full(len(gait.strides), np.nan)
    return np.rad2deg(values) if name.endswith("_deg") else values


def values_of(recording: RecordingAnalysis, side: Side, name: str) -> FloatArray:
    """Give `raw_values` (k,), NaN throughout where the figure is not reported."""
    gait = recording.gait[side]
    if not assessment_of(recording.verdicts, side, name).is_reported:
        return np.full(len(gait.strides), np.nan)
    return raw_values(gait, name)


def side_mean(recording: RecordingAnalysis, side: Side, name: str) -> SideMean:
    """The mean over the strides used."""
    used = recording.gait[side].strides.is_used
    return SideMean(mean_and_sd(values_of(recording, side, name)[used]), assessment_of(recording.verdicts, side, name))


def peak_percent(recording: RecordingAnalysis, side: Side, column: str) -> FloatArray:
    """Give when in each stride (k,) the column's peak comes, percent; NaN where none or not reported."""
    gait, joint = recording.gait[side], joint_of(column, side)
    if joint is None or joint not in gait.cycles:
        return np.full(len(gait.strides), np.nan)
    found = recording.verdicts.joint(joint)
    if not together((found.shape, found.sign)).is_reported:
        return np.full(len(gait.strides), np.nan)
    return find_peak(gait.cycles[joint], WINDOWS[column]).percent


def hip_peaks_percent(recording: RecordingAnalysis, side: Side) -> tuple[FloatArray, FloatArray]:
    """Give when the hip is most flexed and most extended, percent of each stride (k,); NaN where not reported."""
    gait, found = recording.gait[side], recording.verdicts.joint(hip_of(side))
    nothing = np.full(len(gait.strides), np.nan)
    cycles = gait.cycles.get(hip_of(side))
    if cycles is None or not len(cycles) or not together((found.shape, found.sign)).is_reported:
        return nothing, nothing
    is_known = np.asarray(np.isfinite(cycles).all(axis=1), dtype=bool)
    whole = np.where(is_known[:, None], cycles, 0.0)
    most, least = np.where(is_known, whole.argmax(axis=1), np.nan), np.where(is_known, whole.argmin(axis=1), np.nan)
    return most, least


def abduction_curve(recording: RecordingAnalysis, side: Side) -> MeanCycle:
    """A hip's mean abduction over the strides used, radians from standing; NaN where it is not reported."""
    gait, hip = recording.gait[side], recording.hips.get(hip_of(side))
    if hip is None or not assessment_of(recording.verdicts, side, "hip_abduction_peak_deg").is_reported:
        return mean_cycle(np.empty((0, POINTS)))
    cycles = cycles_of(recording.time_s, hip.abduction_rad, gait.strides.start_s, gait.strides.end_s)
    return mean_cycle(cycles[gait.strides.is_used])


def used_cycles(recording: RecordingAnalysis, joint: Joint) -> FloatArray:
    """Give the joint's angle over the strides used, (k, 101), rad, clinical sign, whatever may be stated."""
    gait = recording.gait[joint.side]
    return gait.cycles[joint][gait.strides.is_used] if joint in gait.cycles else np.empty((0, POINTS))


def mean_curve(recording: RecordingAnalysis, joint: Joint) -> MeanCycle:
    """Average the joint's angle over the strides used, rad; NaN where shape or sign is not reported.

    Its height holds only where that is reported.
    """
    found = mean_cycle(used_cycles(recording, joint))
    stated = recording.verdicts.joint(joint)
    if together((stated.shape, stated.sign)).is_reported:
        return found
    nothing = np.full(POINTS, np.nan)
    return replace(found, mean=nothing, sd=found.sd if stated.shape.is_reported else nothing)


def both_sides(recording: RecordingAnalysis) -> BothFeet:
    """Cadence, double support and speed, NaN where not reported, also where only one side was measured."""
    nothing = strides_of(())
    left, right = (recording.gait[side].strides if side in recording.gait else nothing for side in Side)
    found = both_feet(left, right)
    not_reported = {name: math.nan for name in OF_BOTH if not assessment_of_both(recording.verdicts, name).is_reported}
    return replace(found, **not_reported)
