"""What did the sensors measure in the last half minute? For what looks at a whole motion again and again."""

from collections.abc import Iterable, Mapping

import numpy as np

from core.live.sensors import LiveSensor
from core.orientation import oriented
from core.placement.felt import Tracks
from core.samples import FloatArray, ImuBlock, RateKind
from core.tracks import even_tracks

KEPT_S = 30.0
WAIT_S = 1.0  # for a sensor that is behind the others; longer, and it is left out


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
        """Whether all sensors that were ever heard have reached an instant, or are more than WAIT_S behind."""
        heard_s = [float(blocks[-1].time_s[-1]) for blocks in self._blocks.values() if blocks]
        return bool(heard_s) and (min(heard_s) >= time_s or max(heard_s) >= time_s + WAIT_S)

    def forget_before(self, time_s: float) -> None:
        """Let go of blocks that end before an instant."""
        for sensor, blocks in self._blocks.items():
            if blocks and blocks[0].time_s[-1] < time_s:
                self._blocks[sensor] = [block for block in blocks if block.time_s[-1] >= time_s]

    def between(self, from_s: float, to_s: float) -> dict[str, ImuBlock]:
        """Samples of from..to, the end excluded, of each sensor that was heard then."""
        parts = {sensor: _between(sensor, blocks, from_s, to_s) for sensor, blocks in self._blocks.items()}
        return {sensor: part for sensor, part in parts.items() if len(part)}


def tracks_of(blocks: Mapping[str, ImuBlock], sensors: Mapping[str, LiveSensor]) -> Tracks:
    """Oriented stretches of each block, with bias and kind of rate where `sensors` tell."""
    tracks = {}
    for name, block in blocks.items():
        sensor = sensors.get(name)
        bias = np.zeros(3) if sensor is None else sensor.gyro_bias_rad_s
        kind = RateKind.INSTANTANEOUS if sensor is None else sensor.rate_kind
        tracks[name] = [oriented(track, kind, bias) for track in even_tracks(block)]
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
