"""What a simulated sensor records that is strapped to a moving segment.

Rates and specific forces come from the sensor's poses alone, by differences of fourth order on the fine clock.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from core.body import Segment, Side, Site
from core.samples import BoolArray, FloatArray, ImuBlock, RateKind
from devices.simulation.walker_body import SENSOR_PLACES_M, Leg, SensorErrors, Tissue, WalkerSettings
from devices.simulation.walker_motion import LegMotion, noise_in_band, rotation_about

GRAVITY_M_S2 = np.array([0.0, 0.0, -9.81])
SEGMENT_ROW = {Segment.THIGH: 0, Segment.SHANK: 1, Segment.FOOT: 2}
TISSUE_SHARE = {Segment.THIGH: 1.0, Segment.SHANK: 0.6, Segment.FOOT: 0.25}
TISSUE_RAD, TISSUE_M = np.deg2rad(2.0), 0.005
RING_HZ, RING_DECAY_S = 9.0, 0.08
FADED_DECAYS = 40.0  # after so many a ring is below the rounding of what it is added to
# Real tissue: in walking the relative rate off the axis is then 0.5-0.9 rad/s (1.48 MAD) and about 0.6 (rms) above 3 Hz
REAL_RIDE = 1.8  # how much more than soft tissue it follows the flexion
# and how far it shifts for its turning: below 4 Hz two sensors on a person's knee disagree about the joint's force by 8
# to 13 % of what they feel; with 0.4 simulated ones by 17 %, with 1 by 23 %
REAL_SHIFT = 0.4
REAL_WALK_WOBBLE, REAL_FREE_WOBBLE = 1.0, 0.4
REAL_RING_HZ, REAL_RING_DECAY_S, REAL_RING_STEADINESS = (5.0, 12.0), (0.05, 0.12), 0.3
MOVING_RAD_S, USUAL_KNEE_RAD_S = 0.3, 3.15  # of a knee walking at 1.19 m/s, root mean square while it bends
REAL_RING, REAL_TOE_OFF_RING, REAL_JITTER = 1.9, 0.5, 0.045
REAL_SHARE = {Segment.THIGH: 0.95, Segment.SHANK: 0.85, Segment.FOOT: 0.35}  # of ring and jitter
MOST_TURN_RAD = np.deg2rad(12.0)  # a strap lets a sensor turn no further
LOST_AT_ONCE = 5  # mean length of a burst, samples


@dataclass(frozen=True, slots=True)
class Mounting:
    """Where a sensor sits: `segment_from_sensor` (3, 3) and `place_m` (3,) from the segment's proximal joint."""

    segment_from_sensor: FloatArray
    place_m: FloatArray


@dataclass(frozen=True, slots=True)
class SensorFaults:
    """What is constant in one sensor over one session: scales (3,) and biases (3,) at the start."""

    gyr_scale: FloatArray
    gyr_bias_rad_s: FloatArray
    acc_scale: FloatArray
    acc_bias_m_s2: FloatArray


@dataclass(frozen=True, slots=True)
class Ride:
    """How a sensor rides on soft tissue: in which directions of its segment each drive turns and shifts it.

    The drives (3, 3) are the flexion, its rate and the ringing after contacts. In one task one strap rides alike from
    stride to stride and from walk to walk; tissue depends on the task (Leardini et al. 2005,
    doi:10.1016/j.gaitpost.2004.05.002). Real tissue rings at `ring_hz` and for `ring_decay_s` of this strap's own.
    """

    turn: FloatArray
    shift: FloatArray
    ring_hz: float
    ring_decay_s: float


def draw_ride(rng: np.random.Generator) -> Ride:
    """How one sensor rides on soft tissue, by chance."""
    turn, shift = (np.stack([_direction(rng) for _ in range(3)]) for _ in range(2))
    return Ride(turn, shift, rng.uniform(*REAL_RING_HZ), rng.uniform(*REAL_RING_DECAY_S))


