"""A sensor's samples on an even clock: stamps with jitter and missing rows become stretches without gaps."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import Akima1DInterpolator

from core.samples import BoolArray, FloatArray, ImuBlock

MAX_REPORTED_GAP_S = 0.05  # longer gaps stay empty in every output (FORMATS, section 3)
MAX_BRIDGED_GAP_S = 0.12  # a swinging leg's rates can be interpolated this long; after more, orientation restarts
MAX_STILL_GAP_S = 0.25  # and this long where the sensor hardly turns
STILL_RAD_S = 0.5
MAX_RATE_RAD_S, MAX_FORCE_M_S2 = 100.0, 1000.0  # no sensor worn by a patient measures more
MAX_HELD_S = 0.25  # a sensor that repeats itself for longer is stuck,
# but for a coarse one that lies still for not too long: it reads next to no rate and goes on from where it was
MAX_HELD_STILL_S, HELD_STILL_RAD_S, HELD_STILL_M_S2 = 2.0, 0.05, 0.5
QUATERNION_TOLERANCE = 0.1  # of its length
MIN_STRETCH_SAMPLES = 10
MIN_STRETCH_S = 1.0  # below, an orientation filter has not found the vertical
EVEN_CLOCK_TOLERANCE = 0.02  # of a step: closer to an even grid than this, samples are used as they are
BLOCK_S = 600.0  # long recordings are worked through in pieces of this length,
OVERLAP_S = 30.0  # which overlap so far that the filters at a seam have settled


@dataclass(frozen=True, slots=True)
class Track:
    """A stretch of one sensor's samples on an even clock.

    `gyr_rad_s` and `acc_m_s2` (n, 3) hold interpolated values in gaps that are bridged; `is_measured` (n,)
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
        """Even stamps (n,)."""
        return self.start_s + self.step_s * np.arange(len(self))

    @property
    def end_s(self) -> float:
        """Stamp of the last sample."""
        return self.start_s + self.step_s * (len(self) - 1)


def nominal_step_s(time_s: FloatArray) -> float:
    """Give the sensor's sampling interval from the steps without gaps; needs two ascending stamps at least."""
    steps = np.diff(time_s)
    # a quartile and not the median, which half of the rows missing would double; NumPy's own takes five times as long
    position = 0.25 * (len(steps) - 1)
    k = int(position)
    low, high = np.partition(steps, (k, min(k + 1, len(steps) - 1)))[[k, min(k + 1, len(steps) - 1)]]
    usual = float(low + (position - k) * (high - low))
    regular = steps[np.abs(steps - usual) < 0.5 * usual]
    return float(np.mean(regular)) if len(regular) else usual


@dataclass(frozen=True, slots=True)
class Block:
    """A piece of a long recording: samples of from..to are worked through, results of core_from..core_to are kept."""

    number: int
    from_s: float
    to_s: float
    core_from_s: float
    core_to_s: float


def blocks_of(first_s: float, last_s: float) -> Iterator[Block]:
    """Give pieces in order of time that cover first to last; their cores meet without overlap."""
    count = max(1, int(np.ceil((last_s - first_s) / BLOCK_S - 0.5)))
    for k in range(count):
        core_from = first_s + k * BLOCK_S if k else -np.inf
        core_to = first_s + (k + 1) * BLOCK_S if k < count - 1 else np.inf
        yield Block(k, core_from - OVERLAP_S, core_to + OVERLAP_S, core_from, core_to)


