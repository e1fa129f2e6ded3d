"""Estimator of an angle that wanders slowly and is seen only roughly."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from core.samples import FloatArray
from core.signal.robust import median_of, robust_sd
from core.signal.rotations import wrap

MEMORY = 100  # looks whose scatter shows what a look is worth
MIN_LOOKS = 20
UNKNOWN_RAD = np.pi
LOST_RAD, LOST_S = np.deg2rad(8.0), 1.2  # what is seen so far off on the same side for longer than a stride is true


@dataclass(frozen=True, slots=True)
class Wandering:
    """How an angle wanders: by `walk_rad` per square root of a second beside a slope.

    The slope starts within `slope_rad_s` (a standard deviation) and walks by `slope_walk_rad_s` per square root of a
    second.
    """

    walk_rad: float
    slope_rad_s: float
    slope_walk_rad_s: float


@dataclass(frozen=True, slots=True)
class ObservationModel:
    """What is seen of an angle: complex numbers along it, of which longer ones show their direction better.

    `first_scale` and `min_scale` are standard deviations of what lies across the direction that was expected, over the
    square root of the length: before enough was seen, and at least. Looks nearer in time than `correlation_s` show
    the same. Where nothing was known before, so many as `begins_with` are waited for, and their middle one begins: a
    shock may have shown any direction.
    """

    first_scale: float
    min_scale: float
    correlation_s: float
    begins_with: int = 1


class SlowDrift:
    """Kalman filter of an angle and its slope, with the robust weights of the offline fits."""

    def __init__(self, wandering: Wandering, looks: ObservationModel) -> None:
        self._wandering, self._looks = wandering, looks
        self._first: list[complex]  # looks that are still waiting for others
        self.restart(0.0, 0.0, UNKNOWN_RAD)

    def restart(self, time_s: float, angle_rad: float, sd_rad: float) -> None:
        """Begin at an angle that is known to `sd_rad`, UNKNOWN_RAD where it is not."""
        self._time_s, self._angle, self._slope = time_s, angle_rad, 0.0
        self._covariance = (sd_rad**2, 0.0, self._wandering.slope_rad_s**2)  # of angle, of both, of slope
        self._errors: deque[float] = deque(maxlen=MEMORY)
        self._is_unknown, self._first = sd_rad >= UNKNOWN_RAD, []
        self._off_since_s, self._off_sign = np.inf, 0.0  # since when it is seen far off, and on which side

    def turn(self, by_rad: float) -> None:
        """What was called angle is now called angle + by."""
        self._angle += by_rad

    def loosen(self, sd_rad: float) -> None:
        """Something unseen has turned the angle by about `sd_rad`."""
        angle, both, slope = self._covariance
        self._covariance = angle + sd_rad**2, both, slope

    def at(self, time_s: FloatArray) -> FloatArray:
        """The angle (n,) to be expected."""
        return self._angle + self._slope * (time_s - self._time_s)

    @property
    def sd_rad(self) -> float:
        """Standard deviation of the angle when it was last seen."""
        return float(np.sqrt(self._covariance[0]))

    def _advance(self, time_s: float) -> None:
        """Let it wander until `time_s`."""
        w, since_s = self._wandering, time_s - self._time_s
        angle, both, slope = self._covariance
        angle += since_s * (2 * both + since_s * slope + w.walk_rad**2)
        self._covariance = angle, both + since_s * slope, slope + since_s * w.slope_walk_rad_s**2
        self._time_s, self._angle = time_s, self._angle + since_s * self._slope

    def look(self, seen: complex, time_s: float, duration_s: float, unsure_rad: float = 0.0) -> None:
        """Take the mean observation around `time_s`; `unsure_rad`: sd common to this and adjacent ones."""
        self._advance(time_s)
        if self._is_unknown:
            self._first.append(seen)
            if len(self._first) < self._looks.begins_with:
                return
            self._is_unknown, seen = False, _middle(self._first)
        angle, both, slope = self._covariance
        length = max(abs(seen) ** 0.5, 1e-9)
        error_rad = float(np.angle(seen * np.exp(-1j * self._angle)))
        if self._is_lost(time_s, error_rad):
            self.restart(time_s, self._angle + error_rad, UNKNOWN_RAD)
            return
        self._errors.append(length * error_rad)
        scale = self._looks.first_scale
        if len(self._errors) >= MIN_LOOKS:
            errors = np.array(self._errors)
            # about their median: an angle that has been lost must not make its looks worthless
            scale = max(robust_sd(errors - median_of(errors)), self._looks.min_scale)
        variance = (scale / length) ** 2
        robust = (1 + error_rad**2 / (variance + angle + unsure_rad**2)) ** 0.5
        variance = (variance * robust + unsure_rad**2) * max(1.0, self._looks.correlation_s / duration_s)
        gain = 1 / (variance + angle)
        self._angle += gain * angle * error_rad
        self._slope += gain * both * error_rad
        self._covariance = angle - gain * angle**2, both - gain * angle * both, slope - gain * both**2

    def _is_lost(self, time_s: float, error_rad: float) -> bool:
        """Whether the angle has been elsewhere for so long that no movement explains it: something jumped unseen."""
        sign = float(np.sign(error_rad)) if abs(error_rad) > LOST_RAD else 0.0
        if sign != self._off_sign:
            self._off_since_s, self._off_sign = time_s, sign
        return sign != 0.0 and time_s - self._off_since_s > LOST_S


def _middle(looks: list[complex]) -> complex:
    """The one whose direction is nearest to all the others'."""
    direction = np.angle(np.array(looks))
    apart = np.sum(np.abs(wrap(direction[:, None] - direction)), axis=1)
    return looks[int(np.argmin(apart))]
