"""Sensors of tables of no particular program, whose columns say by their names what they are (`column_names`).

What a name does not say is found by size where size leaves one answer only, and reported as a finding; where it leaves
two, the file is refused with the name that would settle it. What a name does say is held to the size, too.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from core.findings import Finding, Severity
from core.samples import BoolArray, FloatArray, ImuBlock, SensorInfo
from devices.drivers.csv_serial import FORCE_UNITS, RATE_UNITS
from devices.files.column_names import (
    SCALES,
    XYZ,
    Quantity,
    SensorColumns,
    listed,
    meaning_of,
    sensor_columns,
    unit_of,
    without_brackets,
    without_quantity,
)
from devices.files.halves import OPEN, Half, joined, unit_by_gravity
from devices.files.magnitudes import FELT_M_S2, FEW, MOST_RAD_S, middle_size, rate_unit_by_gravity
from devices.files.named_table import NamedTable
from devices.files.named_times import stamps_of
from devices.files.refusal import FileRefusedError, quoted
from devices.files.trial import ImportedSensor, ImportedTrial, UnreadFile, read_each

GRAVITY_RANGE_M_S2 = (7.0, 14.0)  # the middle of what a sensor on a leg feels at rest or walking, which shows the unit
LEAST_DOWN = 0.3  # of the size of the mean, where a unit is found by size: acceleration without gravity has none
MOST_WITH_DIGITS = 1000.0
UP = 0.95  # cosine of the angle to the vertical at which an orientation turns the mean specific force

MOST_FELT = GRAVITY_RANGE_M_S2[1] / min(FORCE_UNITS.values())  # as a number, in the smallest unit
NO_GRAVITY = "the median of the acceleration {names} is {middle}, which does not match gravity in {units}"
FREE = "Export acceleration in m/s2 with gravity, not free or linear acceleration"
COUNTS = "Export acceleration in m/s2, not the counts of the sensor's converter"
NAME_THEM = (
    "Name the columns acc_x, acc_y, acc_z and gyr_x, gyr_y, gyr_z, with units as in acc_x_m_s2 "
    "and gyr_x_deg_s; with several sensors left_shank_acc_x and so on"
)


def sensors_of_table(table: NamedTable, rate_hz: float | None) -> tuple[list[ImportedSensor], list[UnreadFile]]:
    """Give a table's sensors, SI, seconds by its stamps, and of several those that cannot be read.
    FileRefusedError for no sensor, bad units or times of all.
    """
    found = [one for one in _columns_of(table) if one.acc and one.gyr]
    if not found:
        raise FileRefusedError(
            table.where,
            "the file's columns do not identify acceleration and angular rates on three axes each: {names}",
            NAME_THEM,
            names=listed([*table.columns, *table.left_out]) or "-",
        )
    sensors: list[ImportedSensor] = []
    unread: list[UnreadFile] = []
    for one in found:
        try:
            sensors.append(_sensor(table, one, rate_hz, _others(table, found)))
        except FileRefusedError as refusal:
            unread.append(UnreadFile(table.file, (one.sensor or table.called,), refusal))
    if not sensors:
        raise unread[0].refusal
    return sensors, unread


def halves_of_table(table: NamedTable, rate_hz: float | None) -> list[Half]:
    """Give the acceleration or the angular rates of a table's sensors, none where it has both; raises as above."""
    found = _columns_of(table)
    if any(one.acc and one.gyr for one in found):
        return []
    halves = []
    for one in found:
        quantity = Quantity.ACC if one.acc else Quantity.GYR
        sensor = _sensor(table, one, rate_hz, _others(table, found))
        name = "_".join(filter(None, [without_quantity(table.called), one.sensor])) or Path(table.file).parent.name
        halves.append(Half((str(Path(table.file).parent), name), quantity, sensor))
    return halves


def trial_of_tables(
    format_name: str,
    read: Callable[[Path], Sequence[NamedTable]],
    files: Sequence[Path],
    rate_hz: float | None = None,
    *,
    may_be_halves: bool = False,
) -> ImportedTrial:
    """Read the sensors of several files of one trial; raises FileRefusedError if the only file is refused.

    `may_be_halves`: accelerometer and gyroscope of one sensor may be in two files.
    """

    of_tables: list[UnreadFile] = []

    def read_one(path: Path) -> list[tuple[str, list[ImportedSensor], list[Half]]]:
        found = []
        for table in read(path):
            halves = halves_of_table(table, rate_hz) if may_be_halves else []
            whole, refused = ([], []) if halves else sensors_of_table(table, rate_hz)
            of_tables.extend(refused)
            found.append((table.called, whole, halves))
        return found

    tables, unread = read_each(files, read_one)
    sensors: list[ImportedSensor] = []
    for called, found, _ in (one for of_file in tables for one in of_file):
        names = {sensor.name.casefold() for sensor in sensors}
        if any(sensor.name.casefold() in names for sensor in found):  # each table may call its sensor "imu"
            found = [replace(sensor, name=f"{called} {sensor.name}") for sensor in found]
        sensors += found
    together, alone = joined([half for of_file in tables for _, _, halves in of_file for half in halves])
    if alone and not sensors and not together:
        raise (unread or alone)[0].refusal
    return ImportedTrial(format_name, (*sensors, *together), (*unread, *of_tables, *alone))


