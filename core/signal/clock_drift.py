"""Sensors whose clock runs faster or slower than those of adjacent sensors.

A walking leg repeats itself, so each of its sensors sees by itself how like every instant is to one in the middle of
the walk. Those likenesses rise and fall together in all sensors, whatever their axes. Where one sensor's are later
from stride to stride, a clock runs away: at two percent by a stride in a minute, and the knee reads 92 degrees for 62.
"""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from core.body import LEG_SEGMENTS, Side, Site
from core.findings import Finding, Severity
from core.samples import FloatArray
from core.session import Recording, RecordingKind
from core.signal.robust import robust_sd
from core.signal.sensors import SensorTracks
from core.signal.tracks import Track, at_positions

STEP_S = 0.02
WINDOW_S = 4.0  # some three strides
WINDOW_STEP_S = 1.0
MAX_WINDOWS = 30
MAX_JUMP_S = 0.2  # from one window to the next; steps are 0.5 s apart and look alike
MIN_WINDOWS = 4
TEMPLATE_S = 1.2  # about a stride
MIN_SPREAD = 0.2  # of the likeness, in a leg that walks
MIN_CORRELATION = 0.6
MIN_DRIFT = 0.004
MIN_DRIFT_S = 0.08  # over the whole walk: starting and stopping look later or earlier by as much
SIGMAS = 5.0


def clock_drifts(tracks: SensorTracks) -> dict[tuple[str, Site], float]:
    """Give how much faster than its leg's a clock runs, percent, by walk and site; only clocks that drift."""
    return {
        (recording.name, site): 100.0 * drift
        for recording in tracks.span
        if recording.kind is RecordingKind.WALKING
        for side in Side
        for site, drift in _drifts(tracks, recording, side).items()
    }


def about_clocks(drifts: Mapping[tuple[str, Site], float]) -> list[Finding]:
    """Give a finding for every sensor whose clock drifts from its leg's in a walk; `drifts` in percent."""
    return [
        Finding("clock_drifts", Severity.WARNING, f"{name}, {site}", {"drift_percent": round(percent, 1)})
        for (name, site), percent in drifts.items()
    ]


def _drifts(tracks: SensorTracks, recording: Recording, side: Side) -> dict[Site, float]:
    """How much faster than its leg's the clocks run that do, each as a share of time."""
    worn = [
        site for site in (Site(f"{side}_{segment}") for segment in LEG_SEGMENTS) if tracks.is_usable(recording, site)
    ]
    stretches = {site: _track(tracks, recording, site) for site in worn}
    known = [(site, track) for site, track in stretches.items() if track is not None]
    total, fast = 0.0, [0.0]
    for (_, one), (_, two) in pairwise(known):
        total += drift_between(one, two) or 0.0
        fast.append(total)
    # of two clocks nobody knows which is wrong: then the distal one is named
    usual = float(np.median(fast)) if len(fast) > 2 else 0.0
    return {
        site: drift - usual for (site, _), drift in zip(known, fast, strict=False) if abs(drift - usual) > MIN_DRIFT
    }


def _track(tracks: SensorTracks, recording: Recording, site: Site) -> Track | None:
    """The longest stretch of the first block."""
    stretches = tracks.oriented(recording, site, tracks.blocks(recording)[0])
    return max((one.track for one in stretches), key=len, default=None)


def drift_between(one: Track, two: Track) -> float | None:
    """Give how much faster the second clock runs (0.01 is 1 %); 0 without drift, None where nothing shows it."""
    time_s = np.arange(max(one.start_s, two.start_s), min(one.end_s, two.end_s), STEP_S)
    width = round(WINDOW_S / STEP_S)
    # in a long walk windows stand apart, but so near that a clock runs off by less than a step's time between two
    step = round(min(WINDOW_S, max(WINDOW_STEP_S, STEP_S * len(time_s) / MAX_WINDOWS)) / STEP_S)
    if len(time_s) < 2 * width:
        return None
    like_1, like_2 = (_likeness(track, time_s) for track in (one, two))
    found = [*_followed(like_1, like_2, width, step), *_followed(like_1, like_2, width, -step)]
    if len(found) < MIN_WINDOWS:
        return None
    at_s, late_s = STEP_S * np.array(sorted(set(found))).T
    return _slope(at_s, late_s)


def _likeness(track: Track, time_s: FloatArray) -> FloatArray:
    """Correlation (m,) of a sensor's rates around every instant with those in the middle."""
    rates = at_positions(track.gyr_rad_s, (time_s - track.start_s) / track.step_s)
    half = round(0.5 * TEMPLATE_S / STEP_S)
    middle = len(rates) // 2
    template = rates[middle - half : middle + half]
    product = sum(np.correlate(rates[:, k], template[:, k], "valid") for k in range(3))
    total = np.concatenate([[0.0], np.cumsum(np.sum(rates**2, axis=1))])
    energy = total[2 * half :] - total[: -2 * half]
    return np.asarray(product / np.sqrt(np.maximum(energy * np.sum(template**2), 1e-9)))


def _followed(one: FloatArray, two: FloatArray, width: int, step: int) -> list[tuple[int, float]]:
    """Window by window from the middle, where it starts and how many samples later `two` repeats `one`."""
    found = []
    near = 0  # where it was found last
    for first in range((len(one) - width) // 2, len(one) - width if step > 0 else -1, step):
        late = _late(one[first : first + width], two, first, near)
        if late is not None:
            near = round(late)
            found.append((first, late))
    return found


def _late(window: FloatArray, other: FloatArray, first: int, near: int) -> float | None:
    """By how many samples `other` (m,) repeats a window (n,) late, near where it did before; None where it does not."""
    reach = round(MAX_JUMP_S / STEP_S)
    start = first + near - reach
    if start < 0 or start + 2 * reach + len(window) > len(other):
        return None
    parts = np.lib.stride_tricks.sliding_window_view(other[start : start + 2 * reach + len(window)], len(window))
    parts = parts - parts.mean(axis=1, keepdims=True)
    mine = window - window.mean()
    spread = np.std(window) * np.std(parts, axis=1)
    if spread.min() < MIN_SPREAD**2:
        return None
    alike = parts @ mine / (len(mine) * spread)
    best = int(np.argmax(alike))
    if alike[best] < MIN_CORRELATION or best in (0, len(alike) - 1):
        return None
    before, here, after = alike[best - 1 : best + 2]
    return near - reach + best + 0.5 * float(after - before) / float(2 * here - before - after)


def _slope(at_s: FloatArray, late_s: FloatArray) -> float:
    """The median slope between any two windows that do not overlap; 0 where it is no more than their scatter."""
    first, second = np.triu_indices(len(at_s), 1)
    apart_s = at_s[second] - at_s[first]
    is_apart = apart_s >= min(WINDOW_S, 0.5 * float(np.ptp(at_s)))
    slope = float(np.median((late_s[second] - late_s[first])[is_apart] / apart_s[is_apart]))
    rest = late_s - slope * at_s
    scatter = robust_sd(rest - np.median(rest))
    independent = max(1.0, float(np.ptp(at_s)) / WINDOW_S)
    sd = scatter / (float(np.std(at_s)) * np.sqrt(independent))
    least = max(MIN_DRIFT, MIN_DRIFT_S / float(np.ptp(at_s)), SIGMAS * sd)
    return slope if abs(slope) > least else 0.0
