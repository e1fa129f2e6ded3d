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
    """Rate, bias and kind of rate by the sensor's name; those that report no rate and are not received are left out.

    Parameters
    ----------
    rests
        Of the sensors that have lain still; the others are taken as without bias, which the orientation filter then
        finds by itself as far as it can.
    not_reported
        What the rates stand for where the sensor does not name it: what an analysis of the free motion has found.
    """
    found = {}
    for name in sensors:
        one = status.get(name)
        rate_hz = (one.details.rate_hz or one.received_hz) if one is not None else 0.0
        if one is not None and rate_hz > 0.0:
            bias = rests[name].gyr_rad_s if name in rests else np.zeros(3)
            found[name] = LiveSensor(rate_hz, bias, one.details.rate_kind or not_reported)
    return found