def draw_mounting(site: Site, spread_m: float, rng: np.random.Generator) -> Mounting:
    """Draw any rotation alike, near the segment's nominal place, `spread_m` being the SD of each coordinate."""
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    v = np.array([x, y, z])
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned = (w * w - v @ v) * np.eye(3) + 2.0 * np.outer(v, v) + 2.0 * w * cross
    outward = np.array([1.0, 1.0 if site.side is Side.LEFT else -1.0, 1.0])
    return Mounting(turned, SENSOR_PLACES_M[site.segment] * outward + rng.normal(0.0, spread_m, 3))


def draw_faults(errors: SensorErrors, rng: np.random.Generator) -> SensorFaults:
    """Scales and biases of one sensor, by chance."""
    draws = rng.normal(size=(4, 3))
    return SensorFaults(
        1.0 + errors.gyro_scale_sd * draws[0],
        errors.gyro_bias_sd_rad_s * draws[1],
        1.0 + errors.acc_scale_sd * draws[2],
        errors.acc_bias_sd_m_s2 * draws[3],
    )


def sensor_poses(
    leg: LegMotion,
    site: Site,
    mounting: Mounting,
    tissue: Tissue,
    ride: Ride,
    rng: np.random.Generator,
    following: FloatArray | None = None,
    wobble: float = 1.0,
) -> tuple[FloatArray, FloatArray]:
    """Give earth from sensor (n, 3, 3) and place (n, 3), m, earth z up; `following` turns it with its tissue."""
    row = SEGMENT_ROW[site.segment]
    segment, origin = leg.rotations[row], leg.origins_m[row]
    if following is not None:
        segment = segment @ following
    if tissue is Tissue.RIGID:
        return segment @ mounting.segment_from_sensor, origin + segment @ mounting.place_m
    turn, shift = _tissue_motion(leg, site.segment, tissue, ride, rng, wobble)
    rotation = segment @ small_rotation(turn) @ mounting.segment_from_sensor
    return rotation, origin + np.einsum("nij,nj->ni", segment, mounting.place_m + shift)


def _tissue_motion(
    leg: LegMotion, segment: Segment, tissue: Tissue, ride: Ride, rng: np.random.Generator, wobble: float
) -> tuple[FloatArray, FloatArray]:
    """The sensor against its segment, in segment axes: rotation vectors (n, 3) and shifts (n, 3)."""
    # it follows the flexion and rings after each contact; real tissue follows further, wobbles slowly, rings after
    # toe-off too, differently each time, and trembles with the muscles
    t, share = leg.time_s, TISSUE_SHARE[segment]
    step_s = t[1] - t[0]
    flexion = leg.angles.ankle if segment is Segment.FOOT else leg.angles.knee
    follows = [flexion / np.deg2rad(60.0), gaussian_filter1d(np.gradient(flexion, step_s), 0.01 / step_s) / 4.0]
    contacts_s = leg.events.initial_contact_s
    if tissue is Tissue.SOFT:
        ring = ring_after(t, contacts_s, np.ones(len(contacts_s)), RING_HZ, RING_DECAY_S)
        drives = np.stack([*follows, 2.0 * ring], axis=-1)
        return share * TISSUE_RAD * (drives @ ride.turn), share * TISSUE_M * (drives @ ride.shift)
    hits_s = np.concatenate([contacts_s, leg.events.toe_off_s])
    sizes = np.repeat([1.0, REAL_TOE_OFF_RING], [len(contacts_s), len(leg.events.toe_off_s)])
    sizes = sizes * np.exp(rng.normal(0.0, REAL_RING_STEADINESS, len(hits_s)))
    ring = REAL_RING * REAL_SHARE[segment] / share * ring_after(t, hits_s, sizes, ride.ring_hz, ride.ring_decay_s)
    drives = np.stack([*(REAL_RIDE * drive for drive in follows), ring], axis=-1)
    moving = _is_moving(leg)[:, None]
    usual = REAL_WALK_WOBBLE if len(contacts_s) else REAL_FREE_WOBBLE
    slow = wobble * usual * (_liveliness(leg) if len(contacts_s) else 1.0)
    fast = REAL_JITTER * REAL_SHARE[segment] / share * usual / REAL_WALK_WOBBLE
    turn, shift = (
        drives @ directions
        + moving * (slow * _wobble(t, (1.2, 3.8), rng) + fast * _wobble(t, (6.0, 18.0), rng) * _bursts(t, rng))
        for directions in (ride.turn, ride.shift)
    )
    return _bounded(share * TISSUE_RAD * turn), REAL_SHIFT * share * TISSUE_M * shift


