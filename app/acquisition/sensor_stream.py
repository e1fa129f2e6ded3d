"""What was received from one sensor: its last seconds, and what is missing of them."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from app.acquisition.ring_buffer import RingBuffer
from core.samples import BoolArray, FloatArray, ImuBlock
from devices.live import SensorDetails
from devices.source import SensorCounts

KEPT_S = 30.0
MOST_RATE_HZ = 400.0  # of a sensor that does not report its rate
RECEIVED_S, MOVEMENT_S, LOST_S = 2.0, 1.0, 10
ROUNDING_S = 1e-6
ON_ITS_WAY_S = 0.25  # so much later than measured a sample may come before anything is missed


@dataclass(frozen=True, slots=True)
class SensorStatus:
    """How a sensor is doing."""

    sensor: str
    source: int  # index of its source
    details: SensorDetails
    received_hz: float  # samples per second over the last two
    silent_s: float  # since something came last; 0 of one that is to send nothing
    movement_rad_s: float  # spread of the angular rate over the last second, all axes together
    counts: SensorCounts  # since it was first received, as they came; a recording's own come from its journal
    lost_share: float  # of the last ten seconds: what the radio does now, not what was lost while the sensor was off


class SensorStream:
    """Not for two threads at once. All times in seconds on the acquisition's clock."""

    def __init__(self, name: str, rate_hz: float | None, now_s: float) -> None:
        self.name, self.rate_hz = name, rate_hz
        self.usual_hz = rate_hz or MOST_RATE_HZ
        self.ring = RingBuffer(name, round(KEPT_S * self.usual_hz))
        self._received_at_s = now_s
        self._received = self._lost = self._damaged = self._doubled = self._late = 0
        self._begins_again = False
        self._noted_s = now_s
        self._noted: deque[tuple[int, int]] = deque([(0, 0)], maxlen=LOST_S + 1)  # received and lost, second by second

    def hear(self, block: ImuBlock, time_s: FloatArray, now_s: float) -> None:
        """Take a block's samples, stamped `time_s` (n,); those that come late are counted, and not shown."""
        self._received_at_s = now_s
        if now_s - self._noted_s >= 1.0:
            self._noted_s = now_s
            self._noted.append((self._received, self._lost))
        last_s = self.ring.last_s
        step_s = _steps_s(time_s, last_s)
        if self._begins_again and (step_s > 0).all():
            self._begins_again, step_s[0] = False, 1.0 / self.usual_hz  # what lies between was not sent
        if not (step_s > 0).all():  # neither of NaN
            is_new = _is_later(time_s, last_s)
            self._count(_steps_s(time_s[is_new], last_s))
            self._count_others(time_s, is_new)
            self.ring.add(time_s[is_new], block.gyr_rad_s[is_new], block.acc_m_s2[is_new])
            return
        self._count(step_s)
        self.ring.add(time_s, block.gyr_rad_s, block.acc_m_s2)

    def begin_again(self) -> None:
        """What comes next does not follow what came before, and nothing between is missing."""
        self._begins_again = True

    @property
    def lost(self) -> int:
        """How many samples are missing since it was first received; none of a sensor whose rate is not known."""
        return self._lost

    def status(self, source: int, reported: SensorDetails, now_s: float) -> SensorStatus:
        return SensorStatus(
            sensor=self.name,
            source=source,
            details=reported,
            received_hz=self._received_hz(now_s),
            silent_s=self.silent_s(reported, now_s),
            movement_rad_s=self._movement_rad_s(now_s),
            counts=SensorCounts(self._received, self._lost, self._damaged, self._doubled, self._late),
            lost_share=self._lost_share(),
        )

    def silent_s(self, reported: SensorDetails, now_s: float) -> float:
        """Seconds since something came last; 0 of one that is to send nothing."""
        return max(now_s - self._received_at_s, 0.0) if reported.quiet is None else 0.0

    def _lost_share(self) -> float:
        received, lost = self._received - self._noted[0][0], max(self._lost - self._noted[0][1], 0)
        return lost / (received + lost) if received + lost else 0.0

    def _received_hz(self, now_s: float) -> float:
        last_s = self.ring.last_s
        end_s = last_s if now_s - last_s < ON_ITS_WAY_S else now_s
        return self.ring.count_since(end_s - RECEIVED_S + ROUNDING_S) / RECEIVED_S

    def _movement_rad_s(self, now_s: float) -> float:
        rate = self.ring.rates_since(now_s - MOVEMENT_S)
        if not np.isfinite(rate).all():
            rate = rate[np.isfinite(rate).all(axis=1)]
        if not len(rate):
            return 0.0
        about_mean = rate - rate.mean(axis=0)
        return float(np.sqrt(np.vdot(about_mean, about_mean) / len(rate)))  # `var` takes three times as long

    def _count(self, step_s: FloatArray) -> None:
        """Count samples that follow the ones before them by `step_s` (n,): a step of two intervals lost one."""
        self._received += len(step_s)
        if self.rate_hz is None or not len(step_s):
            return
        steps = step_s * self.rate_hz
        if steps.max() >= 1.5:
            missing = np.round(steps[np.isfinite(steps)]) - 1.0
            self._lost += int(missing[missing > 0].sum())

    def _count_others(self, time_s: FloatArray, is_new: BoolArray) -> None:
        """Count samples that are not later than all before them."""
        is_timed = np.isfinite(time_s)
        self._damaged += int(np.count_nonzero(~is_timed))
        known_s = np.concatenate([self.ring.since(-np.inf).time_s, time_s[is_new]])
        for stamp_s in time_s[is_timed & ~is_new]:
            if (known_s == stamp_s).any():
                self._doubled += 1
            else:
                self._late += 1
                self._received += 1
                self._lost = max(self._lost - 1, 0)  # it was taken for lost


def _steps_s(time_s: FloatArray, last_s: float) -> FloatArray:
    """From each sample (n,) to the one before, the first one's from `last_s`; `np.diff` takes five times as long."""
    step_s = time_s - last_s
    step_s[1:] = time_s[1:] - time_s[:-1]
    return step_s


def _is_later(time_s: FloatArray, last_s: float) -> BoolArray:
    """Which samples (n,) are later than `last_s` and all before them."""
    newest_s = np.fmax.accumulate(np.concatenate([[last_s], time_s]))
    later: BoolArray = time_s > newest_s[:-1]  # of NaN never
    return later
