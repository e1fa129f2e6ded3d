"""The angle of a true hinge: the rates' angle, held in place by the accelerations over the whole recording.

On a hinge the integral of the rates (Seel et al. 2014, doi 10.3390/s140406891, eq 11) is exact but for a slow drift,
and the direction of the joint's acceleration in both joint planes (eq 14) is free of drift. Where eq 15 filters one
with the other as samples come in, here the drift is a line between knots, found from all samples at once.
"""

import numpy as np

from core.datasets import knot_positions, knot_products, knot_sums
from core.pair import Pair, lever_acceleration
from core.published.angles import angle_from_rates
from core.robust import robust_sd
from core.rotations import in_plane, wrap
from core.samples import FloatArray, IntArray

DRIFT_WALK_RAD = np.deg2rad(0.3)  # per square root of a second
GAP_RAD = np.deg2rad(5.0)  # how far interpolated rates may be off after a gap
CORRELATION_S = 0.1  # accelerations nearer in time tell the same
SAMPLES_PER_S = 20.0
MIN_SCALE_M_S2 = 0.02
STEPS = 6


def hinge_angle(pair: Pair, j1: FloatArray, j2: FloatArray, unknowns: FloatArray) -> FloatArray:
    """Twist (n,) of the distal segment against the proximal one, radians, without jumps.

    Parameters
    ----------
    j1, j2 : (3,)
        Unit axes of the proximal and the distal sensor, each in its own sensor's axes.
    unknowns : (12,)
        Centres o1, o2 (m) and accelerometer biases b1, b2 (m/s2) as `joint_centre` found them.

    Returns
    -------
    (n,)
        rad.
    """
    from_rates = -angle_from_rates(pair.g1, pair.g2, j1, j2, pair.step_s)
    chosen = np.flatnonzero(pair.is_known)[:: max(1, round(1 / (SAMPLES_PER_S * pair.step_s)))]
    if len(chosen) < 2:
        return from_rates
    force_1 = pair.a1[chosen] - unknowns[6:9] - lever_acceleration(pair.g1[chosen], pair.dg1[chosen], unknowns[0:3])
    force_2 = pair.a2[chosen] - unknowns[9:12] - lever_acceleration(pair.g2[chosen], pair.dg2[chosen], unknowns[3:6])
    z1, z2 = in_plane(force_1, j1), in_plane(force_2, j2)
    # the true drift turns z2 exp(i from_rates) into z1; a long z tells its direction better than a short one
    ahead = z1 * np.conj(z2 * np.exp(1j * from_rates[chosen]))
    length = np.sqrt(np.abs(ahead))
    drift = _fit_drift(pair, chosen, np.angle(ahead), length, start=float(np.angle(np.sum(ahead))))
    return from_rates + drift


def _fit_drift(pair: Pair, chosen: IntArray, angle: FloatArray, length: FloatArray, start: float) -> FloatArray:
    intervals, position = knot_positions(pair)
    over = np.flatnonzero(pair.is_measured[1:] & ~pair.is_measured[:-1])  # what a gap hid turns all that follows
    lines, terms = intervals + 1, intervals + 1 + len(over)
    left = np.minimum(position[chosen].astype(int), intervals - 1)
    share = position[chosen] - left
    after = (chosen[:, None] > over).astype(np.float64)
    walk = np.diff(np.eye(terms)[: intervals + 1], axis=0)
    prior = walk.T @ walk / (DRIFT_WALK_RAD**2 * pair.duration_s / intervals)
    prior[range(intervals + 1, terms), range(intervals + 1, terms)] = GAP_RAD**-2
    information = min(1.0, pair.step_s * float(np.median(np.diff(chosen))) / CORRELATION_S)
    knots = np.zeros(terms)
    knots[: intervals + 1] = start
    for _ in range(STEPS):
        drift = (1 - share) * knots[left] + share * knots[left + 1] + after @ knots[lines:]
        error = length * wrap(angle - drift)
        scale = max(robust_sd(error), MIN_SCALE_M_S2)
        weight = information * length**2 / (scale**2 * np.sqrt(1 + (error / scale) ** 2))
        push = weight * error / np.maximum(length, 1e-9)
        matrix, step = prior + 1e-9 * np.eye(terms), -prior @ knots
        matrix[:lines, :lines] += knot_products(left, share, weight, lines)
        step[:lines] += knot_sums(left, share, push, lines)
        if len(over):
            mixed = np.stack([knot_sums(left, share, weight * one, lines) for one in after.T], axis=1)
            matrix[:lines, lines:] += mixed
            matrix[lines:, :lines] += mixed.T
            matrix[lines:, lines:] += after.T @ (after * weight[:, None])
            step[lines:] += push @ after
        knots = knots + np.linalg.solve(matrix, step)
    drift = np.interp(position, np.arange(intervals + 1), knots[: intervals + 1])
    jumps = np.zeros(len(pair))
    jumps[over + 1] = knots[intervals + 1 :]
    return np.asarray(drift + np.cumsum(jumps))