def _columns_of(table: NamedTable) -> tuple[SensorColumns, ...]:
    """A table's sensors, as somebody states them or as their names give them."""
    if table.stated is not None:
        return table.stated
    try:
        return sensor_columns(list(table.columns), table.units)
    except FileRefusedError as refusal:
        raise FileRefusedError.stated_elsewhere(table.where, refusal.what, refusal.remedy, refusal.values) from None


def _others(table: NamedTable, found: Sequence[SensorColumns]) -> list[str]:
    """Columns that were not read."""
    used = {name for one in found for name in one.names()} | ({table.time} if table.time_s is not None else set())
    return [name for name in [*table.columns, *table.left_out] if name not in used]


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
    acc, gyr = (_matrix(table, names, lengths) for names in (named.acc, named.gyr))
    is_there: BoolArray = np.isfinite(np.hstack([acc, gyr])).any(axis=1)  # a row of another sensor's is none of its
    of_units: list[Finding] = []
    acc_unit, gyr_unit = _acc_unit(table, named, acc, of_units), _gyr_unit(table, named, gyr, of_units)
    stamps = stamps_of(table, named, asked_hz, is_there, findings)
    findings += of_units
    kept = np.flatnonzero(is_there)[stamps.is_new]
    acc = acc * FORCE_UNITS[acc_unit]
    if not gyr_unit and named.acc:
        gyr_unit = unit_by_gravity(stamps.time_s, acc[kept], gyr[kept], table.where, listed(named.gyr), findings)
    elif named.acc:
        _refuse_other_unit(table, named, gyr_unit, rate_unit_by_gravity(stamps.time_s, acc[kept], gyr[kept]))
    gyr = gyr * RATE_UNITS[gyr_unit or OPEN]
    q = _orientation(_matrix(table, named.quat, lengths)[kept], acc[kept]) if named.quat else None
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
        mag=_matrix(table, named.mag, lengths)[kept] if named.mag else None,
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
    least, most = GRAVITY_RANGE_M_S2
    fits = [unit for unit, scale in FORCE_UNITS.items() if least < middle * scale < most]
    if reported and fits:
        raise FileRefusedError(
            table.where,
            "the acceleration {names} is labelled {reported}, but its median of {middle} matches gravity in {unit}",
            "Correct the unit, or export the data again in m/s2",
            names=listed(named.acc),
            reported=reported,
            middle=_figure(middle),
            unit=fits[0],
        )
    if not fits:
        names, shown, units = listed(named.acc), _figure(middle), reported or ", ".join(FORCE_UNITS)
        if middle > MOST_FELT:
            raise FileRefusedError(table.where, NO_GRAVITY, COUNTS, names=names, middle=shown, units=units)
        raise FileRefusedError(table.where, NO_GRAVITY, FREE, names=names, middle=shown, units=units)
    if float(np.linalg.norm(np.nanmean(acc, axis=0))) < LEAST_DOWN * middle:
        raise FileRefusedError(
            table.where,
            "the acceleration {names} points nowhere in the mean, as if gravity had been removed",
            FREE,
            names=listed(named.acc),
        )
    findings.append(Finding("unit_by_size", Severity.INFO, "", {"names": listed(named.acc), "unit": fits[0]}))
    return fits[0]


def _figure(value: float) -> str:
    return f"{value:.0f}" if value >= MOST_WITH_DIGITS else f"{value:.3g}"


def _gyr_unit(table: NamedTable, named: SensorColumns, gyr: FloatArray, findings: list[Finding]) -> str:
    """The unit of the rates; empty where neither names nor sizes show it."""
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
                largest=_figure(largest),
            )
        return reported
    if not len(rates):
        return OPEN
    if not MOST_RAD_S < largest < MOST_RAD_S / RATE_UNITS["deg/s"]:
        return ""
    findings.append(Finding("unit_by_size", Severity.INFO, "", {"names": listed(named.gyr), "unit": "deg/s"}))
    return "deg/s"


def _refuse_other_unit(table: NamedTable, named: SensorColumns, reported: str, found: str) -> None:
    """Refuse rates in deg/s that turn gravity as rad/s do; raises FileRefusedError. Others are too fast by size."""
    if (reported, found) == ("deg/s", "rad/s"):
        raise FileRefusedError(
            table.where,
            "the angular rates {names} are labelled {reported}, but gravity turns as if they were in {unit}",
            "Correct the unit, or export the angular rates again in rad/s",
            names=listed(named.gyr),
            reported=reported,
            unit=found,
        )


def _reported_unit(table: NamedTable, names: Sequence[str], quantity: Quantity) -> str:
    """The unit in the names of three columns, or the one given for them; empty where there is none."""
    units = {""} if not names else set[str]()
    for name in names:
        stated = table.units.get(name, "")
        meaning = meaning_of(name, stated)
        units.add(unit_of(quantity, stated) or unit_of(quantity, meaning.unit if meaning else ""))
        bracketed = without_brackets(name)[1]
        for text in (stated or bracketed,):
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


def _matrix(table: NamedTable, names: Sequence[str], lengths: Collection[int]) -> FloatArray:
    """(n, m) values; infinite ones are no measurement and become NaN; (n, 3) NaN where there are no columns."""
    if not names:
        return np.full((next(iter(lengths)), len(XYZ)), np.nan)
    matrix = np.column_stack([table.columns[name] for name in names])
    matrix[np.isinf(matrix)] = np.nan
    return matrix
