"""What did each sensor measure on an even clock? Stamps with jitter and missing rows become stretches without gaps."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from core.samples import BoolArray, FloatArray, ImuBlock

MAX_REPORTED_GAP_S = 0.05  # longer gaps stay empty in every output (FORMATS, section 3)
MAX_BRIDGED_GAP_S = 0.25  # orientation survives this long on interpolated rates; after longer gaps it starts anew
MIN_STRETCH_S = 1.0  # below, an orientation filter has not found the vertical
EVEN_CLOCK_TOLERANCE = 0.02  # of a step: closer to an even grid than this, samples are used as they are
BLOCK_S = 600.0  # long recordings are worked through in pieces of this length,
OVERLAP_S = 30.0  # which overlap so far that the filters at a seam have settled


@dataclass(frozen=True, slots=True)
class Track:
    """A stretch of one sensor's samples on an even clock.

    `gyr_rad_s` and `acc_m_s2` (n, 3) hold interpolated values in gaps of up to MAX_BRIDGED_GAP_S; `is_measured` (n,)
    is False inside those longer than MAX_REPORTED_GAP_S.
    """

    start_s: float
    step_s: float
    gyr_rad_s: FloatArray
    acc_m_s2: FloatArray
    mag: FloatArray | None
    is_measured: BoolArray

    def __len__(self) -> int:
        return len(self.gyr_rad_s)

    @property
    def time_s(self) -> FloatArray:
        return self.start_s + self.step_s * np.arange(len(self))

    @property
    def end_s(self) -> float:
        return self.start_s + self.step_s * (len(self) - 1)


def nominal_step_s(time_s: FloatArray) -> float:
    """The sensor's sampling interval: the median step, refined over the stretches without gaps."""
    steps = np.diff(time_s)
    median = float(np.median(steps))
    regular = steps[np.abs(steps - median) < 0.5 * median]
    return float(np.mean(regular)) if len(regular) else median


def blocks_of(first_s: float, last_s: float) -> Iterator[tuple[float, float, float, float]]:
    """Pieces (from, to, core from, core to) that cover first..last; the cores meet without overlap."""
    count = max(1, int(np.ceil((last_s - first_s) / BLOCK_S - 0.5)))
    for k in range(count):
        core_from = first_s + k * BLOCK_S if k else -np.inf
        core_to = first_s + (k + 1) * BLOCK_S if k < count - 1 else np.inf
        yield core_from - OVERLAP_S, core_to + OVERLAP_S, core_from, core_to


def even_tracks(block: ImuBlock, from_s: float = -np.inf, to_s: float = np.inf) -> list[Track]:
    """Cut a sensor's samples between two instants into stretches without long gaps, each on an even clock."""
    first, last = np.searchsorted(block.time_s, [from_s, to_s])
    time_s, gyr, acc = block.time_s[first:last], block.gyr_rad_s[first:last], block.acc_m_s2[first:last]
    mag = None if block.mag is None else block.mag[first:last]
    is_there = np.isfinite(gyr).all(axis=1) & np.isfinite(acc).all(axis=1)
    if not is_there.all():
        time_s, gyr, acc = time_s[is_there], gyr[is_there], acc[is_there]
        mag = None if mag is None else mag[is_there]
    if len(time_s) < 2:
        return []
    step_s = nominal_step_s(time_s)
    cuts = np.flatnonzero(np.diff(time_s) > max(MAX_BRIDGED_GAP_S, 1.5 * step_s)) + 1
    edges = [0, *cuts.tolist(), len(time_s)]
    tracks = []
    for a, b in zip(edges[:-1], edges[1:], strict=True):
        if b - a >= 5 and time_s[b - 1] - time_s[a] >= MIN_STRETCH_S:
            tracks.append(_even(time_s[a:b], gyr[a:b], acc[a:b], None if mag is None else mag[a:b], step_s))
    return tracks


def _even(time_s: FloatArray, gyr: FloatArray, acc: FloatArray, mag: FloatArray | None, step_s: float) -> Track:
    ticks = np.round((time_s - time_s[0]) / step_s)
    if ticks[-1] > 0:
        step_s = float((time_s[-1] - time_s[0]) / ticks[-1])
    ticks = (time_s - time_s[0]) / step_s
    whole = np.round(ticks).astype(int)
    n = int(whole[-1]) + 1
    is_on_grid = bool(np.max(np.abs(ticks - whole)) < EVEN_CLOCK_TOLERANCE) and bool(np.all(np.diff(whole) > 0))
    is_measured = np.ones(n, dtype=bool)
    grid_s = time_s[0] + step_s * np.arange(n)
    for k in np.flatnonzero(np.diff(time_s) > MAX_REPORTED_GAP_S):
        is_measured[(grid_s > time_s[k] + 0.5 * step_s) & (grid_s < time_s[k + 1] - 0.5 * step_s)] = False
    signals = [gyr, acc] if mag is None else [gyr, acc, np.where(np.isfinite(mag), mag, 0.0)]
    if is_on_grid and n == len(time_s):
        even = signals
    else:
        from scipy.interpolate import Akima1DInterpolator  # local and without overshoot; imported late, it is slow

        even = [Akima1DInterpolator(time_s, signal)(np.clip(grid_s, time_s[0], time_s[-1])) for signal in signals]
        if is_on_grid:
            for values, signal in zip(even, signals, strict=True):
                values[whole] = signal
    return Track(float(time_s[0]), step_s, even[0], even[1], None if mag is None else even[2], is_measured)


def at_positions(values: FloatArray, position: FloatArray) -> FloatArray:
    """Values (n, k) of an even track at fractional indices (m,), by cubics through four samples.

    Whole positions return the samples themselves. Positions outside of 0..n-1 take the nearest sample.
    """
    n = len(values)
    position = np.clip(position, 0, n - 1)
    left = np.floor(position).astype(int)
    u = position - left
    if not np.any(u > 1e-9):
        return values[left]
    left = np.clip(left, 1, n - 3)
    u = (position - left)[:, None]
    p0, p1, p2, p3 = values[left - 1], values[left], values[left + 1], values[left + 2]
    return (
        -u * (u - 1) * (u - 2) / 6 * p0
        + (u + 1) * (u - 1) * (u - 2) / 2 * p1
        - (u + 1) * u * (u - 2) / 2 * p2
        + (u + 1) * u * (u - 1) / 6 * p3
    )
