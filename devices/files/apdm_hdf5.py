"""HDF5 files of APDM's programs, versions 3 to 5, as APDM describes their layout.

Versions 3 and 4 (Motion Studio, Mobility Lab 1): the root's attributes `CaseIdList` and `MonitorLabelList` name the
sensors' groups and labels; a group holds `Time`, `Calibrated/Accelerometers`, `Calibrated/Gyroscopes`,
`Calibrated/Magnetometers`, `Calibrated/Orientation` and the attribute `SampleRate`. Version 5 (Mobility Lab 2, Moveo):
`Sensors/<number>` holds `Time`, `Accelerometer`, `Gyroscope`, `Magnetometer` and the attributes of `Configuration`
("Label 0", "Sample Rate"), `Processed/<number>` the `Orientation`. Times are microseconds since 1970, a row is a
sample, units are SI. The CSV exports are made from these files, so orientation and rates are meant as there.

Not held against a real file: only against the published layout.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.findings import Finding
from core.samples import FloatArray
from devices.files.clock_repair import FileClock, whole_clock
from devices.files.hdf5 import Hdf5File
from devices.files.refusal import FileRefusedError, quoted

VERSION = "FileFormatVersion"
CASE_IDS, LABELS, SENSORS, PROCESSED = "CaseIdList", "MonitorLabelList", "Sensors", "Processed"
VERSIONS = (3, 4, 5)
SAVE_AGAIN = "Save the recording again as HDF5, from Moveo, Mobility Lab or Motion Studio"
RECORD_IT = "Switch on the sensor's accelerometer, gyroscope and timestamps in the APDM software before recording"
TICK_S = 1e-6
UNITS_ATTRIBUTE = "Units"
SI = {"acceleration": ("m/s^2", "m/s²"), "angular rate": ("rad/s",)}
MOST_SENSORS = 100


@dataclass(frozen=True, slots=True)
class RecordedOpal:
    """One sensor's samples as the file holds them, `stamps` ascending, of `tick_s` each.

    `called`: its serial number, as far as the file gives it. `of_clock`: what was found about its stamps.
    """

    name: str
    called: str
    ids: tuple[str, ...]
    stamps: FloatArray
    tick_s: float
    acc_m_s2: FloatArray
    gyr_rad_s: FloatArray
    q_earth_from_sensor: FloatArray | None
    mag: FloatArray | None
    rate_hz: float | None
    of_clock: tuple[Finding, ...]


@dataclass(frozen=True, slots=True)
class _Layout:
    """Where one sensor's values stand."""

    name: str
    case: str
    time: str
    acc: str
    gyr: str
    mag: str
    orientation: str
    rate: tuple[str, str]


def is_apdm_hdf5(path: Path) -> bool:
    """Give whether an HDF5 file states these programs; raises FileRefusedError where it cannot be opened."""
    with Hdf5File(path, path.name) as file:
        has_version = file.attribute("/", VERSION) is not None
        return has_version and (bool(file.texts("/", CASE_IDS)) or file.is_group(SENSORS))


def read_apdm_hdf5(path: Path) -> tuple[RecordedOpal, ...]:
    """Read the sensors of one file; raises FileRefusedError on other versions, units, or times stepping back."""
    with Hdf5File(path, path.name) as file:
        version = _number(file, "/", VERSION)
        if version not in VERSIONS:
            raise FileRefusedError(
                file.where,
                "APDM file version {version} is not supported, only versions {first} to {last}",
                SAVE_AGAIN,
                version="?" if version is None else f"{version:g}",
                first=VERSIONS[0],
                last=VERSIONS[-1],
            )
        layouts = list(_of_version_5(file) if version == VERSIONS[-1] else _of_version_3(file))
        if not layouts or len(layouts) > MOST_SENSORS:
            raise FileRefusedError(file.where, "the file lists no sensors", SAVE_AGAIN)
        return tuple(_read(file, layout) for layout in layouts)


def _of_version_3(file: Hdf5File) -> Iterator[_Layout]:
    labels = file.texts("/", LABELS)
    for number, case in enumerate(file.texts("/", CASE_IDS)):
        name = labels[number] if number < len(labels) and labels.count(labels[number]) == 1 else ""
        yield _Layout(
            name=name or case,
            case=case,
            time=f"{case}/Time",
            acc=f"{case}/Calibrated/Accelerometers",
            gyr=f"{case}/Calibrated/Gyroscopes",
            mag=f"{case}/Calibrated/Magnetometers",
            orientation=f"{case}/Calibrated/Orientation",
            rate=(case, "SampleRate"),
        )


