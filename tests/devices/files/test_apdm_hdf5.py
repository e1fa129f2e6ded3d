"""Tests that APDM's HDF5 files, laid out as APDM describes, become the samples that were put into them.

No file of APDM's programs is at hand: the samples are those of a CSV export, the layout is the published one.
"""

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray
from syrupy.assertion import SnapshotAssertion

from core.body import Site
from core.samples import RateKind
from devices.files import hdf5
from devices.files.apdm import apdm_trial
from devices.files.formats import recognised
from tests.trials_of_files import import_with, refused

FindData = Callable[[str], Path]
Samples = dict[str, NDArray[np.float64]]
START_US = 1_550_879_504_438_281


def still(rows: int = 40, acc: float = 9.81, rate: float = 0.1) -> Samples:
    return {
        "Accelerometer": np.tile((0.0, 0.0, acc), (rows, 1)),
        "Gyroscope": np.tile((rate, 0.0, 0.0), (rows, 1)),
        "Magnetometer": np.tile((20.0, 0.0, 40.0), (rows, 1)),
        "Orientation": np.tile((1.0, 0.0, 0.0, 0.0), (rows, 1)),
    }


def stamps(rows: int = 40) -> NDArray[np.uint64]:
    return (START_US + np.round(1e6 / 128 * np.arange(rows))).astype(np.uint64)


def version_5(
    path: Path,
    sensors: dict[str, tuple[str, NDArray[np.uint64], Samples]],
    version: int = 5,
    *,
    is_packed: bool = False,
) -> Path:
    """Mobility Lab 2 and Moveo: a group per sensor number, its label among its configuration."""
    packing: dict[str, Any] = {"chunks": (8, 1), "compression": "gzip"} if is_packed else {}
    with h5py.File(path, "w") as file:
        file.attrs["FileFormatVersion"] = version
        for number, (label, time, samples) in sensors.items():
            group = file.create_group(f"Sensors/{number}")
            configuration = group.create_group("Configuration")
            configuration.attrs["Label 0"] = np.bytes_(label + "\0\0")
            configuration.attrs["Sample Rate"] = np.uint32(128)
            group["Time"] = time
            for name, values in samples.items():
                place = f"Processed/{number}/{name}" if name == "Orientation" else f"Sensors/{number}/{name}"
                file.create_dataset(place, data=values, **packing)
    return path


def version_4(path: Path, version: int = 4) -> Path:
    """Motion Studio: lists of case ids and labels, calibrated values under the case id."""
    names = {"Accelerometer": "Accelerometers", "Gyroscope": "Gyroscopes", "Magnetometer": "Magnetometers"}
    with h5py.File(path, "w") as file:
        file.attrs["FileFormatVersion"] = version
        file.attrs["CaseIdList"] = np.array([b"SI-000111", b"SI-000112"], dtype="S20")
        file.attrs["MonitorLabelList"] = np.array([b"Left Shank", b"Left Foot"], dtype="S32")
        for number, case in enumerate(("SI-000111", "SI-000112")):
            group = file.create_group(case)
            group.attrs["SampleRate"] = 128
            group["Time"] = stamps()
            for name, values in still(rate=0.1 + number).items():
                group[f"Calibrated/{names.get(name, name)}"] = values
    return path


def refusal(path: Path) -> str:
    return refused(apdm_trial, [path])


