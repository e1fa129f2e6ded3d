"""The gates of what the sensors delivered: samples lost, cut off at the end of the range, or at another rate."""

from collections.abc import Collection, Iterator

import numpy as np

from core.body import Joint, Side, Site
from core.results import RecordingAnalysis
from core.samples import FloatArray
from core.signal.reception import LEAST_PAUSE_S, is_half
from core.verdicts.model import GateReason, Verdict

Limits = tuple[float, float]
"""Where reading with care begins, and where it ends."""


def lost(recording: RecordingAnalysis, limits: Limits, *sites: Site) -> Iterator[GateReason]:
    """Check how much of the strides used lies in gaps too long to bridge; gaps of whole strides do not count."""
    percent = 0.0
    for site in (one for one in sites if one in recording.received):
        found = recording.received[site]
        times_s = _used_s(recording, site) if recording.gait else np.array([found.span_s])
        gaps_s = found.gaps_s[found.gaps_s[:, 1] - found.gaps_s[:, 0] < LEAST_PAUSE_S]
        percent = max(percent, _share_percent(gaps_s, times_s))
    yield from closed("loss", percent, limits, "%")


def clipped(
    recording: RecordingAnalysis, limits: Limits, rates_of: Collection[Site], forces_of: Collection[Site] = ()
) -> Iterator[GateReason]:
    """How many of the strides used hold a sample at the end of a sensor's range."""
    instants = [(site, recording.received[site].clipped_rates_s) for site in rates_of if site in recording.received]
    instants += [(site, recording.received[site].clipped_forces_s) for site in forces_of if site in recording.received]
    percent = 0.0
    for site, at_s in instants:
        times_s = _used_s(recording, site)
        if len(times_s):
            holds = np.searchsorted(at_s, times_s[:, 1]) > np.searchsorted(at_s, times_s[:, 0])
            percent = max(percent, 100.0 * float(np.mean(holds)))
    yield from closed("clipping", percent, limits, "%")


def off_rate(recording: RecordingAnalysis, limits: Limits, *sites: Site) -> Iterator[GateReason]:
    """Whether samples came at the rate that a sensor was set to."""
    known = [recording.received[site].rate_percent for site in sites if site in recording.received]
    percent = max((one for one in known if one is not None), key=lambda one: abs(one - 100.0), default=100.0)
    for reason in closed("every_second" if is_half(percent) else "rate", abs(percent - 100.0), limits, "%"):
        limit = 100.0 + float(np.copysign(limits[reason.verdict is Verdict.NOT_REPORTED], percent - 100.0))
        yield GateReason(reason.gate, reason.verdict, percent, limit, "%")


def _used_s(recording: RecordingAnalysis, site: Site) -> FloatArray:
    """Start and end (k, 2) of the strides used of a sensor's leg, of both legs at the pelvis."""
    sides = [site.side] if site.side is not None else list(Side)
    of_sides = [recording.gait[side].strides for side in sides if side in recording.gait]
    starts_and_ends = [np.stack([one.start_s, one.end_s], axis=1)[one.is_used] for one in of_sides]
    return np.concatenate([np.empty((0, 2)), *starts_and_ends])


def _share_percent(gaps_s: FloatArray, times_s: FloatArray) -> float:
    """How much of some times (k, 2) lies in gaps (m, 2)."""
    whole_s = float(np.sum(times_s[:, 1] - times_s[:, 0]))
    if not len(gaps_s) or whole_s <= 0.0:
        return 0.0
    in_gaps_s = np.repeat(np.cumsum(gaps_s[:, 1] - gaps_s[:, 0]), 2)
    in_gaps_s = np.concatenate([[0.0], in_gaps_s[:-1]])  # up to the first and the last instant of each gap
    until_first, until_last = (np.interp(times_s[:, k], gaps_s.ravel(), in_gaps_s) for k in (0, 1))
    return 100.0 * float(np.sum(until_last - until_first)) / whole_s


def closed(
    gate: str, value: float | None, limits: Limits, unit: str, joint: Joint | None = None
) -> Iterator[GateReason]:
    """What a value beyond the first or the second limit closes; one that is not known closes the second."""
    care, most = limits
    if value is None or not value <= most:
        yield GateReason(gate, Verdict.NOT_REPORTED, known_or_none(value), most, unit, joint=joint)
    elif value > care:
        yield GateReason(gate, Verdict.CARE, value, care, unit, joint=joint)


def known_or_none(value: float | None) -> float | None:
    """None where a value is not known or NaN."""
    return float(value) if value is not None and np.isfinite(value) else None