def _of_version_5(file: Hdf5File) -> Iterator[_Layout]:
    cases = file.names(SENSORS)[: MOST_SENSORS + 1]
    labels = {case: next(iter(file.texts(f"{SENSORS}/{case}/Configuration", "Label 0")), "") for case in cases}
    for case in cases:
        label = labels[case]
        yield _Layout(
            name=label if label and [*labels.values()].count(label) == 1 else case,
            case=case,
            time=f"{SENSORS}/{case}/Time",
            acc=f"{SENSORS}/{case}/Accelerometer",
            gyr=f"{SENSORS}/{case}/Gyroscope",
            mag=f"{SENSORS}/{case}/Magnetometer",
            orientation=f"{PROCESSED}/{case}/Orientation",
            rate=(f"{SENSORS}/{case}/Configuration", "Sample Rate"),
        )


def _read(file: Hdf5File, layout: _Layout) -> RecordedOpal:
    stamps = file.numbers(layout.time)
    if stamps is None:
        raise FileRefusedError(
            file.where, "the file contains no timestamps of {sensor}", RECORD_IT, sensor=quoted(layout.name)
        )
    stamps = stamps.reshape(-1)
    n = len(stamps)
    acc, gyr = _matrix(file, layout.acc, (n, 3)), _matrix(file, layout.gyr, (n, 3))
    if acc is None:
        raise FileRefusedError(
            file.where, "the file contains no acceleration of {sensor}", RECORD_IT, sensor=quoted(layout.name)
        )
    if gyr is None:
        raise FileRefusedError(
            file.where, "the file contains no angular rates of {sensor}", RECORD_IT, sensor=quoted(layout.name)
        )
    for place, quantity in ((layout.acc, "acceleration"), (layout.gyr, "angular rate")):
        _check_unit(file, place, quantity)
    orientation, mag = _matrix(file, layout.orientation, (n, 4)), _matrix(file, layout.mag, (n, 3))
    name = FileClock(f"{file.where}, {layout.name}", lambda row: f"sample {row + 1}", "Time", TICK_S)
    clock = whole_clock(stamps, name, SAVE_AGAIN)
    is_new = clock.is_new
    rate_hz = _number(file, *layout.rate)
    number = layout.case.rpartition("-")[2].lstrip("0")
    ids = tuple(dict.fromkeys(filter(None, (layout.case, number))))
    return RecordedOpal(
        name=layout.name,
        called=ids[-1],
        ids=ids,
        stamps=clock.stamps[is_new],
        tick_s=TICK_S,
        acc_m_s2=acc[is_new],
        gyr_rad_s=gyr[is_new],
        q_earth_from_sensor=None if orientation is None else _rotations(orientation[is_new]),
        mag=None if mag is None else mag[is_new],
        rate_hz=rate_hz if rate_hz is not None and 0 < rate_hz < np.inf else None,
        of_clock=clock.findings,
    )


def _matrix(file: Hdf5File, place: str, shape: tuple[int, int]) -> FloatArray | None:
    """(n, m) values of a dataset, of which infinite ones are none."""
    values = file.numbers(place)
    if values is None:
        return None
    if values.shape != shape:
        raise FileRefusedError(
            f"{file.where}, {place}",
            "the values have the shape {shape} instead of {required}",
            SAVE_AGAIN,
            shape=values.shape,
            required=shape,
        )
    values[np.isinf(values)] = np.nan
    return values


def _rotations(q: FloatArray) -> FloatArray:
    """(n, 4) orientations of length 1; none (NaN) where the file holds zeros."""
    length = np.linalg.norm(q, axis=1, keepdims=True)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(np.abs(length - 1.0) < 0.01, q / length, np.nan)


def _check_unit(file: Hdf5File, place: str, quantity: str) -> None:
    """Files that name their units name these."""
    for unit in filter(None, file.texts(place, UNITS_ATTRIBUTE)):
        if unit not in SI[quantity]:
            raise FileRefusedError(
                f"{file.where}, {place}",
                "the values are in {unit}, expected {required}",
                "Save the recording again in SI units, in the APDM software",
                unit=quoted(unit),
                required=SI[quantity][0],
            )


def _number(file: Hdf5File, place: str, name: str) -> float | None:
    value = np.atleast_1d(np.asarray(file.attribute(place, name))).ravel()
    return float(value[0]) if value.dtype.kind in "fiu" and len(value) else None
