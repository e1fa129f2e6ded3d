"""What changed between walks, visits or legs, and is that more than the measurement error?

Screen, report and files take their figures from here, so that no number is drawn that no table holds.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from itertools import accumulate
from statistics import fmean

import numpy as np

from app.reports.gait_csv import WINDOWS, parameter, used_cycles
from app.reports.walk_figures import both_sides, by_hand_in_words
from app.wording import later
from core.body import Joint, Side, ankle_of, knee_of
from core.chosen_strides import left_out_by_hand
from core.gait.cycles import POINTS, MeanCycle, mean_cycle
from core.gait.spatiotemporal import MeanAndSd, mean_and_sd
from core.gait.symmetry import symmetry_index_percent
from core.norms import (
    MIN_STRIDES_FOR_MEAN,
    MIN_STRIDES_FOR_SD,
    Difference,
    Verdict,
    compare_new_attachment,
    compare_same_attachment,
)
from core.results import Analysis, JointCalibration, RecordingAnalysis, ZeroKind
from core.samples import Recording, RecordingKind

STANCE_SAME_ATTACHMENT_PERCENT = 1.0  # a placeholder until repeat trials exist; no published figure is known
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"


@dataclass(frozen=True, slots=True)
class Measure:
    """One figure that is compared; `column` is that of strides.csv, `kind` knee, ankle or empty."""

    column: str
    name: str
    kind: str
    unit: str = "°"

    @classmethod
    def of(cls, column: str) -> "Measure":
        """Any column of strides.csv; only an angle is a joint's."""
        is_angle = column.endswith("_deg")
        return cls(column, "", column.split("_")[0] if is_angle else "", "°" if is_angle else "%")

    def joint(self, side: Side) -> Joint | None:
        """Whose figure it is; None where it is no joint's."""
        return {"knee": knee_of, "ankle": ankle_of}[self.kind](side) if self.kind else None

    @property
    def needs_height(self) -> bool:
        """Whether it says something only with a zero of the same kind."""
        return bool(self.kind) and not self.column.endswith("_range_deg")


MEASURES = (
    Measure("knee_loading_peak_deg", later("Knee loading peak"), "knee"),
    Measure("knee_swing_peak_deg", later("Knee swing peak"), "knee"),
    Measure("knee_range_deg", later("Knee range"), "knee"),
    Measure("ankle_stance_dorsiflexion_deg", later("Ankle stance peak"), "ankle"),
    Measure("ankle_push_off_plantarflexion_deg", later("Ankle push-off"), "ankle"),
    Measure("ankle_range_deg", later("Ankle range"), "ankle"),
    Measure("stance_percent", later("Stance time, % of stride"), "", "%"),
)


class Kind(StrEnum):
    """What is compared with what."""

    CONDITIONS = "conditions"
    VISITS = "visits"
    SIDES = "sides"


class Reservation(StrEnum):
    """Why a figure is not compared at all."""

    NONE = ""
    NOT_MEASURED = "not_measured"
    OTHER_ZERO = "other_zero"


