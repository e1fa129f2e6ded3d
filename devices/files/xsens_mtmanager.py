"""Exports of Xsens MT Manager: one text per sensor, all of one trial on one packet counter.

The matrix is written by columns and earth from sensor: Mat[i][j] is row i, column j, and turns the specific force of a
sensor at rest to earth z. Euler angles are degrees, turned about z (yaw), then y, then x. The rates of MTw sensors are
means over the interval before their stamp, as the orientation in the same file shows.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from core.findings import Finding, Severity
from core.samples import FloatArray, ImuBlock, RateKind, SensorInfo
from devices.files.clock_repair import FileClock, repaired, unwrapped, without_turns
from devices.files.magnitudes import middle_size, times_the_turning
from devices.files.orientation_rates import Numbers, derive_rates, quaternions, rate_kind_by
from devices.files.refusal import FileRefusedError
from devices.files.tables import Table, header_of, read_csv
from devices.files.trial import ImportedSensor, ImportedTrial, read_each

COUNTER = "PacketCounter"
FINE_TIME = "SampleTimeFine"
ACC = ("Acc_X", "Acc_Y", "Acc_Z")
GYR = ("Gyr_X", "Gyr_Y", "Gyr_Z")
MAG = ("Mag_X", "Mag_Y", "Mag_Z")
USUAL_HZ = 100.0
QUAT = ("Quat_q0", "Quat_q1", "Quat_q2", "Quat_q3")
EULER = ("Yaw", "Pitch", "Roll")
MATRIX = tuple(f"Mat[{row}][{column}]" for row in (1, 2, 3) for column in (1, 2, 3))
NUMERIC = frozenset((COUNTER, FINE_TIME, *ACC, *GYR, *MAG, *QUAT, *EULER, *MATRIX))
DELIMITERS = "\t;, "

COUNTER_TURNS_AT = 65536  # 16 bit
FINE_TICKS_PER_S = 10_000.0
FINE_TURNS_AT = 2.0**32
ROTATION_ERROR = 0.01  # of a matrix or norm; six decimals leave 1e-5
LARGEST_RATE_RAD_S = 35.0  # 2000 deg/s, the widest range of these sensors
EXPORT_AGAIN = "Export the file again from MT Manager"
WITH_IT = "Export the file again from MT Manager, including the missing data"


@dataclass(frozen=True, slots=True)
class MtFile:
    """One sensor's file: n samples in sensor axes, NaN where a value is missing.

    `counter` ascends: turns of the device's 16 bits are taken out. `rate_hz` None: the file does not give it.
    """

    path: Path
    info: SensorInfo
    counter: Numbers
    acc_m_s2: FloatArray
    gyr_rad_s: FloatArray | None
    q_earth_from_sensor: FloatArray | None
    mag: FloatArray | None
    of_clock: tuple[Finding, ...]
    rate_hz: float | None


def is_mtmanager(_path: Path, head: bytes) -> bool:
    """Give whether a file begins with MT Manager's comments; its columns are named as Movella DOT's."""
    return head.lstrip(b"\xef\xbb\xbf").startswith(b"//") and COUNTER.encode() in head


def read_mtmanager(path: Path) -> MtFile:
    """Read one file; raises FileRefusedError without acceleration, rates or orientation, or other units."""
    where = path.name
    comments, names = header_of(path, where, comment="//", delimiters=DELIMITERS)
    if COUNTER not in names:
        raise FileRefusedError(where, "column {name} is missing", WITH_IT, name=COUNTER)
    if not set(ACC) <= set(names):
        raise FileRefusedError(where, "there is no acceleration (Acc_X, Acc_Y, Acc_Z)", WITH_IT)
    table = read_csv(path, where, NUMERIC, comment="//", delimiters=DELIMITERS, keep_others=False)
    counter = unwrapped(table, COUNTER, COUNTER_TURNS_AT, where)
    q = _orientation(table, where)
    if not set(GYR) <= set(names) and q is None:
        raise FileRefusedError(
            where,
            "there are neither angular rates (Gyr_X) nor an orientation to derive them from",
            "Export the file again from MT Manager with angular rates or orientation",
        )
    settings = dict(line.split(":", 1) for line in comments if ":" in line)
    rate_hz = _header_rate(settings) or _fine_rate(table, counter)
    name = FileClock(where, table.place, COUNTER, 1.0 / (rate_hz or USUAL_HZ))
    clock = repaired(counter, name, step=1.0)
    is_new = clock.is_new
    file = MtFile(
        path=path,
        info=SensorInfo(
            serial=(sensor_ids(path) or [path.stem])[0],
            model=settings.get("ProductCode", "").strip(),
            firmware=settings.get("Firmware Version", "").strip(),
        ),
        counter=np.rint(clock.stamps[is_new]).astype(np.int64),
        acc_m_s2=table.matrix(ACC)[is_new],
        gyr_rad_s=table.matrix(GYR)[is_new] if set(GYR) <= set(names) else None,
        q_earth_from_sensor=None if q is None else q[is_new],
        mag=table.matrix(MAG)[is_new] if set(MAG) <= set(names) else None,
        of_clock=(*table.findings, *clock.findings),
        rate_hz=rate_hz,
    )
    _check_units(file)
    return file


def mtmanager_trial(files: Sequence[Path], rate_hz: float | None = None) -> ImportedTrial:
    """Read a trial aligned by packet counter over update rate, with gaps; raises FileRefusedError."""
    read, unread = read_each(files, read_mtmanager, sensor_ids)
    rate_hz = _common_rate(read, rate_hz)
    sensors = []
    for file, counter in zip(read, _start_together(read), strict=True):
        block = _block(file, counter, rate_hz)
        info = replace(file.info, rate_hz=rate_hz, rate_kind=_rate_kind(file, rate_hz))
        ids = tuple(sensor_ids(file.path))
        sensors.append(ImportedSensor(file.path.name, ids, str(file.path), block, info, tuple(_findings(file, block))))
    return ImportedTrial("xsens-mtmanager", tuple(sensors), tuple(unread))


def sensor_ids(path: Path) -> list[str]:
    """The ids by which a file's sensor may be called: the one in its header, the one at the end of its name."""
    try:
        comments, _ = header_of(path, path.name, comment="//", delimiters=DELIMITERS)
    except FileRefusedError:
        comments = []  # it may be among the files without being an export
    ids = [line.split(":", 1)[1].strip() for line in comments if line.startswith("DeviceId:")]
    named = re.search(r"_([0-9A-Fa-f]{8})$", path.stem)
    return list(dict.fromkeys([*ids, *([named[1]] if named else [])]))