def test_samples_of_an_export_come_back_from_hdf5(test_data: FindData, tmp_path: Path) -> None:
    with test_data("vendor_exports/apdm/imuData01.csv").open(encoding="utf-8-sig", newline="") as file:
        cells = list(csv.reader(file))
    at = cells[2].index("Upper/Acceleration/X")
    rows = np.array([[float(cell) for cell in line[at : at + 13]] for line in cells[4:]])
    samples = {
        "Accelerometer": rows[:, 0:3],
        "Gyroscope": rows[:, 3:6],
        "Magnetometer": rows[:, 6:9],
        "Orientation": rows[:, 9:13],
    }
    path = version_5(tmp_path / "a.h5", {"1262": ("Upper", stamps(len(rows)), samples)})
    imported = import_with(apdm_trial, [path], {Site.LEFT_THIGH: "upper"}, "walk 1")
    block, info = imported.imu[Site.LEFT_THIGH], imported.sensors[Site.LEFT_THIGH]
    assert np.array_equal(block.acc_m_s2, rows[:, 0:3])
    assert np.array_equal(block.gyr_rad_s, rows[:, 3:6])
    assert block.mag is not None
    assert np.array_equal(block.mag, rows[:, 6:9])
    assert block.q_earth_from_sensor is not None
    np.testing.assert_allclose(block.q_earth_from_sensor, rows[:, 9:13], atol=1e-6)
    np.testing.assert_allclose(block.time_s, np.arange(len(rows)) / 128.0, atol=1e-6)
    assert (info.serial, info.rate_hz, info.rate_kind) == ("1262", 128.0, RateKind.INSTANTANEOUS)


def test_packed_values_are_the_same(tmp_path: Path) -> None:
    sensors = {"1": ("A", stamps(), still())}
    plain, packed = (
        apdm_trial([version_5(tmp_path / f"{is_packed}.h5", sensors, is_packed=is_packed)]).sensors[0].block
        for is_packed in (False, True)
    )
    assert np.array_equal(plain.acc_m_s2, packed.acc_m_s2)
    assert np.array_equal(plain.time_s, packed.time_s)


@pytest.mark.parametrize("version", [3, 4])
def test_the_older_layout_is_read_by_label_case_and_number(tmp_path: Path, version: int) -> None:
    path = version_4(tmp_path / "a.h5", version)
    assert recognised([path]) == "apdm"
    placement = {Site.LEFT_SHANK: "left shank", Site.LEFT_FOOT: "112"}
    imported = import_with(apdm_trial, [path], placement, "walk 1")
    assert imported.imu[Site.LEFT_SHANK].gyr_rad_s[0].tolist() == [0.1, 0.0, 0.0]
    assert imported.imu[Site.LEFT_FOOT].gyr_rad_s[0].tolist() == [1.1, 0.0, 0.0]
    assert imported.sensors[Site.LEFT_FOOT].serial == "112"
    again = import_with(apdm_trial, [path], {Site.LEFT_FOOT: "SI-000112"}, "walk 1")
    assert {finding.numbers["name"] for finding in again.findings} == {"Left Shank"}


def test_lost_samples_are_gaps_and_doubled_stamps_a_finding(tmp_path: Path) -> None:
    time = stamps()
    lost = np.delete(np.arange(40), [10, 11, 12])
    late = time.copy()
    late[20] = late[19]
    path = version_5(
        tmp_path / "a.h5",
        {
            "1": ("Left Shank", time[lost], {name: values[lost] for name, values in still().items()}),
            "2": ("Left Foot", late, still()),
        },
    )
    imported = import_with(apdm_trial, [path], {Site.LEFT_SHANK: "1", Site.LEFT_FOOT: "2"}, "walk 1")
    steps = np.diff(imported.imu[Site.LEFT_SHANK].time_s) * 128.0
    assert len(imported.imu[Site.LEFT_SHANK]) == 37
    assert steps[9] == pytest.approx(4.0, abs=1e-3)
    assert len(imported.imu[Site.LEFT_FOOT]) == 39
    assert [(finding.key, finding.where) for finding in imported.findings] == [("doubled_stamps", "walk 1, left_foot")]


