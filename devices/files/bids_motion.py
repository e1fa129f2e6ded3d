"""Recordings of BIDS-Motion: a table of samples, one of its channels, and a file of settings for each tracking system.

`*_motion.tsv` has no heads: its columns are the rows of `*_channels.tsv`, which states what each is of which tracked
point and in which unit; `*_motion.json` has the sampling frequency. The files belong together by their names, as BIDS
has it; which they are is found by the table of channels. Times are those of a LATENCY channel, in seconds from
`acq_time` in `*_scans.tsv`, else even. Settings that BIDS lets stand in a folder above are not looked for there.

Two columns that `gaitwright export` adds say what BIDS has no word for: the sensor's number, and what its rates are.
Settings of ours state that nobody was measured, and that the latencies of all tracking systems have one zero.
Held against the table of channels of a public set of a commercial system, and against our own exports.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from core.findings import Finding, Severity
from core.samples import G_M_S2, FloatArray, ImuBlock, RateKind, SensorInfo
from devices.files.bids_tables import (
    CHANNELS,
    ENDINGS,
    EXPORT_AGAIN,
    MOTION,
    MotionSystem,
    common_base,
    has_channels,
    is_channels,
    read_system,
)
from devices.files.clock_repair import FileClock, RepairedClock, repaired
from devices.files.magnitudes import check_magnitudes
from devices.files.refusal import FileRefusedError, quoted
from devices.files.trial import ImportedSensor, ImportedTrial, UnreadFile

SYSTEM = re.compile(r"_tracksys-([A-Za-z0-9]+)")
LAST_MOVED_YEAR = 1925  # BIDS moves times that must not be known to before its end
DERIVED = "derived"  # in our column of what rates are
AXES, QUATERNION = ("x", "y", "z"), ("quat_w", "quat_x", "quat_y", "quat_z")
ACC_UNITS = {"m/s^2": 1.0, "m/s²": 1.0, "m/s2": 1.0, "m.s-2": 1.0, "g": G_M_S2}
RATE_UNITS = {"rad/s": 1.0, "deg/s": np.pi / 180, "°/s": np.pi / 180, "dps": np.pi / 180}
WINDOW_S = 0.25  # over which a sensor turns enough to see whether its acceleration turns with it
IN_SENSOR_AXES = "Export the sensors' own data, in sensor axes"


def is_bids_motion(path: Path, head: bytes) -> bool:
    """Whether a file is a table of channels, or one that such a table belongs to; a folder may hold other files."""
    return is_channels(head) or (path.name.endswith(ENDINGS) and has_channels(path))


def bids_recording(path: Path) -> str:
    """What the names of all files of one recording have in common: all but the tracking system and what each holds."""
    return SYSTEM.sub("", common_base(path).name)


def bids_motion_trial(files: Sequence[Path], rate_hz: float | None = None) -> ImportedTrial:
    """Read one recording's tracked points with accelerometer and gyroscope; raises FileRefusedError."""
    bases = list(dict.fromkeys(map(common_base, files)))
    if len({bids_recording(path) for path in files}) > 1:
        raise FileRefusedError(
            ", ".join(path.name for path in files),
            "the files belong to several recordings",
            "Import one recording at a time",
        )
    systems: list[MotionSystem] = []
    unread: list[UnreadFile] = []
    for base in bases:
        try:
            system = read_system(base)
            unread += _read_sensors(system, rate_hz)
            systems.append(system)
        except FileRefusedError as refusal:
            unread.append(UnreadFile(f"{base}{MOTION}", (), refusal))
    if not any(system.sensors for system in systems) and unread:
        raise unread[0].refusal
    started = systems[0].started
    is_real = started[:4].isdigit() and int(started[:4]) > LAST_MOVED_YEAR
    is_simulated = any(system.is_simulated for system in systems)
    sensors = tuple(_on_one_clock(systems))
    return ImportedTrial("bids-motion", sensors, tuple(unread), started if is_real else "", is_simulated)


def _read_sensors(system: MotionSystem, asked_hz: float | None) -> list[UnreadFile]:
    """Add the tracked points that are sensors, and give those that are only half of one."""
    unread = []
    for point in system.points:
        of_point = system.points[point]
        has = [all((kind, axis) in of_point for axis in AXES) for kind in ("ACCEL", "GYRO")]
        if all(has):
            system.sensors.append(_sensor(system, point, asked_hz))
        elif any(has):
            lacking = "ACCEL" if has[1] else "GYRO"
            refusal = FileRefusedError(
                system.base.name,
                "{point} has no {lacking} channels",
                "Leave this tracked point out, or export both ACCEL and GYRO",
                point=quoted(point),
                lacking=lacking,
            )
            unread.append(UnreadFile(point, (point,), refusal))
    if not system.sensors:
        raise FileRefusedError(
            f"{system.base.name}{CHANNELS}",
            "no tracked point has three ACCEL and three GYRO channels",
            "Choose a recording from inertial sensors",
        )
    return unread