def turn_in_step(
    motion: LegMotion, leg: Leg, segment: Segment, size_rad: float, rng: np.random.Generator
) -> FloatArray:
    """Turn a sensor about flexion once and twice a stride; `size_rad` is rms times root 2 at a thigh."""
    contacts_s = motion.events.initial_contact_s
    phase_1, phase_2 = rng.uniform(0.0, 2.0 * np.pi, 2)
    strides = np.interp(motion.time_s, contacts_s, np.arange(len(contacts_s))) if len(contacts_s) else 0.0
    turns = 2.0 * np.pi * strides
    drive = 0.8 * np.sin(turns + phase_1) + 0.6 * np.sin(2.0 * turns + phase_2)
    moving = _is_moving(motion) if len(contacts_s) > 1 else np.zeros_like(motion.time_s)
    return rotation_about(leg.knee_axis, size_rad * TISSUE_SHARE[segment] * moving * drive)


def _liveliness(leg: LegMotion) -> float:
    """How strongly a walk shakes what hangs on it, against 1.19 m/s: as the square of how fast the knee bends."""
    # after a stroke at 0.4 m/s sensors agree about the joint as well as those of others at 1.2
    rate = np.gradient(leg.angles.knee, leg.time_s[1] - leg.time_s[0])
    moving = rate[np.abs(rate) > MOVING_RAD_S]
    return min(1.0, float(np.mean(moving**2)) / USUAL_KNEE_RAD_S**2) if len(moving) else 0.0


def ring_after(t: FloatArray, hits_s: FloatArray, sizes: FloatArray, ring_hz: float, decay_s: float) -> FloatArray:
    """A decaying oscillation (n,) after each hit, that begins smoothly."""
    ring = np.zeros_like(t)
    for hit_s, size in zip(hits_s, sizes, strict=True):
        here = slice(*np.searchsorted(t, [hit_s, hit_s + FADED_DECAYS * decay_s]))
        since = t[here] - hit_s
        start = (1.0 - np.exp(-since / 0.015)) ** 3
        ring[here] += size * (start * np.exp(-since / decay_s) * np.sin(2.0 * np.pi * ring_hz * since))
    return ring


def _bounded(turn: FloatArray) -> FloatArray:
    """Rotation vectors (n, 3) that a strap lets through: small ones as they are, none beyond `MOST_TURN_RAD`."""
    size = np.linalg.norm(turn, axis=1, keepdims=True) / MOST_TURN_RAD
    return np.asarray(turn / (1.0 + size**4) ** 0.25)


def _direction(rng: np.random.Generator) -> FloatArray:
    v = rng.normal(size=3)
    return np.asarray(v / np.linalg.norm(v))


def _wobble(t: FloatArray, band_hz: tuple[float, float], rng: np.random.Generator) -> FloatArray:
    """Band noise (n, 3) of unit standard deviation: a few sines each within `band_hz`."""
    return noise_in_band(t, band_hz, (3, 5), rng) * np.sqrt(2.0 / 5)


def _bursts(t: FloatArray, rng: np.random.Generator) -> FloatArray:
    """How much the muscles tremble (n, 1), 0 to 2.7, mean square about 1: now and then for some tenths of a second."""
    return np.exp(1.2 * np.tanh(_wobble(t, (0.5, 2.0), rng)[:, :1])) - 0.3


def _is_moving(leg: LegMotion) -> FloatArray:
    """How much the leg moves (n,), 0 to 1, smooth."""
    step_s = leg.time_s[1] - leg.time_s[0]
    speed = np.abs(np.gradient(leg.angles.knee, step_s)) + np.abs(np.gradient(leg.angles.ankle, step_s))
    return np.minimum(gaussian_filter1d(np.minimum(speed, 1.5), 0.15 / step_s) / 0.5, 1.0)