@dataclass(frozen=True)
class Part:
    """One condition, walk or visit: its walks, whose strides are taken together.

    `attachment` numbers how often the sensors had been strapped on anew before; equal numbers of one visit share it.
    """

    letter: str
    name: str
    walks: tuple[RecordingAnalysis, ...]
    calibrated: Mapping[Joint, JointCalibration]
    attachment: int = 0

    @property
    def sides(self) -> tuple[Side, ...]:
        return tuple(side for side in Side if any(side in walk.gait for walk in self.walks))

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Those with mean cycles."""
        has = {joint for walk in self.walks for gait in walk.gait.values() for joint in gait.cycles}
        return tuple(joint for joint in Joint if joint in has)

    def value(self, side: Side, column: str) -> MeanAndSd:
        """Over the strides used of all walks; degrees or percent."""
        found = [
            parameter(walk.gait[side], column)[walk.gait[side].strides.is_used]
            for walk in self.walks
            if side in walk.gait
        ]
        return mean_and_sd(np.concatenate(found) if found else np.empty(0))

    def cycle(self, joint: Joint) -> MeanCycle:
        """Mean over the strides used of all walks, degrees; NaN throughout where the sign of one is in doubt."""
        gaits = [walk.gait[joint.side] for walk in self.walks if joint.side in walk.gait]
        known = [used_cycles(gait, joint) for gait in gaits if joint in gait.cycles]
        if not known or any(joint in gait.sign_in_doubt for gait in gaits):
            return mean_cycle(np.empty((0, POINTS)))
        return mean_cycle(np.rad2deg(np.concatenate(known)))

    def is_no_peak(self, side: Side, column: str) -> bool:
        """Whether the angle is known and only passes through where this peak is looked for."""
        joint = Measure.of(column).joint(side)
        if joint is None or column not in WINDOWS or self.zero(joint) is ZeroKind.NONE:
            return False
        return self.cycle(joint).n >= MIN_STRIDES_FOR_MEAN and not math.isfinite(self.value(side, column).mean)

    def of_both(self, name: str) -> float:
        """Cadence, double support or speed (the names of `BothFeet`), the mean of the walks in which it is known."""
        known = [value for walk in self.walks if math.isfinite(value := getattr(both_sides(walk), name))]
        return fmean(known) if known else math.nan

    def stance_percent(self, side: Side) -> float:
        return self.value(side, "stance_percent").mean

    def strides(self, side: Side) -> int:
        return sum(int(np.count_nonzero(walk.gait[side].strides.is_used)) for walk in self.walks if side in walk.gait)

    def left_out_by_hand(self, side: Side | None) -> int:
        """Of one side, or of both."""
        gaits = [walk.gait[one] for walk in self.walks for one in walk.gait if side in (None, one)]
        return sum(map(left_out_by_hand, gaits))

    def zero(self, joint: Joint) -> ZeroKind:
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
        return self.reservation is Reservation.NONE and math.isfinite(self.difference.difference_deg)

    @property
    def exceeds(self) -> bool:
        return self.is_told and self.difference.verdict is Verdict.EXCEEDS_ERROR


@dataclass(frozen=True)
class Comparison:
    """`parts` in the order of time; each is told against `parts[base]`."""

    kind: Kind
    parts: tuple[Part, ...]
    base: int = 0
    is_simulated: bool = False

    @property
    def against(self) -> Part:
        return self.parts[self.base]

    @property
    def others(self) -> tuple[Part, ...]:
        return tuple(part for k, part in enumerate(self.parts) if k != self.base)

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

    @cached_property
    def rows(self) -> tuple[Compared, ...]:
        """Every measure of each side of each part but the one told against."""
        return tuple(
            self.compare(measure, side, part) for measure in MEASURES for side in self.sides for part in self.others
        )

    def is_same_attachment(self, part: Part) -> bool:
        return self.kind is Kind.CONDITIONS and part.attachment == self.against.attachment

    def has_one_zero(self, joint: Joint) -> bool:
        """Whether all parts that have the joint measured its height from the same kind of zero, and from one."""
        kinds = {part.zero(joint) for part in self.parts if joint in part.joints}
        return len(kinds) == 1 and ZeroKind.NONE not in kinds

    def compare(self, measure: Measure, side: Side, part: Part) -> Compared:
        value, other = part.value(side, measure.column), self.against.value(side, measure.column)
        return Compared(
            measure,
            side,
            part,
            self.against,
            value,
            other,
            _difference(measure, side, value, other, is_same=self.is_same_attachment(part)),
            self._reservation(measure, side, value, other),
        )

    def _reservation(self, measure: Measure, side: Side, value: MeanAndSd, other: MeanAndSd) -> Reservation:
        joint = measure.joint(side)
        if joint is not None and measure.needs_height and not self.has_one_zero(joint):
            return Reservation.OTHER_ZERO
        return Reservation.NOT_MEASURED if not (value.n and other.n) else Reservation.NONE


@dataclass(frozen=True, slots=True)
class SideRow:
    """One figure of both legs: the first (affected, or left) less the second; symmetry where it means something."""

    measure: Measure
    first: MeanAndSd
    second: MeanAndSd
    difference: Difference
    symmetry_percent: float

    @property
    def is_told(self) -> bool:
        return math.isfinite(self.difference.difference_deg)

    @property
    def exceeds(self) -> bool:
        return self.is_told and self.difference.verdict is Verdict.EXCEEDS_ERROR


def first_and_second(affected: Side | None) -> tuple[Side, Side]:
    """Affected against sound where that is known, else left against right."""
    return (Side.RIGHT, Side.LEFT) if affected is Side.RIGHT else (Side.LEFT, Side.RIGHT)


def compare_sides(part: Part, sides: tuple[Side, Side]) -> tuple[SideRow, ...]:
    """Every measure that both legs have, as `first_and_second` orders them; empty with one leg."""
    first, second = sides
    rows = []
    for measure in MEASURES:
        one, other = part.value(first, measure.column), part.value(second, measure.column)
        if not (one.n and other.n):
            continue
        difference = _difference(measure, first, one, other, is_same=False)
        has_index = not measure.needs_height and min(one.n, other.n) >= MIN_STRIDES_FOR_MEAN
        symmetry = symmetry_index_percent(one.mean, other.mean) if has_index else math.nan
        rows.append(SideRow(measure, one, other, difference, symmetry))
    return tuple(rows)


def calibrated_for(analysis: Analysis, recording: RecordingAnalysis) -> Mapping[Joint, JointCalibration]:
    """The calibrations that `recording` was measured with."""
    for calibration in analysis.calibrations:
        if recording.name in calibration.walks:
            return calibration.joints
    for calibration in analysis.calibrations:  # a free motion is measured with what it gave
        if any(found.free_motion_from == recording.name for found in calibration.joints.values()):
            return calibration.joints
    return analysis.calibrations[-1].joints if analysis.calibrations else {}


def conditions_of(analysis: Analysis, recordings: Sequence[Recording], prefix: str = "") -> tuple[Part, ...]:
    """The walks of one session that have strides: those of the same condition and attachment together.

    Walks without a condition stay by themselves, named as recorded.

    Parameters
    ----------
    recordings
        Those of the session, in order of time, whose conditions and attachments count.
    prefix
        Stands before each letter.
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
    return tuple(
        Part(prefix + letter, name, tuple(walks), calibrated_for(analysis, walks[0]), at)
        for letter, ((name, at), walks) in zip(LETTERS, found.items(), strict=False)
    )


