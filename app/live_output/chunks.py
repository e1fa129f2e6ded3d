"""What leaves of a running walk: angles with their certainty and status, and the feet's events. Nothing of a person."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from core.body import Joint, Side, Site
from core.gait.live import FootEvent
from core.samples import FloatArray
from core.verdicts.model import Verdict

STATUSES = (
    Verdict.READ,
    Verdict.CARE,
    Verdict.NOT_REPORTED,
)  # it leaves as its place or word


@dataclass(frozen=True, slots=True)
class AngleChunk:
    """New samples of a joint, all (n,): on the acquisition's clock, deg, NaN where `status` is that of no report."""

    time_s: FloatArray
    angle_deg: FloatArray
    sd_deg: FloatArray
    status: npt.NDArray[np.int8]

    def __len__(self) -> int:
        return len(self.time_s)

    def since(self, time_s: float) -> "AngleChunk":
        """Give the samples that are no earlier."""
        is_later = self.time_s >= time_s
        if is_later.all():
            return self
        return AngleChunk(self.time_s[is_later], self.angle_deg[is_later], self.sd_deg[is_later], self.status[is_later])


@dataclass(frozen=True, slots=True)
class EventMark:
    """An initial contact or toe-off: when it happened, and the sample that showed it."""

    side: Side
    event: FootEvent
    time_s: float
    reported_s: float


@dataclass(frozen=True, slots=True)
class LiveChunk:
    """What one update of the estimator has brought.

    `doubtful`: sides whose events are not reported now. `missing`: sites that are silent.
    """

    angles: Mapping[Joint, AngleChunk]
    events: tuple[EventMark, ...] = ()
    doubtful: tuple[Side, ...] = ()
    missing: tuple[Site, ...] = ()

    @property
    def samples(self) -> int:
        """How many samples and events it holds."""
        return sum(map(len, self.angles.values())) + len(self.events)


@dataclass(frozen=True, slots=True)
class LiveStreams:
    """What there is to be received: joints with their rates, Hz; sides with a foot sensor; whether it is simulated."""

    rates_hz: Mapping[Joint, float]
    feet: tuple[Side, ...]
    is_simulated: bool


def angle_chunk(time_s: FloatArray, angle_rad: FloatArray, sd_rad: FloatArray, verdict: Verdict) -> AngleChunk:
    """Give samples of a joint whose verdict is that; without a verdict or a number none is reported."""
    number = STATUSES.index(verdict) if verdict in STATUSES else len(STATUSES) - 1
    status = np.where(np.isfinite(angle_rad), number, len(STATUSES) - 1).astype(np.int8)
    is_reported = status < len(STATUSES) - 1
    angle_deg, sd_deg = (np.where(is_reported, np.rad2deg(one), np.nan) for one in (angle_rad, sd_rad))
    return AngleChunk(time_s, angle_deg, sd_deg, status)
