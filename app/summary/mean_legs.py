"""Legs at each percent of a mean stride. Drawn from the angles and the thighs' inclination.

Seen from the side: forward is x, up is z, each hip at the origin. What may not be read of a joint is not drawn.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from app.summary.drawn_legs import DrawnLeg, draw_legs
from core.body import Side, ankle_of, knee_of
from core.gait.cycles import POINTS, cycles_of, mean_cycle
from core.results import Analysis, RecordingAnalysis
from core.samples import FloatArray
from core.session import Session
from core.verdicts.model import together
from core.verdicts.quantities import side_mean

HIP, KNEE, ANKLE, TOES = range(4)
FORWARD, UP = 0, 2


@dataclass(frozen=True, slots=True)
class MeanLeg:
    """`points_m` (101, 4, 2): hip, knee, ankle and toes over the leg's own stride, NaN where not to be drawn."""

    points_m: FloatArray
    stride_s: float
    toe_off_percent: float

    @property
    def has_foot(self) -> bool:
        return bool(np.isfinite(self.points_m[:, TOES]).any())


@dataclass(frozen=True, slots=True)
class MeanLegs:
    """Both legs, or the one that was measured.

    Attributes
    ----------
    reference
        The leg whose stride is gone through.
    other_contact_percent
        When in that stride the other foot comes down; half of it where the clocks cannot say, see `is_together`.
    is_together
        Whether both legs are known at one instant.
    tilt_rad
        Of the pelvis over the reference leg's stride (101,), forward positive; None where it is not to be drawn.
    """

    legs: Mapping[Side, MeanLeg]
    reference: Side
    other_contact_percent: float = 50.0
    is_together: bool = False
    tilt_rad: FloatArray | None = None

    def percent_of(self, side: Side, percent: float) -> float:
        """Where on its own stride a leg is when the reference leg is at `percent`, 0 to 100."""
        if side is self.reference or side not in self.legs:
            return percent % 100.0
        ratio = self.legs[self.reference].stride_s / self.legs[side].stride_s
        return (percent - self.other_contact_percent) * ratio % 100.0

    def is_standing(self, side: Side, percent: float) -> bool:
        """Whether a foot is on the floor when the reference leg is at `percent`; False where that is not known."""
        return self.percent_of(side, percent) < self.legs[side].toe_off_percent

    def pelvis_tilt_rad(self, percent: float) -> float | None:
        """How far the pelvis is tilted when the reference leg is at `percent`; None where it is not to be drawn."""
        return None if self.tilt_rad is None else float(np.interp(percent % 100.0, np.arange(POINTS), self.tilt_rad))

    def pose_m(self, side: Side, percent: float) -> FloatArray:
        """Hip, knee, ankle and toes (4, 2) of a leg at `percent` of its own stride."""
        at = percent % 100.0
        low = math.floor(at)
        share = at - low
        points = self.legs[side].points_m
        return np.asarray((1 - share) * points[low] + share * points[low + 1])


def bent_by(pose_m: FloatArray, knee_deg: float, ankle_deg: float) -> FloatArray:
    """A pose (4, 2) with its knee flexed and its ankle dorsiflexed by so much more, on the same thigh."""
    hip, knee, ankle, toes = pose_m
    shank_rad, foot_rad = -math.radians(knee_deg), math.radians(ankle_deg - knee_deg)
    new_ankle = knee + _turned(ankle - knee, shank_rad)
    return np.stack([hip, knee, new_ankle, new_ankle + _turned(toes - ankle, foot_rad)])


def _turned(vector: FloatArray, angle_rad: float) -> FloatArray:
    """Forward and up, turned from forward to up."""
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([cos * vector[0] - sin * vector[1], sin * vector[0] + cos * vector[1]])


def mean_legs(session: Session, analysis: Analysis, walk: RecordingAnalysis) -> MeanLegs | None:
    """The mean over the strides used; None where no thigh sensor sent or no knee's height may be read."""
    drawn = draw_legs(session, analysis, walk)
    legs = {side: leg for side, one in drawn.items() if (leg := _mean_leg(walk, side, one)) is not None}
    if not legs:
        return None
    affected = analysis.affected_side
    reference = affected if affected in legs else next(side for side in Side if side in legs)
    tilt = _mean_tilt(walk, reference)
    other = Side.RIGHT if reference is Side.LEFT else Side.LEFT
    if other not in legs:
        return MeanLegs(legs, reference, tilt_rad=tilt)
    step = side_mean(walk, other, "step_time_s")
    is_together = step.assessment.is_reported and math.isfinite(step.found.mean)
    contact = 100.0 * step.found.mean / legs[reference].stride_s if is_together else 50.0
    return MeanLegs(legs, reference, contact, is_together, tilt)


def _mean_tilt(walk: RecordingAnalysis, side: Side) -> FloatArray | None:
    if walk.pelvis is None or not walk.verdicts.pelvis.is_reported:
        return None
    strides = walk.gait[side].strides
    cycles = cycles_of(walk.time_s, walk.pelvis.tilt_rad, strides.start_s, strides.end_s)
    found = mean_cycle(cycles[strides.is_used])
    return found.mean if found.n else None


def _mean_leg(walk: RecordingAnalysis, side: Side, drawn: DrawnLeg) -> MeanLeg | None:
    gait = walk.gait.get(side)
    if gait is None:
        return None
    knee, ankle = walk.verdicts.joint(knee_of(side)), walk.verdicts.joint(ankle_of(side))
    if not together((knee.height, knee.sign, knee.shape)).is_reported:
        return None
    used = gait.strides.is_used
    starts, ends = gait.strides.start_s[used], gait.strides.end_s[used]
    points = _over_strides(drawn, starts, ends)
    if points is None:
        return None
    if not together((ankle.height, ankle.sign, ankle.shape)).is_reported:
        points[:, TOES] = np.nan
    stance = side_mean(walk, side, "stance_percent")
    toe_off = stance.found.mean if stance.assessment.is_reported else math.nan
    return MeanLeg(points, float(np.mean(ends - starts)), toe_off)


def _over_strides(drawn: DrawnLeg, starts_s: FloatArray, ends_s: FloatArray) -> FloatArray | None:
    """The mean pose (101, 4, 2) over strides that were wholly seen; None without one."""
    at_once = np.concatenate([drawn.leg_m, drawn.foot_m[:, 1:]], axis=1)[..., [FORWARD, UP]]
    at_once = at_once - at_once[:, :1]
    share, found = np.linspace(0.0, 1.0, POINTS), []
    for start, end in zip(starts_s, ends_s, strict=True):
        time_s = start + share * (end - start)
        flat = at_once.reshape(len(at_once), -1)
        columns = [np.interp(time_s, drawn.time_s, column, left=np.nan, right=np.nan) for column in flat.T]
        found.append(np.stack(columns, axis=1).reshape(POINTS, 4, 2))
    whole = [one for one in found if np.isfinite(one[:, : ANKLE + 1]).all()]
    return np.mean(whole, axis=0) if whole else None
