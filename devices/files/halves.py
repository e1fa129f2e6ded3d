"""Accelerometer and gyroscope of one sensor in files of their own, joined by time.

The rates keep their instants: they are integrated. The acceleration is interpolated at them; where it has a gap it is
missing. Both files have to have one clock, which is what they have where one program wrote both.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from core.findings import Finding, Severity
from core.samples import FloatArray
from devices.drivers.csv_serial import RATE_UNITS
from devices.files.column_names import Quantity
from devices.files.magnitudes import rate_unit_by_gravity
from devices.files.refusal import FileRefusedError
from devices.files.trial import ImportedSensor, UnreadFile

OPEN = "rad/s"  # in which rates are kept as long as their unit is open
LONGEST_STEP = 2.5  # usual steps of the acceleration; beyond, it has a gap
LEAST_COMMON = 0.5  # of the shorter file: those of one recording lie on each other
IMPORT_BOTH = (
    "Choose the files of accelerometer and gyroscope together; their names differ in the quantity alone, such as "
    "left_thigh_acc and left_thigh_gyro"
)


@dataclass(frozen=True, slots=True)
class Half:
    """One quantity of a sensor, whose other one is NaN. `key`: what the files of one sensor have in common."""

    key: tuple[str, str]
    quantity: Quantity
    sensor: ImportedSensor


def joined(halves: Sequence[Half]) -> tuple[list[ImportedSensor], list[UnreadFile]]:
    """Give the sensors that two files make, and the files without another half."""
    sensors: list[ImportedSensor] = []
    unread: list[UnreadFile] = []
    for key in dict.fromkeys(half.key for half in halves):
        of_key = [half for half in halves if half.key == key]
        acc, gyr = ([one.sensor for one in of_key if one.quantity is what] for what in (Quantity.ACC, Quantity.GYR))
        try:
            if len(acc) == 1 and len(gyr) == 1:
                sensors.append(_joined(acc[0], gyr[0], key[1]))
                continue
            refusal = _refusal(of_key, has_acc=bool(acc), has_gyr=bool(gyr))
        except FileRefusedError as apart:
            refusal = apart
        unread += [UnreadFile(one.sensor.file, (one.sensor.name,), refusal) for one in of_key]
    return sensors, unread


def _refusal(halves: Sequence[Half], *, has_acc: bool, has_gyr: bool) -> FileRefusedError:
    where = ", ".join(Path(half.sensor.file).name for half in halves)
    if has_acc and has_gyr:
        return FileRefusedError(
            where,
            "more than two files hold acceleration or angular rates of one sensor",
            "Leave out all but one file of each quantity",
        )
    if has_acc:
        return FileRefusedError(where, "the file holds acceleration but no angular rates", IMPORT_BOTH)
    return FileRefusedError(where, "the file holds angular rates but no acceleration", IMPORT_BOTH)


def _joined(acc: ImportedSensor, gyr: ImportedSensor, name: str) -> ImportedSensor:
    time_s, acc_s = gyr.block.time_s, acc.block.time_s
    where = f"{Path(acc.file).name}, {Path(gyr.file).name}"
    if len(time_s) < 2 or len(acc_s) < 2:
        raise FileRefusedError(where, "one of the two files has no samples", IMPORT_BOTH)
    common_s = min(acc_s[-1], time_s[-1]) - max(acc_s[0], time_s[0])
    if common_s < LEAST_COMMON * min(acc_s[-1] - acc_s[0], time_s[-1] - time_s[0]):
        raise FileRefusedError(
            where,
            "accelerometer and gyroscope of one sensor are in two files whose times do not fit each other",
            "Export both files of one recording again, with times on one clock",
        )
    step_s = float(np.median(np.diff(acc_s)))
    is_within = (time_s >= acc_s[0] - 0.5 * step_s) & (time_s <= acc_s[-1] + 0.5 * step_s)
    block = gyr.block.select(is_within)
    block = replace(block, sensor=name, acc_m_s2=_at(acc_s, acc.block.acc_m_s2, block.time_s, LONGEST_STEP * step_s))
    understood, of_unit = _understood(acc, gyr), list[Finding]()
    if not understood.numbers["gyr_unit"]:
        names = str(understood.numbers["gyr"])
        unit = unit_by_gravity(block.time_s, block.acc_m_s2, block.gyr_rad_s, Path(gyr.file).name, names, of_unit)
        block = replace(block, gyr_rad_s=block.gyr_rad_s * RATE_UNITS[unit])
        understood = replace(understood, numbers={**understood.numbers, "gyr_unit": unit})
    numbers: Mapping[str, float | int | str] = {
        "acc": Path(acc.file).name,
        "gyr": Path(gyr.file).name,
        "acc_hz": acc.info.rate_hz or 0.0,
        "gyr_hz": gyr.info.rate_hz or 0.0,
    }
    findings = (
        understood,
        *of_unit,
        Finding("joined_files", Severity.INFO, "", numbers),
        *(one for half in (acc, gyr) for one in half.findings if one.key != "columns_understood"),
    )
    ids = tuple(dict.fromkeys((name, *(Path(one.file).name for one in (acc, gyr)), Path(acc.file).stem)))
    info = replace(gyr.info, serial=name)
    return ImportedSensor(name, ids, gyr.file, block, info, findings)


def unit_by_gravity(
    time_s: FloatArray, acc_m_s2: FloatArray, rates: FloatArray, where: str, names: str, findings: list[Finding]
) -> str:
    """The unit of rates that gravity shows, noted as found so; raises FileRefusedError where it does not show it."""
    unit = rate_unit_by_gravity(time_s, acc_m_s2, rates)
    if not unit:
        raise FileRefusedError(
            where,
            "it is unclear whether the angular rates {names} are in rad/s or in deg/s",
            "Name the columns with their unit, such as gyr_x_rad_s or gyr_x_deg_s",
            names=names,
        )
    findings.append(Finding("unit_by_gravity", Severity.INFO, "", {"names": names, "unit": unit}))
    return unit


def _at(stamp_s: FloatArray, values: FloatArray, time_s: FloatArray, longest_s: float) -> FloatArray:
    """Values (n, 3) at other instants, NaN in gaps; the ends are held for half a step."""
    is_there = np.isfinite(values).all(axis=1)
    known_s, known = stamp_s[is_there], values[is_there]
    if len(known_s) < 2:
        return np.full((len(time_s), 3), np.nan)
    found = np.column_stack([np.interp(time_s, known_s, column) for column in known.T])
    after = np.clip(np.searchsorted(known_s, time_s), 1, len(known_s) - 1)
    is_gap = (known_s[after] - known_s[after - 1] > longest_s) & ~np.isin(time_s, known_s)
    found[is_gap] = np.nan
    return found


def _understood(acc: ImportedSensor, gyr: ImportedSensor) -> Finding:
    """What was made of the columns of both files, as one finding."""
    of_acc, of_gyr = (next(one for one in half.findings if one.key == "columns_understood") for half in (acc, gyr))
    of_force = {name: of_acc.numbers[name] for name in ("acc", "acc_unit")}
    return replace(of_gyr, numbers={**of_gyr.numbers, **of_force})
