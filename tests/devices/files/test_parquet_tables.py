"""Tests that Parquet tables of any program become samples by the same rules as CSV."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray
from syrupy.assertion import SnapshotAssertion

from core.body import Site
from devices.files.formats import recognised
from devices.files.parquet_tables import parquet_trial
from tests.trials_of_files import import_with, refused

ROWS = 200
TIME_MS = np.arange(ROWS) * 10
ACC = np.random.default_rng(1).normal(size=(ROWS, 3)) + np.array([0.0, 9.81, 0.0])
GYR = np.random.default_rng(2).normal(size=(ROWS, 3))


def columns(prefix: str = "", acc: NDArray[np.float64] = ACC) -> dict[str, NDArray[np.float64]]:
    return {f"{prefix}acc_{axis}": acc[:, k] for k, axis in enumerate("xyz")} | {
        f"{prefix}gyr_{axis}": np.rad2deg(GYR[:, k]) for k, axis in enumerate("xyz")
    }


def written(path: Path, named: Mapping[str, object], units: Mapping[str, str] | None = None) -> Path:
    """A table whose units stand in the metadata of its columns."""
    arrays = {name: pa.array(values) for name, values in named.items()}
    reported = units or {}
    fields = [
        pa.field(name, array.type, metadata={"unit": reported[name]} if name in reported else None)
        for name, array in arrays.items()
    ]
    pq.write_table(pa.table(list(arrays.values()), schema=pa.schema(fields)), path)
    return path


def in_degrees(prefix: str = "") -> dict[str, str]:
    return {f"{prefix}gyr_{axis}": "deg/s" for axis in "xyz"}


def test_units_of_the_columns_metadata_count(tmp_path: Path) -> None:
    named = {"time_ms": TIME_MS, **columns("L_"), **columns("R_", ACC + 0.1), "note": ["x"] * ROWS}
    path = written(tmp_path / "a.txt", named, in_degrees("L_") | in_degrees("R_"))
    assert recognised([path]) == "parquet"
    imported = import_with(parquet_trial, [path], {Site.LEFT_SHANK: "L", Site.RIGHT_SHANK: "R"}, "walk 1")
    np.testing.assert_allclose(imported.imu[Site.LEFT_SHANK].gyr_rad_s, GYR)
    np.testing.assert_allclose(imported.imu[Site.RIGHT_SHANK].acc_m_s2, ACC + 0.1)
    np.testing.assert_allclose(imported.imu[Site.LEFT_SHANK].time_s, TIME_MS / 1000.0)
    assert imported.sensors[Site.LEFT_SHANK].rate_hz == 100.0
    left_out = [dict(one.numbers) for one in imported.findings if one.key == "columns_left_out"]
    assert left_out == [{"names": "note"}] * 2


def test_what_is_left_open_or_no_such_table_is_refused(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    def of(named: Mapping[str, object], units: Mapping[str, str] | None = None) -> str:
        return refused(parquet_trial, [written(tmp_path / "a.parquet", named, units)])

    slow = {**columns(), **{f"gyr_{axis}": GYR[:, k] for k, axis in enumerate("xyz")}}
    back = TIME_MS - 200 * (np.arange(ROWS) >= 20)
    assert {
        "rates in either unit": of({"time_ms": TIME_MS, **slow}),
        "no times": of(slow),
        "times go back": of({"time_ms": back, **columns()}, in_degrees()),
        "texts for times": of({"time_s": ["0", "1"], **{name: v[:2] for name, v in columns().items()}}),
        "other columns": of({"year": [2026], "amount": [1.0]}),
    } == snapshot
    path = written(tmp_path / "a.parquet", {"year": [2026], "amount": [1.0]})
    assert "the file format is not recognised" in refused(recognised, [path])
    path.write_bytes(path.read_bytes()[:-20])
    assert "the file is not a readable Parquet file" in refused(parquet_trial, [path])  # then in Arrow's words