def _sensor(system: MotionSystem, point: str, asked_hz: float | None) -> ImportedSensor:
    where, of_point = f"{system.base.name}{MOTION}", system.points[point]

    def values(kind: str, components: Sequence[str]) -> FloatArray | None:
        if not all((kind, one) in of_point for one in components):
            return None
        return system.rows[:, [of_point[kind, one] for one in components]]

    acc, gyr = values("ACCEL", AXES), values("GYRO", AXES)
    assert acc is not None  # `_read_sensors` leaves out a point without
    assert gyr is not None
    acc = acc * _scale(system, of_point, "ACCEL", ACC_UNITS, point)
    gyr = gyr * _scale(system, of_point, "GYRO", RATE_UNITS, point)
    clock, rate_hz = _times(system, of_point, asked_hz, where)
    is_kept = clock.is_new & (np.isfinite(acc).any(axis=1) | np.isfinite(gyr).any(axis=1))  # what is missing is a gap
    acc, gyr, time_s = acc[is_kept], gyr[is_kept], clock.stamps[is_kept]
    first = system.channels[of_point["GYRO", "x"]]
    check_magnitudes(acc, gyr, point, where)
    if first.frame.casefold() == "global" and rate_hz is not None:
        _check_axes(acc, gyr, rate_hz, point, where)
    q, mag = values("ORNT", QUATERNION), values("MAGN", AXES)
    q = None if q is None else q[is_kept]
    is_up = q is not None and _turns_gravity_up(q, acc)
    block = ImuBlock(
        sensor=first.sensor or point,
        time_s=time_s,
        gyr_rad_s=gyr,
        acc_m_s2=acc,
        q_earth_from_sensor=q if is_up else None,
        mag=None if mag is None else mag[is_kept],
        is_rate_derived=first.rate_kind == DERIVED,
    )
    kind = RateKind.INSTANTANEOUS if first.rate_kind == DERIVED else None
    kind = RateKind(first.rate_kind) if first.rate_kind in set(RateKind) else kind
    info = SensorInfo(
        serial=first.sensor or point, model=system.maker, rate_hz=rate_hz, rate_kind=kind, clock=first.clock
    )
    findings = [*system.of_rows, *clock.findings]
    if block.is_rate_derived:
        findings.append(Finding("rate_from_orientation", Severity.INFO, ""))
    if q is not None and not is_up:
        findings.append(Finding("orientation_left_out", Severity.INFO, "", {"names": "ORNT"}))
    ids = (first.sensor,) if first.sensor else ()
    return ImportedSensor(point, ids, f"{system.base}{MOTION}", block, info, tuple(findings))


def _scale(
    system: MotionSystem,
    of_point: Mapping[tuple[str, str], int],
    kind: str,
    units: Mapping[str, float],
    point: str,
) -> FloatArray:
    """(3,) what brings the three channels to SI units."""
    stated = [system.channels[of_point[kind, axis]].units for axis in AXES]
    for unit in stated:
        if unit not in units:
            raise FileRefusedError(
                f"{system.base.name}{CHANNELS}",
                "{kind} of {point} is in {unit}, expected one of {known}",
                EXPORT_AGAIN,
                kind=kind,
                point=quoted(point),
                unit=quoted(unit),
                known=", ".join(units),
            )
    return np.array([units[unit] for unit in stated])