def _orientation(table: Table, where: str) -> FloatArray | None:
    """(n, 4) earth from sensor, scalar first, from whichever of its three forms the file holds."""
    names = set(table.numbers)
    if names >= set(QUAT):
        q = table.matrix(QUAT)
        error = np.abs(np.linalg.norm(q, axis=1) - 1.0)
    elif names >= set(MATRIX):
        matrix = table.matrix(MATRIX).reshape(-1, 3, 3)
        error = np.abs(matrix).max(axis=(1, 2)) - 1.0  # NaN where an element is missing
        is_small = error < ROTATION_ERROR  # what is larger might not even be multiplied
        small = matrix[is_small]
        error[is_small] = np.abs(small @ small.swapaxes(1, 2) - np.eye(3)).max(axis=(1, 2))
        error[is_small] += np.linalg.det(small) < 0
        q = quaternions(Rotation.from_matrix, matrix, error < ROTATION_ERROR)
    elif names >= set(EULER):
        angles = table.matrix(EULER)
        error = np.zeros(len(angles))
        q = quaternions(lambda a: Rotation.from_euler("ZYX", a, degrees=True), angles, np.isfinite(angles.sum(axis=1)))
    else:
        return None
    wrong = np.flatnonzero(error > ROTATION_ERROR)
    if len(wrong):
        raise FileRefusedError(
            f"{where}, {table.place(int(wrong[0]))}", "the orientation is not a valid rotation", EXPORT_AGAIN
        )
    return q


def _header_rate(settings: Mapping[str, str]) -> float | None:
    rate = re.fullmatch(r"\s*([\d.]+)\s*Hz\s*", settings.get("Update Rate", ""))
    try:
        rate_hz = float(rate[1]) if rate else 0.0
    except ValueError:
        return None
    return rate_hz if rate_hz > 0 else None


