"""Streams of an MTi as files: recorded ones, an emulated sensor's, and what is made where something was not sent."""

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from syrupy.assertion import SnapshotAssertion

from core.samples import RateKind
from devices.drivers.xbus import Item, Mid, item, message
from devices.files.formats import format_of
from devices.files.mti_streams import mti_trial
from devices.files.trial import ImportedSensor
from tests.devices.drivers.test_xsens_mti import golden_items, golden_numbers
from tests.swinging_sensor import swinging_sensor
from tests.trials_of_files import refused

Find = Callable[[str], Path]
HZ, COUNT = 100.0, 400
FREE, MATRIX = 0x4030, 0x2020


def stream(test_data: Find, number: int) -> Path:
    return test_data(f"vendor_streams/xsens_mti/einride_{number}_output.bin")


def golden(test_data: Find, number: int, required: str) -> list[list[float]]:
    """The values of one kind of item as another program read them."""
    text = test_data(f"vendor_streams/xsens_mti/einride_{number}_output.golden").read_text(encoding="utf-8")
    return [
        golden_numbers(required, reported)
        for items in golden_items(text)
        for name, reported in items
        if name.split("(")[0] == required
    ]


def one(path: Path, rate_hz: float | None = None) -> ImportedSensor:
    (sensor,) = mti_trial([path], rate_hz).sensors
    return sensor


def reals(identifier: int, *numbers: float) -> bytes:
    return item(identifier, struct.pack(f">{len(numbers)}f", *numbers))


def written(
    path: Path,
    *,
    kinds: frozenset[int],
    ticks: bool = True,
    first: int = 0,
    lost: int = -1,
    force_every: int = 1,
    scale: float = 1.0,
    count: int = COUNT,
) -> Path:
    """A swinging sensor's messages with items of these kinds, written without the reader's help.

    `force_every`: only every so-manieth message has the acceleration, multiplied by `scale`.
    """
    swing = swinging_sensor(count, HZ)
    data = message(Mid.DEVICE_ID + 1, bytes.fromhex("0123ABCD"))
    for k in range(count):
        if k == lost:
            continue
        q = swing.q_earth_from_sensor[k]
        turned = Rotation.from_quat(q, scalar_first=True)
        before = Rotation.from_quat(swing.q_earth_from_sensor[max(k - 1, 0)], scalar_first=True)
        felt = scale * swing.acc_m_s2[k]
        free = turned.apply(felt) - [0.0, 0.0, 9.81]
        content = item(Item.COUNTER, struct.pack(">H", (first + k) % 65536))
        if ticks:
            content += item(Item.FINE_TIME, struct.pack(">I", (first + 100 * k) % 2**32))
        parts = {
            Item.RATE: reals(Item.RATE, *swing.gyr_rad_s[k]),
            Item.ACCELERATION: reals(Item.ACCELERATION, *felt),
            Item.QUATERNION: reals(Item.QUATERNION, *q),
            Item.ROTATION_CHANGE: reals(Item.ROTATION_CHANGE, *(before.inv() * turned).as_quat(scalar_first=True)),
            Item.VELOCITY_CHANGE: reals(Item.VELOCITY_CHANGE, *(felt / HZ)),
            FREE: reals(FREE, *free),
            MATRIX: reals(MATRIX, *turned.as_matrix().T.ravel()),  # column after column
        }
        sent = kinds if k % force_every == 0 else kinds - {Item.ACCELERATION}
        data += message(Mid.MT_DATA2, content + b"".join(part for kind, part in parts.items() if kind in sent))
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_a_recorded_stream_is_recognised_and_read_as_by_another_program(test_data: Find, number: int) -> None:
    path = stream(test_data, number)
    assert format_of(path) == "xsens-mti"
    block = one(path).block
    force, rate = golden(test_data, number, "Acceleration"), golden(test_data, number, "RateOfTurn")
    assert block.acc_m_s2.tolist() == force
    assert block.gyr_rad_s.tolist() == rate
    assert len(block) == 96
    assert np.diff(block.time_s) == pytest.approx(0.01, abs=1e-9)


def test_free_acceleration_and_no_rates_are_made_good_by_the_orientation_and_stated(test_data: Find) -> None:
    """Of the fifth stream the orientation comes twice, as quaternion and as matrix."""
    sensor = one(stream(test_data, 5))
    assert {finding.key for finding in sensor.findings} == {"rate_from_orientation", "gravity_from_orientation"}
    assert sensor.block.is_rate_derived
    q = sensor.block.q_earth_from_sensor
    assert q is not None
    free = np.array(golden(test_data, 5, "FreeAcceleration"))
    up = Rotation.from_quat(q, scalar_first=True).apply(sensor.block.acc_m_s2)
    assert up - free == pytest.approx(np.tile([0.0, 0.0, 9.81], (len(free), 1)), abs=1e-4)
    matrices = np.array(golden(test_data, 5, "RotationMatrix")).reshape(-1, 3, 3)
    turned = Rotation.from_quat(q, scalar_first=True).as_matrix()
    assert turned == pytest.approx(matrices.transpose(0, 2, 1), abs=1e-4)


