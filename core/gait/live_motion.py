"""Pitch axis of a foot and its speed since it last stood, sample by sample, in any mounting.

What `core.gait.foot` does with a whole walk, causally. In plain floats: a sample costs some microseconds, an array of
three alone would cost more.
"""

import math
from itertools import pairwise

from core.gait.foot import CALM_M_S2, CALM_RAD_S, GRAVITY_M_S2, MIN_SWING_M_S, MOVING_RAD_S
from core.gait.strides import MAX_STRIDE_S
from core.samples import FloatArray

RESTLESS = 10.0  # in units of CALM squared; a foot on the floor moves less, unless its sensor sits very loosely
MAX_RESTLESS = 60.0  # a landing counts no more than this, so that the foot is found calm soon after
QUIET, QUIET_S = 1.5, 0.15  # a force of gravity's length for so long is gravity, wherever it points after a shock
CALM_S = 0.04  # over which that is averaged,
LEVELLING_S = 0.1  # in which a foot that lies calm shows the vertical,
STOPPING_S = 0.05  # and loses its speed
UPRIGHT_S = 5.0  # in which even a foot that never lies calm shows the vertical
FORGETTING_S = 20.0  # a strap slips; the axis follows
AXIS_WEIGHT = 10.0  # rad2/s of turning: a pitch axis that was given weighs as much as two steps
POWERS = 8  # the first time; afterwards one per sample follows
FIRST_VOTE = 1.5  # of the way of walking: two steps to the contrary turn the toes round
VOTE_MEMORY = 0.7  # of one step's word on where the toes are, in the next

Vector = tuple[float, float, float]
Travelled = list[tuple[float, Vector]]  # time and velocity
Moment = tuple[float, float, float, float, float, float]


class LiveMotion:
    """One foot, in sensor axes.

    Attributes
    ----------
    pitch_axis
        Turning about it lifts the toes; None before the first step.
    speed_m_s
        Zero while the foot lies calm.
    calm_s, flat_s
        For how long it has been calm as on the floor, though it may roll slowly; and hardly turning besides.
    travelled
        Time and velocity from the moment the foot was no longer calm, on the sample when it is calm again; else empty.
    """

    def __init__(self, pitch_axis: FloatArray | None) -> None:
        x, y, z = (0.0, 0.0, 0.0) if pitch_axis is None else pitch_axis.tolist()
        w = AXIS_WEIGHT
        self._given: Moment = (w * x * x, w * y * y, w * z * z, w * x * y, w * x * z, w * y * z)
        self._moment = self._given
        self._votes = 0.0
        self.pitch_axis: Vector | None = None
        self.start_anew()

    def start_anew(self) -> None:
        """After a gap the foot may be anywhere."""
        self._up: Vector | None = None
        self._restless = MAX_RESTLESS
        self._left_s = -math.inf
        self._quiet_s = 0.0
        self._velocity = self._turned = self._tilted = (0.0, 0.0, 0.0)
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
        tx, ty, tz = self._turned
        self._turned = tx, ty, tz = tx + x * step_s, ty + y * step_s, tz + z * step_s
        sx, sy, sz = self._tilted
        self._tilted = sx + tx * step_s, sy + ty * step_s, sz + tz * step_s

        ux, uy, uz = self._up or acc
        ux, uy, uz = ux + (uy * z - uz * y) * step_s, uy + (uz * x - ux * z) * step_s, uz + (ux * y - uy * x) * step_s
        ax, ay, az = fx - ux, fy - uy, fz - uz
        too_long = math.sqrt(fx * fx + fy * fy + fz * fz) - GRAVITY_M_S2
        restless = turning / CALM_RAD_S**2 + too_long * too_long / CALM_M_S2**2
        self._quiet_s = self._quiet_s + step_s if restless < QUIET else 0.0
        if self._up is not None and self._quiet_s < QUIET_S:
            restless = turning / CALM_RAD_S**2 + (ax * ax + ay * ay + az * az) / CALM_M_S2**2
        share = step_s / (CALM_S + step_s)
        self._restless += share * (min(restless, MAX_RESTLESS) - self._restless)
        calm = max(0.0, 1.0 - self._restless / RESTLESS)
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
        share = min(1.0, step_s * (calm / LEVELLING_S + 1.0 / UPRIGHT_S))
        ux, uy, uz = ux + share * ax, uy + share * ay, uz + share * az
        longer = GRAVITY_M_S2 / max(math.sqrt(ux * ux + uy * uy + uz * uz), 1e-9)
        self._up = ux * longer, uy * longer, uz * longer

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
        axis = self._turned
        for _ in range(POWERS):
            axis = self._powered(axis)
        forward_m_s = dot(_cross(self._up, axis), self._velocity) / GRAVITY_M_S2
        is_agreed = dot(self._turned, axis) * forward_m_s < 0.0
        if not is_agreed and abs(forward_m_s) < MIN_SWING_M_S:
            return None
        x, y, z = axis
        self.pitch_axis = axis if forward_m_s > 0.0 else (-x, -y, -z)
        self._votes = FIRST_VOTE
        return self.pitch_axis

    def forget_axis(self) -> None:
        """The foot is calm again and has not stepped: what it did was not walking."""
        self.pitch_axis, self._moment = None, self._given
        self._turned = self._tilted = (0.0, 0.0, 0.0)

    def begin_step(self, has_swung: bool) -> bool:
        """The foot is flat. Its last swing, toes mostly down, says where they are; True if that is turned round."""
        tilt = dot(self._tilted, self.pitch_axis) if self.pitch_axis is not None else 0.0
        self._turned = self._tilted = (0.0, 0.0, 0.0)
        if not has_swung or tilt == 0.0 or self.pitch_axis is None:
            return False
        self._votes = VOTE_MEMORY * self._votes - math.copysign(1.0, tilt)
        if self._votes >= 0.0:
            return False
        x, y, z = self.pitch_axis
        self.pitch_axis, self._votes = (-x, -y, -z), -self._votes
        return True


def speeds_of(travelled: Travelled) -> list[tuple[float, float]]:
    """Time and speed of a foot that is calm at the end: what velocity is left there has crept in evenly.

    Returns
    -------
    list
        Pairs of s and m/s.
    """
    start_s, (end_s, (ex, ey, ez)) = travelled[0][0], travelled[-1]
    lasts_s = max(end_s - start_s, 1e-9)
    return [
        (t, math.hypot(x - share * ex, y - share * ey, z - share * ez))
        for t, (x, y, z) in travelled
        for share in ((t - start_s) / lasts_s,)
    ]


def way_of_m(travelled: Travelled) -> float:
    """How far a foot went that hardly turned, and is calm at the end.

    Returns
    -------
    float
        m, over the floor.
    """
    total = [0.0, 0.0, 0.0]
    for (a, v), (b, w) in pairwise(travelled):
        total = [s + 0.5 * (b - a) * (p + q) for s, p, q in zip(total, v, w, strict=True)]
    half_s = 0.5 * (travelled[-1][0] - travelled[0][0])
    return math.hypot(*(s - half_s * e for s, e in zip(total, travelled[-1][1], strict=True)))


def dot(a: Vector, b: Vector) -> float:
    """Scalar product of two vectors of three plain floats.

    Returns
    -------
    float
        In the product of their units.
    """
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
