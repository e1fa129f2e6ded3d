"""Angle of a true hinge: the integral of the rates, whose slow drift the joint's accelerations show.

Seel et al. 2014, doi 10.3390/s140406891, eqs 11 to 14, and instead of eq 15 a Kalman filter of the drift and of the
relative bias behind it: the causal form of `core.angles.hinge_angle`.
"""

import numpy as np

from core.live.drift import UNKNOWN_RAD, ObservationModel, SlowDrift, Wandering
from core.live.joint_frames import JointGeometry
from core.live.pairing import PairedSamples
from core.samples import FloatArray

BIAS_RAD_S, BIAS_WALK_RAD_S = np.deg2rad(1.5), np.deg2rad(0.02)  # what was not removed, and its change
GAP_RAD = np.deg2rad(5.0)  # how far interpolated rates may be off after a gap
ENDS = 2  # samples whose angular acceleration the next ones give

HINGE = Wandering(np.deg2rad(0.1), BIAS_RAD_S, BIAS_WALK_RAD_S)
HINGE_LOOKS = ObservationModel(first_scale=0.15, min_scale=0.02, correlation_s=0.1)  # m/s2
# On a human joint off-axis motion comes in, the accelerations do not quite meet, and contacts shake the tissue.
HUMAN = Wandering(np.deg2rad(1.0), BIAS_RAD_S, BIAS_WALK_RAD_S)
HUMAN_LOOKS = ObservationModel(first_scale=0.5, min_scale=0.3, correlation_s=0.3, begins_with=5)


class Integral:
    """The twist of one joint from a sample on, sample by sample.

    Parameters
    ----------
    start_rad, start_sd_rad
        Where it begins, and how sure that is; the standard deviation None where nothing is known.
    """

    def __init__(
        self, geometry: JointGeometry, step_s: float, time_s: float, start_rad: float, start_sd_rad: float | None
    ) -> None:
        self._geometry, self._step_s = geometry, step_s
        self._last_rate: float | None = None
        self._last_rad = start_rad
        self._drift = SlowDrift(HINGE, HINGE_LOOKS) if geometry.is_hinge else SlowDrift(HUMAN, HUMAN_LOOKS)
        self._drift.restart(time_s, 0.0, UNKNOWN_RAD if start_sd_rad is None else start_sd_rad)
        self._rows: list[PairedSamples] = []  # since the last look, and the last ones before
        self._integral: list[FloatArray] = []

    @property
    def sd_rad(self) -> float:
        """Standard deviation of the angle now."""
        return self._drift.sd_rad

    def follow(self, rows: PairedSamples) -> FloatArray:
        """Twist (n,) at the next samples, by the trapezoid rule."""
        rate = self._geometry.bending_rate(rows)
        before = rate[:1] if self._last_rate is None else [self._last_rate]
        turned = np.cumsum(0.5 * self._step_s * (rate + np.concatenate([before, rate[:-1]])))
        if self._last_rate is None:
            turned -= turned[0]
        integral = self._last_rad + turned
        self._last_rate, self._last_rad = float(rate[-1]), float(integral[-1])
        self._rows.append(rows)
        self._integral.append(integral)
        return integral + self._drift.at(rows.time_s)

    def look(self) -> None:
        """What the accelerations since the last look show of the drift."""
        rows, integral = joined_pairs(self._rows), np.concatenate(self._integral)
        self._rows, self._integral = [rows.part(slice(-2 * ENDS, None))], [integral[-2 * ENDS :]]
        if not rows.is_measured.all():
            self._drift.loosen(GAP_RAD)
        elif len(rows) > 2 * ENDS:
            inner = slice(ENDS, -ENDS)
            one, two = self._geometry.forces(rows, self._step_s)
            ahead = complex(np.mean(one * np.conj(two * np.exp(1j * integral[inner]))))
            self._drift.look(ahead, float(np.mean(rows.time_s[inner])), len(one) * self._step_s)


def joined_pairs(parts: list[PairedSamples]) -> PairedSamples:
    """Samples that follow each other."""
    return PairedSamples(*(np.concatenate([getattr(p, name) for p in parts]) for name in PairedSamples.__slots__))
