"""A sensor that sends what no sensor of its maker sends: numbers beyond its memory, and notices without an end."""

import tracemalloc
from collections.abc import Callable

import pytest

from devices.dot.fetching import FetchedFile, Fetching
from devices.dot.memory import list_files, record, stop
from devices.dot.messages import RECORDING_GROUP, DotMessage, DotNotice, RecordedFile
from devices.dot.samples import RECORDED
from devices.dot.sensor import DotRefusedError, DotSensor
from devices.emulators.bluetooth import Notification
from devices.emulators.dot_faults import DotFaults
from tests.devices.dot.virtual_time import VirtualRadio
from tests.devices.dot.worn_dots import WornDots

UTC_S = 1_600_000_000
NOTICE = 0x7003


class StopPressedError(Exception):
    """Somebody pressed Stop."""


def nobody(*_: object) -> None:
    """Keep and show nothing."""


def recorded(radio: VirtualRadio, seconds: float = 1.0) -> tuple[WornDots, DotSensor, RecordedFile]:
    """A sensor with one file in its memory."""
    wearing = WornDots(radio, [DotFaults()])
    wearing.group.make_ready_to_record()
    (sensor,) = wearing.group.sensors
    radio.run(record([sensor], UTC_S, 120))
    radio.pass_s(seconds)
    radio.run(stop(sensor))
    (file,) = radio.run(list_files(sensor))
    return wearing, sensor, file


def send_too(
    wearing: WornDots, monkeypatch: pytest.MonkeyPatch, more: Callable[[list[Notification]], list[Notification]]
) -> None:
    (dot,) = wearing.dots
    due = dot.notifications
    monkeypatch.setattr(dot, "notifications", lambda: more(due()))


def data(number: int) -> Notification:
    content = bytes([DotNotice.DATA]) + number.to_bytes(4, "little") + bytes(RECORDED.size)
    return NOTICE, DotMessage(RECORDING_GROUP, content).packed()


def damaged(number: int) -> Notification:
    content = bytes([DotNotice.DATA_DAMAGED]) + number.to_bytes(4, "little")
    return NOTICE, DotMessage(RECORDING_GROUP, content).packed()


@pytest.mark.parametrize("number", [0xFFFFFFFE, 0xFFFFFFFF, 1 << 31, 4_000_000])
def test_a_number_beyond_any_memory_costs_no_memory_and_loses_no_sample(
    radio: VirtualRadio, monkeypatch: pytest.MonkeyPatch, number: int
) -> None:
    wearing, sensor, file = recorded(radio)
    sound: FetchedFile = radio.run(Fetching(sensor, file, nobody, nobody).fetch())
    sent = [data(number), damaged(number)]
    send_too(wearing, monkeypatch, lambda due: [*due, *(sent.pop() for _ in sent[:1] if due)])
    tracemalloc.start()
    fetched: FetchedFile = radio.run(Fetching(sensor, file, nobody, nobody).fetch())
    _, most_bytes = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert sent == []
    assert fetched == sound
    assert most_bytes < 20e6


def test_a_damaged_number_in_the_millions_costs_no_memory(radio: VirtualRadio, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is below what counts as beyond any memory: all before it is asked for, in vain."""
    wearing, sensor, file = recorded(radio)
    sent = [damaged(3_999_999)]
    send_too(wearing, monkeypatch, lambda due: [*due, *(sent.pop() for _ in sent[:1] if due)])
    tracemalloc.start()
    radio.run(Fetching(sensor, file, nobody, nobody).fetch())
    _, most_bytes = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert sent == []
    assert most_bytes < 20e6


def test_notices_that_never_end_do_not_hold_stop(radio: VirtualRadio, monkeypatch: pytest.MonkeyPatch) -> None:
    wearing, sensor, file = recorded(radio)
    send_too(wearing, monkeypatch, lambda due: [*due, damaged(0)])

    def stopped(fetched: int, _about: int) -> None:
        if fetched:
            raise StopPressedError

    began_s = radio.loop.time()
    with pytest.raises(StopPressedError):
        radio.run(Fetching(sensor, file, nobody, stopped).fetch())
    assert radio.loop.time() - began_s < 60.0


def test_a_sensor_that_only_talks_is_given_up(radio: VirtualRadio, monkeypatch: pytest.MonkeyPatch) -> None:
    wearing, sensor, file = recorded(radio)
    send_too(wearing, monkeypatch, lambda due: [damaged(0)])
    began_s = radio.loop.time()
    with pytest.raises(DotRefusedError, match="does not send"):
        radio.run(Fetching(sensor, file, nobody, nobody).fetch())
    assert radio.loop.time() - began_s < 600.0


def test_what_nobody_fetches_does_not_pile_up(radio: VirtualRadio, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("devices.dot.sensor.MOST_WAITING", 50)
    wearing, sensor, _ = recorded(radio)
    send_too(wearing, monkeypatch, lambda due: [*due, *[damaged(0)] * 1000])
    radio.pass_s(1.0)
    monkeypatch.undo()
    waiting = 0
    while radio.run(sensor.notice(0.5)):
        waiting += 1
    assert waiting <= 1050  # with what arrived while the first was waited for
