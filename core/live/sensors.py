"""All sensors of a patient, as their samples come in: even clocks, bias removed, orientations."""

from collections.abc import Mapping
from dataclasses import dataclass

from core.body import Site
from core.live.orientation import LiveOrientation, OrientedSamples
from core.live.streams import EvenStream
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
    """Streams and orientations of any number of sensors, each on its own clock and grid."""

    def __init__(self, sensors: Mapping[Site, LiveSensor]) -> None:
        self.sensors = dict(sensors)
        self._streams = {site: EvenStream(sensor.rate_hz) for site, sensor in sensors.items()}
        self._orientations = {
            site: LiveOrientation(sensor.gyro_bias_rad_s, sensor.rate_kind, sensor.step_s)
            for site, sensor in sensors.items()
        }

    def update(self, blocks: Mapping[Site, ImuBlock]) -> dict[Site, OrientedSamples]:
        """Take new samples of some or all sites; returns what they and those before them have settled.

        Raises
        ------
        KeyError
            A site that was not announced.
        """
        turned = {}
        for site, block in blocks.items():
            if len(block) == 0:
                continue
            stream = self._streams[site]
            stream.feed(block)
            even = stream.take()
            if len(even):
                turned[site] = self._orientations[site].update(even)
        return turned

    @property
    def late(self) -> dict[Site, int]:
        """Samples of each site that came too late, or twice, and were dropped."""
        return {site: stream.late for site, stream in self._streams.items()}
