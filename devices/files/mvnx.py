"""Exports of Xsens MVN as MVNX: one XML file with all sensors of a trial, frame by frame.

The orientation of a sensor is earth from sensor, scalar first, earth z up. Its free acceleration is in earth axes,
m/s2, gravity taken out; files of older versions hold acceleration and angular rates (rad/s) in sensor axes instead.
Only frames of the type "normal" are measured, the others are poses of the calibration. The stamps in ms are rounded,
so time is the number of the frame divided by the frame rate.

Not held against a real file: read as the MVN manual describes it.
"""

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from core.findings import Finding, Severity
from core.samples import BoolArray, FloatArray, ImuBlock, RateKind, SensorInfo
from devices.files.clock_repair import FileClock, repaired
from devices.files.magnitudes import check_magnitudes
from devices.files.orientation_rates import Numbers, derive_rates, rate_kind_by, with_gravity
from devices.files.refusal import FileRefusedError, quoted
from devices.files.trial import ImportedSensor, ImportedTrial

ORIENTATION, FREE_ACC, ACC = "sensorOrientation", "sensorFreeAcceleration", "sensorAcceleration"
GYR, MAG = "sensorAngularVelocity", "sensorMagneticField"
WIDTHS = {ORIENTATION: 4, FREE_ACC: 3, ACC: 3, GYR: 3, MAG: 3}
CLOCK = "Xsens MVN"  # one station stamps all sensors
LARGEST_FRAME = 2**40  # beyond, a frame's number is damaged
LEAST_RATE_HZ, MOST_RATE_HZ = 1.0, 2000.0  # beyond, it is damaged
ROTATION_ERROR = 0.01
EXPORT_AGAIN = "Export the file again from MVN as MVNX"
WITH_THEM = "Export the file again from MVN as MVNX, with sensor orientation and sensor free acceleration"


@dataclass(slots=True)
class MvnxFile:
    """What has been read so far: rows of each quantity by its element, frames' numbers and their stamps in ms."""

    where: str
    started: str = ""
    rate_hz: float | None = None
    sensors: list[str] = field(default_factory=list)
    index: list[int] = field(default_factory=list)
    stamps_ms: list[float] = field(default_factory=list)
    rows: dict[str, list[FloatArray | None]] = field(default_factory=lambda: {name: [] for name in WIDTHS})


def is_mvnx(_path: Path, head: bytes) -> bool:
    """Whether a file that begins so is one of these."""
    return re.search(rb"<mvnx[\s>]", head[:4096]) is not None


def read_mvnx(path: Path) -> MvnxFile:
    """Read one file frame by frame; raises FileRefusedError for no XML, several people, or invalid frames."""
    found = MvnxFile(path.name)
    subjects = 0
    open_elements: list[ET.Element] = []
    try:
        with path.open("rb") as file:
            for event, element in ET.iterparse(file, events=("start", "end")):
                name = element.tag.rpartition("}")[2]
                if event == "start":
                    open_elements.append(element)
                    if name == "subject":
                        subjects += 1
                        _note_subject(found, element, subjects)
                    continue
                open_elements.pop()
                _note(found, name, element)
                if name in ("frame", "segment", "joint") and open_elements:
                    open_elements[-1].clear()
    except (ET.ParseError, LookupError, ValueError) as error:  # the last two of encodings
        raise FileRefusedError(
            found.where,
            "the file is not a complete XML file ({why})",
            "Copy or export the file again",
            why=quoted(error),
        ) from error
    if not found.sensors:
        raise FileRefusedError(found.where, "the file lists no sensors", WITH_THEM)
    return found


def mvnx_trial(files: Sequence[Path], rate_hz: float | None = None) -> ImportedTrial:
    """Read one trial's sensors by segment, all in one file; raises FileRefusedError where one cannot be read."""
    if len(files) != 1:
        raise FileRefusedError(
            ", ".join(path.name for path in files),
            "an MVNX file contains all sensors of a trial",
            "Import one file at a time",
        )
    file = read_mvnx(files[0])
    rate_hz = file.rate_hz or rate_hz
    if rate_hz is None:
        raise FileRefusedError(file.where, "the frame rate of the file is missing", "Give the rate in Hz (--rate)")
    frames = np.array(file.index, dtype=np.int64)
    clock = repaired(frames, FileClock(file.where, lambda row: f"frame {row + 1}", "index", 1.0 / rate_hz), step=1.0)
    is_new = clock.is_new
    index: Numbers = np.rint(clock.stamps[is_new]).astype(np.int64)
    _check_stamps(file, index, rate_hz)
    values = {name: _by_sensor(file, name, is_new) for name in WIDTHS}
    is_gravity_added, is_rate_derived = values[ACC] is None, values[GYR] is None
    acc, gyr, rate_kinds = _motion(file, values, index, rate_hz)
    q, mag = values[ORIENTATION], values[MAG]
    findings = (*_findings(is_rate_derived, is_gravity_added), *clock.findings)
    sensors = []
    for k, name in enumerate(file.sensors):
        block = ImuBlock(
            sensor=name,
            time_s=(index - index[:1]) / rate_hz,
            gyr_rad_s=gyr[:, k],
            acc_m_s2=acc[:, k],
            q_earth_from_sensor=None if q is None else q[:, k],
            mag=None if mag is None else mag[:, k],
            is_rate_derived=is_rate_derived,
        )
        info = SensorInfo(serial=name, model="Xsens", rate_hz=rate_hz, rate_kind=rate_kinds[k], clock=CLOCK)
        sensors.append(ImportedSensor(name, (), str(files[0]), block, info, findings))
    return ImportedTrial("mvnx", tuple(sensors), started=file.started)


