"""Averages of a walk over the strides used, with error and verdict, for all files and tables of figures."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from core.body import Side
from core.gait.chosen_strides import left_out_by_hand
from core.results import RecordingAnalysis
from core.verdicts.measurement_error import whisker
from core.verdicts.model import Assessment
from core.verdicts.quantities import (
    OF_BOTH,
    OF_HIPS,
    PARAMETERS,
    assessment_of_both,
    both_sides,
    side_mean,
    values_of,
)
from core.verdicts.sigmas import ComparisonKind
from core.verdicts.stride_means import mean_of_strides


@dataclass(frozen=True, slots=True)
class Average:
    """One average; NaN where it is not reported, was not measured, or is not known."""

    mean: float
    sd: float
    error: float  # half of what a difference of two walks has to exceed
    assessment: Assessment


@dataclass(frozen=True, slots=True)
class LegAverages:
    """Averages of one leg by column, and how many strides are behind them."""

    used: int
    left_out: int
    left_out_by_hand: int
    of: Mapping[str, Average]


@dataclass(frozen=True, slots=True)
class WalkAverages:
    """Averages of one walk. `legs` has those that were measured, `both` by column what both make together."""

    walk: str
    legs: Mapping[Side, LegAverages]
    both: Mapping[str, Average]


def averages_of(recording: RecordingAnalysis) -> WalkAverages:
    """All averages of a walk."""
    feet = both_sides(recording)
    both = {
        name: Average(getattr(feet, name), np.nan, np.nan, assessment_of_both(recording.verdicts, name))
        for name in OF_BOTH
    }
    legs = {side: _of_leg(recording, side) for side in Side if side in recording.gait}
    return WalkAverages(recording.name, legs, both)


def _of_leg(recording: RecordingAnalysis, side: Side) -> LegAverages:
    gait = recording.gait[side]
    used = int(np.count_nonzero(gait.strides.is_used))
    columns = (*PARAMETERS, *(OF_HIPS if recording.pelvis is not None else ()))
    averages = {column: _average(recording, side, column) for column in columns}
    return LegAverages(used, len(gait.strides) - used, left_out_by_hand(gait), averages)


def _average(recording: RecordingAnalysis, side: Side, column: str) -> Average:
    found = side_mean(recording, side, column)
    strides = mean_of_strides(values_of(recording, side, column)[recording.gait[side].strides.is_used])
    error = whisker(column, ComparisonKind.ATTACHED, strides)
    return Average(found.found.mean, found.found.sd, error, found.assessment)