def visit_of(letter: str, name: str, analysis: Analysis) -> Part | None:
    """All walks of one visit that have strides; None without any."""
    walks = tuple(_walks(analysis))
    return Part(letter, name, walks, calibrated_for(analysis, walks[0])) if walks else None


def _walks(analysis: Analysis) -> list[RecordingAnalysis]:
    return [
        recording
        for recording in analysis.recordings
        if recording.kind is RecordingKind.WALKING
        and any(gait.strides.is_used.any() for gait in recording.gait.values())
    ]


def _difference(measure: Measure, side: Side, one: MeanAndSd, other: MeanAndSd, *, is_same: bool) -> Difference:
    joint = measure.joint(side)
    if joint is None:
        is_same_stance = is_same and measure.column == "stance_percent"  # of other figures no error is known
        return _stance_difference(one, other, is_same=is_same_stance)
    return compare_same_attachment(one, other) if is_same else compare_new_attachment(joint, one, other)


def _stance_difference(one: MeanAndSd, other: MeanAndSd, *, is_same: bool) -> Difference:
    has_means = min(one.n, other.n) >= MIN_STRIDES_FOR_MEAN
    difference = one.mean - other.mean if has_means else math.nan
    if not has_means or (is_same and min(one.n, other.n) < MIN_STRIDES_FOR_SD):
        return Difference(difference, math.nan, Verdict.TOO_FEW_STRIDES)
    if not is_same:
        return Difference(difference, math.nan, Verdict.NO_PUBLISHED_FIGURE)
    error = max(STANCE_SAME_ATTACHMENT_PERCENT, 1.96 * math.sqrt(one.sd**2 / one.n + other.sd**2 / other.n))
    verdict = Verdict.EXCEEDS_ERROR if abs(difference) > error else Verdict.INSIDE_ERROR
    return Difference(difference, error, verdict)
