"""Samples of the two sensors at one joint at the same instants."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from core.samples import BoolArray, FloatArray
from core.signal.joint_force import JointForce, joint_force
from core.signal.rotations import cross_matrix, matrix_from_quaternion
from core.signal.tracks import Track, at_positions, continuous

MOVING_RAD_S = 0.3  # both sensors' rates together, averaged over
MOVING_WINDOW_S = 0.5
FAST_RAD_S = 6.0  # above, impacts and whole-body turns dominate what the sensors feel


@dataclass(frozen=True)
class OrientedTrack:
    """A track with its gyroscope bias removed and an orientation (n, 4), earth from sensor."""

    track: Track
    q_earth_from_sensor: FloatArray

    @cached_property
    def earth_from_sensor(self) -> FloatArray:
        """The same as rotations (n, 3, 3)."""
        return matrix_from_quaternion(self.q_earth_from_sensor)

    @cached_property
    def joint_force(self) -> JointForce:
        """What it feels of a joint; found once, for both joints of its segment."""
        track = self.track
        return joint_force(
            track.start_s,
            track.step_s,
            track.gyr_rad_s,
            angular_acceleration(track.gyr_rad_s, track.step_s),
            track.acc_m_s2,
            self.earth_from_sensor,
            track.is_measured,
        )


@dataclass(frozen=True, slots=True)
class Pair:
    """Samples of the proximal (1) and the distal (2) sensor of a joint over one stretch, on the proximal one's clock.

    Rates `g`, specific forces `a` and angular accelerations `dg` are (n, 3) in sensor axes, rotations `earth_from` are
    (n, 3, 3); the two earths differ by a heading. `is_measured` and `is_known` (n,): both sensors gave samples; and
    their angular accelerations exist too. `tracks` are what was paired, the distal one's stamps `lag_s` earlier.
    """

    time_s: FloatArray
    step_s: float
    g1: FloatArray
    g2: FloatArray
    a1: FloatArray
    a2: FloatArray
    dg1: FloatArray
    dg2: FloatArray
    earth_from_1: FloatArray
    earth_from_2: FloatArray
    is_measured: BoolArray
    is_known: BoolArray
    tracks: tuple[OrientedTrack, OrientedTrack]
    lag_s: float

    def __len__(self) -> int:
        return len(self.time_s)

    @property
    def duration_s(self) -> float:
        """Seconds from the first to the last sample."""
        return float(self.time_s[-1] - self.time_s[0])

    @property
    def is_moving(self) -> BoolArray:
        """Samples (n,) around which both sensors together turn faster than MOVING_RAD_S."""
        speed = np.sqrt(np.einsum("ni,ni->n", self.g1, self.g1) + np.einsum("ni,ni->n", self.g2, self.g2))
        return moving_mean(speed, max(1, round(MOVING_WINDOW_S / self.step_s))) > MOVING_RAD_S


def is_turning(one_rad_s: FloatArray, other_rad_s: FloatArray) -> BoolArray:
    """Give the samples (n,) at which two segments turn, and not more slowly than in half of all."""
    squares = (np.einsum("ni,ni->n", rate, rate) for rate in (one_rad_s, other_rad_s))
    speed = np.sqrt(sum(squares))
    return np.asarray(speed > max(MOVING_RAD_S, float(np.median(speed))))


def moving_mean(values: FloatArray, width: int) -> FloatArray:
    """Average values (n, ...) over up to `width` samples, centred; fewer at the borders."""
    total = np.zeros((len(values) + 1, *values.shape[1:]))
    np.cumsum(values, axis=0, out=total[1:])
    index = np.arange(len(values))
    first, last = np.maximum(index - width // 2, 0), np.minimum(index + (width - width // 2), len(values))
    count = (last - first).reshape(-1, *[1] * (values.ndim - 1))
    return np.asarray((total.take(last, axis=0) - total.take(first, axis=0)) / count)


def angular_acceleration(rate: FloatArray, step_s: float) -> FloatArray:
    """Differentiate rates; NaN in two samples per end (Seel et al. 2014, doi 10.3390/s140406891, eq 1)."""
    derivative = np.full_like(rate, np.nan)
    derivative[2:-2] = (rate[:-4] - 8 * rate[1:-3] + 8 * rate[3:-1] - rate[4:]) / (12 * step_s)
    return derivative


def lever_matrix(rate: FloatArray, angular_acceleration: FloatArray) -> FloatArray:
    """Give K (..., 3, 3), with K o the acceleration of a point at o about the joint (Seel et al. 2014, eq 7)."""
    matrix = rate[..., :, None] * rate[..., None, :]
    square = np.sum(rate**2, axis=-1)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):  # [g]x[g]x = g g' - |g|^2
        matrix[..., i, i] -= square
        matrix[..., j, i] += angular_acceleration[..., k]
        matrix[..., k, i] -= angular_acceleration[..., j]
    return matrix


def lever_acceleration(rate: FloatArray, angular_acceleration: FloatArray, lever_m: FloatArray) -> FloatArray:
    """Give K o (n, 3) of one lever o (3,), m/s2, in sensor axes."""
    along, square = rate @ lever_m, np.sum(rate**2, axis=1)
    return along[:, None] * rate - square[:, None] * lever_m - angular_acceleration @ cross_matrix(lever_m).T


def pair_up(proximal: OrientedTrack, distal: OrientedTrack, lag_s: float) -> Pair | None:
    """Bring the distal track to the proximal one's clock; None where they do not overlap for a second.

    Parameters
    ----------
    lag_s
        What is added to the distal sensor's stamps.

    Returns
    -------
    Pair or None
        Both sensors at the proximal one's samples, each in its own axes.
    """
    one, two = proximal.track, distal.track
    first = max(0, int(np.ceil((two.start_s + lag_s - one.start_s) / one.step_s - 1e-6)))
    last = min(len(one) - 1, int(np.floor((two.end_s + lag_s - one.start_s) / one.step_s + 1e-6)))
    if (last - first) * one.step_s < 1.0:
        return None
    part = slice(first, last + 1)
    time_s = one.start_s + one.step_s * np.arange(first, last + 1)
    position = (time_s - lag_s - two.start_s) / two.step_s
    whole = np.round(position)
    if np.max(np.abs(position - whole)) < 1e-3:  # one clock: no interpolation
        position = whole
        turned = at_positions(distal.earth_from_sensor.reshape(-1, 9), position).reshape(-1, 3, 3)
    else:
        turned = matrix_from_quaternion(at_positions(continuous(distal.q_earth_from_sensor), position))
    is_measured = one.is_measured[part] & two.is_measured[np.clip(whole, 0, len(two) - 1).astype(int)]
    rates = one.gyr_rad_s[part], at_positions(two.gyr_rad_s, position)
    forces = one.acc_m_s2[part], at_positions(two.acc_m_s2, position)
    earth_from = proximal.earth_from_sensor[part], turned
    return _pair(time_s, one.step_s, rates, forces, earth_from, is_measured, (proximal, distal), lag_s)


def pair_of(
    time_s: FloatArray,
    step_s: float,
    rates: tuple[FloatArray, FloatArray],
    forces: tuple[FloatArray, FloatArray],
    orientations: tuple[FloatArray, FloatArray],
    is_measured: BoolArray,
) -> Pair:
    """Make a pair from samples at the same even instants; proximal first, orientations earth from sensor."""
    one, two = (
        OrientedTrack(Track(float(time_s[0]), step_s, rate, force, None, None, is_measured), q)
        for rate, force, q in zip(rates, forces, orientations, strict=True)
    )
    earth_from = one.earth_from_sensor, two.earth_from_sensor
    return _pair(time_s, step_s, rates, forces, earth_from, is_measured, (one, two), 0.0)


def _pair(
    time_s: FloatArray,
    step_s: float,
    rates: tuple[FloatArray, FloatArray],
    forces: tuple[FloatArray, FloatArray],
    earth_from: tuple[FloatArray, FloatArray],
    is_measured: BoolArray,
    tracks: tuple[OrientedTrack, OrientedTrack],
    lag_s: float,
) -> Pair:
    return Pair(
        time_s=time_s,
        step_s=step_s,
        g1=rates[0],
        g2=rates[1],
        a1=forces[0],
        a2=forces[1],
        dg1=angular_acceleration(rates[0], step_s),
        dg2=angular_acceleration(rates[1], step_s),
        earth_from_1=earth_from[0],
        earth_from_2=earth_from[1],
        is_measured=is_measured,
        is_known=_known(is_measured),
        tracks=tracks,
        lag_s=lag_s,
    )


def _known(is_measured: BoolArray) -> BoolArray:
    """Where the sample and the two on each side of it were measured."""
    is_known = is_measured.copy()
    is_known[:2] = is_known[-2:] = False
    for shift in (1, 2):
        is_known[shift:] &= is_measured[:-shift]
        is_known[:-shift] &= is_measured[shift:]
    return is_known
