"""What did each sensor measure on an even clock? Stamps with jitter and missing rows become stretches without gaps."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from core.samples import BoolArray, FloatArray, ImuBlock

MAX_REPORTED_GAP_S = 0.05  # longer gaps stay empty in every output (FORMATS, section 3)
MAX_BRIDGED_GAP_S = 0.25  # orientation survives this long on interpolated rates; after longer gaps it starts anew
MIN_STRETCH_SAMPLES = 10
MIN_STRETCH_S = 1.0  # below, an orientation filter has not found the vertical
EVEN_CLOCK_TOLERANCE = 0.02  # of a step: closer to an even grid than this, samples are used as they are
BLOCK_S = 600.0  # long recordings are worked through in pieces of this length,
OVERLAP_S = 30.0  # which overlap so far that the filters at a seam have settled


@dataclass(frozen=True, slots=True)
class Track:
    """A stretch of one sensor's samples on an even clock.

    `gyr_rad_s` and `acc_m_s2` (n, 3) hold interpolated values in gaps of up to MAX_BRIDGED_GAP_S; `is_measured` (n,)
    is False inside those longer than MAX_REPORTED_GAP_S. `mag` (n, 3) and `q_device` (n, 4), the device's own
    orientation, where it sends them.
    """

    start_s: float
    step_s: float
    gyr_rad_s: FloatArray
    acc_m_s2: FloatArray
    mag: FloatArray | None
    q_device: FloatArray | None
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


@dataclass(frozen=True, slots=True)
class Block:
    """A piece of a long recording: samples of from..to are worked through, results of core_from..core_to are kept."""

    number: int
    from_s: float
    to_s: float
    core_from_s: float
    core_to_s: float


def blocks_of(first_s: float, last_s: float) -> Iterator[Block]:
    """Pieces that cover first..last; their cores meet without overlap."""
    count = max(1, int(np.ceil((last_s - first_s) / BLOCK_S - 0.5)))
    for k in range(count):
        core_from = first_s + k * BLOCK_S if k else -np.inf
        core_to = first_s + (k + 1) * BLOCK_S if k < count - 1 else np.inf
        yield Block(k, core_from - OVERLAP_S, core_to + OVERLAP_S, core_from, core_to)


def even_tracks(block: ImuBlock, from_s: float = -np.inf, to_s: float = np.inf) -> list[Track]:
    """Cut a sensor's samples between two instants into stretches without long gaps, each on an even clock."""
    first, last = np.searchsorted(block.time_s, [from_s, to_s])
    part = slice(int(first), int(last))
    is_there = np.isfinite(block.gyr_rad_s[part]).all(axis=1) & np.isfinite(block.acc_m_s2[part]).all(axis=1)
    time_s = block.time_s[part][is_there]
    if len(time_s) < 2:
        return []
    signals = {"gyr_rad_s": block.gyr_rad_s[part][is_there], "acc_m_s2": block.acc_m_s2[part][is_there]}
    if block.mag is not None:
        signals["mag"] = _without_gaps(block.mag[part][is_there])
    if block.q_earth_from_sensor is not None:
        signals["q_device"] = continuous(_without_gaps(block.q_earth_from_sensor[part][is_there]))
    step_s = nominal_step_s(time_s)
    cuts = np.flatnonzero(np.diff(time_s) > max(MAX_BRIDGED_GAP_S, 1.5 * step_s)) + 1
    tracks = []
    for a, b in pairwise([0, *cuts.tolist(), len(time_s)]):
        if b - a >= MIN_STRETCH_SAMPLES and time_s[b - 1] - time_s[a] >= MIN_STRETCH_S:
            tracks.append(_even(time_s[a:b], {name: values[a:b] for name, values in signals.items()}, step_s))
    return tracks


def continuous(q: FloatArray) -> FloatArray:
    """The same rotations (n, 4) without jumps between q and -q."""
    flips = np.sum(q[1:] * q[:-1], axis=1) < 0
    if not flips.any():
        return q
    return q * np.concatenate([[1.0], np.cumprod(np.where(flips, -1.0, 1.0))])[:, None]


def _without_gaps(values: FloatArray) -> FloatArray:
    """Rows (n, k) that are missing take the last one heard, at the start the first."""
    heard = np.flatnonzero(np.isfinite(values).all(axis=1))
    if len(heard) in (0, len(values)):
        return values
    last = np.searchsorted(heard, np.arange(len(values)), side="right") - 1
    return values[heard[np.maximum(last, 0)]]


def _even(time_s: FloatArray, signals: dict[str, FloatArray], step_s: float) -> Track:
    intervals = max(1.0, float(np.round((time_s[-1] - time_s[0]) / step_s)))
    step_s = float((time_s[-1] - time_s[0]) / intervals)
    ticks = (time_s - time_s[0]) / step_s
    whole = np.round(ticks).astype(int)
    n = int(whole[-1]) + 1
    is_on_grid = bool(np.max(np.abs(ticks - whole)) < EVEN_CLOCK_TOLERANCE) and bool(np.all(np.diff(whole) > 0))
    grid_s = time_s[0] + step_s * np.arange(n)
    is_measured = np.ones(n, dtype=bool)
    for k in np.flatnonzero(np.diff(time_s) > MAX_REPORTED_GAP_S):
        is_measured[(grid_s > time_s[k] + 0.5 * step_s) & (grid_s < time_s[k + 1] - 0.5 * step_s)] = False
    if is_on_grid and n == len(time_s):
        even = signals
    else:
        from scipy.interpolate import Akima1DInterpolator  # local and without overshoot; imported late, it is slow

        inside_s = np.clip(grid_s, time_s[0], time_s[-1])
        even = {name: Akima1DInterpolator(time_s, values)(inside_s) for name, values in signals.items()}
        if is_on_grid:
            for name, values in signals.items():
                even[name][whole] = values
    return Track(
        start_s=float(time_s[0]),
        step_s=step_s,
        gyr_rad_s=even["gyr_rad_s"],
        acc_m_s2=even["acc_m_s2"],
        mag=even.get("mag"),
        q_device=even.get("q_device"),
        is_measured=is_measured,
    )


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
