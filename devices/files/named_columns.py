"""Sensors of tables of no particular program, whose columns say by their names what they are (`column_names`).

What a name does not say is found by size where size leaves one answer only, and reported as a finding; where it leaves
two, the file is refused with the name that would settle it. What a name does say is held to the size, too.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from core.findings import Finding, Severity
from core.samples import BoolArray, FloatArray, ImuBlock, SensorInfo
from devices.drivers.csv_serial import FORCE_UNITS, RATE_UNITS
from devices.files.column_names import (
    SCALES,
    Quantity,
    SensorColumns,
    listed,
    meaning_of,
    sensor_columns,
    unit_of,
    without_brackets,
)
from devices.files.magnitudes import FELT_M_S2, FEW, MOST_RAD_S, middle_size
from devices.files.named_table import NamedTable
from devices.files.named_times import stamps_of
from devices.files.refusal import FileRefusedError, quoted
from devices.files.trial import ImportedSensor, ImportedTrial, read_each

GRAVITY_M_S2 = (7.0, 14.0)  # the middle of what a sensor on a leg at rest or walking feels, by which a unit is found
UP = 0.95  # cosine of the angle to the vertical at which an orientation turns the mean specific force

NAME_THEM = (
    "Name the columns acc_x, acc_y, acc_z and gyr_x, gyr_y, gyr_z, with units as in acc_x_m_s2 "
    "and gyr_x_deg_s; with several sensors left_shank_acc_x and so on"
)


def sensors_of_table(table: NamedTable, rate_hz: float | None) -> list[ImportedSensor]:
    """Give a table's sensors, SI, seconds by its stamps; FileRefusedError for no sensor, bad units or times."""
    try:
        found = sensor_columns(list(table.columns), table.units)
    except FileRefusedError as refusal:
        raise FileRefusedError.stated_elsewhere(table.where, refusal.what, refusal.remedy, refusal.values) from None
    if not found:
        raise FileRefusedError(
            table.where,
            "the file's columns do not identify acceleration and angular rates on three axes each: {names}",
            NAME_THEM,
            names=listed([*table.columns, *table.left_out]) or "-",
        )
    used = {name for one in found for name in one.names()}
    others = [name for name in [*table.columns, *table.left_out] if name not in used]
    return [_sensor(table, one, rate_hz, others) for one in found]


def trial_of_tables(
    format_name: str,
    read: Callable[[Path], Sequence[NamedTable]],
    files: Sequence[Path],
    rate_hz: float | None = None,
) -> ImportedTrial:
    """Read the sensors of several files of one trial; raises FileRefusedError if the only file is refused."""
    tables, unread = read_each(
        files, lambda path: [(table.called, sensors_of_table(table, rate_hz)) for table in read(path)]
    )
    sensors: list[ImportedSensor] = []
    for called, found in (one for of_file in tables for one in of_file):
        names = {sensor.name.casefold() for sensor in sensors}
        if any(sensor.name.casefold() in names for sensor in found):  # each table may call its sensor "imu"
            found = [replace(sensor, name=f"{called} {sensor.name}") for sensor in found]
        sensors += found
    return ImportedTrial(format_name, tuple(sensors), tuple(unread))


def _sensor(table: NamedTable, named: SensorColumns, asked_hz: float | None, others: Sequence[str]) -> ImportedSensor:
    name = named.sensor or table.called
    lengths = {len(table.columns[column]) for column in (*named.acc, *named.gyr, *named.mag, *named.quat)}
    if len(lengths) != 1:
        raise FileRefusedError(
            table.where,
            "the columns of {sensor} differ in length",
            "Save the columns with one row per sample",
            sensor=quoted(name),
        )
    findings = list(table.findings)
    acc, gyr = _matrix(table, named.acc), _matrix(table, named.gyr)
    is_there: BoolArray = np.isfinite(np.hstack([acc, gyr])).any(axis=1)  # a row of another sensor's is none of its
    stamps = stamps_of(table, named, asked_hz, is_there, findings)
    acc_unit = _acc_unit(table, named, acc, findings)
    gyr_unit = _gyr_unit(table, named, gyr, findings)
    acc, gyr = acc * FORCE_UNITS[acc_unit], gyr * RATE_UNITS[gyr_unit]
    kept = np.flatnonzero(is_there)[stamps.is_new]
    q = _orientation(_matrix(table, named.quat)[kept], acc[kept]) if named.quat else None
    if named.quat and q is None:
        findings.append(Finding("orientation_left_out", Severity.INFO, "", {"names": listed(named.quat)}))
    understood = {
        "acc": listed(named.acc),
        "acc_unit": acc_unit,
        "gyr": listed(named.gyr),
        "gyr_unit": gyr_unit,
        "time": stamps.reported,
    }
    findings.insert(0, Finding("columns_understood", Severity.INFO, "", understood))
    if others:
        findings.append(Finding("columns_left_out", Severity.INFO, "", {"names": listed(others)}))
    block = ImuBlock(
        sensor=name,
        time_s=stamps.time_s,
        gyr_rad_s=gyr[kept],
        acc_m_s2=acc[kept],
        q_earth_from_sensor=q,
        mag=_matrix(table, named.mag)[kept] if named.mag else None,
    )
    ids = tuple({name.replace("_", " "), name.replace(" ", "_")} - {name})
    return ImportedSensor(
        name, ids, table.file, block, SensorInfo(serial=name, rate_hz=stamps.rate_hz), tuple(findings)
    )