def even_tracks(block: ImuBlock, from_s: float = -np.inf, to_s: float = np.inf) -> list[Track]:
    """Cut a sensor's samples between two instants into stretches without long gaps, each on an even clock.

    Parameters
    ----------
    block
        Samples in sensor axes, NaN or missing where there were none.

    Returns
    -------
    list of Track
        In order of time; empty where next to nothing was received.
    """
    first, last = np.searchsorted(block.time_s, [from_s, to_s])
    part = slice(int(first), int(last))
    gyr, acc = block.gyr_rad_s[part], block.acc_m_s2[part]
    is_there = is_received(block.time_s[part], gyr, acc)
    time_s = block.time_s[part][is_there]
    if len(time_s) < 2:
        return []
    gyr = gyr[is_there].astype(np.float64)  # the filter takes no other precision
    signals = {"gyr_rad_s": gyr, "acc_m_s2": acc[is_there].astype(np.float64)}
    if block.mag is not None and np.any(np.nan_to_num(block.mag[part])):
        signals["mag"] = _without_gaps(block.mag[part][is_there].astype(np.float64))
    if block.q_earth_from_sensor is not None:
        signals["q_device"] = continuous(_without_gaps(_unit(block.q_earth_from_sensor[part][is_there])))
    step_s = nominal_step_s(time_s)
    gap_s = np.diff(time_s)
    speed = np.sqrt(np.einsum("ni,ni->n", gyr, gyr))
    is_still = np.maximum(speed[:-1], speed[1:]) < STILL_RAD_S
    allowed_s = np.maximum(np.where(is_still, MAX_STILL_GAP_S, MAX_BRIDGED_GAP_S), 1.5 * step_s)
    cuts = np.flatnonzero(gap_s > allowed_s) + 1
    tracks = []
    for a, b in pairwise([0, *cuts.tolist(), len(time_s)]):
        if b - a >= MIN_STRETCH_SAMPLES and time_s[b - 1] - time_s[a] >= MIN_STRETCH_S:
            tracks.append(_even(time_s[a:b], {name: values[a:b] for name, values in signals.items()}, step_s))
    return tracks


def is_received(time_s: FloatArray, gyr: FloatArray, acc: FloatArray) -> BoolArray:
    """Give which samples are measurements: finite, possible, later than the one before, not of a stuck sensor."""
    is_there = is_possible(gyr, acc)
    is_there[1:] &= np.diff(time_s) > 0
    return is_there & ~is_stuck(time_s, gyr, acc)


def is_possible(gyr: FloatArray, acc: FloatArray) -> BoolArray:
    """Give which samples (n,) a sensor worn by a patient can measure; False where values are missing."""
    with np.errstate(invalid="ignore"):
        return in_every_column(np.abs(gyr) <= MAX_RATE_RAD_S) & in_every_column(np.abs(acc) <= MAX_FORCE_M_S2)


def in_every_column(holds: BoolArray) -> BoolArray:
    """Give the rows (n,) of (n, 3) where all hold; several times faster than reducing along so short an axis."""
    return holds[:, 0] & holds[:, 1] & holds[:, 2]


def is_stuck(time_s: FloatArray, gyr: FloatArray, acc: FloatArray) -> BoolArray:
    """Give which samples (n,) are in a run of equal rows that lasts longer than a sensor holds a value."""
    stuck = np.zeros(len(time_s), dtype=bool)
    is_same = np.zeros(len(time_s), dtype=bool)
    is_same[1:] = in_every_column(gyr[1:] == gyr[:-1]) & in_every_column(acc[1:] == acc[:-1])
    if not is_same.any():
        return stuck
    edges = np.flatnonzero(np.diff(np.concatenate([[0], is_same.astype(np.int8), [0]])))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        held_s = time_s[last - 1] - time_s[first - 1]
        if held_s > MAX_HELD_STILL_S or (held_s > MAX_HELD_S and not _lies_still(gyr, acc, first - 1, last)):
            stuck[first:last] = True
    return stuck


def _lies_still(gyr: FloatArray, acc: FloatArray, first: int, end: int) -> bool:
    """Whether equal rows from `first` to before `end` are those of a coarse sensor at rest."""
    beside = [i for i in (first - 1, end) if 0 <= i < len(gyr)]
    is_quiet = bool(np.all(np.abs(gyr[first]) < HELD_STILL_RAD_S)) and bool(beside)
    return is_quiet and all(
        np.all(np.abs(gyr[i] - gyr[first]) < HELD_STILL_RAD_S) and np.all(np.abs(acc[i] - acc[first]) < HELD_STILL_M_S2)
        for i in beside
    )


def _unit(q: FloatArray) -> FloatArray:
    """Quaternions (n, 4) of unit length; NaN where a row is none."""
    with np.errstate(invalid="ignore"):
        length = np.linalg.norm(np.where(np.abs(q) < 2.0, q, np.nan), axis=1)
        return np.where((np.abs(length - 1.0) < QUATERNION_TOLERANCE)[:, None], q / length[:, None], np.nan)


