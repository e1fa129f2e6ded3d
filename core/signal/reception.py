"""What one recording holds of each sensor: gaps, pauses, samples at the end of the range, the rate they came at."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from core.body import Site
from core.samples import BoolArray, FloatArray, ImuBlock
from core.session import Recording
from core.signal.clipping import clipped_forces, clipped_rates
from core.signal.tracks import MAX_REPORTED_GAP_S, MIN_STRETCH_SAMPLES, is_received, nominal_step_s

STEPS_TOGETHER, STEPS_BESIDE = 30, 5
SHORT_STEP, MIN_SHORT_STEPS = 0.7, 0.005  # of the usual step; of all steps, where stamps jitter
LEAST_PAUSE_S = 2.0  # longer than a stride: what is missing are whole ones, and the others are as good as without
ALL_LOST_PERCENT = 100.0
KEPT_RATE_PERCENT = 2.0  # clocks of sensors are off by less

Pause = tuple[float, float]
"""First and last instant of a time in which no sensor of a recording was received, on its clock."""


@dataclass(frozen=True, slots=True)
class Reception:
    """What one recording holds of one sensor; instants on the recording's clock.

    `gaps_s`: (m, 2): first and last instant of what is longer than `MAX_REPORTED_GAP_S`, ascending.
    `clipped_rates_s`, `clipped_forces_s`: (k,): samples at the end of the sensor's range, ascending.
    `rate_percent`: the rate that the samples came at, of the one that was set; None where that is not known.
    """

    lost_percent: float = 0.0  # samples missing outside of pauses; 100 where next to none was received
    gaps_s: FloatArray = field(default_factory=lambda: np.empty((0, 2)))
    span_s: tuple[float, float] = (0.0, 0.0)  # first and last sample
    clipped_rates_s: FloatArray = field(default_factory=lambda: np.empty(0))
    clipped_forces_s: FloatArray = field(default_factory=lambda: np.empty(0))
    rate_percent: float | None = None


def receptions(
    recording: Recording,
    nominal_hz: Mapping[Site, float | None],
    pauses: Sequence[Pause],
    offsets_s: Mapping[Site, float],
) -> dict[Site, Reception]:
    """Give what a recording holds of the sensors in `offsets_s`, which bring each clock to the recording's."""
    return {
        site: _reception(recording.imu[site], nominal_hz.get(site), pauses, offset_s)
        for site, offset_s in offsets_s.items()
    }


def _is_received(block: ImuBlock) -> BoolArray:
    return is_received(block.time_s, block.gyr_rad_s, block.acc_m_s2)


def _reception(block: ImuBlock, nominal_hz: float | None, pauses: Sequence[Pause], offset_s: float) -> Reception:
    is_there = _is_received(block)
    received_s = block.time_s[is_there]
    if len(received_s) < MIN_STRETCH_SAMPLES:
        return Reception(lost_percent=ALL_LOST_PERCENT)
    at_s = received_s + offset_s
    return Reception(
        lost_percent=lost_percent(block.time_s, received_s, nominal_hz, pauses),
        gaps_s=gaps_of(received_s) + offset_s,
        span_s=(float(at_s[0]), float(at_s[-1])),
        clipped_rates_s=at_s[clipped_rates(block.gyr_rad_s[is_there]).any(axis=1)],
        clipped_forces_s=at_s[clipped_forces(block.acc_m_s2[is_there]).any(axis=1)],
        rate_percent=rate_percent(received_s, nominal_hz),
    )


def gaps_of(received_s: FloatArray) -> FloatArray:
    """Give first and last instant (m, 2) of each gap too long to be bridged without a report."""
    after = np.flatnonzero(np.diff(received_s) > max(MAX_REPORTED_GAP_S, 1.5 * nominal_step_s(received_s)))
    return np.stack([received_s[after], received_s[after + 1]], axis=1)


def pauses_of(recording: Recording) -> list[Pause]:
    """When no sensor of a recording was received for longer than a stride takes."""
    return pauses_among(block.time_s[_is_received(block)] for block in recording.imu.values())


