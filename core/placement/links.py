"""Test of two sensors for a common joint: both must feel the same acceleration there (Seel et al. 2014, eq 7)."""

from dataclasses import dataclass

import numpy as np

from core.placement.smoothed_tracks import SmoothedTrack
from core.samples import FloatArray, IntArray
from core.signal.rotations import turn_about_vertical

HEADING_STEP_RAD = np.deg2rad(30.0)  # from so near the exact heading is found in closed form
SCALE_M_S2 = 0.5
CENTRE_PRIOR_M = 0.1  # tight, so that what the motion does not show of a lever stays short
BIAS_PRIOR_M_S2 = 0.05
LAG_STEPS = (-1, 0, 1)  # two clocks, each up to 30 ms off, are apart by a step and a bit
LAG_PRIOR_S = 0.025  # of what whole steps leave
STEPS = 4
MIN_WINDOW_INSTANTS = 20


@dataclass(frozen=True, slots=True)
class Link:
    """How well two sensors share a joint: `cost` is the mean robust loss of what they disagree on.

    `centre_1_m`, `centre_2_m` (3,): from the joint to each sensor, in sensor axes.
    """

    cost: float
    centre_1_m: FloatArray
    centre_2_m: FloatArray


def link(one: SmoothedTrack, two: SmoothedTrack, index: IntArray, window: IntArray) -> Link | None:
    """Fit a joint at `index` (m,), one heading per window; None where no window has samples enough of both."""
    is_known = np.isfinite(one.terms[index, 0, 0])
    for step in LAG_STEPS:
        is_known &= np.isfinite(two.change[index + step, 0, 0])
    counts = np.bincount(window[is_known], minlength=int(window.max()) + 1)
    is_known &= counts[window] >= MIN_WINDOW_INSTANTS
    if not is_known.any():
        return None
    index, window = index[is_known], window[is_known]
    terms_1 = one.terms[index]
    starts = [(_scanned(terms_1, two.terms[index + step], window), index + step) for step in LAG_STEPS]
    start, later = min(starts, key=lambda found: found[0].left)
    terms_2, change_2 = two.terms[later], two.change[later]
    x, heading = start.unknowns, start.heading
    weight = np.ones(len(index))
    for _ in range(STEPS):
        change = change_2[..., 6] - change_2[..., :6] @ x[6:12]
        x = _solved(terms_1, terms_2, change, heading[window], weight)
        joint_1 = terms_1[..., 6] - terms_1[..., :6] @ x[:6]
        joint_2 = terms_2[..., 6] - terms_2[..., :6] @ x[6:12] - change * x[12]
        heading = _aligned(joint_1, joint_2, weight, window)
        error = joint_1 - turn_about_vertical(heading[window], joint_2)
        root = np.sqrt(1 + np.sum(error**2, axis=1) / SCALE_M_S2**2)
        weight = 1 / root
    return Link(float(2 * np.mean(root - 1)), x[0:3], x[6:9])


@dataclass(frozen=True, slots=True)
class _Start:
    """Least squares: unknowns (12,), heading per window (w,), and the squares left."""

    unknowns: FloatArray
    heading: FloatArray
    left: float


def _scanned(terms_1: FloatArray, terms_2: FloatArray, window: IntArray) -> _Start:
    """Try headings all around the circle, each window by itself; the unknowns are the windows' mean."""
    heading, x, left = np.zeros(int(window.max()) + 1), np.zeros(12), 0.0
    for w in np.unique(window):
        mine = window == w
        heading[w], unknowns, least = _best_heading(terms_1[mine], terms_2[mine])
        x += unknowns * np.mean(mine)
        left += least
    return _Start(x, heading, left)


def _prior() -> FloatArray:
    """Information (6,) of the centre and the bias of one sensor, in units of the residual's."""
    return SCALE_M_S2**2 * np.repeat([CENTRE_PRIOR_M**-2, BIAS_PRIOR_M_S2**-2], 3)


def _best_heading(one: FloatArray, two: FloatArray) -> tuple[float, FloatArray, float]:
    """The heading under which least squares leave least, their unknowns (12,), and what they leave."""
    # Rz(d) is cos d A + sin d B + C, so the moments of all headings come from three
    x, y, z = np.concatenate([one, two], axis=2).transpose(1, 0, 2)
    flat, upright, turned = x.T @ x + y.T @ y, z.T @ z, x.T @ y
    parts = np.stack([flat[:7, 7:], turned[7:, :7].T - turned[:7, 7:], upright[:7, 7:]])
    trial = np.arange(0.0, 2 * np.pi, HEADING_STEP_RAD)
    mixed = np.tensordot(np.stack([np.cos(trial), np.sin(trial), np.ones_like(trial)], axis=1), parts, 1)
    own_1, own_2 = ((flat + upright)[part, part] for part in (slice(0, 7), slice(7, 14)))
    matrix = np.zeros((len(trial), 12, 12))
    matrix[:, :6, :6], matrix[:, 6:, 6:] = own_1[:6, :6], own_2[:6, :6]
    matrix[:, :6, 6:], matrix[:, 6:, :6] = -mixed[:, :6, :6], -np.swapaxes(mixed[:, :6, :6], 1, 2)
    matrix += np.diag(np.tile(_prior(), 2))
    slope = np.concatenate([own_1[:6, 6] - mixed[:, :6, 6], own_2[:6, 6] - mixed[:, 6, :6]], axis=1)
    unknowns = np.linalg.solve(matrix, slope[..., None])[..., 0]
    left = own_1[6, 6] + own_2[6, 6] - 2 * mixed[:, 6, 6] - np.sum(unknowns * slope, axis=1)
    best = int(np.argmin(left))
    return float(trial[best]), unknowns[best], float(left[best])


def _solved(
    terms_1: FloatArray, terms_2: FloatArray, change_2: FloatArray, heading: FloatArray, weight: FloatArray
) -> FloatArray:
    """Centre and bias of either sensor and the lag (13,), by weighted least squares under headings (n,)."""
    # the lag enters by the derivative of the joint's force as the second sensor feels it
    second = np.concatenate([terms_2[..., :6], change_2[..., None], terms_2[..., 6:]], axis=2)
    second = np.swapaxes(turn_about_vertical(heading[:, None], np.swapaxes(second, 1, 2)), 1, 2)
    design = np.concatenate([terms_1[..., :6], -second[..., :7]], axis=2).reshape(-1, 13)
    weighted = design * np.repeat(weight, 3)[:, None]
    matrix = weighted.T @ design + np.diag([*np.tile(_prior(), 2), (SCALE_M_S2 / LAG_PRIOR_S) ** 2])
    return np.asarray(np.linalg.solve(matrix, weighted.T @ (terms_1[..., 6] - second[..., 7]).ravel()))


def _aligned(joint_1: FloatArray, joint_2: FloatArray, weight: FloatArray, window: IntArray) -> FloatArray:
    """Heading of each window (w,) under which two courses of one vector (n, 3) differ least."""
    product = weight * (joint_1[:, 0] + 1j * joint_1[:, 1]) * (joint_2[:, 0] - 1j * joint_2[:, 1])
    real, imaginary = (np.bincount(window, part) for part in (product.real, product.imag))
    return np.asarray(np.angle(real + 1j * imaginary))