def _note_subject(found: MvnxFile, subject: ET.Element, number: int) -> None:
    if number > 1:
        raise FileRefusedError(found.where, "the file contains several people", "Export each person to a separate file")
    found.started = subject.get("recDate", "")
    try:
        rate_hz = float(subject.get("frameRate", "nan"))
    except ValueError:
        return
    found.rate_hz = rate_hz if LEAST_RATE_HZ <= rate_hz <= MOST_RATE_HZ else None


def _note(found: MvnxFile, name: str, element: ET.Element) -> None:
    """Take from an element that has been read whole what is needed of it."""
    if name == "frame" and element.get("type", "normal") == "normal":
        _note_frame(found, element)
    elif name == "sensor":
        label = element.get("label", "").strip()
        if not label or label in found.sensors:
            raise FileRefusedError(
                found.where, "{label} is not a sensor name, or is used twice", EXPORT_AGAIN, label=quoted(label)
            )
        found.sensors.append(label)


def _note_frame(found: MvnxFile, frame: ET.Element) -> None:
    number = frame.get("index", str(len(found.index)))
    if re.fullmatch(r"\d{1,13}", number, re.ASCII) is None or int(number) > LARGEST_FRAME:
        raise FileRefusedError(found.where, "{number} is not a frame number", EXPORT_AGAIN, number=quoted(number))
    found.index.append(int(number))
    try:
        found.stamps_ms.append(float(frame.get("time", "nan")))
    except ValueError:
        found.stamps_ms.append(np.nan)
    texts = {child.tag.rpartition("}")[2]: child.text or "" for child in frame}
    for name, width in WIDTHS.items():
        found.rows[name].append(_numbers(found, texts[name], width, number) if name in texts else None)


def _numbers(found: MvnxFile, text: str, width: int, frame: str) -> FloatArray:
    try:
        values = np.array(text.replace(",", ".").split(), dtype=np.float64)
    except ValueError as error:
        raise FileRefusedError(
            f"{found.where}, frame {frame}",
            "a value is not a number ({why})",
            EXPORT_AGAIN,
            why=quoted(error),
        ) from error
    if len(values) != width * len(found.sensors):
        raise FileRefusedError(
            f"{found.where}, frame {frame}",
            "the frame has {count} values for {sensors} sensors, expected {required}",
            EXPORT_AGAIN,
            count=len(values),
            sensors=len(found.sensors),
            required=width * len(found.sensors),
        )
    return values


def _check_stamps(file: MvnxFile, index: Numbers, rate_hz: float) -> None:
    """The stamps in ms and the frames' numbers have to give the same rate."""
    stamps_s = np.array(file.stamps_ms) / 1000.0
    if len(index) < 2 or not np.isfinite(stamps_s[[0, -1]]).all():
        return
    by_stamps, by_frames = float(stamps_s[-1] - stamps_s[0]), float(index[-1] - index[0]) / rate_hz
    if by_frames > 1.0 and abs(by_stamps - by_frames) > 0.02 * by_frames + 0.1:
        raise FileRefusedError(
            file.where,
            "the frames of the file take {frames} s at {rate} Hz, but its timestamps take {stamps} s",
            EXPORT_AGAIN,
            frames=f"{by_frames:.1f}",
            rate=f"{rate_hz:g}",
            stamps=f"{by_stamps:.1f}",
        )


def _by_sensor(file: MvnxFile, name: str, is_new: BoolArray) -> FloatArray | None:
    """(n, sensors, width), NaN where a frame lacks it; None where all do."""
    rows, width = file.rows[name], WIDTHS[name]
    if not any(row is not None for row in rows):
        return None
    values = np.full((len(rows), width * len(file.sensors)), np.nan)
    for k, row in enumerate(rows):
        if row is not None:
            values[k] = row
    values[~np.isfinite(values)] = np.nan
    return values.reshape(len(rows), len(file.sensors), width)[is_new]


def _motion(
    file: MvnxFile, values: dict[str, FloatArray | None], index: Numbers, rate_hz: float
) -> tuple[FloatArray, FloatArray, list[RateKind | None]]:
    """Specific force and angular rates (n, sensors, 3), and what each sensor's rates stand for."""
    q, acc, gyr = values[ORIENTATION], values[ACC], values[GYR]
    if q is not None:
        error = np.abs(np.linalg.norm(q, axis=2) - 1.0).max(axis=1, initial=0.0)
        if (error > ROTATION_ERROR).any():
            frame = int(index[int(np.argmax(error > ROTATION_ERROR))])
            raise FileRefusedError(
                f"{file.where}, frame {frame}", "the orientation is not a valid rotation", EXPORT_AGAIN
            )
    if acc is None:
        free = values[FREE_ACC]
        if free is None or q is None:
            raise FileRefusedError(
                file.where, "there is no sensor acceleration, or no orientation to add gravity with", WITH_THEM
            )
        acc = with_gravity(free, q)
    sensors = range(len(file.sensors))
    for k, name in enumerate(file.sensors):
        check_magnitudes(acc[:, k], None if gyr is None else gyr[:, k], name, file.where)
    if gyr is not None:
        kinds = [None if q is None else rate_kind_by(q[:, k], gyr[:, k], index, rate_hz) for k in sensors]
        return acc, gyr, kinds
    if q is None:
        raise FileRefusedError(file.where, "there is no sensor orientation", WITH_THEM)
    derived = np.stack([derive_rates(q[:, k], index, rate_hz) for k in sensors], axis=1)
    return acc, derived, [RateKind.INSTANTANEOUS for _ in sensors]


def _findings(is_rate_derived: bool, is_gravity_added: bool) -> Iterator[Finding]:
    if is_rate_derived:
        yield Finding("rate_from_orientation", Severity.INFO, "")
    if is_gravity_added:
        yield Finding("gravity_from_orientation", Severity.INFO, "")
