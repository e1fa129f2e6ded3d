"""Swings, pitch and velocity of a foot from one stance to the next, in any mounting.

Between two steps every foot comes to rest, or nearly so: the calmest instant of each stance anchors everything. From
stance to stance the specific force is integrated and what velocity is left in the next is taken off (zero-velocity
updates; Skog et al. 2010, doi 10.1109/TBME.2010.2060723, whose stance statistic is used too).
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.signal import find_peaks

from core.samples import GRAVITY_M_S2, FloatArray, IntArray
from core.signal.pair import OrientedTrack, moving_mean

CALM_RAD_S, CALM_M_S2 = 0.3, 0.6  # how much a foot still moves in the middle of an ordinary stance
CALM_WINDOW_S = 0.1
MIN_CALM_RATIO = 15.0  # a step moves the foot so much more than the stances around it (mean squares)
MAX_CALM = 30.0  # a foot that moves more than this, in units of CALM squared, is not standing,
MAX_CALM_SHARE = 1.0 / 40.0  # nor one that moves more than this share of what its livelier moments reach, if fast or
LIVELY_QUANTILE = 0.9  # strapped loosely: of the restlessness above MAX_CALM
HOVER_RATIO, HOVER_CALM = 50.0, 10.0  # so much livelier than the stance beside it, and lively, a foot hovers
CALM_FLOOR = 0.03  # the sensors' own noise
REST_TILT_RAD = np.deg2rad(
    2.2
)  # a sensor that shakes by CALM more than an ordinary one tilts so far on a standing foot
FAR_FROM_STEP_S = 1.2  # a standing foot's calmest sample further from a step than this is too far from it:
BESIDE_STEP_S = 0.8  # slow walkers' are not; so near another is sought,
STILL_RATIO = 3.0  # beside which the foot moves no more than by so much the calmest of its standing
MAX_REST_S = 0.8  # to either side; standing lasts longer, and the tilt then drifts
MAX_TILT_ERROR_RAD = np.deg2rad(3.0)  # the filter is better than this; what is more, the foot's own wobble felt
EVEN_M_S2 = 0.005  # what an accelerometer's bias leaves once a stance has shown the vertical, sample by sample
BEND_SHARE = 0.2  # of a second difference is what the trapezoid may miss,
SMOOTH_M_S2 = 10.0  # where it exceeds what a swinging foot does at 50 Hz
MIN_SWING_M = 0.08  # shorter is fidgeting, not a step
MIN_SWING_M_S = 0.25
MAX_TILT_RAD = np.deg2rad(30.0)  # a resting foot is as it mostly is at rest; ramps and kerbs included
MOVING_RAD_S = 1.0
MIN_HEEL_UP_RAD = np.deg2rad(1.0)  # mean pitch of swings that gives where the toes are; shuffling feet have 1.2 deg


@dataclass(frozen=True, slots=True)
class Swings:
    """Every forward movement of one foot between two stances, as indices of samples, each (k,), ascending.

    `anchor_before` and `anchor_after` are the calmest instants of the stances around, `fastest` is the foot's greatest
    speed.
    """

    anchor_before: IntArray
    fastest: IntArray
    anchor_after: IntArray

    def __len__(self) -> int:
        return len(self.fastest)


@dataclass(frozen=True, slots=True)
class FootRest:
    """One stance as zero velocity sees it: the calmest sample, the samples around it and how much each counts.

    A sensor may shake on its foot. Over a stance that averages out, in one instant it does not. The weights fade
    towards both ends, where the foot begins to roll.
    """

    anchor: int
    span: slice
    weights: FloatArray


@dataclass(frozen=True, slots=True)
class FootMotion:
    """One foot over one track.

    `pitch_rate_rad_s`, `pitch_rad`: (n,): toes up positive; the pitch is zero in the rest of each stance.
    `velocity_m_s`, `acceleration_m_s2`: (n, 3): of the sensor, in earth axes.
    `height_m`: (k,): how high the sensor rose over the line from its place in the stance before to that in the stance
    after.
    """

    start_s: float
    step_s: float
    swings: Swings
    pitch_axis: FloatArray  # (3,): in sensor axes; turning about it lifts the toes
    pitch_rate_rad_s: FloatArray
    pitch_rad: FloatArray
    velocity_m_s: FloatArray
    acceleration_m_s2: FloatArray
    travel_m: FloatArray  # (k, 2): how far each swing carried the foot over the floor
    height_m: FloatArray
    climb_m: FloatArray  # (k,): how much higher the foot stood after each swing than before it
    turn_rad: FloatArray  # (k,): how far each swing turned the foot about the vertical
    is_direction_certain: bool  # what the pitch and what the way of walking say about the toes agree

    def time_of(self, index: FloatArray) -> FloatArray:
        """Seconds at fractional indices of samples (...,)."""
        return self.start_s + self.step_s * index


def follow(foot: OrientedTrack) -> FootMotion:
    """Find every swing of a foot and how far it went. A foot that never steps has no swings.

    Parameters
    ----------
    foot
        One stretch without gaps of a sensor on the foot, in any mounting, its gyroscope's bias removed.

    Returns
    -------
    FootMotion
        Pitch (n,), rad, and velocity (n, 3), m/s, in earth axes; swings (k,) as indices of samples.

    Examples
    --------
    >>> bias_rad_s = rest_of(standing.imu[Site.LEFT_FOOT]).gyr_rad_s
    >>> track = even_tracks(walk.imu[Site.LEFT_FOOT])[0]
    >>> motion = follow(oriented(track, RateKind.INSTANTANEOUS, bias_rad_s))
    >>> len(motion.swings) >= 5
    True
    """
    track = foot.track
    step_s, gyr = track.step_s, track.gyr_rad_s
    earth_from_sensor = foot.earth_from_sensor
    acceleration = np.einsum("nij,nj->ni", earth_from_sensor, track.acc_m_s2) - [0.0, 0.0, GRAVITY_M_S2]
    up = earth_from_sensor[:, 2]  # in sensor axes
    restless = _restlessness(gyr, acceleration, step_s)
    anchors = _beside_steps(_anchors(restless, up), restless, step_s)
    shaking = max(0.0, float(np.median(restless[anchors])) - 1.0) if len(anchors) else 0.0
    rough = _velocity(acceleration, _instants(anchors, len(up), step_s), step_s)
    standing = _without_hovering(anchors, restless, _integral(rough, step_s))
    if len(standing) < len(anchors):
        anchors, rough = standing, _velocity(acceleration, _instants(standing, len(up), step_s), step_s)
    rests = _stances(anchors, up, np.linalg.norm(rough, axis=1), step_s, np.sqrt(shaking) * REST_TILT_RAD)
    velocity = _velocity(acceleration, rests, step_s)
    path = _integral(velocity, step_s)
    swings = _swings(anchors, velocity, path)
    axis, is_certain = _pitch_axis(gyr, earth_from_sensor, anchors, swings, path, step_s)
    forward = np.cross(np.median(up[anchors], axis=0), axis) if len(anchors) else np.cross([0.0, 0.0, 1.0], axis)
    forward = forward / max(float(np.linalg.norm(forward)), 1e-9)
    headings = np.unwrap(_heading(earth_from_sensor, forward))
    before, after = swings.anchor_before, swings.anchor_after
    return FootMotion(
        start_s=track.start_s,
        step_s=step_s,
        swings=swings,
        pitch_axis=axis,
        pitch_rate_rad_s=gyr @ axis,
        pitch_rad=_pitch(up @ forward, rests),
        velocity_m_s=velocity,
        acceleration_m_s2=acceleration,
        travel_m=path[after, :2] - path[before, :2],
        height_m=_heights(path[:, 2], swings),
        climb_m=path[after, 2] - path[before, 2],
        turn_rad=headings[after] - headings[before],
        is_direction_certain=is_certain,
    )


def _restlessness(gyr: FloatArray, acceleration: FloatArray, step_s: float) -> FloatArray:
    """How much the foot moves (n,), about 1 in the middle of an ordinary stance."""
    restless = np.sum(gyr**2, axis=1) / CALM_RAD_S**2 + np.sum(acceleration**2, axis=1) / CALM_M_S2**2
    return moving_mean(restless, max(3, round(CALM_WINDOW_S / step_s)))


def _anchors(restless: FloatArray, up: FloatArray) -> IntArray:
    """The calmest sample of every stance."""
    calm = -np.log(restless + CALM_FLOOR)
    edge = [calm.min() - 1.0]  # a recording may begin and end in standing
    found, _ = find_peaks(np.concatenate([edge, calm, edge]), prominence=np.log(MIN_CALM_RATIO))
    found = found - 1
    found = found[restless[found] < _most_calm(restless)]
    if not len(found):
        return found
    usual = np.median(up[found], axis=0)
    tilt = up[found] @ (usual / max(float(np.linalg.norm(usual)), 1e-9))
    return found[tilt > np.cos(MAX_TILT_RAD)]


def _beside_steps(anchors: IntArray, restless: FloatArray, step_s: float) -> IntArray:
    """The same and, where a long standing is calmest far from a step, one more beside the step."""
    # integrated over 6 s of standing, first steps came out a quarter too short, over 15 s by metres
    reach, far = round(BESIDE_STEP_S / step_s), round(FAR_FROM_STEP_S / step_s)
    more: list[int] = []
    for before, after in pairwise(anchors.tolist()):
        if after - before <= far:
            continue
        liveliest = before + int(np.argmax(restless[before:after]))
        for anchor, step in ((before, -1), (after, 1)):
            calm = np.flatnonzero(restless[liveliest:anchor:step] < STILL_RATIO * max(1.0, float(restless[anchor])))
            if not len(calm):
                continue
            edge = liveliest + step * int(calm[0])
            if abs(anchor - edge) > far:
                begin, end = sorted((edge, edge + step * reach))
                more.append(begin + int(np.argmin(restless[begin : end + 1])))
    return np.unique(np.concatenate([anchors, np.array(more, dtype=np.int64)]))


def _most_calm(restless: FloatArray) -> float:
    """How restless the calmest instant of a stance may be."""
    lively = restless[restless > MAX_CALM]
    return max(MAX_CALM, MAX_CALM_SHARE * float(np.quantile(lively, LIVELY_QUANTILE))) if len(lively) else MAX_CALM


def _without_hovering(anchors: IntArray, restless: FloatArray, path: FloatArray) -> IntArray:
    """Leave out where a foot that is about to land, or has just left, goes along with the floor for a moment."""
    unrest = restless[anchors]
    is_beside = np.linalg.norm(np.diff(path[anchors, :2], axis=0), axis=1) < MIN_SWING_M  # no step lies between
    calmest = np.full(len(anchors), np.inf)
    calmest[:-1][is_beside] = unrest[1:][is_beside]
    calmest[1:][is_beside] = np.minimum(calmest[1:], unrest[:-1])[is_beside]
    return anchors[(unrest < HOVER_CALM) | (unrest < HOVER_RATIO * calmest)]


def _integral(rate: FloatArray, step_s: float) -> FloatArray:
    total = np.zeros_like(rate)
    np.cumsum(0.5 * step_s * (rate[1:] + rate[:-1]), axis=0, out=total[1:])
    return total


def _instants(anchors: IntArray, n: int, step_s: float) -> list[FootRest]:
    """The shortest rests: no more than the calm around each anchor."""
    reach = max(1, round(0.5 * CALM_WINDOW_S / step_s))
    return [_rest(i, max(0, i - reach), min(n, i + reach + 1)) for i in anchors.tolist()]


def _stances(
    anchors: IntArray, up: FloatArray, speed_m_s: FloatArray, step_s: float, tilt_rad: float
) -> list[FootRest]:
    """The longest rests: all samples around each anchor in which the foot rests as it does there."""
    # a rest ends two thirds of the way to the foot's greatest speed, even if it slides flat
    most = round(MAX_REST_S / step_s)
    fastest = [a + int(np.argmax(speed_m_s[a:b])) for a, b in pairwise(anchors.tolist())]
    rests = []
    for k, least in enumerate(_instants(anchors, len(up), step_s)):
        i = least.anchor
        begin = max(0, i - most) if k == 0 else max(i - most, (i + 2 * fastest[k - 1]) // 3)
        end = min(len(up), i + most) if k == len(fastest) else min(i + most, (i + 2 * fastest[k]) // 3)
        usual = least.weights @ up[least.span]
        is_away = up[begin:end] @ usual < np.cos(tilt_rad) * np.linalg.norm(usual)
        before, after = np.flatnonzero(is_away[: i - begin]), np.flatnonzero(is_away[i - begin :])
        begin = begin + int(before[-1]) + 1 if len(before) else begin
        end = i + int(after[0]) if len(after) else end
        rests.append(_rest(i, min(begin, least.span.start), max(end, least.span.stop)))
    return rests


def _rest(anchor: int, begin: int, end: int) -> FootRest:
    weights = np.hanning(end - begin + 2)[1:-1]
    return FootRest(anchor, slice(begin, end), weights / weights.sum())


def _at_rest(signal: FloatArray, rests: list[FootRest]) -> FloatArray:
    """Means (k, ...) of `signal` (n, ...) over each rest."""
    return np.stack([rest.weights @ signal[rest.span] for rest in rests])


def _upright(acceleration: FloatArray, rests: list[FootRest]) -> FloatArray:
    """Take off the tilt of the earth's axes (n, 3) that a standing foot shows: there is nothing but gravity at rest."""
    gravity = np.array([0.0, 0.0, GRAVITY_M_S2])
    felt = _at_rest(acceleration, rests) + gravity
    tilt = np.cross(felt, [0.0, 0.0, 1.0]) / np.linalg.norm(felt, axis=1, keepdims=True)
    tilt *= np.minimum(1.0, MAX_TILT_ERROR_RAD / np.maximum(np.linalg.norm(tilt, axis=1, keepdims=True), 1e-9))
    index, anchors = np.arange(len(acceleration)), [rest.anchor for rest in rests]
    turned = np.stack([np.interp(index, anchors, tilt[:, k]) for k in range(3)], axis=1)
    return acceleration + np.cross(turned, acceleration + gravity)


