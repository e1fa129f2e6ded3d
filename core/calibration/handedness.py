"""Sensors whose accelerometer and gyroscope belong to no common right-handed axes, found by the adjacent segments.

A body that turns turns as a whole: over a second and more, thigh, shank and foot turn alike about the vertical. A
sensor whose accelerations have the wrong sign takes up for down and turns the other way round. One sensor alone cannot
show it: a reversed accelerometer is a person seen in a mirror, who walks as anyone does. For the same reason nothing
that we compute changes where all accelerometers are reversed alike.

A joint of two axes may turn its segments against each other, so this is a suspicion only: reversed is an accelerometer
with whose opposite both sensors agree better about what their joint feels.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.signal import butter, sosfiltfilt

from core.body import Joint, Side, Site
from core.calibration.identify import decide, disagreement_about, moving_data
from core.samples import FloatArray, ImuBlock, RateKind
from core.signal.filters import filtered_offline
from core.signal.orientation import oriented
from core.signal.pair import OrientedTrack, pair_up
from core.signal.rotations import matrix_from_quaternion
from core.signal.tracks import Track, even_tracks

LOOKED_AT_S = 60.0
TURN_HZ, GRID_HZ, MEANS_HZ = 1.0, 10.0, 25.0
MIN_OVERLAP_S = 5.0
MIN_TURN_RAD_S = 0.1  # rms; on people a straight walk has 0.1-0.3
# Correlation: of adjacent segments on people 0.1-0.9, in free motion and turns 0.6-1.0; below 0 if one is reversed
OPPOSITE = -0.55
# What a joint's sensors disagree on: people 0.025-0.089, and 0.08-0.27 with one accelerometer negated; hinges
# 0.003-0.007 and 0.40
NEGATED_SHARE = 0.6


@dataclass(frozen=True, slots=True)
class Turning:
    """The longest stretch at the start of a recording, and how fast it turns about the vertical, (n,) at `time_s`."""

    track: Track
    time_s: FloatArray
    rate_rad_s: FloatArray


# None where a recording is too short or too gappy
Turn = Turning | None


def reversed_sites(turns: Mapping[Site, Turn]) -> list[tuple[Site, ...]]:
    """Find sites whose sensors turn about the vertical against adjacent segments, alone or one of two."""
    found: list[tuple[Site, ...]] = []
    for side in Side:
        knee, ankle = (_agreement(turns, joint) for joint in (Joint(f"{side}_knee"), Joint(f"{side}_ankle")))
        thigh, shank, foot = (Site(f"{side}_{segment}") for segment in ("thigh", "shank", "foot"))
        if knee is False and ankle is False:
            found.append((shank,))
        elif knee is False:
            found.append((thigh,) if ankle else (thigh, shank))
        elif ankle is False:
            found.append((foot,) if knee else (shank, foot))
    return found


def _agreement(turns: Mapping[Site, Turn], joint: Joint) -> bool | None:
    """Whether both sensors at a joint turn the same way; None where they turn too little or it is not clear."""
    proximal, distal = turns.get(joint.proximal), turns.get(joint.distal)
    if proximal is None or distal is None:
        return None
    t1, t2 = proximal.time_s, distal.time_s
    grid = np.arange(max(t1[0], t2[0]), min(t1[-1], t2[-1]), 1.0 / GRID_HZ)
    if len(grid) < MIN_OVERLAP_S * GRID_HZ:
        return None
    one, other = np.interp(grid, t1, proximal.rate_rad_s), np.interp(grid, t2, distal.rate_rad_s)
    sizes = np.sqrt(np.mean(one**2)), np.sqrt(np.mean(other**2))
    if min(sizes) < MIN_TURN_RAD_S:
        return None
    correlation = float(np.mean(one * other) / (sizes[0] * sizes[1]))
    if correlation < OPPOSITE:
        return False if _is_one_reversed(proximal.track, distal.track) else None
    return True if correlation > 0.0 else None


def _is_one_reversed(proximal: Track, distal: Track) -> bool:
    """Whether both sensors agree better about their joint with one accelerometer negated, it does not matter which."""
    one = _oriented(proximal)
    as_is, negated = (
        _disagreement(one, _oriented(track)) for track in (distal, replace(distal, acc_m_s2=-distal.acc_m_s2))
    )
    return negated < NEGATED_SHARE * as_is


def _oriented(track: Track) -> OrientedTrack:
    return oriented(track, RateKind.INSTANTANEOUS, np.zeros(3))


def _disagreement(one: OrientedTrack, two: OrientedTrack) -> float:
    pair = pair_up(one, two, 0.0)
    data = moving_data((pair,)) if pair is not None else None
    if data is None:
        return float("nan")
    best = decide(data).best
    return disagreement_about(data, best.axis_1[0], best.axis_2[0])


def turn_about_vertical(block: ImuBlock) -> Turn:
    """How a sensor turns about the vertical, below `TURN_HZ`."""
    if not len(block):
        return None
    tracks = even_tracks(block, to_s=float(block.time_s[0]) + LOOKED_AT_S)
    if not tracks:
        return None
    track = max(tracks, key=len)
    if track.end_s - track.start_s < MIN_OVERLAP_S or track.step_s > 0.2 / TURN_HZ:
        return None
    # so slow a turn needs no more than a mean of each few samples
    width = max(1, round(1.0 / (MEANS_HZ * track.step_s)))
    gyr, acc, time_s = (_means(v, width) for v in (track.gyr_rad_s, track.acc_m_s2, track.time_s))
    step_s = width * track.step_s
    # a filter that does not estimate the gyroscopes' bias finds reversed accelerometers where there are none
    vertical = matrix_from_quaternion(filtered_offline(gyr, acc, None, step_s))[:, 2]
    return Turning(track, time_s, sosfiltfilt(_low_pass(step_s), np.sum(gyr * vertical, axis=1)))


def _means(values: FloatArray, width: int) -> FloatArray:
    """Means (n // width, ...) of `width` successive values (n, ...)."""
    whole = len(values) // width * width
    total = values[0:whole:width].copy()
    for k in range(1, width):
        total += values[k:whole:width]
    return total / width


@lru_cache(maxsize=16)
def _low_pass(step_s: float) -> FloatArray:
    return np.asarray(butter(2, TURN_HZ, fs=1.0 / step_s, output="sos"))
