"""The angle of a true hinge: the rates' angle, held in place by the accelerations over the whole recording.

On a hinge the integral of the rates (Seel et al. 2014, doi 10.3390/s140406891, eq 11) is exact but for a slow drift,
and the direction of the joint's acceleration in both joint planes (eq 14) is free of drift. Where eq 15 filters one
with the other as samples come in, here the drift is a line between knots, found from all samples at once. Beside what
wanders there is what is left of the gyroscopes' biases, a slope, and of their scales, a share of the swing.
"""

import numpy as np
from scipy.signal import butter, sosfiltfilt

from core.published.angles import angle_from_rates
from core.samples import FloatArray, IntArray
from core.signal.datasets import knot_positions, knot_products, knot_sums
from core.signal.pair import Pair, lever_acceleration
from core.signal.robust import robust_sd
from core.signal.rotations import in_plane, wrap

DRIFT_WALK_RAD = np.deg2rad(0.3)  # per square root of a second
GAP_RAD = np.deg2rad(5.0)  # how far interpolated rates may be off after a gap
SLOPE_RAD_S = np.deg2rad(1.5)  # what may be left of two biases
SCALE, SWING_HZ = 0.01, 0.05  # of the gyroscopes; slower than this, a swing is drift
MAX_ELEVATION_RAD = np.deg2rad(45.0)  # an axis that is steeper does not show the scales
SD_FACTOR = 2.0  # the covariance of the fit alone holds too little
SD_STEP_S = 0.5  # it changes slowly
CLIPPED_BEYOND_RAD_S, SAME_RAD_S = 1.5, 1e-9  # the narrowest range of a gyroscope is 125 deg/s
CORRELATION_S = 0.1  # accelerations nearer in time show the same
SAMPLES_PER_S = 20.0
MIN_SCALE_M_S2 = 0.02
STEPS = 6


def hinge_angle(pair: Pair, j1: FloatArray, j2: FloatArray, unknowns: FloatArray) -> FloatArray:
    """Give the twist (n,) of the distal against the proximal segment, rad, without jumps.
    `j1`, `j2` (3,) are unit axes in each sensor's own axes; `unknowns` (12,) are centres o1, o2 (m) and
    biases b1, b2 (m/s2) of `joint_centre`.
    """
    return hinge_angle_and_sd(pair, j1, j2, unknowns)[0]


