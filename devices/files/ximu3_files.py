"""What the programs of x-io keep of x-IMU3 sensors: the bytes of one (`.ximu3`), or the folder of CSV made of them.

The bytes are read as by the live driver, which was held against the maker's own decoder. Of the folder `Inertial.csv`
is read, by its heads as public files show them, and `Quaternion.csv` where it has the same times. Each sensor has a
clock of its own, of microseconds.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from core.findings import Finding, Severity
from core.samples import G_M_S2, FloatArray, ImuBlock, SensorInfo
from devices.clocks.clock import BACK_S
from devices.drivers.ximu3 import DRIVER, MODEL, Ximu3Framer, received_in
from devices.files.clock_repair import FileClock, repaired, usual_rate, whole_clock
from devices.files.magnitudes import check_magnitudes
from devices.files.own_clocks import with_own_clocks
from devices.files.refusal import FileRefusedError
from devices.files.tables import read_csv
from devices.files.text_files import as_utf8
from devices.files.trial import BESIDE_INERTIAL, ImportedSensor, ImportedTrial, read_each
from devices.stream import decoded

INERTIAL = "Inertial.csv"
TIME = "Timestamp (us)"
GYR = tuple(f"Gyroscope {axis} (deg/s)" for axis in "XYZ")
ACC = tuple(f"Accelerometer {axis} (g)" for axis in "XYZ")
QUAT = ("W", "X", "Y", "Z")
DELIMITERS = ",;\t"
BEGINNING = 400  # bytes
US_PER_S = 1e6
LEAST_MESSAGES = 3
CONVERT_AGAIN = "Convert the .ximu3 file again, or import that file directly"


def is_ximu3(path: Path, head: bytes) -> bool:
    """Whether a file is a sensor's bytes or its Inertial.csv, or a folder holds one."""
    if not head:
        return path.is_dir() and (path / INERTIAL).is_file()
    first = head.partition(b"\n")[0].decode("utf-8", "replace").strip().lstrip("\ufeff")
    if first.startswith(TIME):
        return any(set(first.split(one)) >= {*GYR, *ACC} for one in DELIMITERS)
    framer = Ximu3Framer()
    framer.feed(head, 0.0)
    received = framer.received
    return len(received.rows) >= LEAST_MESSAGES and 10 * received.damaged < len(received.rows) + received.skipped


def ximu3_trial(files: Sequence[Path], rate_hz: float | None = None) -> ImportedTrial:
    """Read one trial's sensors, a file or folder each, rate by stamps; raises FileRefusedError or OSError."""
    sensors, unread = read_each(files, _sensor)
    return ImportedTrial(DRIVER, tuple(with_own_clocks(sensors)), tuple(unread))


def ximu3_recording(path: Path) -> str:
    """What files or folders of one recording have in common: the folder that holds them."""
    return path.parent.parent.name if path.name == INERTIAL else path.parent.name


def _sensor(path: Path) -> ImportedSensor:
    is_table = path.is_dir() or path.name == INERTIAL or _begins(path).startswith(TIME)
    block, findings = _of_table(path / INERTIAL if path.is_dir() else path) if is_table else _of_bytes(path)
    if not len(block):
        raise FileRefusedError(
            path.name,
            "the file contains no inertial messages",
            "Set the sensor to send inertial messages, and record again",
        )
    check_magnitudes(block.acc_m_s2, block.gyr_rad_s, block.sensor, path.name, gyr_unit="deg/s", is_export=is_table)
    info = SensorInfo(serial=block.sensor, model=MODEL, rate_hz=usual_rate(block.time_s))
    return ImportedSensor(block.sensor, (path.stem,), str(path), block, info, tuple(findings))


def _begins(path: Path) -> str:
    with path.open("rb") as file:
        return as_utf8(file.read(BEGINNING)).decode("utf-8", "replace").lstrip("\ufeff")


def _of_bytes(path: Path) -> tuple[ImuBlock, list[Finding]]:
    received = received_in(path)
    name = FileClock(path.name, lambda row: f"sample {row + 1}", "its clock")
    clock = repaired(np.array([row[0] for row in received.rows]), name, slack=BACK_S)  # messages overtake each other
    timed = [(float(time_s), *row[1:]) for time_s, row in zip(clock.stamps, received.rows, strict=True) if time_s >= 0]
    found = decoded(path.stem, replace(received, rows=timed), [row[0] for row in timed])
    damaged = found.counts.damaged
    reported = [Finding("damaged_stretches", Severity.WARNING, "", {"count": damaged})] if damaged else []
    return found.block, [*clock.findings, *reported]


def _of_table(path: Path) -> tuple[ImuBlock, list[Finding]]:
    where = f"{path.parent.name}/{path.name}"
    table = read_csv(path, where, {TIME, *GYR, *ACC}, delimiters=DELIMITERS, keep_others=False)
    missing = [name for name in (TIME, *GYR, *ACC) if name not in table.numbers]
    if missing:
        raise FileRefusedError(where, "column {name} is missing", CONVERT_AGAIN, name=missing[0])
    clock = whole_clock(table.numbers[TIME], FileClock(where, table.place, TIME, 1.0 / US_PER_S), CONVERT_AGAIN)
    time_s, is_new = clock.stamps / US_PER_S, clock.is_new
    name = path.parent.name if path.name == INERTIAL else path.stem
    block = ImuBlock(
        sensor=name,
        time_s=time_s[is_new],
        gyr_rad_s=np.radians(table.matrix(GYR)[is_new]),
        acc_m_s2=table.matrix(ACC)[is_new] * G_M_S2,
        q_earth_from_sensor=_orientation(path.with_name(BESIDE_INERTIAL), time_s[is_new]),
    )
    return block, [*table.findings, *clock.findings]


def _orientation(path: Path, time_s: FloatArray) -> FloatArray | None:
    """(n, 4) at the samples' instants; None where there is none at the same ones."""
    if not len(time_s) or not path.is_file():
        return None
    where = f"{path.parent.name}/{path.name}"
    table = read_csv(path, where, {TIME, *QUAT}, delimiters=DELIMITERS, keep_others=False)
    if not set(table.numbers) >= {TIME, *QUAT}:
        return None
    own_s, q = table.numbers[TIME] / US_PER_S, table.matrix(QUAT)
    is_rotation = np.abs(np.linalg.norm(q, axis=1) - 1.0) < 0.05
    found = np.full((len(time_s), 4), np.nan)
    at = np.minimum(np.searchsorted(time_s, own_s), len(time_s) - 1)
    is_there = is_rotation & np.isfinite(own_s) & (time_s[at] == own_s)
    found[at[is_there]] = q[is_there]
    return found if is_there.any() else None