def pauses_among(received: Iterable[FloatArray]) -> list[Pause]:
    """As `pauses_of`, of the times (n,) at which samples of each sensor were received, on one clock."""
    common: list[Pause] | None = None
    for received_s in received:
        if len(received_s) < MIN_STRETCH_SAMPLES:
            continue
        gaps = [(float(a), float(b)) for a, b in gaps_of(received_s) if b - a >= LEAST_PAUSE_S]
        both = gaps if common is None else _common(common, gaps)
        common = [(a, b) for a, b in both if b - a >= LEAST_PAUSE_S]
    return common or []


def _common(some: Sequence[Pause], others: Sequence[Pause]) -> list[Pause]:
    """Give what two ascending rows of gaps have in common, in the time that their lengths take together."""
    found, at, other = [], 0, 0
    while at < len(some) and other < len(others):
        (a, b), (c, d) = some[at], others[other]
        found.append((max(a, c), min(b, d)))
        at, other = (at + 1, other) if b < d else (at, other + 1)
    return found


def outside_of(pauses: Sequence[Pause], gaps_s: FloatArray) -> FloatArray:
    """Give the part (m,) of each gap (m, 2), in s, in which other sensors were received."""
    left = gaps_s[:, 1] - gaps_s[:, 0]
    for first, last in pauses:
        left = left - np.maximum(np.minimum(gaps_s[:, 1], last) - np.maximum(gaps_s[:, 0], first), 0.0)
    return np.asarray(left)


def lost_percent(
    time_s: FloatArray, received_s: FloatArray, nominal_hz: float | None = None, pauses: Sequence[Pause] = ()
) -> float:
    """Give the share of missing samples outside pauses, 100 where next to none came; no rate: by stamps alone.

    `time_s`: of every row, those without a measurement included.
    """
    if len(received_s) < MIN_STRETCH_SAMPLES:
        return ALL_LOST_PERCENT
    step_s = nominal_step_s(received_s)
    missing = float(np.sum(_missing_rows(received_s, step_s)))
    missing -= sum(max(round((last - first) / step_s) - 1, 0) for first, last in pauses)
    missing += float(np.count_nonzero(time_s < received_s[0]) + np.count_nonzero(time_s > received_s[-1]))
    received = len(received_s) / (max(missing, 0.0) + len(received_s))
    came_at = rate_percent(received_s, nominal_hz)
    if came_at is not None and came_at < 100.0 - KEPT_RATE_PERCENT:
        received *= came_at / 100.0
    return 100.0 * (1.0 - received)


def rate_percent(received_s: FloatArray, nominal_hz: float | None) -> float | None:
    """Give the rate that samples came at in percent of the nominal one, gaps counted as received."""
    if not nominal_hz or len(received_s) < MIN_STRETCH_SAMPLES:
        return None
    steps = len(received_s) - 1 + float(np.sum(_missing_rows(received_s, nominal_step_s(received_s))))
    return 100.0 * steps / (float(received_s[-1] - received_s[0]) * nominal_hz)


def is_half(percent: float) -> bool:
    """Whether every second sample is missing throughout, so that the stamps of the others show no gap."""
    return abs(percent - 50.0) <= KEPT_RATE_PERCENT


def _missing_rows(received_s: FloatArray, step_s: float) -> FloatArray:
    """How many samples lack after each but the last (n - 1,)."""
    # where stamps jitter, a long step between short ones lacks nothing: as many must be missing around it, by a step
    # that many steps show
    steps = np.diff(received_s)
    if len(steps) <= STEPS_TOGETHER or np.mean(steps < SHORT_STEP * step_s) < MIN_SHORT_STEPS:
        return np.asarray(np.maximum(np.round(steps / step_s) - 1, 0))
    together_s = (received_s[STEPS_TOGETHER:] - received_s[:-STEPS_TOGETHER]) / STEPS_TOGETHER
    step_s = float(np.quantile(together_s, 0.1))
    index = np.arange(len(steps))
    first, last = np.maximum(index - STEPS_BESIDE, 0), np.minimum(index + STEPS_BESIDE + 1, len(steps))
    around = np.floor((received_s[last] - received_s[first]) / step_s - (last - first) + 0.3)
    return np.asarray(np.clip(np.round(steps / step_s) - 1, 0, np.maximum(around, 0)))
