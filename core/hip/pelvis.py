"""The pelvis over a walk: how it turns against its mean, where the body turns round, and figures of each stride."""

from collections.abc import Callable

import numpy as np
from scipy.ndimage import gaussian_filter1d

from core.body import Side
from core.gait.strides import Strides
from core.hip.results import HipAngle, PelvisAngles, PelvisTurn
from core.samples import FloatArray
from core.signal.pair import moving_mean
from core.signal.tracks import nominal_step_s

TURN_RAD_S = np.deg2rad(15.0)  # about the vertical, below
TURN_HZ = 1.0
MIN_TURN_RAD = np.deg2rad(45.0)  # a step turns the pelvis by 12 deg
HALF_POWER = 0.1325  # seconds of a Gaussian that halves the power at 1 Hz

Figure = Callable[[FloatArray], np.floating]
"""One figure of some samples (m,)."""


def turns_of(time_s: FloatArray, heading_rad: FloatArray) -> tuple[PelvisTurn, ...]:
    """Find body turns: rate about the vertical below 1 Hz over 15 deg/s for 45 deg and more."""
    received = np.flatnonzero(np.isfinite(heading_rad))
    if len(received) < 3:
        return ()
    step_s = nominal_step_s(time_s)
    even = np.interp(time_s, time_s[received], heading_rad[received])
    smooth = gaussian_filter1d(even, HALF_POWER / TURN_HZ / step_s, mode="nearest")
    rate = np.gradient(smooth, time_s)
    turns: list[PelvisTurn] = []
    for sign in (1.0, -1.0):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], (sign * rate > TURN_RAD_S).astype(np.int8), [0]])))
        for first, end in zip(edges[::2], edges[1::2], strict=True):
            angle = float(smooth[end - 1] - smooth[first])
            if abs(angle) >= MIN_TURN_RAD:
                turns.append(PelvisTurn(float(time_s[first]), float(time_s[end - 1]), angle))
    return tuple(sorted(turns, key=lambda turn: turn.start_s))


def rotation_of(
    time_s: FloatArray, heading_rad: FloatArray, turns: tuple[PelvisTurn, ...], stride_s: float
) -> FloatArray:
    """Give pelvis heading against its two-stride mean (n,), rad to the left; NaN near turns, or no strides."""
    rotation = np.full(len(time_s), np.nan)
    received = np.flatnonzero(np.isfinite(heading_rad))
    if not np.isfinite(stride_s) or len(received) < 3:
        return rotation
    step_s = nominal_step_s(time_s)
    even = np.interp(time_s, time_s[received], heading_rad[received])
    rotation = even - moving_mean(even, max(1, round(2.0 * stride_s / step_s)))
    rotation[~np.isfinite(heading_rad)] = np.nan
    for turn in turns:
        rotation[(time_s > turn.start_s - stride_s) & (time_s < turn.end_s + stride_s)] = np.nan
    rotation[(time_s < time_s[0] + stride_s) | (time_s > time_s[-1] - stride_s)] = np.nan
    return rotation


def hip_parameters(strides: Strides, time_s: FloatArray, hip: HipAngle) -> dict[str, FloatArray]:
    """Compute a hip's range and peaks per stride, (k,) rad from standing; extension is positive behind."""
    most, least = (_of_strides(strides, time_s, hip.angle_rad, of) for of in (np.max, np.min))
    outwards, inwards = (_of_strides(strides, time_s, hip.abduction_rad, of) for of in (np.max, np.min))
    return {
        "hip_range_rad": most - least,
        "hip_flexion_peak_rad": most,
        "hip_extension_peak_rad": -least,
        "hip_abduction_range_rad": outwards - inwards,
        "hip_abduction_peak_rad": outwards,
        "hip_adduction_peak_rad": -inwards,
    }


def pelvis_parameters(strides: Strides, time_s: FloatArray, pelvis: PelvisAngles, side: Side) -> dict[str, FloatArray]:
    """Compute pelvis ranges, tilt and drop per stride, (k,) rad; drop positive with the swing side lower."""
    obliquity, rotation = pelvis.obliquity_rad, pelvis.rotation_rad
    lowered = -obliquity if side is Side.LEFT else obliquity
    swing = _during(strides.toe_off_s, strides.end_s, time_s, lowered, np.max)
    return {
        "pelvis_obliquity_range_rad": _of_strides(strides, time_s, obliquity, np.ptp),
        "pelvis_drop_rad": swing,
        "pelvis_rotation_range_rad": _of_strides(strides, time_s, rotation, np.ptp),
        "pelvis_tilt_range_rad": _of_strides(strides, time_s, pelvis.tilt_rad, np.ptp),
        "pelvis_lean_rad": _of_strides(strides, time_s, pelvis.tilt_rad, np.mean),
    }


def _of_strides(strides: Strides, time_s: FloatArray, values: FloatArray, of: Figure) -> FloatArray:
    return _during(strides.start_s, strides.end_s, time_s, values, of)


def _during(from_s: FloatArray, to_s: FloatArray, time_s: FloatArray, values: FloatArray, of: Figure) -> FloatArray:
    """A figure of the samples (n,) in each interval (k,); NaN where one of them is missing."""
    found = np.full(len(from_s), np.nan)
    for k, (start_s, end_s) in enumerate(zip(from_s, to_s, strict=True)):
        here = values[slice(*np.searchsorted(time_s, [start_s, end_s]))] if np.isfinite(start_s + end_s) else values[:0]
        if len(here) and np.isfinite(here).all():
            found[k] = float(of(here))
    return found
