"""Smoothed terms of every sensor at the same instants, which distinguish adjacent segments from others.

Everything here is linear in the unknowns of a joint, so it may be averaged over time first. That takes away what
tissue, impacts and small lags do between two adjacent segments, and leaves the slow swing of the limbs, which others
do not share.
"""

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import convolve1d

from core.samples import FloatArray, IntArray
from core.signal.joint_force import JointForce
from core.signal.pair import FAST_RAD_S, OrientedTrack
from core.signal.tracks import at_positions

STEP_S = 0.05
MEAN_S = 0.15  # twice over: longer than tissue rings, shorter than a leg swings
LONGEST_S = 60.0  # the liveliest minute shows as much as an hour
WINDOW_S = 15.0  # over which two headings hardly drift apart
MAX_INSTANTS = 400
BORDER_S = 0.05  # at the ends of a stretch what is felt leans on one side
MIN_SHARE = 0.5  # of what a mean is taken over was received


@dataclass(frozen=True, slots=True)
class SmoothedTrack:
    """One sensor at even instants (n,); NaN where it gave no sample.

    With o the vector from a joint to the sensor and b the accelerometer's bias, both in sensor axes, the joint's
    specific force in the sensor's own earth is terms @ (-o, -b, 1).
    """

    terms: FloatArray  # (n, 3, 7)
    change: FloatArray  # (n, 3, 7): their derivatives by time

    @property
    def up(self) -> FloatArray:
        """Mean vertical (3,) in sensor axes."""
        return np.asarray(np.nanmean(self.terms[:, 2, 3:6], axis=0))


@dataclass(frozen=True, slots=True)
class SmoothedTracks:
    """All sensors at the same even instants; `index` (m,) are those to be used.

    `window` (m,) numbers the stretches of one heading each.
    """

    sensors: Mapping[str, SmoothedTrack]
    index: IntArray
    window: IntArray


Tracks = Mapping[str, Sequence[OrientedTrack]]
"""The oriented stretches of each sensor in one recording, by the sensor's name."""


def smoothed_in_steps(tracks: Tracks) -> Generator[None, None, SmoothedTracks | None]:
    """Smooth the sensors' liveliest common minute, a step each; None where one was not received for a second."""
    if not all(tracks.values()):
        return None
    start_s = max(min(one.track.start_s for one in stretches) for stretches in tracks.values())
    end_s = min(max(one.track.end_s for one in stretches) for stretches in tracks.values())
    if end_s - start_s < 1.0:
        return None
    start_s, end_s = _liveliest(tracks, start_s, end_s)
    time_s = np.arange(start_s, end_s, STEP_S)
    sensors = {}
    for name, stretches in tracks.items():
        sensors[name] = _smoothed(stretches, time_s)
        yield
    if any(np.isnan(one.terms).all() for one in sensors.values()):
        return None
    index = np.arange(1, len(time_s) - 1, -(-len(time_s) // MAX_INSTANTS))
    windows = max(1, round((end_s - start_s) / WINDOW_S))
    return SmoothedTracks(sensors, index, index * windows // len(time_s))


def _liveliest(tracks: Tracks, start_s: float, end_s: float) -> tuple[float, float]:
    if end_s - start_s <= LONGEST_S:
        return start_s, end_s
    energy = np.zeros(int(np.ceil(end_s - start_s)))
    for stretches in tracks.values():
        for one in stretches:
            square = np.minimum(np.sum(one.track.gyr_rad_s**2, axis=1), FAST_RAD_S**2)  # a jump is not a minute's worth
            at = np.floor(one.track.time_s - start_s).astype(np.int64)
            is_inside = (at >= 0) & (at < len(energy))
            energy += one.track.step_s * np.bincount(at[is_inside], square[is_inside], len(energy))
    total = np.concatenate([[0.0], np.cumsum(energy)])
    seconds = int(LONGEST_S)
    first = int(np.argmax(total[seconds:] - total[:-seconds]))
    return start_s + first, min(start_s + first + LONGEST_S, end_s)


def _smoothed(stretches: Sequence[OrientedTrack], time_s: FloatArray) -> SmoothedTrack:
    rows = np.full((len(time_s), 21), np.nan)
    for one in stretches:
        force = one.joint_force
        reach_s = 2 * _half_width(force.step_s) * force.step_s + BORDER_S
        is_inside = (time_s >= one.track.start_s + reach_s) & (time_s <= one.track.end_s - reach_s)
        if is_inside.any():
            rows[is_inside] = _smooth_terms(force, time_s[is_inside])
    terms = rows.reshape(-1, 3, 7)
    return SmoothedTrack(terms, np.gradient(terms, STEP_S, axis=0))


def _smooth_terms(force: JointForce, time_s: FloatArray) -> FloatArray:
    """Terms row by row (n, 21), averaged around ascending instants inside a stretch; NaN where little was received."""
    half = _half_width(force.step_s)
    middle = (time_s - force.start_s) / force.step_s
    first = max(0, int(middle[0]) - 2 * half - 1)
    near = slice(first, int(middle[-1]) + 2 * half + 3)
    is_received = force.received[near, None] > MIN_SHARE
    rows = np.concatenate([np.where(is_received, force.terms[near].reshape(-1, 21), 0.0), is_received], axis=1)
    smooth = at_positions(_mean_of_means(rows, half), middle - first - 2 * half)
    share = smooth[:, 21:]
    return np.where(share > MIN_SHARE, smooth[:, :21] / np.maximum(share, MIN_SHARE), np.nan)


def _half_width(step_s: float) -> int:
    return max(1, round(0.5 * MEAN_S / step_s))


def _mean_of_means(values: FloatArray, half: int) -> FloatArray:
    """Means (n - 4 half, k) of the means of rows (n, k) and the `half` rows on each side of each."""
    width = 2 * half + 1
    both = np.convolve(np.ones(width), np.ones(width)) / width**2
    return np.asarray(convolve1d(values, both, axis=0)[2 * half : len(values) - 2 * half])
