"""What is missing is counted as it comes; what comes late or twice is not shown, and is no loss."""

import numpy as np
import pytest

from app.acquisition.sensor_stream import SensorStatus, SensorStream
from core.samples import FloatArray, ImuBlock
from devices.live import SensorDetails
from devices.quiet import Quiet
from devices.source import SensorCounts


def hear(sensor: SensorStream, *numbers: float, rate: FloatArray | None = None) -> None:
    count = len(numbers)
    rate = np.ones((count, 3)) if rate is None else rate
    block = ImuBlock(sensor.name, np.array(numbers) / 100, rate, np.ones((count, 3)))
    sensor.hear(block, block.time_s, float(np.nanmax(block.time_s, initial=0.0)))


def status(sensor: SensorStream, now_s: float) -> SensorStatus:
    return sensor.status(0, SensorDetails(), now_s)


@pytest.mark.parametrize(
    ("arrived", "counts"),
    [
        ([(0, 1, 2), (3, 4)], SensorCounts(received=5)),
        ([(0, 1, 4), (5, 8)], SensorCounts(received=5, lost=4)),
        ([(0, 1.2, 1.9), (3.3,)], SensorCounts(received=4)),
        ([(0, 1, 3), (2, 4)], SensorCounts(received=5, lost=0, late=1)),
        ([(0, 3, 1, 2, 4)], SensorCounts(received=5, late=2)),
        ([(0, 1), (1, 2)], SensorCounts(received=3, doubled=1)),
        ([(0, 1, 1, 2)], SensorCounts(received=3, doubled=1)),
        ([(0, np.nan, 2)], SensorCounts(received=2, lost=1, damaged=1)),
        ([(np.nan,), (7,)], SensorCounts(received=1, damaged=1)),
    ],
)
def test_samples_are_counted_as_they_come(arrived: list[tuple[float, ...]], counts: SensorCounts) -> None:
    sensor = SensorStream("one", 100.0, 0.0)
    for numbers in arrived:
        hear(sensor, *numbers)
    assert status(sensor, 0.1).counts == counts
    shown = sensor.ring.newest(100).time_s
    assert np.all(np.diff(shown) > 0)
    assert len(shown) == counts.received - counts.late


def test_no_loss_is_reported_of_a_sensor_without_a_rate() -> None:
    sensor = SensorStream("one", None, 0.0)
    hear(sensor, 0, 5, 6)
    assert status(sensor, 0.1).counts == SensorCounts(received=3)


def test_a_sensor_that_falls_silent_is_reported() -> None:
    sensor = SensorStream("one", 100.0, 0.0)
    assert status(sensor, 0.4).silent_s == pytest.approx(0.4)
    hear(sensor, *range(300))
    assert status(sensor, 3.0).received_hz == pytest.approx(100.0)
    assert status(sensor, 4.0).received_hz == pytest.approx(50.0, abs=1.0)
    assert status(sensor, 9.0).received_hz == 0.0
    assert status(sensor, 9.0).silent_s == pytest.approx(9.0 - 2.99)


def test_movement_is_the_spread_of_the_rate_and_no_bias() -> None:
    sensor = SensorStream("one", 100.0, 0.0)
    rate = np.zeros((200, 3))
    rate[:, 1] = 5.0 + 2.0 * np.sqrt(2) * np.sin(np.arange(200) * 2 * np.pi / 50)
    rate[7] = np.nan
    hear(sensor, *range(200), rate=rate)
    assert status(sensor, 2.0).movement_rad_s == pytest.approx(2.0, rel=0.01)
    assert status(sensor, 9.0).movement_rad_s == 0.0


def test_the_share_of_what_is_lost() -> None:
    sensor = SensorStream("one", 100.0, 0.0)
    assert status(sensor, 0.0).lost_share == 0.0
    hear(sensor, 0, 1, 2, 4)
    assert status(sensor, 0.1).lost_share == pytest.approx(0.2)


@pytest.mark.parametrize(("is_again", "lost"), [(True, 0), (False, 997)])
def test_what_a_sensor_was_not_to_send_is_not_missing(is_again: bool, lost: int) -> None:
    sensor = SensorStream("one", 100.0, 0.0)
    hear(sensor, 0, 1, 2)
    if is_again:
        sensor.begin_again()
    hear(sensor, 1000, 1001)
    hear(sensor, 1003)
    assert sensor.lost == lost + 1


@pytest.mark.parametrize(("quiet", "silent_s"), [(Quiet.IN_MEMORY, 0.0), (None, 7.0)])
def test_one_that_is_to_send_nothing_is_not_silent(quiet: Quiet | None, silent_s: float) -> None:
    sensor = SensorStream("one", 100.0, 0.0)
    hear(sensor, 0, 1, 2)
    assert sensor.status(0, SensorDetails(quiet=quiet), 7.02).silent_s == pytest.approx(silent_s)
