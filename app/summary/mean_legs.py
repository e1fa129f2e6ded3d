"""Legs at each percent of a mean stride. Drawn from the angles and the thighs' inclination.

Seen from the side: forward is x, up is z, each hip at the origin. What may not be read of a joint is not drawn.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from app.summary.comparison import Comparison
from app.summary.drawn_legs import DrawnLeg, draw_legs
from core.body import Joint, Side, ankle_of, knee_of
from core.gait.cycles import POINTS, cycles_of, mean_cycle
from core.results import Analysis, RecordingAnalysis
from core.samples import FloatArray
from core.session import Session
from core.verdicts.model import together

HIP, KNEE, ANKLE, TOES = range(4)
FORWARD, UP = 0, 2


@dataclass(frozen=True, slots=True)
class MeanLegs:
    """Both legs, or the one that was measured.

    `points_m`: hip, knee, ankle and toes of each leg over its own stride (101, 4, 2), NaN where not to be drawn.
    `tilt_rad`: of the pelvis over the affected leg's stride, else the left one's (101,), forward positive; None where
    it is not to be drawn.
    """

    points_m: Mapping[Side, FloatArray]
    tilt_rad: FloatArray | None = None

    def pelvis_tilt_rad(self, percent: float) -> float | None:
        """How far the pelvis is tilted at `percent` of the stride; None where it is not to be drawn."""
        return None if self.tilt_rad is None else float(np.interp(percent % 100.0, np.arange(POINTS), self.tilt_rad))

    def pose_m(self, side: Side, percent: float) -> FloatArray:
        """Hip, knee, ankle and toes (4, 2) of a leg at `percent` of its own stride."""
        at = percent % 100.0
        low = math.floor(at)
        share = at - low
        points = self.points_m[side]
        return np.asarray((1 - share) * points[low] + share * points[low + 1])


@dataclass(frozen=True, slots=True)
class ThinBend:
    """How much further a leg was bent where the thin line is drawn, over the cycle (101,), degrees."""

    knee_deg: FloatArray
    ankle_deg: FloatArray


def thin_bends(found: Comparison) -> dict[Side, ThinBend]:
    """Of legs whose knee's height can be compared; an ankle whose cannot is NaN."""
    then, now = found.against, found.others[-1]

    def change(joint: Joint) -> FloatArray:
        is_known = all(joint in part.joints and part.verdicts.joint(joint).height.is_reported for part in (then, now))
        if not is_known or not found.has_one_zero(joint):
            return np.full(POINTS, np.nan)
        return then.cycle(joint).mean - now.cycle(joint).mean

    bends = {side: ThinBend(change(knee_of(side)), change(ankle_of(side))) for side in found.sides}
    return {side: bend for side, bend in bends.items() if np.isfinite(bend.knee_deg).all()}


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
    points = {side: leg for side in Side if side in drawn and (leg := _points_m(walk, side, drawn[side])) is not None}
    if not points:
        return None
    affected = analysis.affected_side
    return MeanLegs(points, _mean_tilt(walk, affected if affected in points else next(iter(points))))


def _mean_tilt(walk: RecordingAnalysis, side: Side) -> FloatArray | None:
    if walk.pelvis is None or not walk.verdicts.pelvis.is_reported:
        return None
    strides = walk.gait[side].strides
    cycles = cycles_of(walk.time_s, walk.pelvis.tilt_rad, strides.start_s, strides.end_s)
    found = mean_cycle(cycles[strides.is_used])
    return found.mean if found.n else None


def _points_m(walk: RecordingAnalysis, side: Side, drawn: DrawnLeg) -> FloatArray | None:
    gait = walk.gait.get(side)
    if gait is None:
        return None
    knee, ankle = walk.verdicts.joint(knee_of(side)), walk.verdicts.joint(ankle_of(side))
    if not together((knee.height, knee.sign, knee.shape)).is_reported:
        return None
    used = gait.strides.is_used
    points = _over_strides(drawn, gait.strides.start_s[used], gait.strides.end_s[used])
    if points is not None and not together((ankle.height, ankle.sign, ankle.shape)).is_reported:
        points[:, TOES] = np.nan
    return points


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
