"""Tests that where no sensor answers, or one that cannot be used, the refusal states so and what to do."""

import pytest
from syrupy.assertion import SnapshotAssertion

from devices.drivers.csv_serial import Columns, CsvSerial
from devices.drivers.shimmer3 import Shimmer3
from devices.drivers.witmotion import WitMotion
from devices.drivers.ximu3 import Ximu3
from devices.drivers.xsens_mti import XsensMti
from devices.emulators.shimmer3 import Shimmer3Voice
from devices.emulators.witmotion import WitVoice
from devices.live import SourceRefusedError
from devices.stream import ByteSource, SensorProtocol
from tests.devices.scripted import ScriptedChannel

WAITS_S = {
    "csv_serial.STATES_S": 0.05,
    "shimmer3.ANSWERS_S": 0.01,
    "witmotion.ANSWERS_S": 0.01,
    "witmotion.STATES_S": 0.05,
    "ximu3.PING_S": 0.01,
    "xsens_mti.ANSWERS_S": 0.01,
}


def test_who_does_not_answer_or_cannot_be_used_is_refused_and_its_port_let_go(
    monkeypatch: pytest.MonkeyPatch, snapshot: SnapshotAssertion
) -> None:
    for name, wait_s in WAITS_S.items():
        monkeypatch.setattr(f"devices.drivers.{name}", wait_s)

    def of(protocol: SensorProtocol, channel: ScriptedChannel) -> str:
        with pytest.raises(SourceRefusedError) as refused:
            ByteSource(protocol, channel).open()
        assert not channel.is_open
        return str(refused.value)

    timeless = WitVoice("1", lambda _: (0.0, 0.0, 0.0, 0.0, 0.0, 1.0), content=0b1110)
    columns = Columns(0, (1, 2, 3), (4, 5, 6), count=7)
    bare = Shimmer3Voice(has_calibration=False)
    assert {
        "lines of something else": of(CsvSerial(columns), ScriptedChannel([b"hello\nhello\n"])),
        "Shimmer3, nothing": of(Shimmer3(), ScriptedChannel()),
        "Shimmer3 without calibration": of(Shimmer3(), ScriptedChannel(answers=bare.hear)),
        "WitMotion, something else": of(WitMotion(), ScriptedChannel([b"hello"])),
        "WitMotion without a time": of(WitMotion(), ScriptedChannel([timeless.sample(k) for k in range(200)])),
        "x-IMU3, something else": of(Ximu3(), ScriptedChannel([b"$GPGGA,1\r\n"])),
        "Xsens, nothing": of(XsensMti(), ScriptedChannel()),
    } == snapshot