def test_sensors_that_began_later_keep_their_place_in_time(tmp_path: Path) -> None:
    sensors = {"1": ("A", stamps(), still()), "2": ("B", stamps() + np.uint64(50_000), still())}
    imported = import_with(
        apdm_trial, [version_5(tmp_path / "a.h5", sensors)], {Site.LEFT_SHANK: "A", Site.LEFT_FOOT: "B"}, "walk 1"
    )
    assert imported.imu[Site.LEFT_SHANK].time_s[0] == 0.0
    assert imported.imu[Site.LEFT_FOOT].time_s[0] == pytest.approx(0.05)


def test_orientations_of_zeros_are_none(tmp_path: Path) -> None:
    samples = still()
    samples["Orientation"][3] = 0.0
    path = version_5(tmp_path / "a.h5", {"1": ("A", stamps(), samples)})
    block = import_with(apdm_trial, [path], {Site.LEFT_SHANK: "A"}, "walk 1").imu[Site.LEFT_SHANK]
    assert block.q_earth_from_sensor is not None
    assert np.flatnonzero(np.isnan(block.q_earth_from_sensor[:, 0])).tolist() == [3]


def test_other_units_and_what_is_missing_are_refused(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    def of(samples: Samples, time: NDArray[np.uint64] | None = None) -> str:
        sensors = {"1": ("A", stamps() if time is None else time, samples)}
        return refusal(version_5(tmp_path / "a.h5", sensors))

    reported = version_5(tmp_path / "b.h5", {"1": ("A", stamps(), still())})
    with h5py.File(reported, "r+") as file:
        file["Sensors/1/Accelerometer"].attrs["Units"] = "g"
    back = stamps()
    back[20:] -= 1_000_000
    assert {
        "force in g": of(still(acc=1.0)),
        "rates in deg/s": of(still(rate=180.0)),
        "another unit is reported": refusal(reported),
        "no rates": of({name: values for name, values in still().items() if name != "Gyroscope"}),
        "a sample too few": of({**still(), "Accelerometer": np.ones((39, 3))}),
        "times that go back": of(still(), back),
        "an older version": refusal(version_4(tmp_path / "a.h5", 2)),
        "no sensors": refusal(version_5(tmp_path / "a.h5", {})),
    } == snapshot
    reported.write_bytes(reported.read_bytes()[: reported.stat().st_size // 2])
    assert "b.h5: the file cannot be read as HDF5" in refusal(reported)


def test_values_that_stand_in_another_file_are_not_read(tmp_path: Path) -> None:
    version_5(tmp_path / "other.h5", {"1": ("A", stamps(), still())})
    linked = version_5(tmp_path / "a.h5", {"1": ("A", stamps(), still())})
    with h5py.File(linked, "r+") as file:
        del file["Sensors/1/Gyroscope"]
        file["Sensors/1/Gyroscope"] = h5py.ExternalLink("other.h5", "/Sensors/1/Gyroscope")
    assert 'a.h5: "Sensors/1/Gyroscope" is stored in another file' in refusal(linked)
    (tmp_path / "secret").write_bytes(bytes(40 * 3 * 8))
    stored = version_5(tmp_path / "b.h5", {"1": ("A", stamps(), still())})
    with h5py.File(stored, "r+") as file:
        del file["Sensors/1/Gyroscope"]
        place = [(str(tmp_path / "secret"), 0, h5py.h5f.UNLIMITED)]
        file.create_dataset("Sensors/1/Gyroscope", (40, 3), dtype="f8", external=place)
    assert 'the values of "Sensors/1/Gyroscope" are stored in another file' in refusal(stored)


def test_other_hdf5_is_not_taken_for_it(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["Sensors/1/Accelerometer"] = np.ones((3, 3))
    assert "the file format is not recognised" in refused(recognised, [tmp_path / "a.h5"])


def test_without_its_library_it_states_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = version_5(tmp_path / "a.h5", {"1": ("A", stamps(), still())})
    monkeypatch.setattr(hdf5, "LIBRARY", "h5py_that_is_not_there")
    assert "h5py_that_is_not_there, which is not installed. Install gaitwright[imports]" in refusal(path)