def small_rotation(v: FloatArray) -> FloatArray:
    """Give rotation matrices (n, 3, 3) of rotation vectors (n, 3)."""
    angle = np.linalg.norm(v, axis=1)
    k = np.zeros((len(v), 3, 3))
    k[:, 0, 1], k[:, 0, 2], k[:, 1, 2] = -v[:, 2], v[:, 1], -v[:, 0]
    k -= np.swapaxes(k, 1, 2)
    sine = np.sinc(angle / np.pi)[:, None, None]
    versine = 0.5 * np.sinc(0.5 * angle / np.pi)[:, None, None] ** 2
    return np.asarray(np.eye(3) + sine * k + versine * (k @ k))


def angular_rate(rotations: FloatArray, step_s: float) -> FloatArray:
    """Differentiate earth-from-sensor to rates (n, 3) in sensor axes, rad/s; two at each end repeat."""
    near = _rotation_between(rotations[1:-3], rotations[3:-1])
    far = _rotation_between(rotations[:-4], rotations[4:])
    return _repeat_ends((8.0 * near - far) / (12.0 * step_s))


def _rotation_between(first: FloatArray, second: FloatArray) -> FloatArray:
    """Rotation vectors (n, 3) from first to second (n, 3, 3), both turned by less than a right angle."""
    relative = np.swapaxes(first, 1, 2) @ second
    sine = 0.5 * (relative - np.swapaxes(relative, 1, 2))
    v = np.stack([sine[:, 2, 1], sine[:, 0, 2], sine[:, 1, 0]], axis=-1)
    size = np.linalg.norm(v, axis=1, keepdims=True)
    return np.asarray(v / np.sinc(np.arcsin(np.minimum(size, 1.0)) / np.pi))


def acceleration(place_m: FloatArray, step_s: float) -> FloatArray:
    """Differentiate a path (n, 3) twice, m/s2, without gravity; two at each end repeat."""
    p = place_m
    return _repeat_ends((-p[:-4] + 16.0 * p[1:-3] - 30.0 * p[2:-2] + 16.0 * p[3:-1] - p[4:]) / (12.0 * step_s**2))


def _repeat_ends(inner: FloatArray) -> FloatArray:
    return np.concatenate([inner[:1], inner[:1], inner, inner[-1:], inner[-1:]])


def interpolate(signal: FloatArray, at: FloatArray) -> FloatArray:
    """Interpolate (n, ...) at fractional indices (m,) by cubics through the four nearest values."""
    i = np.clip(np.floor(at).astype(int), 1, len(signal) - 3)
    u = (at - i).reshape(-1, *(1,) * (signal.ndim - 1))
    a, b, c, d = (signal[i + k] for k in (-1, 0, 1, 2))
    return np.asarray(
        -a * u * (u - 1) * (u - 2) / 6
        + b * (u + 1) * (u - 1) * (u - 2) / 2
        - c * (u + 1) * u * (u - 2) / 2
        + d * (u + 1) * u * (u - 1) / 6
    )


def _mean_before(signal: FloatArray, at: FloatArray, width: float) -> FloatArray:
    """Means (m, 3) of `signal` (n, 3) over `width` steps that end at fractional indices (m,)."""
    # the running integral, exact for cubics inside
    inner = (-signal[:-3] + 13.0 * signal[1:-2] + 13.0 * signal[2:-1] - signal[3:]) / 24.0
    ends = 0.5 * (signal[:-1] + signal[1:])
    steps = np.concatenate([ends[:1], inner, ends[-1:]])
    total = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    return np.asarray((interpolate(total, at) - interpolate(total, at - width)) / width, dtype=np.float64)


@dataclass(frozen=True, slots=True)
class SensorClock:
    """The instants of one sensor's samples (m,) that were kept, and the stamps they got."""

    true_s: FloatArray
    stamp_s: FloatArray


