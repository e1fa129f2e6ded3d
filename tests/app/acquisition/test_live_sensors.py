"""What the estimator is given of the sensors."""

import numpy as np
import pytest

from app.acquisition.live_sensors import live_sensors
from app.acquisition.sensor_stream import SensorStatus
from core.calibration.rest import Rest
from core.samples import RateKind
from devices.live import SensorDetails
from devices.source import SensorCounts

REST = Rest(np.array([0.01, -0.02, 0.005]), np.array([0.0, 0.0, 9.8]), 3.0)


def status(name: str, reported: SensorDetails, received_hz: float = 99.5) -> SensorStatus:
    return SensorStatus(name, 0, reported, received_hz, 0.0, 0.0, SensorCounts(), 0.0)


def test_what_a_sensor_shows_goes_before_what_is_received() -> None:
    reported = SensorDetails(rate_hz=100.0, rate_kind=RateKind.AVERAGED)
    found = live_sensors(["A"], {"A": REST}, {"A": status("A", reported)})["A"]
    assert (found.rate_hz, found.rate_kind) == (100.0, RateKind.AVERAGED)
    assert found.gyro_bias_rad_s is REST.gyr_rad_s


@pytest.mark.parametrize("not_reported", list(RateKind))
def test_one_that_shows_nothing_is_taken_as_it_is_received(not_reported: RateKind) -> None:
    found = live_sensors(["A"], {}, {"A": status("A", SensorDetails())}, not_reported)["A"]
    assert (found.rate_hz, found.rate_kind) == (99.5, not_reported)
    assert not found.gyro_bias_rad_s.any()


def test_one_of_no_known_rate_is_left_out() -> None:
    not_received = status("B", SensorDetails(), received_hz=0.0)
    assert live_sensors(["A", "B"], {}, {"B": not_received}) == {}
