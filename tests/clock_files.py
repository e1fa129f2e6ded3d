"""Tables of two sensors whose clocks restart, jump, pause or lose samples."""

from pathlib import Path

import numpy as np

from core.samples import BoolArray, FloatArray

RATE_HZ, LENGTH_S = 100.0, 20.0
TIME_S: FloatArray = np.arange(0.0, LENGTH_S, 1.0 / RATE_HZ)
ALL: BoolArray = np.ones(len(TIME_S), dtype=bool)


SensorTable = tuple[FloatArray, BoolArray]
"""Times (n,), and which of them are left."""


def restarted(at_s: float, at: float = 0.5) -> FloatArray:
    """Times that begin again with `at` from `at_s` on."""
    return np.where(at_s - 1e-9 <= TIME_S, TIME_S - at_s + at, TIME_S)


def jumped(at_s: float, by_s: float) -> FloatArray:
    return np.where(at_s - 1e-9 <= TIME_S, TIME_S + by_s, TIME_S)


def without(*gaps_s: tuple[float, float]) -> BoolArray:
    """Which samples are left where these times are missing."""
    is_there = ALL.copy()
    for first, last in gaps_s:
        is_there &= (first > TIME_S) | (last < TIME_S)
    return is_there


def table(folder: Path, name: str, time_s: FloatArray = TIME_S, is_there: BoolArray = ALL, phase: float = 0.0) -> Path:
    """One sensor that turns to and fro, as a table with named columns."""
    rate = np.sin(TIME_S * 6.0 + phase)
    rows = np.column_stack([time_s, np.zeros((len(TIME_S), 2)), np.full(len(TIME_S), 9.81), rate, rate / 2, rate / 3])
    path = folder / f"{name}.csv"
    head = "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyr_x_rad_s,gyr_y_rad_s,gyr_z_rad_s"
    lines = [",".join(f"{value:.6g}" if k else f"{value:.4f}" for k, value in enumerate(row)) for row in rows[is_there]]
    path.write_text("\n".join([head, *lines, ""]))
    return path


def pair(
    folder: Path,
    thigh: SensorTable = (TIME_S, ALL),
    shank: SensorTable = (TIME_S, ALL),
) -> list[Path]:
    """A left thigh and a left shank."""
    return [table(folder, "left_thigh", *thigh), table(folder, "left_shank", *shank, phase=0.3)]
