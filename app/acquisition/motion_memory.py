"""Measurements of the sensors in the last half minute. For whatever looks at a whole motion again and again.

A look at six sensors takes a tenth of a second or two. It is taken in steps of some ten milliseconds, a few with every
update, so that what else the estimator's thread shows stays fresh.
"""

import math
from collections.abc import Callable, Generator, Iterable, Mapping

import numpy as np

from core.live.sensors import LiveSensor
from core.samples import FloatArray, ImuBlock, RateKind
from core.signal.orientation import oriented
from core.signal.pair import OrientedTrack
from core.signal.tracks import even_tracks

KEPT_S = 30.0
WAIT_S = 1.0  # for a sensor that is behind the others; longer, and it is left out
STEP_EVERY_S = 0.025  # of the stream, is a step of a look: the thirty of the longest take less than a second

Look = Callable[[float], Generator[None, None, None]]
"""Looks at what was measured before an instant, in steps."""


class MotionMemory:
    """Samples of each sensor by name, as they came. Looks are taken at instants of time, whatever the blocks were."""

    def __init__(self, sensors: Iterable[str]) -> None:
        self._blocks: dict[str, list[ImuBlock]] = {sensor: [] for sensor in sensors}

    def feed(self, blocks: Mapping[str, ImuBlock]) -> None:
        """Take new samples of some or all sensors; those of unknown ones are passed over."""
        for sensor, block in blocks.items():
            if len(block) and sensor in self._blocks:
                self._blocks[sensor].append(block)

    def has_passed(self, time_s: float) -> bool:
        """Whether all sensors that were ever received have reached an instant, or are more than WAIT_S behind."""
        received_s = [float(blocks[-1].time_s[-1]) for blocks in self._blocks.values() if blocks]
        return bool(received_s) and (min(received_s) >= time_s or max(received_s) >= time_s + WAIT_S)

    def forget_before(self, time_s: float) -> None:
        """Let go of blocks that end before an instant."""
        for sensor, blocks in self._blocks.items():
            if blocks and blocks[0].time_s[-1] < time_s:
                self._blocks[sensor] = [block for block in blocks if block.time_s[-1] >= time_s]

    def between(self, from_s: float, to_s: float) -> dict[str, ImuBlock]:
        """Samples of from..to, the end excluded, of each sensor that was received then."""
        parts = {sensor: _between(sensor, blocks, from_s, to_s) for sensor, blocks in self._blocks.items()}
        return {sensor: part for sensor, part in parts.items() if len(part)}


class Looks:
    """Looks at the memory every `every_s` of the stream, the first one `after_s` after the first sample."""

    def __init__(self, memory: MotionMemory, look: Look, every_s: float, after_s: float = 0.0) -> None:
        self._memory, self._look = memory, look
        self._every_s, self._after_s = every_s, after_s
        self._next_s: float | None = None
        self._going_on: Generator[None, None, None] | None = None
        self._steps = 0  # that the stream so far has allowed

    def update(self, blocks: Mapping[str, ImuBlock]) -> None:
        """Take new samples of some or all sensors, and as many steps as they allow."""
        received = [block for block in blocks.values() if len(block)]
        if not received:
            return
        self._memory.feed(blocks)
        if self._next_s is None:
            first_s = min(float(block.time_s[0]) for block in received)
            self._next_s = self._every_s * (math.floor((first_s + self._after_s) / self._every_s) + 1)
            self._steps = math.floor(first_s / STEP_EVERY_S)
        allowed = math.floor(max(float(block.time_s[-1]) for block in received) / STEP_EVERY_S)
        for _ in range(allowed - self._steps):
            if self._going_on is None and not self._memory.has_passed(self._next_s):
                break
            self._next_s = self._step(self._next_s)
        self._steps = max(self._steps, allowed)

    def _step(self, at_s: float) -> float:
        """The look at an instant goes on; returns which is next."""
        if self._going_on is None:
            self._going_on = self._look(at_s)
        try:
            next(self._going_on)
        except StopIteration:
            self._going_on = None
            self._memory.forget_before(at_s + self._every_s - KEPT_S)
            return at_s + self._every_s
        return at_s


def tracks_in_steps(
    blocks: Mapping[str, ImuBlock], sensors: Mapping[str, LiveSensor]
) -> Generator[None, None, dict[str, list[OrientedTrack]]]:
    """Oriented stretches of each block, with bias and kind of rate where `sensors` has them; a step for each."""
    tracks = {}
    for name, block in blocks.items():
        sensor = sensors.get(name)
        bias = np.zeros(3) if sensor is None else sensor.gyro_bias_rad_s
        kind = RateKind.INSTANTANEOUS if sensor is None else sensor.rate_kind
        tracks[name] = [oriented(track, kind, bias) for track in even_tracks(block)]
        yield
    return tracks


def _between(sensor: str, blocks: list[ImuBlock], from_s: float, to_s: float) -> ImuBlock:
    near = [block for block in blocks if block.time_s[-1] >= from_s and block.time_s[0] < to_s]
    time_s = _joined([block.time_s for block in near], (0,))
    part = slice(*np.searchsorted(time_s, [from_s, to_s]).tolist())
    gyr = _joined([block.gyr_rad_s for block in near], (0, 3))
    acc = _joined([block.acc_m_s2 for block in near], (0, 3))
    return ImuBlock(sensor, time_s[part], gyr[part], acc[part])


def _joined(parts: list[FloatArray], empty: tuple[int, ...]) -> FloatArray:
    return np.concatenate(parts) if parts else np.empty(empty)