def _fine_rate(table: Table, counter: Numbers) -> float | None:
    """The update rate by the device's own 10 kHz clock, where the file holds it."""
    ticks = table.numbers.get(FINE_TIME, np.empty(0))
    if len(ticks) < 2 or not np.isfinite(ticks).all():
        return None
    turned = without_turns(ticks.astype(np.int64), int(FINE_TURNS_AT))
    elapsed = float(turned[-1] - turned[0])
    return FINE_TICKS_PER_S * float(counter[-1] - counter[0]) / elapsed if elapsed > 0 else None


def _common_rate(files: Sequence[MtFile], asked_hz: float | None) -> float:
    rates_hz = {file.path.name: file.rate_hz for file in files if file.rate_hz is not None}
    if asked_hz is not None:
        rates_hz["--rate"] = asked_hz
    if not rates_hz:
        raise FileRefusedError(
            ", ".join(file.path.name for file in files),
            "the sample rate is missing",
            "Give the sample rate in Hz (--rate), as set in MT Manager for the recording",
        )
    (first, rate_hz), *others = rates_hz.items()
    for name, other_hz in others:
        if abs(other_hz - rate_hz) > 0.002 * rate_hz:  # clocks of two sensors differ less, settings more
            raise FileRefusedError(
                name,
                "the update rate is {here} Hz, but {there} Hz in {other}",
                "Import files of one trial only, and give its recording rate",
                here=f"{other_hz:g}",
                other=first,
                there=f"{rate_hz:g}",
            )
    return rate_hz


def _start_together(files: Sequence[MtFile]) -> list[Numbers]:
    """Every file's counter from the first packet of all, each brought to the turn that lies nearest to the first's."""
    filled = [file for file in files if len(file.counter)]
    if not filled:
        return [file.counter for file in files]
    reference, half = filled[0].counter[0], COUNTER_TURNS_AT // 2
    turned = [
        file.counter - file.counter[:1] + reference + (file.counter[:1] - reference + half) % COUNTER_TURNS_AT - half
        for file in files
    ]
    start = min(counter[0] for counter in turned if len(counter))
    return [counter - start for counter in turned]


def _block(file: MtFile, counter: Numbers, rate_hz: float) -> ImuBlock:
    gyr = file.gyr_rad_s
    if gyr is None:
        assert file.q_earth_from_sensor is not None  # read_mtmanager refuses a file without both
        gyr = derive_rates(file.q_earth_from_sensor, counter, rate_hz)
    return ImuBlock(
        sensor=file.info.serial,
        time_s=counter / rate_hz,
        gyr_rad_s=gyr,
        acc_m_s2=file.acc_m_s2,
        q_earth_from_sensor=file.q_earth_from_sensor,
        mag=file.mag,
        is_rate_derived=file.gyr_rad_s is None,
    )


def _rate_kind(file: MtFile, rate_hz: float) -> RateKind | None:
    if file.gyr_rad_s is None:
        return RateKind.INSTANTANEOUS
    if file.q_earth_from_sensor is None:
        return None
    return rate_kind_by(file.q_earth_from_sensor, file.gyr_rad_s, file.counter, rate_hz)


def _check_units(file: MtFile) -> None:
    where = file.path.name
    median = middle_size(file.acc_m_s2)
    if 0.7 < median < 1.4:
        raise FileRefusedError(
            where,
            "the median acceleration is {middle}; the unit seems to be g and not m/s2",
            EXPORT_AGAIN,
            middle=f"{median:.2f}",
        )
    if median < 0.7:
        raise FileRefusedError(
            where,
            "the median acceleration is {middle} m/s2, as if gravity had been removed",
            "Export the file again from MT Manager with Acc, not with FreeAcc",
            middle=f"{median:.2f}",
        )
    if file.gyr_rad_s is None:
        return
    speed = np.linalg.norm(file.gyr_rad_s, axis=1)
    ratio = np.nan
    if file.q_earth_from_sensor is not None:
        rate_hz = file.rate_hz or 100.0  # a ratio of 57 is seen with a rate that is off by two, too
        ratio = times_the_turning(file.gyr_rad_s, file.q_earth_from_sensor, file.counter, rate_hz)
    if ratio > 20.0 or (np.isnan(ratio) and np.any(speed > 2.0 * LARGEST_RATE_RAD_S)):
        raise FileRefusedError(where, "the angular rates are in deg/s, not in rad/s", EXPORT_AGAIN)


def _findings(file: MtFile, block: ImuBlock) -> Iterator[Finding]:
    if block.is_rate_derived:
        yield Finding("rate_from_orientation", Severity.INFO, "")
    yield from file.of_clock
