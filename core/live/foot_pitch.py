"""How a foot is pitched when it lands, live: its inclination from gravity against that of the stance before.

Nothing but the inclination of the sensor and the foot's pitch axis is needed, so neither the sensor's place on the foot
nor its heading matter. The inclination wanders by less than a degree from one stance to the contact that follows.
"""

import math
from collections import deque
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from core.gait.live import FootEvent, LiveEvent
from core.live.orientation import OrientedSamples, joined
from core.samples import FloatArray

KEPT_S = 5.0  # longer than the slowest stride, with the delay of its events
REST_S = 0.06  # of a stance: as long as a foot that is flat is flat at least (`LiveEventSettings.min_flat_s`)
MAX_STANCE_S = 2.5  # further back the patient stood
MAX_REST_RAD_S = 1.0  # a foot that never turns more slowly in a stance was not flat: its pitch has no zero


@dataclass(frozen=True, slots=True)
class FootStrike:
    """`pitch_rad` at the initial contact at `time_s`, toes up positive; `reported_s`: the sample that showed it."""

    time_s: float
    reported_s: float
    pitch_rad: float


class FootPitch:
    """The pitch of one foot at its initial contacts; a contact without a flat stance before it has none."""

    def __init__(self) -> None:
        self._parts: deque[tuple[FloatArray, OrientedSamples]] = deque()  # of the last seconds
        self._time_s: FloatArray = np.empty(0)  # as they were at the latest contact; so are the others
        self._up: FloatArray = np.empty((0, 3))
        self._speed2: FloatArray = np.empty(0)
        self._contact_s, self._off_s = -math.inf, math.nan

    def update(
        self, time_s: FloatArray, samples: OrientedSamples, events: Collection[LiveEvent], axis: FloatArray | None
    ) -> tuple[FootStrike, ...]:
        """Take new samples at `time_s` (n,), the events' clock; `axis` (3,) lifts the toes, None: unknown."""
        if len(time_s):
            self._parts.append((time_s, samples))
            while self._parts[0][0][-1] < time_s[-1] - KEPT_S:
                self._parts.popleft()
        if any(event.event is FootEvent.INITIAL_CONTACT for event in events):
            self._join()
        strikes = []
        for event in events:
            if event.event is FootEvent.TOE_OFF:
                self._off_s = event.time_s
            elif event.event is FootEvent.INITIAL_CONTACT:
                pitch_rad = None if axis is None else self._pitch_at(event.time_s, axis)
                if pitch_rad is not None:
                    strikes.append(FootStrike(event.time_s, event.reported_s, pitch_rad))
                self._contact_s, self._off_s = event.time_s, math.nan
        return tuple(strikes)

    def _join(self) -> None:
        """Put the parts together; with every block it took a twentieth of the live estimator's time."""
        if self._parts:
            self._time_s = np.concatenate([time_s for time_s, _ in self._parts])
            samples = joined([part for _, part in self._parts])
            self._up = _up_in_sensor(samples.q_earth_from_sensor)
            self._speed2 = np.sum(samples.gyr_rad_s**2, axis=1)

    def _pitch_at(self, contact_s: float, axis: FloatArray) -> float | None:
        rest = self._up_at_rest()
        if rest is None or not self._time_s[0] <= contact_s <= self._time_s[-1]:
            return None
        forward = np.cross(rest, axis)  # horizontal in that rest, towards the toes
        length = float(np.linalg.norm(forward))
        if length == 0.0:
            return None
        up = np.array([np.interp(contact_s, self._time_s, self._up[:, k]) for k in range(3)])
        sine = float(up @ forward) / (length * float(np.linalg.norm(up)))
        return math.asin(min(max(sine, -1.0), 1.0))

    def _up_at_rest(self) -> FloatArray | None:
        """Where up was (3,) in the quietest moment of the latest stance, in sensor axes."""
        if math.isnan(self._off_s):
            return None
        from_s = max(self._contact_s, self._off_s - MAX_STANCE_S)
        a, b = np.searchsorted(self._time_s, [from_s, self._off_s]).tolist()
        if b - a < 2:
            return None
        count = max(1, round(REST_S * (b - a - 1) / float(self._time_s[b - 1] - self._time_s[a])))
        if b - a < count:
            return None
        sums = np.concatenate([[0.0], np.cumsum(self._speed2[a:b])])
        means = (sums[count:] - sums[:-count]) / count
        quietest = int(np.argmin(means))
        if means[quietest] > MAX_REST_RAD_S**2:
            return None
        up = self._up[a + quietest : a + quietest + count].mean(axis=0)
        return np.asarray(up / np.linalg.norm(up))


def _up_in_sensor(q: FloatArray) -> FloatArray:
    """Earth's z (n, 3) in sensor axes, of orientations (n, 4) earth from sensor, scalar first."""
    w, x, y, z = q.T
    return np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1)