def hinge_angle_and_sd(
    pair: Pair, j1: FloatArray, j2: FloatArray, unknowns: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """As `hinge_angle`, with the drift's standard deviation (n,), rad; zero where nothing is known."""
    from_rates = -angle_from_rates(pair.g1, pair.g2, j1, j2, pair.step_s)
    chosen = np.flatnonzero(pair.is_known)[:: max(1, round(1 / (SAMPLES_PER_S * pair.step_s)))]
    if len(chosen) < 2:
        return from_rates, np.zeros(len(pair))
    force_1 = pair.a1[chosen] - unknowns[6:9] - lever_acceleration(pair.g1[chosen], pair.dg1[chosen], unknowns[0:3])
    force_2 = pair.a2[chosen] - unknowns[9:12] - lever_acceleration(pair.g2[chosen], pair.dg2[chosen], unknowns[3:6])
    z1, z2 = in_plane(force_1, j1), in_plane(force_2, j2)
    # the true drift turns z2 exp(i from_rates) into z1; a long z gives its direction better than a short one
    ahead = z1 * np.conj(z2 * np.exp(1j * from_rates[chosen]))
    length = np.sqrt(np.abs(ahead))
    causes = _causes(pair, j1, from_rates)
    drift, sd = _fit_drift(pair, chosen, np.angle(ahead), length, float(np.angle(np.sum(ahead))), causes)
    return from_rates + drift, sd


Causes = tuple[FloatArray, FloatArray]
"""Courses (n, c) that a part of the drift may take, and the standard deviations (c,) of their sizes."""


def _causes(pair: Pair, j1: FloatArray, from_rates: FloatArray) -> Causes:
    """What biases do; and scales, which on a steep axis look like what tilts the accelerations."""
    since = pair.time_s - 0.5 * (pair.time_s[0] + pair.time_s[-1])
    steepness = float(np.median(np.abs(pair.earth_from_1[:, 2] @ j1)))
    if steepness > np.sin(MAX_ELEVATION_RAD):
        return since[:, None], np.array([SLOPE_RAD_S])
    swing = sosfiltfilt(butter(1, SWING_HZ, "highpass", fs=1 / pair.step_s, output="sos"), from_rates)
    return np.stack([since, swing], axis=1), np.array([SLOPE_RAD_S, SCALE])


def _hidden_before(pair: Pair) -> IntArray:
    """The last sample of each time that hid some turning, which turns all that follows: gaps, rates at their end."""
    # a gyroscope at its end stays at one value; eq 15 forgets what that lost within its time constant
    is_lost = ~pair.is_measured
    for rates in (pair.g1, pair.g2):
        low, high = rates.min(axis=0) + SAME_RAD_S, rates.max(axis=0) - SAME_RAD_S
        at_end = ((rates < low) | (rates > high)) & (np.abs(rates) > CLIPPED_BEYOND_RAD_S)
        is_lost[2:] |= (at_end[2:] & at_end[1:-1] & at_end[:-2]).any(axis=1)
    return np.flatnonzero(is_lost[:-1] & ~is_lost[1:])


def _fit_drift(
    pair: Pair, chosen: IntArray, angle: FloatArray, length: FloatArray, start: float, causes: Causes
) -> tuple[FloatArray, FloatArray]:
    intervals, position = knot_positions(pair)
    over = _hidden_before(pair)
    courses, sizes = causes
    lines, jumps = intervals + 1, intervals + 1 + len(sizes)
    terms = jumps + len(over)
    left = np.minimum(position[chosen].astype(int), intervals - 1)
    share = position[chosen] - left
    course = np.concatenate([courses[chosen], chosen[:, None] > over], axis=1)
    walk = np.diff(np.eye(terms)[:lines], axis=0)
    prior = walk.T @ walk / (DRIFT_WALK_RAD**2 * pair.duration_s / intervals)
    prior[range(lines, terms), range(lines, terms)] = np.append(sizes, np.full(len(over), GAP_RAD)) ** -2.0
    information = min(1.0, pair.step_s * float(np.median(np.diff(chosen))) / CORRELATION_S)
    knots = np.zeros(terms)
    knots[:lines] = start
    for _ in range(STEPS):
        drift = (1 - share) * knots[left] + share * knots[left + 1] + course @ knots[lines:]
        error = length * wrap(angle - drift)
        scale = max(robust_sd(error), MIN_SCALE_M_S2)
        weight = information * length**2 / (scale**2 * np.sqrt(1 + (error / scale) ** 2))
        push = weight * error / np.maximum(length, 1e-9)
        matrix, step = prior + 1e-9 * np.eye(terms), -prior @ knots
        mixed = np.stack([knot_sums(left, share, weight * one, lines) for one in course.T], axis=1)
        matrix[:lines, :lines] += knot_products(left, share, weight, lines)
        matrix[:lines, lines:] += mixed
        matrix[lines:, :lines] += mixed.T
        matrix[lines:, lines:] += course.T @ (course * weight[:, None])
        step[:lines] += knot_sums(left, share, push, lines)
        step[lines:] += push @ course
        knots = knots + np.linalg.solve(matrix, step)
    turned = np.zeros(len(pair))
    turned[over + 1] = knots[jumps:]
    drift = np.interp(position, np.arange(lines), knots[:lines]) + courses @ knots[lines:jumps] + np.cumsum(turned)
    some = np.unique(np.linspace(0, len(pair) - 1, 2 + int(pair.duration_s / SD_STEP_S)).astype(np.int64))
    shares = np.maximum(1 - np.abs(position[some, None] - np.arange(lines)), 0.0)
    by = np.concatenate([shares, courses[some], some[:, None] > over], axis=1)
    sd = SD_FACTOR * np.sqrt(np.sum(by @ np.linalg.inv(matrix) * by, axis=1))
    return np.asarray(drift), np.interp(np.arange(len(pair)), some, sd)
