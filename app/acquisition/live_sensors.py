"""Facts about the sensors that the live estimator needs before it can work on them."""

from collections.abc import Iterable, Mapping

import numpy as np

from app.acquisition.sensor_stream import SensorStatus
from core.calibration.rest import Rest
from core.live.sensors import LiveSensor
from core.samples import RateKind


def live_sensors(
    sensors: Iterable[str],
    rests: Mapping[str, Rest],
    status: Mapping[str, SensorStatus],
    not_reported: RateKind = RateKind.INSTANTANEOUS,
) -> dict[str, LiveSensor]:
    """Give rate, bias (0 without rest) and rate kind by sensor, omitting those with no rate known or received."""
    found = {}
    for name in sensors:
        one = status.get(name)
        rate_hz = (one.details.rate_hz or one.received_hz) if one is not None else 0.0
        if one is not None and rate_hz > 0.0:
            bias = rests[name].gyr_rad_s if name in rests else np.zeros(3)
            found[name] = LiveSensor(rate_hz, bias, one.details.rate_kind or not_reported)
    return found
