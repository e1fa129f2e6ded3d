"""The sign of flexion, found from how people stand and walk, never asked.

A knee bends one way only from standing, and in walking the shank swings forward faster than back. At the ankle,
dorsiflexion turns the other way about the same line as knee flexion.
"""

from dataclasses import dataclass

import numpy as np

from core.samples import FloatArray

MIN_RANGE_RAD = np.deg2rad(10.0)  # a stiff knee: its few degrees do not show which way it bends
MIN_SWING_RAD_S = 0.7  # a shank slower than this is not walking
MIN_MARGIN = 0.5  # a shank that swings forward twice as fast as back has 0.33, three times 0.5
CONTRADICTION = 0.25  # so much against what another witness shows is no chance
MIN_AXES_ALIGNMENT = 0.5
MIN_SWINGS = 3  # of a foot, for it to show where its toes are


@dataclass(frozen=True, slots=True)
class ClinicalSign:
    """`sign` turns the twist into flexion or dorsiflexion; where not certain it is the likelier one.

    `is_contradicted`: the way of bending and the way of swinging speak against each other, as in walking backward.
    """

    sign: int
    margin: float
    is_certain: bool
    is_contradicted: bool = False


def skewness(values: FloatArray, share: float) -> float:
    """Compute (p_hi + p_lo)/(p_hi - p_lo) of quantiles `share`, 1 - share: 1 all positive, 0 symmetric."""
    low, high = np.quantile(values, [share, 1 - share])
    return float((high + low) / (high - low)) if high > low else 0.0


def range_of(theta_rad: FloatArray) -> float:
    """Give the range between the 2nd and 98th percentile of an angle (n,) without NaN."""
    low, high = np.quantile(theta_rad, [0.02, 0.98])
    return float(high - low)


def forward_swing(rate_rad_s: FloatArray) -> float:
    """Give how much faster the shank turns one way, -1 to 1, 0 where it hardly swings; rate (m,) while moving."""
    low, high = np.quantile(rate_rad_s, [0.005, 0.995])
    if high - low < 2 * MIN_SWING_RAD_S:
        return 0.0
    return skewness(rate_rad_s, 0.005)


def knee_sign(
    theta_rad: FloatArray, shank_rate_rad_s: FloatArray, is_walking: bool, has_standing: bool
) -> ClinicalSign:
    """Find the sign of knee flexion; `theta_rad` (n,) is the moving twist less its standing value or median.
    `shank_rate_rad_s` (m,) is -g2.j2 while moving; without walking and standing nothing is certain.
    """
    bend = skewness(theta_rad, 0.02) if range_of(theta_rad) > MIN_RANGE_RAD else 0.0
    swing = forward_swing(shank_rate_rad_s) if is_walking else 0.0
    total = bend + 2 * swing
    disagree = bend * swing < 0 and min(abs(bend), 2 * abs(swing)) > 0.5 * max(abs(bend), 2 * abs(swing))
    is_certain = abs(total) > MIN_MARGIN and bend != 0.0 and not disagree and (is_walking or has_standing)
    return ClinicalSign(1 if total >= 0 else -1, abs(total), is_certain, disagree)


def ankle_sign(
    knee: ClinicalSign | None, alignment: float, shank_rate_rad_s: FloatArray, is_walking: bool
) -> ClinicalSign:
    """Find the sign of ankle dorsiflexion: opposite to the knee's, else by the shank's undisputed swing.
    `alignment` is j2,knee . j1,ankle in the shank's sensor, 0 without knee; the rate (m,) is -g1.j1,ankle.
    """
    swing = forward_swing(shank_rate_rad_s) if is_walking else 0.0
    if knee is None or not knee.is_certain:
        is_certain = abs(swing) > MIN_MARGIN and not (knee is not None and knee.is_contradicted)
        return ClinicalSign(-1 if swing >= 0 else 1, abs(swing), is_certain)
    if abs(alignment) < MIN_AXES_ALIGNMENT:
        return ClinicalSign(-1 if swing >= 0 else 1, abs(swing), is_certain=False)
    from_knee = knee.sign * (1 if alignment > 0 else -1)
    disagree = from_knee * swing < -CONTRADICTION
    return ClinicalSign(-from_knee, min(knee.margin, abs(alignment)), not disagree)


def ankle_sign_from_foot(pitch_alignment: float, swings: int) -> ClinicalSign:
    """Find the ankle's sign from the foot; `pitch_alignment`: j2,ankle . pitch axis, toes up positive."""
    is_certain = swings >= MIN_SWINGS and abs(pitch_alignment) >= MIN_AXES_ALIGNMENT
    return ClinicalSign(1 if pitch_alignment >= 0 else -1, abs(pitch_alignment), is_certain)
