"""Pitch axis of a foot and its speed since it last stood, sample by sample, in any mounting.

What `core.gait.foot` does with a whole walk, causally. In plain floats: a sample costs some microseconds, an array of
three alone would cost more.
"""

import math
from collections import deque
from itertools import pairwise

from core.gait.foot import (
    CALM_FLOOR,
    CALM_M_S2,
    CALM_RAD_S,
    MIN_CALM_RATIO,
    MIN_HEEL_UP_RAD,
    MIN_SWING_M_S,
    MOVING_RAD_S,
)
from core.gait.strides import MAX_STRIDE_S
from core.samples import GRAVITY_M_S2, FloatArray

RESTLESS = (
    10.0  # in units of CALM squared; a foot on the floor moves less, unless its sensor sits loosely or it slides:
)
RESTLESS_RATIO, MAX_RESTLESS = 4.0, 150.0  # then less than so much the least of its last stances, at most
STANCES = 3  # that say so
SHOCK_RATIO = 6.0  # of what is rest: a landing counts no more, so that the foot is found calm soon after
CALM_DEPTH = math.log(MIN_CALM_RATIO)  # a stance is so much calmer than what is before and after it,
STEP_DEPTH = math.log(80.0)  # and than a step; feet that are moved about in the air reach 50
LIVELY = math.log(30.0)  # a foot that moves less has not left the floor
QUIET, QUIET_S = 1.5, 0.15  # a force of gravity's length for so long is gravity, wherever it points after a shock
CALM_S = 0.04  # over which that is averaged,
LEVELLING_S = 0.1  # in which a foot that lies calm shows the vertical,
STOPPING_S = 0.05  # and loses its speed
UPRIGHT_S = 5.0  # in which even a foot that never lies calm shows the vertical
FORGETTING_S = 20.0  # a strap slips; the axis follows
AXIS_WEIGHT = 10.0  # rad2/s of turning: a pitch axis that was given weighs as much as two steps
POWERS = 8  # the first time; afterwards one per sample follows
FIRST_VOTE = 0.5  # of the way of the first push-off: a step to the contrary turns the toes round, two once steps agreed
VOTE_MEMORY = 0.7  # of one step's word on where the toes are, in the next
VOTING_M_S = 2.0 * MIN_SWING_M_S  # a foot that was so fast has stepped
SURE_M_S = 2.0  # the word of a slower step weighs less
MIN_STEP_S = 0.3  # from stance to stance
ROLLING_RAD = 2.0 * MIN_HEEL_UP_RAD  # of one swing; of all, half of it is enough

Vector = tuple[float, float, float]
Travelled = list[tuple[float, Vector]]  # time and velocity
Moment = tuple[float, float, float, float, float, float]
Turning = tuple[Vector, Vector, float]  # since a stance: how far it turned, that summed over time, and for how long
NOT_AT_ALL: Vector = (0.0, 0.0, 0.0)
UNTURNED: Turning = (NOT_AT_ALL, NOT_AT_ALL, 0.0)


