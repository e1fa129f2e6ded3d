"""Tests that Parquet tables of any program become samples by the same rules as CSV."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from numpy.typing import NDArray

from core.body import Site
from devices.files.formats import recognised
from devices.files.parquet_tables import parquet_trial
from devices.files.refusal import FileRefusedError
from tests.trials_of_files import import_with

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


def test_what_is_left_open_is_asked_for(tmp_path: Path) -> None:
    slow = {**columns(), **{f"gyr_{axis}": GYR[:, k] for k, axis in enumerate("xyz")}}
    with pytest.raises(
        FileRefusedError, match=r"a.parquet: it is unclear whether the angular rates .* rad/s or in deg/s"
    ):
        parquet_trial([written(tmp_path / "a.parquet", {"time_ms": TIME_MS, **slow})])
    with pytest.raises(FileRefusedError, match="the samples in the file have no times"):
        parquet_trial([written(tmp_path / "a.parquet", slow)])


def test_stamps_that_step_back_are_refused_by_their_row(tmp_path: Path) -> None:
    back = TIME_MS.copy()
    back[20:] -= 200
    with pytest.raises(FileRefusedError, match=r'a.parquet, row 21: "time_ms" goes back from 190 to 0'):
        parquet_trial([written(tmp_path / "a.parquet", {"time_ms": back, **columns()}, in_degrees())])


def test_other_parquet_is_not_taken_for_it(tmp_path: Path) -> None:
    path = written(tmp_path / "a.parquet", {"year": [2026], "amount": [1.0]})
    with pytest.raises(FileRefusedError, match="the file format is not recognised"):
        recognised([path])
    with pytest.raises(
        FileRefusedError, match=r"the file's columns do not identify acceleration .*: year, amount. Name"
    ):
        parquet_trial([path])
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(FileRefusedError, match="the file is not a readable Parquet file"):
        parquet_trial([path])
    text = written(tmp_path / "b.parquet", {"time_s": ["0", "1"], **{name: v[:2] for name, v in columns().items()}})
    with pytest.raises(FileRefusedError, match="column time_s contains string, not numbers"):
        parquet_trial([text])
