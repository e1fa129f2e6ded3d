"""All sensors of a patient, as their samples come in: even clocks, bias removed, orientations."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from core.body import Site
from core.live.bias import BiasCorrection, BiasWatch
from core.live.orientation import LiveOrientation, OrientedSamples, joined
from core.live.streams import EvenSamples, EvenStream
from core.samples import FloatArray, ImuBlock, RateKind


@dataclass(frozen=True, slots=True)
class LiveSensor:
    """What has to be known of a sensor before its samples come. `gyro_bias_rad_s` (3,): from standing."""

    rate_hz: float
    gyro_bias_rad_s: FloatArray
    rate_kind: RateKind = RateKind.INSTANTANEOUS

    @property
    def step_s(self) -> float:
        """Seconds between two samples."""
        return 1.0 / self.rate_hz


class LiveSensors:
    """Streams and orientations of any number of sensors, each on its own clock and grid.

    `corrections`: of biases that the first rest has contradicted, in the order of finding.
    """

    def __init__(self, sensors: Mapping[Site, LiveSensor]) -> None:
        self.sensors = dict(sensors)
        self._streams = {site: EvenStream(sensor.rate_hz) for site, sensor in sensors.items()}
        self._orientations = {
            site: LiveOrientation(sensor.gyro_bias_rad_s, sensor.rate_kind, sensor.step_s)
            for site, sensor in sensors.items()
        }
        self._watches = {site: BiasWatch(sensor.gyro_bias_rad_s, sensor.step_s) for site, sensor in sensors.items()}
        self.corrections: tuple[BiasCorrection, ...] = ()

    def update(self, blocks: Mapping[Site, ImuBlock]) -> dict[Site, OrientedSamples]:
        """Take new samples of some or all sites; give what is settled. KeyError for a site not announced."""
        turned = {}
        for site, block in blocks.items():
            if len(block) == 0:
                continue
            stream = self._streams[site]
            stream.feed(block)
            even = stream.take()
            if len(even):
                turned[site] = self._turned(site, even)
        return turned

    def _turned(self, site: Site, even: EvenSamples) -> OrientedSamples:
        """Orient samples of a sensor; until its first rest, see whether its bias holds."""
        orientation, watch = self._orientations[site], self._watches[site]
        parts = []
        while len(even) and not watch.is_done:
            count = watch.reach(even)
            part, even = even.part(slice(0, count)), even.part(slice(count, None))
            parts.append(orientation.update(part))
            rest = watch.update(part)
            if rest is not None:
                bias_rad_s = rest.gyr_rad_s.mean(axis=0)
                off_rad_s = float(np.linalg.norm(bias_rad_s - self.sensors[site].gyro_bias_rad_s))
                self.corrections += (BiasCorrection(site, float(part.time_s[-1]), off_rad_s),)
                orientation.begin_again(bias_rad_s, rest)
        return joined([*parts, orientation.update(even)]) if len(even) else joined(parts)

    @property
    def late(self) -> dict[Site, int]:
        """Samples of each site that came too late, or twice, and were dropped."""
        return {site: stream.late for site, stream in self._streams.items()}
