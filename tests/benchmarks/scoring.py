"""Distance of an estimate from the truth. The same questions to every method of the comparison."""

from dataclasses import dataclass

import numpy as np

from core.samples import FloatArray
from core.signal.rotations import angle_between, wrap
from tests.benchmarks.trials import Truth

SETTLING_S = 3.0  # in which a causal filter finds the vertical; not scored, for all alike
MAX_OFFSET_SAMPLES, OFFSET_STEP_SAMPLES = 2.0, 0.1


@dataclass(frozen=True, slots=True)
class Estimate:
    """What a method found: axes (3,), their common sign being free, and the angle (n,) at `time_s` as they turn.

    NaN where a method finds no such thing. `cpu_s` is what it took.
    """

    axis_1: FloatArray
    axis_2: FloatArray
    time_s: FloatArray
    angle_rad: FloatArray
    cpu_s: float


@dataclass(frozen=True, slots=True)
class Score:
    """Degrees. Axes are compared as lines, so that a wrong pairing counts once, in `is_paired`.

    `m_deg`: root mean square after removing the mean; `z_deg`: after the standing zero.
    """

    axis_1_deg: float
    axis_2_deg: float
    is_paired: bool
    m_deg: float
    z_deg: float


def score(found: Estimate, truth: Truth) -> Score:
    """Compare; the common sign of both axes, which needs more than a joint's own data, is given to all methods."""
    along_1, along_2 = float(found.axis_1 @ truth.axis_1), float(found.axis_2 @ truth.axis_2)
    m_deg, z_deg = _angle_errors_deg(found, truth, -1.0 if along_1 < 0 else 1.0)
    return Score(
        axis_1_deg=line_error_deg(found.axis_1, truth.axis_1),
        axis_2_deg=line_error_deg(found.axis_2, truth.axis_2),
        is_paired=along_1 * along_2 > 0,
        m_deg=m_deg,
        z_deg=z_deg,
    )


def line_error_deg(found: FloatArray, true: FloatArray) -> float:
    return float(np.rad2deg(min(angle_between(found, true), angle_between(-found, true))))


def _angle_errors_deg(found: Estimate, truth: Truth, sign: float) -> tuple[float, float]:
    if not np.isfinite(found.angle_rad).any():
        return float("nan"), float("nan")
    reach = 0.0 if truth.is_clock_shared else MAX_OFFSET_SAMPLES
    step_s = float(np.median(np.diff(truth.time_s)))
    offsets_s = step_s * np.arange(-reach, reach + 0.5 * OFFSET_STEP_SAMPLES, OFFSET_STEP_SAMPLES)
    errors = [_error_rad(found, truth, sign, float(offset_s)) for offset_s in offsets_s]
    error = min(errors, key=lambda e: float(np.std(e)))
    standing = np.sqrt(np.mean((error + truth.standing_rad) ** 2))
    return float(np.rad2deg(np.std(error))), float(np.rad2deg(standing))


def _error_rad(found: Estimate, truth: Truth, sign: float, offset_s: float) -> FloatArray:
    """Angle minus truth (m,) where both are known; whole turns do not count, however an angle was unwrapped."""
    true = np.interp(found.time_s - offset_s, truth.time_s, truth.angle_rad, left=np.nan, right=np.nan)
    error = sign * found.angle_rad - true
    error = error[(found.time_s >= found.time_s[0] + SETTLING_S) & np.isfinite(error)]
    middle = np.angle(np.mean(np.exp(1j * error)))
    return np.asarray(wrap(error - middle) + middle)