class LiveMotion:
    """One foot, in sensor axes.

    `pitch_axis`: turning about it lifts the toes; None before the first step.
    `speed_m_s`: zero while the foot lies calm.
    `calm_s`, `flat_s`: for how long it has been calm as on the floor, though it may roll slowly; and hardly turning
    besides.
    `travelled`: time and velocity from the moment the foot was no longer calm, on the sample when it is calm again;
    else empty.
    `has_turned_round`: on the sample that shows that the toes are on the other side than was thought.
    """

    def __init__(self, pitch_axis: FloatArray | None) -> None:
        x, y, z = (0.0, 0.0, 0.0) if pitch_axis is None else pitch_axis.tolist()
        w = AXIS_WEIGHT
        self._given: Moment = (w * x * x, w * y * y, w * z * z, w * x * y, w * x * z, w * y * z)
        self._moment = self._given
        self._votes = 0.0
        self._leasts: deque[float] = deque(maxlen=STANCES)
        self._limit = RESTLESS
        self.pitch_axis: Vector | None = None
        self._turning = self._calmest = UNTURNED
        self._fastest_m_s = 0.0
        self.start_again()

    def start_again(self) -> None:
        """After a gap the foot may be anywhere."""
        self._up: Vector | None = None
        self._restless = SHOCK_RATIO * self._limit
        self._unrest = self._most = math.log(self._restless)
        self._least: float | None = None  # in this stance; None in a swing
        self._fastest = NOT_AT_ALL, NOT_AT_ALL  # up and velocity when the foot was fastest
        self._left_s = -math.inf
        self._quiet_s = 0.0
        self._velocity = NOT_AT_ALL
        self._begin_step()
        self.has_turned_round = False
        self._way: Travelled = []
        self.travelled: Travelled = []
        self.speed_m_s = self.calm_s = self.flat_s = 0.0

    def add(self, now_s: float, step_s: float, gyr: Vector, acc: Vector, flat_rad_s: float) -> None:
        """Take one sample, `step_s` after the last: rate (rad/s) and specific force (m/s2) in sensor axes."""
        x, y, z = gyr
        fx, fy, fz = acc
        turning = x * x + y * y + z * z
        if turning > MOVING_RAD_S**2:
            self._learn(step_s, gyr)
        (tx, ty, tz), (sx, sy, sz), lasted_s = self._turning
        tx, ty, tz = tx + x * step_s, ty + y * step_s, tz + z * step_s
        self._turning = (tx, ty, tz), (sx + tx * step_s, sy + ty * step_s, sz + tz * step_s), lasted_s + step_s

        ux, uy, uz = self._up or acc
        ux, uy, uz = ux + (uy * z - uz * y) * step_s, uy + (uz * x - ux * z) * step_s, uz + (ux * y - uy * x) * step_s
        ax, ay, az = fx - ux, fy - uy, fz - uz
        too_long = math.sqrt(fx * fx + fy * fy + fz * fz) - GRAVITY_M_S2
        restless = turning / CALM_RAD_S**2 + too_long * too_long / CALM_M_S2**2
        self._quiet_s = self._quiet_s + step_s if restless < QUIET else 0.0
        if self._up is not None and self._quiet_s < QUIET_S:
            restless = turning / CALM_RAD_S**2 + (ax * ax + ay * ay + az * az) / CALM_M_S2**2
        share = step_s / (CALM_S + step_s)
        self._restless += share * (min(restless, SHOCK_RATIO * self._limit) - self._restless)
        self._unrest += share * (math.log(restless + CALM_FLOOR) - self._unrest)
        self.has_turned_round = False
        self._watch_stance()
        calm = max(0.0, 1.0 - self._restless / self._limit)
        self.calm_s = self.calm_s + step_s if calm > 0.0 else 0.0
        self.flat_s = self.flat_s + step_s if calm > 0.0 and turning < flat_rad_s**2 else 0.0
        self.travelled = []
        if self._up is None and calm == 0.0:
            return
        vx, vy, vz = self._velocity
        vx, vy, vz = (
            vx + (ax + vy * z - vz * y) * step_s,
            vy + (ay + vz * x - vx * z) * step_s,
            vz + (az + vx * y - vy * x) * step_s,
        )
        if calm > 0.0:
            kept = 1.0 - min(1.0, calm * step_s / STOPPING_S)
            vx, vy, vz = kept * vx, kept * vy, kept * vz
            self.travelled, self._way = self._way, []
            self._left_s = now_s
        elif now_s - self._left_s <= MAX_STRIDE_S:
            self._way.append((now_s, (vx, vy, vz)))
        else:
            self._way = []  # it shakes, it does not step
        self._velocity = vx, vy, vz
        self.speed_m_s = math.sqrt(vx * vx + vy * vy + vz * vz)
        if self.speed_m_s > self._fastest_m_s:
            self._fastest_m_s, self._fastest = self.speed_m_s, ((ux, uy, uz), self._velocity)
        still = max(0.0, 1.0 - self._restless / RESTLESS)  # a foot that slides shows more than gravity
        share = min(1.0, step_s * (still / LEVELLING_S + 1.0 / UPRIGHT_S))
        ux, uy, uz = ux + share * ax, uy + share * ay, uz + share * az
        longer = GRAVITY_M_S2 / max(math.sqrt(ux * ux + uy * uy + uz * uz), 1e-9)
        self._up = ux * longer, uy * longer, uz * longer

    def _watch_stance(self) -> None:
        """Find every stance by what is before and after it; the last ones say how calm the next is."""
        # as offline, but causally: a stance is over when the foot is MIN_CALM_RATIO livelier again
        if self._least is None:
            self._most = max(self._most, self._unrest)
            if self._unrest >= self._most - CALM_DEPTH:
                return
            self._least = math.inf
        if self._unrest < self._least:
            self._least, self._calmest = self._unrest, self._turning
        if self._unrest < max(self._least + CALM_DEPTH, LIVELY):
            return
        if self._most - self._least > STEP_DEPTH:
            self._leasts.append(math.exp(self._least))
            self._limit = min(max(RESTLESS, RESTLESS_RATIO * max(self._leasts)), MAX_RESTLESS)
        self._least, self._most = None, self._unrest
        self._vote(self._calmest)
        self._turning = _since(self._turning, self._calmest)

    def _learn(self, step_s: float, gyr: Vector) -> None:
        """The principal axis of all turning, by one step of the power method per sample."""
        x, y, z = gyr
        keep = 1.0 - step_s / FORGETTING_S
        xx, yy, zz, xy, xz, yz = self._moment
        self._moment = (
            keep * xx + x * x * step_s,
            keep * yy + y * y * step_s,
            keep * zz + z * z * step_s,
            keep * xy + x * y * step_s,
            keep * xz + x * z * step_s,
            keep * yz + y * z * step_s,
        )
        if self.pitch_axis is not None:
            self.pitch_axis = self._powered(self.pitch_axis)

    def _powered(self, axis: Vector) -> Vector:
        x, y, z = axis
        xx, yy, zz, xy, xz, yz = self._moment
        x, y, z = xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z
        length = math.sqrt(x * x + y * y + z * z)
        return (x / length, y / length, z / length) if length > 0.0 else axis

    def find_axis(self) -> Vector | None:
        """Of a foot that leaves the floor for the first time: it travels toes first, and has mostly lifted its heel."""
        if self.speed_m_s < MIN_SWING_M_S or not any(self._moment) or self._up is None:
            return None
        axis = self._turning[0]
        for _ in range(POWERS):
            axis = self._powered(axis)
        forward_m_s = dot(_cross(self._up, axis), self._velocity) / GRAVITY_M_S2
        is_agreed = dot(self._turning[0], axis) * forward_m_s < 0.0
        if not is_agreed and abs(forward_m_s) < MIN_SWING_M_S:
            return None
        x, y, z = axis
        self.pitch_axis = axis if forward_m_s > 0.0 else (-x, -y, -z)
        self._votes = FIRST_VOTE
        return self.pitch_axis

    def forget_axis(self) -> None:
        """The foot is calm again and has not stepped: what it did was not walking."""
        self.pitch_axis, self._moment = None, self._given
        self._begin_step()

    def rest(self) -> None:
        """The foot is flat: what it turns from here on is its next step."""
        self._vote(self._turning)
        self._begin_step()

    def _begin_step(self) -> None:
        self._turning = self._calmest = UNTURNED
        self._fastest_m_s = 0.0

    def _vote(self, step: Turning) -> None:
        """Where the last step has the toes: its swing was mostly toes down or, if it hardly rolled, toes first."""
        turned, tilted, lasted_s = step
        if self._fastest_m_s < VOTING_M_S or lasted_s < MIN_STEP_S or self.pitch_axis is None:
            return
        weight, self._fastest_m_s = min(1.0, self._fastest_m_s / SURE_M_S), 0.0
        # less what a rate that is off by a constant turns
        heel_up_rad = 0.5 * dot(turned, self.pitch_axis) - dot(tilted, self.pitch_axis) / lasted_s
        up, velocity = self._fastest
        toes_first = dot(_cross(up, self.pitch_axis), velocity)
        stated = heel_up_rad if abs(heel_up_rad) > ROLLING_RAD else toes_first
        self._votes = VOTE_MEMORY * self._votes + math.copysign(weight, stated)
        if self._votes < 0.0:
            x, y, z = self.pitch_axis
            self.pitch_axis, self._votes = (-x, -y, -z), -self._votes
            self.has_turned_round = True


