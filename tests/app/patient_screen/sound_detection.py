"""Find sounds in samples, by the samples alone: when clicks begin, when a tone sounds."""

import numpy as np

from core.samples import FloatArray

SILENCE_S = 0.02  # between two sounds; within one its wave crosses zero a thousand times a second


def onsets_s(samples: FloatArray, rate_hz: float, share: float = 0.5) -> FloatArray:
    """When each sound begins, (n,): where it first has `share` of the loudest, after a silence."""
    loud = np.flatnonzero(np.abs(samples) >= share * np.abs(samples).max()) if len(samples) else np.empty(0, dtype=int)
    if not len(loud) or not np.abs(samples).max():
        return np.empty(0)
    begins = np.concatenate([[True], np.diff(loud) > SILENCE_S * rate_hz])
    return np.asarray(loud[begins] / rate_hz)


def spans_s(samples: FloatArray, rate_hz: float, tone_hz: float, share: float = 0.3) -> list[tuple[float, float]]:
    """From when to when a tone of this frequency sounds: its power in windows of 10 ms, whatever else sounds."""
    window = round(0.01 * rate_hz)
    count = len(samples) // window
    time_s = np.arange(window) / rate_hz
    wave = np.exp(-2j * np.pi * tone_hz * time_s) * np.hanning(window)
    power = np.abs(samples[: count * window].reshape(count, window) @ wave)
    if not count or not power.max():
        return []
    is_there = np.concatenate([[False], power > share * power.max(), [False]])
    edges = np.flatnonzero(np.diff(is_there.astype(int)))
    return [(a * 0.01, b * 0.01) for a, b in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)]