def make_clock(settings: WalkerSettings, site: Site, duration_s: float, rng: np.random.Generator) -> SensorClock:
    """Give the instants and stamps (m,) of one sensor, with its lag, pace, jitter and losses."""
    rate_hz = settings.site_rates_hz.get(site, settings.rate_hz)
    late_s, pace = settings.clock_late_s.get(site, 0.0), settings.clock_rate.get(site, 1.0)
    # samples come at the rate that the sensor's own clock calls `rate_hz`
    count = int(np.floor(duration_s * pace * rate_hz + 1e-9)) + 1
    stamp = np.arange(count) / rate_hz
    true = stamp / pace - late_s
    jitter, lost = (
        rng.normal(size=count),
        _lost(count, settings.site_loss_fractions.get(site, settings.loss_fraction), rng),
    )
    stamp = stamp + np.clip(settings.stamp_jitter_s * jitter, -0.4 / rate_hz, 0.4 / rate_hz)
    return SensorClock(true[~lost], stamp[~lost])


def _lost(count: int, fraction: float, rng: np.random.Generator) -> BoolArray:
    """Which samples (n,) are lost: bursts of `LOST_AT_ONCE` on average, `fraction` of all on average."""
    chance = rng.uniform(size=count)
    lost = np.zeros(count, dtype=np.bool_)
    start = fraction / (LOST_AT_ONCE * max(1.0 - fraction, 1e-9))
    for i in range(1, count) if fraction > 0.0 else ():
        lost[i] = chance[i] < (1.0 - 1.0 / LOST_AT_ONCE if lost[i - 1] else start)
    return lost


def record(
    settings: WalkerSettings,
    site: Site,
    clock: SensorClock,
    fine_s: FloatArray,
    poses: tuple[FloatArray, FloatArray],
    faults: SensorFaults,
    rng: np.random.Generator,
) -> tuple[ImuBlock, FloatArray]:
    """Record one sensor over a recording, and its gyroscope's bias (m, 3), rad/s; poses at `fine_s`."""
    rotations, place = poses
    step_s = float(fine_s[1] - fine_s[0])
    rate_hz = settings.site_rates_hz.get(site, settings.rate_hz)
    at = (clock.true_s - fine_s[0]) / step_s
    rate = angular_rate(rotations, step_s)
    if settings.rate_kind is RateKind.AVERAGED:
        gyr = _mean_before(rate, at, 1.0 / (rate_hz * settings.clock_rate.get(site, 1.0) * step_s))
    else:
        gyr = interpolate(rate, at)
    without_gravity = acceleration(place, step_s) - GRAVITY_M_S2
    acc = interpolate(np.einsum("nji,nj->ni", rotations, without_gravity), at)

    errors, n = settings.errors_of(site), len(at)
    gyr_noise, acc_noise = rng.normal(size=(2, n, 3)) * np.sqrt(0.5 * rate_hz)
    since = np.diff(clock.true_s, prepend=clock.true_s[:1])[:, None]
    bias = np.asarray(
        faults.gyr_bias_rad_s
        + errors.gyro_bias_walk_rad_s * np.cumsum(rng.normal(size=(n, 3)) * np.sqrt(since), axis=0)
    )
    block = ImuBlock(
        sensor=f"DEMO-{site.value}",
        time_s=clock.stamp_s,
        gyr_rad_s=_digits(
            faults.gyr_scale * gyr + bias + errors.gyro_noise_rad_s * gyr_noise,
            errors.gyro_step_rad_s,
            errors.gyro_range_rad_s,
        ),
        acc_m_s2=_digits(
            faults.acc_scale * acc + faults.acc_bias_m_s2 + errors.acc_noise_m_s2 * acc_noise,
            errors.acc_step_m_s2,
            errors.acc_range_m_s2,
        ),
    )
    return block, bias


def _digits(values: FloatArray, step: float, limit: float) -> FloatArray:
    """What a converter of steps `step` (0: none) and of range +-`limit` makes of `values`."""
    if step > 0.0:
        values = step * np.round(values / step)
        limit = step * np.floor(limit / step) if np.isfinite(limit) else limit
    return np.clip(values, -limit, limit) if np.isfinite(limit) else values