def _since(turning: Turning, then: Turning) -> Turning:
    """How far the foot has turned since an instant, of how far it has now and had then."""
    ((tx, ty, tz), (sx, sy, sz), now_s), ((x, y, z), (px, py, pz), then_s) = turning, then
    s = now_s - then_s
    return (tx - x, ty - y, tz - z), (sx - px - x * s, sy - py - y * s, sz - pz - z * s), s


def speeds_of(travelled: Travelled) -> list[tuple[float, float]]:
    """Give times, s, and speeds, m/s, of a foot calm at the end, residual velocity removed evenly."""
    start_s, (end_s, (ex, ey, ez)) = travelled[0][0], travelled[-1]
    lasts_s = max(end_s - start_s, 1e-9)
    return [
        (t, math.hypot(x - share * ex, y - share * ey, z - share * ez))
        for t, (x, y, z) in travelled
        for share in ((t - start_s) / lasts_s,)
    ]


def way_of_m(travelled: Travelled) -> float:
    """Give how far, m over the floor, a foot that hardly turned went, calm at the end."""
    total = [0.0, 0.0, 0.0]
    for (a, v), (b, w) in pairwise(travelled):
        total = [s + 0.5 * (b - a) * (p + q) for s, p, q in zip(total, v, w, strict=True)]
    half_s = 0.5 * (travelled[-1][0] - travelled[0][0])
    return math.hypot(*(s - half_s * e for s, e in zip(total, travelled[-1][1], strict=True)))


def dot(a: Vector, b: Vector) -> float:
    """Compute the scalar product of two vectors of three plain floats."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
