"""What is reported of the hips and the pelvis in one recording."""

from dataclasses import dataclass
from enum import StrEnum

from core.samples import FloatArray

MIN_APPLIED_S = 0.010  # below, tissue looks like a clock


class ClockStatus(StrEnum):
    """How the clocks of both legs are tied. The values are the words of summary.json."""

    PROVEN = "proven"
    FOUND = "found"
    NOT_REPORTED = "withheld"


@dataclass(frozen=True, slots=True)
class LegClock:
    """How far the right leg's stamps are later than the left's, s, and what follows.

    `sd_s` is NaN where the offset is not reported. `applied_s` is what the right leg's stamps were moved back by.
    """

    offset_s: float
    sd_s: float
    status: ClockStatus

    @property
    def applied_s(self) -> float:
        """0 where the clocks are proven common, where they are not known, and where they may be."""
        is_moved = self.status is ClockStatus.FOUND and abs(self.offset_s) > MIN_APPLIED_S
        return self.offset_s if is_moved else 0.0


@dataclass(frozen=True, slots=True)
class HipIdentification:
    """How pelvis and thigh sit on one hip, and how sure that is; figures of the recording's longest stretch.

    Centres (3,) point from the joint to the sensors, m, in sensor axes. `is_3d`: the heading is sure enough for Cardan
    angles, and that of adjacent segments; else flexion is that against the vertical, and there is no abduction.
    `centres_apart_m`: how far to the left of the right hip's centre the left one's lies; None where there is one hip
    only. `frame_proximal` and `frame_distal` (3, 3) are what the angles were measured with: rows x forward, y left,
    z up of pelvis and thigh, in sensor axes.
    """

    centre_proximal_m: FloatArray
    centre_distal_m: FloatArray
    margin: float
    disagreement: float
    heading_sd_rad: float
    is_3d: bool
    moving_s: float
    lag_s: float
    standing_from: str
    centres_apart_m: float | None
    frame_proximal: FloatArray
    frame_distal: FloatArray


@dataclass(frozen=True, slots=True)
class HipAngle:
    """One hip over one recording (n,), rad from standing: flexion, its sd, abduction; NaN where unknown."""

    angle_rad: FloatArray
    sd_rad: FloatArray
    abduction_rad: FloatArray
    identification: HipIdentification


@dataclass(frozen=True, slots=True)
class PelvisAngles:
    """The pelvis over one recording (n,), rad from standing, NaN where unknown.

    `tilt_rad` is positive forward, `obliquity_rad` with the left side up, `rotation_rad` to the left, against its mean
    over two strides; NaN in turns.
    """

    tilt_rad: FloatArray
    obliquity_rad: FloatArray
    rotation_rad: FloatArray


@dataclass(frozen=True, slots=True)
class PelvisTurn:
    """A turn of the whole body: when it begins and ends, s, and how far it leads to the left, rad."""

    start_s: float
    end_s: float
    angle_rad: float