def _times(
    system: MotionSystem, of_point: Mapping[tuple[str, str], int], asked_hz: float | None, where: str
) -> tuple[RepairedClock, float | None]:
    """Seconds of the rows, and samples per second."""
    n = len(system.rows)
    own = [place for (kind, _), place in of_point.items() if kind == "LATENCY"]
    common = [place for place, one in enumerate(system.channels) if one.type == "LATENCY"]
    rate_hz = system.rate_hz or asked_hz
    if not common:
        if rate_hz is None:
            raise FileRefusedError(
                where, "the sampling frequency of the recording is missing", "Give the rate in Hz (--rate)"
            )
        return RepairedClock(np.arange(n) / rate_hz, np.ones(n, dtype=bool), ()), rate_hz
    time_s = system.rows[:, (own or common)[0]]
    steps_s = np.diff(time_s)
    is_empty = np.isnan(time_s)
    if is_empty.any():
        raise FileRefusedError(f"{where}, line {int(np.argmax(is_empty)) + 1}", "a sample has no time", EXPORT_AGAIN)
    step_s = float(np.median(steps_s)) if len(steps_s) else np.nan
    if rate_hz is not None and np.isfinite(step_s) and not 0.5 < step_s * rate_hz < 2.0:
        raise FileRefusedError(
            where,
            "the file's latency step of {step} does not match {rate} samples per second",
            "Give latencies in seconds, as BIDS requires",
            step=f"{step_s:g}",
            rate=f"{rate_hz:g}",
        )
    if rate_hz is None and step_s > 0:
        rate_hz = round(1.0 / step_s, 2)
    return repaired(time_s, FileClock(where, lambda row: f"line {row + 1}", "latency")), rate_hz


def _check_axes(acc_m_s2: FloatArray, gyr_rad_s: FloatArray, rate_hz: float, point: str, where: str) -> None:
    """What is named as in global axes may be so: where a sensor turns, gravity has to turn in its own axes."""
    rows = max(int(WINDOW_S * rate_hz), 2)
    turned = -np.cross(gyr_rad_s, acc_m_s2) / rate_hz
    windows = len(turned) // rows
    if windows < 8:
        return
    expected = turned[: windows * rows].reshape(windows, rows, 3).sum(axis=1)[:-1]
    seen = np.diff(acc_m_s2[: windows * rows : rows], axis=0)
    is_there = np.isfinite(expected + seen).all(axis=1)
    weight = float(np.sum(expected[is_there] ** 2))
    if weight < 1.0 * max(int(is_there.sum()), 1):
        return  # it hardly turns: no axes can be distinguished from others
    if float(np.sum(expected[is_there] * seen[is_there])) < 0.4 * weight:
        raise FileRefusedError(
            where,
            "the acceleration of {sensor} does not rotate with the sensor, so it is in global axes",
            IN_SENSOR_AXES,
            sensor=quoted(point),
        )


def _turns_gravity_up(q: FloatArray, acc_m_s2: FloatArray) -> bool:
    is_there = np.isfinite(q).all(axis=1) & np.isfinite(acc_m_s2).all(axis=1)
    if not is_there.any() or np.any(np.abs(np.linalg.norm(q[is_there], axis=1) - 1.0) > 0.01):
        return False
    up = Rotation.from_quat(q[is_there], scalar_first=True).apply(acc_m_s2[is_there]).mean(axis=0)
    return bool(up[2] > 0.9 * np.linalg.norm(up))


def _on_one_clock(systems: Sequence[MotionSystem]) -> Iterator[ImportedSensor]:
    """The sensors of all systems, each brought to the start of the first by the times of acquisition.

    Our own exports state that all latencies have one zero, as recordings without a known start have, too.
    """
    known = [system for system in systems if system.sensors]
    is_common = all(system.is_common_start for system in known)
    starts = [0.0 if is_common else _moment(system.started) for system in known]
    first = min((start for start in starts if start is not None), default=None)
    names = [sensor.name for system in known for sensor in system.sensors]
    for system, start in zip(known, starts, strict=True):
        is_apart = len(known) > 1 and (start is None or None in starts)
        offset_s = start - first if start is not None and first is not None and not is_apart else 0.0
        found = SYSTEM.search(system.base.name)
        label = found[1] if found else system.base.name
        for sensor in system.sensors:
            block, info, findings = sensor.block, sensor.info, sensor.findings
            if offset_s:
                block = replace(block, time_s=block.time_s + offset_s)
            if is_apart:
                info = replace(info, clock=label)
                findings = (*findings, Finding("not_synchronised", Severity.WARNING, ""))
            name = sensor.name if names.count(sensor.name) == 1 else f"{sensor.name} ({label})"
            yield ImportedSensor(name, sensor.ids, sensor.file, block, info, findings)


def _moment(started: str) -> float | None:
    """Seconds, on a clock that is the same for all times of one file."""
    try:
        moment = datetime.fromisoformat(started)
    except ValueError:
        return None
    utc = moment if moment.tzinfo is not None else moment.replace(tzinfo=UTC)
    return (utc - datetime(1900, 1, 1, tzinfo=UTC)).total_seconds()