def _velocity(acceleration: FloatArray, rests: list[FootRest], step_s: float) -> FloatArray:
    """Velocity (n, 3) whose mean over every rest is zero."""
    # what is left in a rest is taken off where it most likely arose: evenly from a bias, and at once from an impact too
    # short for the sampling rate, where the force bends most from sample to sample
    if not rests:
        return _integral(acceleration, step_s)
    upright = _upright(acceleration, rests)
    velocity = _integral(upright, step_s)
    doubt = np.full(len(velocity), EVEN_M_S2**2 * step_s)
    bend = np.sum((upright[2:] - 2.0 * upright[1:-1] + upright[:-2]) ** 2, axis=1)
    doubt[1:-1] += (BEND_SHARE * step_s) ** 2 * np.maximum(bend - SMOOTH_M_S2**2, 0.0)
    blame = np.cumsum(doubt)
    left, blamed = _at_rest(velocity, rests), _at_rest(blame, rests)
    for k in range(3):
        velocity[:, k] -= np.interp(blame, blamed, left[:, k])
    return velocity


def _swings(anchors: IntArray, velocity: FloatArray, path: FloatArray) -> Swings:
    speed = np.linalg.norm(velocity, axis=1)
    pairs = list(zip(anchors[:-1].tolist(), anchors[1:].tolist(), strict=True))
    fastest = np.array([a + int(np.argmax(speed[a:b])) for a, b in pairs], dtype=np.int64)
    before, after = anchors[:-1], anchors[1:]
    travel = np.linalg.norm(path[after, :2] - path[before, :2], axis=1)
    is_step = (travel > MIN_SWING_M) & (speed[fastest] > MIN_SWING_M_S)
    return Swings(before[is_step], fastest[is_step], after[is_step])