def _acc_unit(table: NamedTable, named: SensorColumns, acc: FloatArray, findings: list[Finding]) -> str:
    reported = _reported_unit(table, named.acc, Quantity.ACC)
    middle = middle_size(acc)
    if np.isnan(middle):
        return reported or "m/s2"
    if reported and FELT_M_S2[0] < middle * FORCE_UNITS[reported] < FELT_M_S2[1]:
        return reported
    least, most = GRAVITY_M_S2
    fits = [unit for unit, scale in FORCE_UNITS.items() if least < middle * scale < most]
    if reported and fits:
        raise FileRefusedError(
            table.where,
            "the acceleration {names} is labelled {reported}, but its median of {middle} matches gravity in {unit}",
            "Correct the unit, or export the data again in m/s2",
            names=listed(named.acc),
            reported=reported,
            middle=f"{middle:.3g}",
            unit=fits[0],
        )
    if not fits:
        raise FileRefusedError(
            table.where,
            "the median of the acceleration {names} is {middle}, which does not match gravity in {units}",
            "Export acceleration in m/s2 with gravity, not free or linear acceleration",
            names=listed(named.acc),
            middle=f"{middle:.3g}",
            units=reported or ", ".join(FORCE_UNITS),
        )
    findings.append(Finding("unit_by_size", Severity.INFO, "", {"names": listed(named.acc), "unit": fits[0]}))
    return fits[0]


def _gyr_unit(table: NamedTable, named: SensorColumns, gyr: FloatArray, findings: list[Finding]) -> str:
    reported = _reported_unit(table, named.gyr, Quantity.GYR)
    rates = np.abs(gyr[np.isfinite(gyr)])
    largest = float(np.quantile(rates, FEW)) if len(rates) else 0.0
    if reported:
        if largest * RATE_UNITS[reported] > MOST_RAD_S:
            raise FileRefusedError(
                table.where,
                "the angular rates {names} are labelled {reported}, but reach {largest}, beyond the range of "
                "any sensor",
                "Correct the unit, or export the angular rates again in rad/s",
                names=listed(named.gyr),
                reported=reported,
                largest=f"{largest:.3g}",
            )
        return reported
    if not len(rates):
        return "rad/s"
    if not MOST_RAD_S < largest < MOST_RAD_S / RATE_UNITS["deg/s"]:
        raise FileRefusedError(
            table.where,
            "it is unclear whether the angular rates {names} are in rad/s or in deg/s",
            "Name the columns with their unit, such as gyr_x_rad_s or gyr_x_deg_s",
            names=listed(named.gyr),
        )
    findings.append(Finding("unit_by_size", Severity.INFO, "", {"names": listed(named.gyr), "unit": "deg/s"}))
    return "deg/s"


def _reported_unit(table: NamedTable, names: Sequence[str], quantity: Quantity) -> str:
    """The unit in the names of three columns, or the one given for them; empty where there is none."""
    units = set()
    for name in names:
        stated = table.units.get(name, "")
        meaning = meaning_of(name, stated)
        units.add(meaning.unit if meaning else "")
        bracketed = without_brackets(name)[1]
        for text in (stated, bracketed):
            if text.strip() and not unit_of(quantity, text):
                raise FileRefusedError(
                    table.where,
                    "{name} is in {unit}, expected one of {required}",
                    "Export the file again in one of these units, or correct the unit",
                    name=quoted(name),
                    unit=quoted(text),
                    required=", ".join(SCALES[quantity]),
                )
    if len(units) > 1:
        raise FileRefusedError(
            table.where,
            "the columns {names} have different units",
            "Export the columns again in one unit",
            names=listed(names),
        )
    return units.pop()


def _orientation(q: FloatArray, acc: FloatArray) -> FloatArray | None:
    """(n, 4) unit quaternions, earth from sensor; None where they do not turn the specific force upwards."""
    # no name shows whether a program means earth from sensor or sensor from earth; gravity does
    length = np.linalg.norm(q, axis=1)
    is_whole = np.abs(length - 1.0) < 0.05
    is_felt = is_whole & np.isfinite(acc).all(axis=1)
    if not is_felt.any():
        return None
    unit = np.full_like(q, np.nan)
    unit[is_whole] = q[is_whole] / length[is_whole, None]
    mean = Rotation.from_quat(unit[is_felt], scalar_first=True).apply(acc[is_felt]).mean(axis=0)
    size = float(np.linalg.norm(mean))
    return unit if size > 0.0 and mean[2] > UP * size else None


def _matrix(table: NamedTable, names: Sequence[str]) -> FloatArray:
    """(n, m) values; infinite ones are no measurement and become NaN."""
    matrix = np.column_stack([table.columns[name] for name in names])
    matrix[np.isinf(matrix)] = np.nan
    return matrix
