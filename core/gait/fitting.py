"""What a prosthetist reads of each stride beside peaks and ranges: knee in late swing, foot, and how the segments lean.

Values per stride, whatever may be stated about them; which verdict each rests on, and what it cannot say, is in
`core.verdicts.fitting`.
"""

from collections.abc import Mapping

import numpy as np

from core.body import Segment
from core.gait.cycles import POINTS, cycles_of, find_peak
from core.gait.strides import Strides
from core.parameters import KNEE_WINDOWS
from core.samples import FloatArray

EXTENDED_RAD = np.deg2rad(3.0)  # a knee that has come so near to its straightest has arrived; its last degrees are slow
UNBENT, UNBENT_POINTS = (0.25, 0.85), 31  # share of swing, past what the toes' spring does and before the landing
SWING_PEAK = KNEE_WINDOWS[-1]


def late_swing_of_knee(cycles: FloatArray) -> dict[str, FloatArray]:
    """Measure each stride's knee (k, 101), rad, in late swing: extension and its time; NaN: no peak in swing."""
    peak = find_peak(cycles, SWING_PEAK).percent
    extension, early = np.full(len(cycles), np.nan), np.full(len(cycles), np.nan)
    known = np.flatnonzero(np.isfinite(peak))
    after = np.where(np.arange(POINTS) >= peak[known, None], cycles[known], np.inf)
    extension[known] = least = after.min(axis=1, initial=np.inf)
    near = least + EXTENDED_RAD
    first = (after <= near[:, None]).argmax(axis=1)
    # between the sample before and this one the knee came so near; from a low peak on it always was
    before, at = cycles[known, np.maximum(first - 1, 0)], cycles[known, first]
    is_falling = before > near
    share = np.divide(near - at, before - at, out=np.zeros(len(known)), where=is_falling)
    early[known] = POINTS - 1 - (first - share)
    return {"knee_terminal_extension_rad": extension, "knee_extended_before_contact_percent": early}


def foot_measures(strides: Strides, time_s: FloatArray, pitch_rad: FloatArray) -> dict[str, FloatArray]:
    """Measure foot-flat time, landing pitch and heel rise per stride, (k,); pitch (n,) toes up, zero flat."""
    flat = np.maximum(strides.heel_rise_s - strides.full_contact_s, 0.0)
    cycles = cycles_of(time_s, pitch_rad, strides.start_s, strides.end_s)
    middle = 0.5 * (strides.toe_off_s + strides.end_s)
    at_s = strides.start_s[:, None] + strides.time_s[:, None] * np.linspace(0.0, 1.0, POINTS)
    is_rising = (at_s >= strides.heel_rise_s[:, None]) & (at_s <= middle[:, None]) & np.isfinite(cycles)
    lowest = np.where(is_rising, cycles, np.inf).min(axis=1, initial=np.inf)
    return {
        "foot_flat_percent": 100.0 * flat / strides.time_s,
        "foot_pitch_at_contact_rad": cycles[:, 0] if len(cycles) else np.empty(0),
        "foot_heel_rise_rad": np.where(np.isfinite(lowest), -lowest, np.nan),
    }


def shank_to_foot(strides: Strides, time_s: FloatArray, pitch_rad: FloatArray, leaning_rad: FloatArray) -> FloatArray:
    """Give the mean angle (k,) of the foot against the shank while nothing bends it, in the middle of each swing, rad.

    Pitch of the foot (toes up) and lean of the shank (forward) add up to dorsiflexion, from standing, and need no axis
    of an ankle: of a foot without a joint this is how it is set.
    """
    swing_s = strides.end_s - strides.toe_off_s
    at_s = strides.toe_off_s[:, None] + swing_s[:, None] * np.linspace(*UNBENT, UNBENT_POINTS)
    if not len(time_s):
        return np.full(len(strides), np.nan)
    return np.asarray(np.interp(at_s, time_s, pitch_rad + leaning_rad).mean(axis=1))


def inclination_measures(
    strides: Strides, time_s: FloatArray, inclinations: Mapping[Segment, FloatArray]
) -> dict[str, FloatArray]:
    """Measure thigh and shank lean in stance and shank turn per rocker, (k,), rad; inclinations (n,) forward."""
    instants = {
        "initial_contact": strides.start_s,
        "full_contact": strides.full_contact_s,
        "mid_stance": 0.5 * (strides.start_s + strides.toe_off_s),
        "heel_rise": strides.heel_rise_s,
        "toe_off": strides.toe_off_s,
    }
    measures: dict[str, FloatArray] = {}
    for segment, leaning in inclinations.items():
        is_known = np.isfinite(cycles_of(time_s, leaning, strides.start_s, strides.end_s)).all(axis=1)
        at = {
            name: np.where(is_known, np.interp(at_s, time_s, leaning), np.nan)
            if len(time_s)
            else np.full(len(strides), np.nan)
            for name, at_s in instants.items()
        }
        for name in ("initial_contact", "mid_stance", "toe_off"):
            measures[f"{segment}_at_{name}_rad"] = at[name]
        if segment is Segment.SHANK:
            measures["shank_heel_rocker_rad"] = at["full_contact"] - at["initial_contact"]
            measures["shank_over_flat_foot_rad"] = at["heel_rise"] - at["full_contact"]
            measures["shank_forefoot_rocker_rad"] = at["toe_off"] - at["heel_rise"]
    return measures