def _pitch_axis(
    gyr: FloatArray, earth_from_sensor: FloatArray, anchors: IntArray, swings: Swings, path: FloatArray, step_s: float
) -> tuple[FloatArray, bool]:
    """The axis the foot mostly turns about, toes up positive, and whether both signs agree."""
    # a foot leaves with its heel first: in swings its pitch is mostly toes down; and it travels toes first, which alone
    # decides where it hardly rolls
    if not len(swings):
        return np.array([1.0, 0.0, 0.0]), False
    moving = gyr[np.sum(gyr**2, axis=1) > MOVING_RAD_S**2]
    axis = np.asarray(np.linalg.eigh(moving.T @ moving)[1][:, -1])
    angle = _integral(gyr @ axis, step_s)
    angle -= np.interp(np.arange(len(angle)), anchors, angle[anchors])
    heel_up = -np.mean(np.concatenate([angle[a:b] for a, b in _spans(swings)]))
    before, after = swings.anchor_before, swings.anchor_after
    right = (earth_from_sensor[before] + earth_from_sensor[after]) @ axis
    travel = path[after] - path[before]
    toes_first = float(np.sum(travel[:, 1] * right[:, 0] - travel[:, 0] * right[:, 1]))
    is_rolling = abs(heel_up) > MIN_HEEL_UP_RAD
    sign = 1.0 if (heel_up if is_rolling else toes_first) > 0 else -1.0
    return axis * sign, not is_rolling or bool(heel_up * toes_first > 0)


def _spans(swings: Swings) -> list[tuple[int, int]]:
    return list(zip(swings.anchor_before.tolist(), swings.anchor_after.tolist(), strict=True))


def _pitch(forward_up: FloatArray, rests: list[FootRest]) -> FloatArray:
    pitch = np.arcsin(np.clip(forward_up, -1.0, 1.0))
    if not rests:
        return pitch
    return np.asarray(pitch - np.interp(np.arange(len(pitch)), [rest.anchor for rest in rests], _at_rest(pitch, rests)))


def _heading(earth_from_sensor: FloatArray, forward: FloatArray) -> FloatArray:
    """Direction (n,) of the foot over the floor; it drifts, so that only differences over seconds mean anything."""
    pointing = earth_from_sensor @ forward
    return np.arctan2(pointing[:, 1], pointing[:, 0])


def _heights(height: FloatArray, swings: Swings) -> FloatArray:
    rises = []
    for a, b in _spans(swings):
        rise = height[a : b + 1] - np.linspace(height[a], height[b], b - a + 1)
        rises.append(float(rise.max()))
    return np.array(rises)
