"""Check the contacts of a foot against the flexion of its own knee, live.

A walking knee bends once in every swing, and its foot lands once before it bends again. Where that does not hold, the
foot's events were lost or invented, and nothing counted from them means anything.
"""

import math
from collections import deque
from collections.abc import Iterable

import numpy as np

from core.gait.strides import MAX_STRIDE_S
from core.live.angle import AngleSamples

# The bend of loading reaches 20 degrees and a third of that of swing.
MIN_BEND_RAD, BEND_SHARE = np.deg2rad(25.0), 0.5
STEPS = 4  # from peak to peak; the last so many are looked at,
MOST_ODD = 1  # and so many may be odd: a shuffled step bends no knee


class KneeCheck:
    """One leg, fed angles and contacts as they come; both on one clock."""

    def __init__(self) -> None:
        self._contacts_s: deque[float] = deque(maxlen=32)
        self._odd_s: deque[float] = deque(maxlen=STEPS)  # when each step was over; NaN of one that was as it should be
        self._start_again()

    @property
    def is_doubtful(self) -> bool:
        """Whether of the last steps more than one had no contact, or several."""
        return len(self._odd()) > MOST_ODD

    @property
    def doubtful_from_s(self) -> float:
        """When the first of those steps was over; NaN while there is no doubt."""
        return self._odd()[0] if self.is_doubtful else math.nan

    def _odd(self) -> list[float]:
        return [time_s for time_s in self._odd_s if not math.isnan(time_s)]

    def update(self, knee: AngleSamples, contacts_s: Iterable[float]) -> None:
        """Take what is new of both."""
        self._contacts_s.extend(contacts_s)
        for time_s, angle_rad in zip(knee.time_s.tolist(), knee.angle_rad.tolist(), strict=True):
            if math.isnan(angle_rad):
                self._start_again()
            else:
                self._follow(time_s, angle_rad)

    def _start_again(self) -> None:
        """What the knee did meanwhile is not known."""
        self._odd_s.clear()
        self._highest, self._lowest = (-math.inf, -math.inf), math.inf
        self._bend_rad, self._is_bending = MIN_BEND_RAD, False
        self._last_s = -math.inf  # of the last peak of flexion

    def _follow(self, time_s: float, angle_rad: float) -> None:
        is_walking = time_s - self._last_s <= MAX_STRIDE_S
        if not is_walking:
            self._odd_s.clear()
        if self._is_bending:
            self._highest = max(self._highest, (angle_rad, time_s))
            if angle_rad < self._highest[0] - self._bend_rad:
                self._bent(self._highest[1])
                self._bend_rad = max(MIN_BEND_RAD, BEND_SHARE * (self._highest[0] - self._lowest))
                self._is_bending, self._lowest = False, angle_rad
            return
        self._lowest = min(self._lowest, angle_rad)
        if not is_walking:
            self._bend_rad = MIN_BEND_RAD
        if angle_rad > self._lowest + self._bend_rad:
            self._is_bending, self._highest = True, (angle_rad, time_s)

    def _bent(self, peak_s: float) -> None:
        if peak_s - self._last_s <= MAX_STRIDE_S:
            contacts = sum(self._last_s < contact_s <= peak_s for contact_s in self._contacts_s)
            self._odd_s.append(math.nan if contacts == 1 else peak_s)
        self._last_s = peak_s
