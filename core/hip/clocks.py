"""Which clocks the hips find in one recording, and by how much the stamps of a leg are moved."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from core.angles.measure import pairs_of
from core.body import Side, Site, hip_of
from core.gait.clocks import stamps_residual_s
from core.hip.leg_clock import (
    MAX_HALVES_S,
    MIN_MARGIN,
    ThighClock,
    leg_clock,
    thigh_clock,
)
from core.hip.results import MIN_APPLIED_S, ClockStatus, LegClock
from core.session import Recording
from core.signal.sensors import SensorTracks


@dataclass(frozen=True, slots=True)
class HipClocks:
    """Of one recording: both legs' clock, None without both thighs, and what brings each thigh's to the pelvis's, s."""

    legs: LegClock | None
    lag_s: Mapping[Side, float]

    @property
    def right_late_s(self) -> float:
        """What the right leg's stamps are to be moved back by, s."""
        return self.legs.applied_s if self.legs is not None else 0.0

    def from_pelvis_s(self, side: Side) -> float:
        """What brings the pelvis's stamps to a leg's own, the right one's moved back already; s."""
        return -self.lag_s.get(side, 0.0) - (self.right_late_s if side is Side.RIGHT else 0.0)


NO_CLOCKS = HipClocks(None, {})


def hip_clocks(tracks: SensorTracks, recording: Recording) -> HipClocks:
    """Find one recording's clocks from its first ten minutes; none without a pelvis sensor."""
    found: dict[Side, ThighClock] = {}
    for side in Side:
        if tracks.is_usable(recording, Site.PELVIS, hip_of(side).distal):
            pairs = pairs_of(tracks, recording, hip_of(side), tracks.blocks(recording)[0], 0.0)
            longest = max(pairs, key=len, default=None)
            clock = thigh_clock(longest) if longest is not None else None
            if clock is not None:
                found[side] = clock
    sites = (Site.PELVIS, *(hip_of(side).distal for side in found))
    is_proven = _is_common(tracks, recording, sites)
    legs = leg_clock(found[Side.LEFT], found[Side.RIGHT], is_proven) if len(found) == len(Side) else None
    is_offset = legs is not None and legs.status is ClockStatus.FOUND and legs.applied_s != 0.0
    lag_s = {side: clock.lag_s if not is_proven and _is_lag(clock, is_offset) else 0.0 for side, clock in found.items()}
    return HipClocks(legs, lag_s)


def _is_lag(clock: ThighClock, is_offset: bool) -> bool:
    is_sound = clock.margin >= MIN_MARGIN and clock.halves_s <= MAX_HALVES_S and not clock.is_at_border
    return is_sound and (is_offset or abs(clock.lag_s) > MIN_APPLIED_S)


def _is_common(tracks: SensorTracks, recording: Recording, sites: tuple[Site, ...]) -> bool:
    """Whether all of these sensors are declared to share one clock, or their stamps prove it."""
    ids = [info.clock if (info := tracks.session.sensors.get(site)) else "" for site in sites]
    if all(ids):
        return len(set(ids)) == 1
    first, *others = (recording.imu[site].time_s for site in sites)
    return bool(others) and all(np.isfinite(stamps_residual_s(first, other)) for other in others)