def continuous(q: FloatArray) -> FloatArray:
    """Remove the jumps between q and -q from unit quaternions (n, 4)."""
    flips = np.sum(q[1:] * q[:-1], axis=1) < 0
    if not flips.any():
        return q
    return q * np.concatenate([[1.0], np.cumprod(np.where(flips, -1.0, 1.0))])[:, None]


def _without_gaps(values: FloatArray) -> FloatArray:
    """Rows (n, k) that are missing take the last one received, at the start the first."""
    received = np.flatnonzero(np.isfinite(values).all(axis=1))
    if len(received) in (0, len(values)):
        return values
    last = np.searchsorted(received, np.arange(len(values)), side="right") - 1
    return values[received[np.maximum(last, 0)]]


def _even(time_s: FloatArray, signals: dict[str, FloatArray], step_s: float) -> Track:
    intervals = max(1.0, float(np.round((time_s[-1] - time_s[0]) / step_s)))
    step_s = float((time_s[-1] - time_s[0]) / intervals)
    ticks = (time_s - time_s[0]) / step_s
    if np.max(np.abs(ticks - np.round(ticks))) >= EVEN_CLOCK_TOLERANCE:
        time_s, step_s = _without_stamp_noise(time_s, step_s, signals["gyr_rad_s"])
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
        # local and without overshoot
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


def _without_stamp_noise(time_s: FloatArray, step_s: float, gyr: FloatArray) -> tuple[FloatArray, float]:
    """Stamps (n,) on the even clock that made them, and its step, where the noise is the stamps' own."""
    # stamps often say when a sample arrived; where each follows better by number than by stamp, numbers are believed
    number = np.concatenate([[0.0], np.cumsum(np.maximum(np.round(np.diff(time_s) / step_s), 1.0))])
    slope, start = np.polyfit(number, time_s, 1)
    even_s = start + slope * number
    if len(time_s) < 2 * MIN_STRETCH_SAMPLES or np.max(np.abs(even_s - time_s)) > step_s:
        return time_s, step_s
    if _misfit(number, gyr) < _misfit(time_s, gyr):
        return even_s, float(slope)
    return time_s, step_s


def _misfit(at: FloatArray, values: FloatArray) -> float:
    """How far samples (n, k) lie from the cubic through the four beside them, placed at `at` (n,): a median."""
    centre = at[2:-2]
    nodes = np.stack([at[:-4], at[1:-3], at[3:-1], at[4:]])
    adjacent = np.stack([values[:-4], values[1:-3], values[3:-1], values[4:]])
    weight = np.ones_like(nodes)
    for j in range(4):
        for m in range(4):
            if m != j:
                weight[j] *= (centre - nodes[m]) / (nodes[j] - nodes[m])
    return float(np.median(np.linalg.norm(values[2:-2] - np.sum(weight[..., None] * adjacent, axis=0), axis=1)))


def at_positions(values: FloatArray, position: FloatArray) -> FloatArray:
    """Interpolate (n, k) at fractional indices (m,) by cubics, the nearest outside 0..n-1; may give a view."""
    n = len(values)
    position = np.clip(position, 0, n - 1)
    left = np.floor(position).astype(int)
    u = position - left
    if not np.any(u > 1e-9):
        is_all_in_a_row = len(left) > 0 and left[-1] - left[0] == len(left) - 1 and bool(np.all(np.diff(left) == 1))
        return values[left[0] : left[-1] + 1] if is_all_in_a_row else values[left]
    left = np.clip(left, 1, n - 3)
    u = (position - left)[:, None]
    found = values.take(left, axis=0) * ((u + 1) * (u - 1) * (u - 2) / 2)
    found -= values.take(left - 1, axis=0) * (u * (u - 1) * (u - 2) / 6)
    found -= values.take(left + 1, axis=0) * ((u + 1) * u * (u - 2) / 2)
    found += values.take(left + 2, axis=0) * ((u + 1) * u * (u - 1) / 6)
    return found
