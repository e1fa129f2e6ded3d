"""Tables of Consensys as public files show them: their heads, their units, their clocks, and what is refused."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from syrupy.assertion import SnapshotAssertion

from devices.files.formats import format_of
from devices.files.shimmer_tables import shimmer_trial
from tests.trials_of_files import refused

BEGIN_MS = 1_732_790_638_000.0
COUNT = 120
QUANTITIES = {
    "Timestamp_Unix": ("ms", ("",)),
    "TimestampSync_Unix": ("ms", ("",)),
    "Accel_LN": ("m/(s^2)", tuple("XYZ")),
    "Accel_WR": ("m/(s^2)", tuple("XYZ")),
    "Gyro": ("deg/s", tuple("XYZ")),
    "Mag": ("local_flux", tuple("XYZ")),
}


def written(
    path: Path,
    sensors: Sequence[str] = ("Shimmer_40AC",),
    required: Sequence[str] = ("Timestamp_Unix", "Accel_WR", "Gyro"),
    *,
    delimiter: str = ",",
    has_sep: bool = True,
    units: dict[str, str] | None = None,
    later_ms: float = 0.0,
    lost: int = -1,
    kind: str = "CAL",
    count: int = COUNT,
) -> Path:
    names, reported = [], []
    scale = 9.80665 if (units or {}).get("Accel_WR") == "g" else 1.0
    for sensor in sensors:
        for what in required:
            unit, axes = QUANTITIES[what]
            names += [f"{sensor}_{what}{'_' * bool(axis)}{axis}_{kind}" for axis in axes]
            reported += [(units or {}).get(what, unit)] * len(axes)
    lines = [f'"sep={delimiter}"'] if has_sep else []
    lines += [delimiter.join([*names, ""]), delimiter.join([*reported, ""])]
    for k in range(count):
        if k == lost:
            continue
        cells: list[str] = []
        for s in range(len(sensors)):
            for what in required:
                if what.startswith("Timestamp"):
                    cells.append(repr(BEGIN_MS + later_ms + 10.0 * k))
                elif what == "Gyro":
                    cells += [repr(float(value)) for value in (10.0 * s, -20.0, 0.5 * k)]
                elif what == "Accel_LN":
                    cells += ["1.0", "2.0", "9.0"]
                else:
                    cells += [repr(value / scale) for value in (0.5, -0.25, 9.8 + 0.001 * k)]
        lines.append(delimiter.join([*cells, ""]))
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    return path


@pytest.mark.parametrize("delimiter", [",", "\t", ";"])
@pytest.mark.parametrize("has_sep", [True, False])
def test_a_table_is_recognised_and_read(tmp_path: Path, delimiter: str, has_sep: bool) -> None:
    path = written(tmp_path / "walk.csv", delimiter=delimiter, has_sep=has_sep)
    assert format_of(path) == "shimmer"
    (sensor,) = shimmer_trial([path]).sensors
    assert (sensor.name, sensor.ids, sensor.info.rate_hz) == ("Shimmer_40AC", ("40AC",), 100.0)
    assert sensor.block.time_s == pytest.approx(np.arange(COUNT) / 100, abs=1e-6)
    assert sensor.block.gyr_rad_s[:, 2] == pytest.approx(np.radians(0.5 * np.arange(COUNT)))
    assert sensor.block.acc_m_s2[:, 2] == pytest.approx(9.8 + 0.001 * np.arange(COUNT))
    assert sensor.findings == ()


def test_the_wide_accelerometer_is_taken_and_the_narrow_one_where_there_is_no_other(tmp_path: Path) -> None:
    both = written(tmp_path / "a.csv", required=("Timestamp_Unix", "Accel_LN", "Accel_WR", "Gyro", "Mag"))
    (sensor,) = shimmer_trial([both]).sensors
    assert sensor.block.acc_m_s2[0].tolist() == [0.5, -0.25, 9.8]
    assert sensor.block.mag is not None
    narrow = written(tmp_path / "b.csv", required=("Timestamp_Unix", "Accel_LN", "Gyro"))
    assert shimmer_trial([narrow]).sensors[0].block.acc_m_s2[0].tolist() == [1.0, 2.0, 9.0]


def test_units_are_those_that_are_reported(tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv", units={"Gyro": "rad/s", "Accel_WR": "g"})
    (sensor,) = shimmer_trial([path]).sensors
    assert sensor.block.gyr_rad_s[0].tolist() == [0.0, -20.0, 0.0]
    assert sensor.block.acc_m_s2[0] == pytest.approx([0.5, -0.25, 9.8])


def test_sensors_that_the_base_synchronised_share_a_clock(tmp_path: Path) -> None:
    required = ("TimestampSync_Unix", "Accel_WR", "Gyro")
    paths = [written(tmp_path / f"{k}.csv", (f"S_{k}",), required, later_ms=250.0 * k) for k in range(2)]
    first, second = shimmer_trial(paths).sensors
    assert first.info.clock == second.info.clock == "Consensys"
    assert (first.block.time_s[0], second.block.time_s[0]) == pytest.approx((0.0, 0.25), abs=1e-6)


@pytest.mark.parametrize(("later_ms", "keys", "start_s"), [(250.0, [], 0.25), (3.6e6, ["not_synchronised"], 0.0)])
def test_sensors_that_it_did_not_keep_their_own(
    tmp_path: Path, later_ms: float, keys: list[str], start_s: float
) -> None:
    paths = [written(tmp_path / f"{k}.csv", (f"S_{k}",), later_ms=later_ms * k) for k in range(2)]
    first, second = shimmer_trial(paths).sensors
    assert (first.info.clock, second.info.clock) == ("S_0", "S_1")
    assert second.block.time_s[0] == pytest.approx(start_s, abs=1e-6)
    assert [finding.key for finding in second.findings] == keys


def test_several_sensors_may_stand_side_by_side_and_losses_are_gaps(tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv", ("S_Thigh", "S_Shank"), lost=40)
    thigh, shank = shimmer_trial([path]).sensors
    assert (thigh.name, shank.name) == ("S_Thigh", "S_Shank")
    assert shank.block.gyr_rad_s[0, 0] == pytest.approx(np.radians(10.0))
    assert np.diff(shank.block.time_s).max() == pytest.approx(0.02, abs=1e-6)


def test_what_is_not_calibrated_or_in_another_unit_is_refused(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    path = written(tmp_path / "a.csv")
    text = path.read_text(encoding="utf-8")

    def of(text: str) -> str:
        path.write_text(text, encoding="utf-8")
        return refused(shimmer_trial, [path])

    raw = written(tmp_path / "b.csv", kind="RAW")
    assert format_of(raw) == "shimmer"
    assert {
        "not calibrated": refused(shimmer_trial, [raw]),
        "no acceleration": refused(shimmer_trial, [written(path, required=("Timestamp_Unix", "Gyro"))]),
        "times in s": refused(shimmer_trial, [written(path, units={"Timestamp_Unix": "s"})]),
        "an unknown unit": refused(shimmer_trial, [written(path, units={"Gyro": "furlongs"})]),
        "called g, and m/s2": of(text.replace("m/(s^2)", "g")),
        "called rad/s, and deg/s": of(text.replace("deg/s", "rad/s").replace("-20.0", "-200.0")),
    } == snapshot
