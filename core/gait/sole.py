"""When a foot's sole begins and ceases to travel over the floor, for contacts that pitch does not show.

A standing foot may roll, and the point that it rolls on keeps still: what its sensor does is the rolling. Taking
the rolling off the sensor's velocity leaves that of the sole, in any way of landing and leaving: heels first, toes
first, flat or dragging.
"""

from dataclasses import dataclass

import numpy as np

from core.gait.crossings import Onset, crossing, onset
from core.gait.foot import FootMotion
from core.samples import BoolArray, FloatArray

EARLY_SHARE = 0.1  # of the greatest speed: slower than this on its way to leave, a foot still rolls where it stood
MAX_SENSOR_HEIGHT_M = 0.15
TRAVEL_SHARE = 0.05  # of the sole's greatest speed: more, and it travels
LANDED_SHARE = 0.25  # more, and it has not landed: real feet that land heels first go on at 0.1 to 0.2
STANDING_SHARE = 0.04  # less, and the foot is at rest, however it came down
MAX_EARLY_S, MAX_LATE_S = 0.04, 0.01  # the pitch of a flat foot that lands further from its sole shows something else
NEAR_SHARE, SHOCK_S = 0.5, 0.05  # a shock counts from so long before the sole becomes slower than this share;
# a sole that lands softly is at rest twice that after it is below LANDED_SHARE; what moves it later is the shoe
MIN_SHOCK_M_S2 = 5.0  # from sample to sample; feet put down softly after a stroke begin here
SHOCK_RATIO = 3.0  # a landing so much harder than the rest of the swing is felt as a shock
SHOCK_ONSET_SHARE = 0.5  # of the greatest shock


@dataclass(frozen=True, slots=True)
class SoleTravel:
    """Where the sole of each swing (k,) begins to travel and ceases to, as indices of samples.

    A sole that lands hard is stopped by the floor: the shock shows when. One that lands softly has slowed down before.

    `leaves_reach`, `lands_reach` are how far, in samples, the sole's speed was extrapolated to find them;
    `speed_share` (n,) is how fast the sole travels, as a share of its greatest speed in the swing.
    """

    leaves: FloatArray
    lands: FloatArray
    leaves_reach: FloatArray
    lands_reach: FloatArray
    speed_share: FloatArray

    def is_landing(self, index: FloatArray, is_flat: BoolArray, is_straight: BoolArray, step_s: float) -> BoolArray:
        """Whether soles may land at indices (k,): hardly travelling, flat ones at rest; False where NaN."""
        at = np.where(np.isfinite(index), index, 0.0).astype(int)
        most = np.where(is_flat, STANDING_SHARE, np.where(is_straight, LANDED_SHARE, np.inf))
        is_slow = self.speed_share[at] < most
        after_s = step_s * (index - self.lands)
        is_then = (after_s > -MAX_EARLY_S) & (after_s < MAX_LATE_S)
        return np.isfinite(index) & is_slow & (is_then | ~is_flat)


def travel_of(motion: FootMotion) -> SoleTravel:
    """When the sole of each swing of `motion` leaves and lands."""
    swings = motion.swings
    spans = list(zip(swings.anchor_before.tolist(), swings.fastest.tolist(), swings.anchor_after.tolist(), strict=True))
    forward = [_forward(motion, k, a, b) for k, (a, _, b) in enumerate(spans)]
    height_m = _sensor_height_m(motion, spans, forward)
    shock = np.linalg.norm(np.diff(motion.acceleration_m_s2, axis=0), axis=1)
    rows, share = np.empty((len(spans), 4)), np.zeros(len(motion.pitch_rad))
    for k, (a, _, b) in enumerate(spans):
        speed = np.abs(forward[k] + height_m * motion.pitch_rate_rad_s[a : b + 1])
        fastest = int(np.argmax(speed))
        share[a : b + 1] = speed / speed[fastest]
        left = onset(share[a : b + 1], fastest, 0, TRAVEL_SHARE)
        landed = _landing(share[a : b + 1], shock[a:b], fastest, round(SHOCK_S / motion.step_s))
        rows[k] = left.index + a, landed.index + a, left.reach, landed.reach
    leaves, lands, leaves_reach, lands_reach = rows.T
    return SoleTravel(leaves, lands, leaves_reach, lands_reach, share)


def _landing(share: FloatArray, shock: FloatArray, fastest: int, ahead: int) -> Onset:
    """Where the sole, `share` (n,) of its greatest speed, ceases to travel; `ahead` is SHOCK_S in samples."""
    near = fastest + int(np.argmax(share[fastest:] < NEAR_SHARE))
    near = max(near - ahead, (fastest + near) // 2)
    felt = shock[near:]
    hardest = float(felt.max(initial=0.0))
    least = max(MIN_SHOCK_M_S2, SHOCK_RATIO * float(shock[fastest:near].max(initial=0.0)))
    if hardest > least:
        return Onset(near + float(np.argmax(felt > max(least, SHOCK_ONSET_SHARE * hardest))), 0.0)
    soft = onset(share, fastest, len(share) - 1, TRAVEL_SHARE)
    latest = crossing(share, fastest, len(share) - 1, LANDED_SHARE) + 2.0 * ahead
    return soft if soft.index < latest else Onset(latest, 2.0 * ahead)


def _forward(motion: FootMotion, k: int, first: int, last: int) -> FloatArray:
    """Velocity (n,) of the sensor along the way of swing `k`."""
    way = motion.travel_m[k] / max(float(np.linalg.norm(motion.travel_m[k])), 1e-9)
    return np.asarray(motion.velocity_m_s[first : last + 1, :2] @ way)


def _sensor_height_m(motion: FootMotion, spans: list[tuple[int, int, int]], forward: list[FloatArray]) -> float:
    """How high the sensor sits over what the foot rolls on, from how it goes forward while the toes turn down."""
    moved = turned = 0.0
    for (a, m, _), along in zip(spans, forward, strict=True):
        speed = np.linalg.norm(motion.velocity_m_s[a : m + 1], axis=1)
        early = slice(0, int(np.argmax(speed > EARLY_SHARE * speed[-1])))
        rate = motion.pitch_rate_rad_s[a : m + 1][early]
        moved -= float(rate @ along[: m + 1 - a][early])
        turned += float(rate @ rate)
    return float(np.clip(moved / max(turned, 1e-9), 0.0, MAX_SENSOR_HEIGHT_M))