@pytest.mark.parametrize(
    ("kinds", "keys"),
    [
        ({Item.RATE, Item.ACCELERATION}, set()),
        ({Item.RATE, Item.ACCELERATION, Item.QUATERNION}, set()),
        ({Item.ROTATION_CHANGE, Item.VELOCITY_CHANGE}, set()),
        ({Item.QUATERNION, FREE}, {"rate_from_orientation", "gravity_from_orientation"}),
        ({MATRIX, FREE}, {"rate_from_orientation", "gravity_from_orientation"}),
        ({Item.RATE, MATRIX, FREE}, {"gravity_from_orientation"}),
    ],
)
def test_whatever_is_sent_the_same_motion_is_read(tmp_path: Path, kinds: set[int], keys: set[str]) -> None:
    sensor = one(written(tmp_path / "a.bin", kinds=frozenset(kinds)))
    truth, block = swinging_sensor(COUNT, HZ), sensor.block
    assert {finding.key for finding in sensor.findings} == keys
    assert (sensor.info.serial, block.sensor, sensor.info.rate_hz) == ("0123ABCD", "0123ABCD", 100.0)
    assert block.time_s == pytest.approx(np.arange(COUNT) / HZ, abs=1e-9)
    inner = slice(3, -3)
    assert block.acc_m_s2[inner] == pytest.approx(truth.acc_m_s2[inner], abs=1e-4)
    rate = truth.gyr_rad_s
    if Item.ROTATION_CHANGE in kinds:  # a mean over the interval before the stamp
        q = Rotation.from_quat(truth.q_earth_from_sensor, scalar_first=True)
        rate = np.vstack([np.zeros(3), (q[:-1].inv() * q[1:]).as_rotvec() * HZ])
    assert block.gyr_rad_s[inner] == pytest.approx(rate[inner], abs=0.02)
    derived = "rate_from_orientation" in keys
    assert sensor.info.rate_kind is (RateKind.INSTANTANEOUS if derived else RateKind.AVERAGED)


def test_clocks_turn_and_losses_are_gaps(tmp_path: Path) -> None:
    kinds = frozenset({Item.RATE, Item.ACCELERATION})
    block = one(written(tmp_path / "a.bin", kinds=kinds, first=2**32 - 5000, lost=200)).block
    assert len(block) == COUNT - 1
    assert np.diff(block.time_s)[[198, 199, 200]] == pytest.approx([0.01, 0.02, 0.01], abs=1e-9)
    counted = one(written(tmp_path / "b.bin", kinds=kinds, ticks=False, first=65_400, lost=200), 100.0).block
    assert counted.time_s == pytest.approx(block.time_s, abs=1e-9)


@pytest.mark.parametrize(("force_every", "kept", "keys"), [(1, COUNT, []), (4, COUNT // 4, ["slower_kept"])])
def test_rate_and_acceleration_at_unequal_rates_keep_the_slower_one_and_say_so(
    tmp_path: Path, force_every: int, kept: int, keys: list[str]
) -> None:
    kinds = frozenset({Item.RATE, Item.ACCELERATION})
    sensor = one(written(tmp_path / "a.bin", kinds=kinds, force_every=force_every))
    assert (len(sensor.block), sensor.info.rate_hz) == (kept, HZ / force_every)
    assert [finding.key for finding in sensor.findings] == keys
    for finding in sensor.findings:
        assert finding.numbers == {"kept": kept, "count": COUNT - kept}


def test_what_shows_no_motion_no_gravity_or_no_time_is_refused_with_what_to_set(
    tmp_path: Path, snapshot: SnapshotAssertion
) -> None:
    path, both = tmp_path / "a.bin", frozenset({Item.RATE, Item.ACCELERATION})
    silent = refused(mti_trial, [written(path, kinds=frozenset())])
    assert format_of(path) == "xsens-mti"
    old = tmp_path / "old.bin"
    old.write_bytes(message(0x32, bytes(50)) * 20)
    assert format_of(old) == "xsens-mti"
    assert {
        "force in g": refused(mti_trial, [written(path, kinds=both, scale=1 / 9.81)]),
        "force ten times as large": refused(mti_trial, [written(path, kinds=both, scale=9.81)]),
        "no time": refused(mti_trial, [written(path, kinds=both, ticks=False)]),
        "no motion": silent,
        "older messages": refused(mti_trial, [old]),
        "no gravity": refused(mti_trial, [written(path, kinds=frozenset({Item.RATE, FREE}))]),
    } == snapshot


def test_damage_is_passed_over_and_reported(tmp_path: Path) -> None:
    path = written(tmp_path / "a.bin", kinds=frozenset({Item.RATE, Item.ACCELERATION}))
    data = bytearray(path.read_bytes())
    data[5000:5010] = bytes(10)
    path.write_bytes(data)
    sensor = one(path)
    assert COUNT - 3 <= len(sensor.block) < COUNT
    assert [(finding.key, finding.numbers) for finding in sensor.findings] == [("damaged_stretches", {"count": 1})]


@pytest.mark.parametrize(("apart_ticks", "keys", "start_s"), [(1000, [], 0.1), (10_000_000, ["not_synchronised"], 0.0)])
def test_several_sensors_keep_their_own_clocks(
    tmp_path: Path, apart_ticks: int, keys: list[str], start_s: float
) -> None:
    """As they report them, where these can be of one trial; else each begins with the others, which is stated."""
    kinds = frozenset({Item.RATE, Item.ACCELERATION})
    paths = [written(tmp_path / f"{name}.bin", kinds=kinds, first=apart_ticks * k) for k, name in enumerate("ab")]
    first, second = mti_trial(paths).sensors
    assert [[finding.key for finding in sensor.findings] for sensor in (first, second)] == [keys] * 2
    assert (first.block.time_s[0], second.block.time_s[0]) == pytest.approx((0.0, start_s))
    assert first.info.clock
    assert second.info.clock


@pytest.mark.parametrize("data", [b"", b"\xfa\xff", b"time_s,acc_x\n1,2\n", bytes(5000), b"\xfa\xff6\x05hello" * 40])
def test_other_bytes_are_no_stream(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "other.bin"
    path.write_bytes(data)
    assert format_of(path) != "xsens-mti"
