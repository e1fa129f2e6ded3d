"""Streams of an Xsens MTi kept as they came: bytes of the Xbus protocol, one file for each sensor.

What a message holds is read as by the live driver, `drivers/xbus.py`, held against recorded streams and another
program's reading of them. Times are those of the sensor's fine clock, else of its packet counter. Rates are means over
the interval before their stamps. Where rates or acceleration were not sent, they are made of what was: the turns and
velocities of each interval, or the orientation, with gravity added to free acceleration; the latter two are stated.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from core.findings import Finding, Severity
from core.samples import BoolArray, FloatArray, ImuBlock, RateKind, SensorInfo
from devices.drivers.xbus import (
    AXES_MASK,
    ITEM_MASK,
    NORTH_EAST_DOWN,
    PREAMBLE,
    Item,
    Items,
    Message,
    Mid,
    XbusFramer,
    values,
)
from devices.drivers.xsens_mti import (
    COUNTER_BITS,
    DRIVER,
    FINE_BITS,
    FINE_HZ,
    MOST_M_S2,
    MOST_RAD_S,
    upward,
)
from devices.files.clock_repair import FileClock, RepairedClock, repaired
from devices.files.magnitudes import check_magnitudes
from devices.files.orientation_rates import Numbers, derive_rates, rates_of_turns, with_gravity
from devices.files.own_clocks import with_own_clocks
from devices.files.refusal import FileRefusedError
from devices.files.trial import ImportedSensor, ImportedTrial, read_each

OLD_DATA = 0x32  # MTData, which MTi sensors sent before MTData2
MOST_BEFORE = 4096  # bytes of noise before the first message
PIECE = 1 << 20  # bytes
LEAST_MESSAGES = 3
MOST_LONE = 0.1  # of the samples: more is no damage, but another rate
MATRIX, FREE_ACCELERATION = 0x2020, 0x4030
SET_OUTPUT = "Set the sensor to send rate of turn, acceleration and sample time fine (MT Manager, Output Configuration)"


@dataclass(frozen=True, slots=True)
class MtiStream:
    """What was read of one stream: one row for each message with motion, NaN where it held no value.

    `lone`: how many messages held a rate or an acceleration and not both.
    """

    ticks: FloatArray
    counter: FloatArray
    rate: FloatArray
    force: FloatArray
    turn: FloatArray
    velocity: FloatArray
    free: FloatArray
    q: FloatArray
    mag: FloatArray
    serial: str
    damaged: int
    lone: int


def is_mti_stream(path: Path, head: bytes) -> bool:
    """Whether a file is a stream of Xbus messages of one sensor, old ones included."""
    if PREAMBLE not in head[:MOST_BEFORE]:
        return False
    messages = XbusFramer(_ANSWERS).feed(head)
    of_motion = [one for one in messages if one.mid in (Mid.MT_DATA2, OLD_DATA)]
    read = sum(len(one.data) + 5 for one in messages)
    return len(of_motion) >= min(LEAST_MESSAGES, len(messages)) > 0 and 2 * read > len(head)


def mti_trial(files: Sequence[Path], rate_hz: float | None = None) -> ImportedTrial:
    """Read one trial's sensors, a file each; raises FileRefusedError if the only file has no motion or time."""
    sensors, unread = read_each(files, lambda path: _sensor(path, rate_hz))
    return ImportedTrial(DRIVER, tuple(with_own_clocks(sensors)), tuple(unread))


def read_mti_stream(path: Path) -> MtiStream:
    """Read a stream's messages, passing over damaged stretches; FileRefusedError if old ones, or no motion."""
    framer, rows = XbusFramer(_ANSWERS), _Rows()
    with path.open("rb") as file:
        while piece := file.read(PIECE):
            rows.take(framer.feed(piece))
    rows.take(framer.flush())
    if not rows.rows and rows.is_old:
        raise FileRefusedError(
            path.name,
            "the file's messages are of the older type MTData, which does not describe its content",
            SET_OUTPUT,
        )
    if not rows.rows:
        raise FileRefusedError(path.name, "the file contains no rate of turn, acceleration or orientation", SET_OUTPUT)
    parts = np.split(np.array(rows.rows), np.cumsum([1, 1, 3, 3, 4, 3, 3, 4]), axis=1)
    ticks, counter, rate, force, turn, velocity, free, q, mag = parts
    return MtiStream(
        ticks[:, 0],
        counter[:, 0],
        rate,
        force,
        turn,
        velocity,
        free,
        q,
        mag,
        rows.serial,
        damaged=framer.damaged,
        lone=rows.lone,
    )


class _Rows:
    """A row for each message with motion, in the order in which they came."""

    def __init__(self) -> None:
        self.rows: list[tuple[float, ...]] = []
        self.serial = ""
        self.is_old = False
        self.lone = 0

    def take(self, messages: Sequence[Message]) -> None:
        for one in messages:
            if one.mid == Mid.MT_DATA2:
                self._sample(one.items)
            elif one.mid == Mid.DEVICE_ID + 1 and one.data:
                self.serial = one.data.hex().upper()
            self.is_old |= one.mid == OLD_DATA

    def _sample(self, items: Items) -> None:
        reported = {identifier & ITEM_MASK: identifier for identifier in items}

        def of(kind: int, count: int, most: float = np.inf) -> tuple[float, ...]:
            found = values(reported[kind], items[reported[kind]]) if kind in reported else ()
            is_meant = len(found) == count and all(-most < value < most for value in found)
            return found if is_meant else (np.nan,) * count

        rate, force = of(Item.RATE, 3, MOST_RAD_S), of(Item.ACCELERATION, 3, MOST_M_S2)
        turn, velocity = of(Item.ROTATION_CHANGE, 4, 2.0), of(Item.VELOCITY_CHANGE, 3, MOST_M_S2)
        free, q = of(FREE_ACCELERATION, 3, MOST_M_S2), of(Item.QUATERNION, 4, 2.0)
        if np.isnan(q[0]):
            q = _of_matrix(of(MATRIX, 9, 2.0))
        if reported.get(Item.QUATERNION, reported.get(MATRIX, 0)) & AXES_MASK == NORTH_EAST_DOWN:
            q = upward(q)
        if reported.get(FREE_ACCELERATION, 0) & AXES_MASK == NORTH_EAST_DOWN:
            free = free[1], free[0], -free[2]
        has_rate = np.isfinite([rate[0], turn[0], q[0]]).any()
        has_force = np.isfinite([force[0], velocity[0], free[0]]).any()
        if not has_rate or not has_force:
            self.lone += bool(has_rate or has_force)  # else it is what the satellites reported
            return
        ticks, counter = of(Item.FINE_TIME, 1), of(Item.COUNTER, 1)
        mag = of(Item.MAGNETIC_FIELD, 3)
        self.rows.append((*ticks, *counter, *rate, *force, *turn, *velocity, *free, *q, *mag))


def _of_matrix(matrix: Sequence[float]) -> tuple[float, ...]:
    """A quaternion (4) of a rotation matrix, which is sent column after column; NaN of what is none."""
    columns = np.array(matrix).reshape(3, 3).T
    if not np.isfinite(columns).all() or np.abs(columns @ columns.T - np.eye(3)).max() > 0.05:
        return (np.nan,) * 4
    return tuple(Rotation.from_matrix(columns).as_quat(scalar_first=True).tolist())


def _sensor(path: Path, asked_hz: float | None) -> ImportedSensor:
    stream = read_mti_stream(path)
    clock = _times(stream, asked_hz, path.name)
    is_new, time_s = clock.is_new, clock.stamps[clock.is_new]
    step_s = np.diff(time_s)
    usual_s = float(np.median(step_s)) if len(step_s) else 0.01
    rate_hz = asked_hz or round(1.0 / usual_s, 3)
    counter: Numbers = np.rint((time_s - time_s[:1]) / usual_s).astype(np.int64)
    q = stream.q[is_new] if np.isfinite(stream.q).any() else None
    gyr, is_derived = _rates(stream, is_new, q, counter, rate_hz)
    acc, is_added = _forces(stream, is_new, q, usual_s, path.name)
    check_magnitudes(acc, None if is_derived else gyr, stream.serial or path.stem, path.name, is_export=False)
    findings = [*clock.findings, *_findings(stream, is_derived=is_derived, is_added=is_added)]
    name = stream.serial or path.stem
    block = ImuBlock(
        sensor=name,
        time_s=time_s,
        gyr_rad_s=gyr,
        acc_m_s2=acc,
        q_earth_from_sensor=q,
        mag=stream.mag[is_new] if np.isfinite(stream.mag).any() else None,
        is_rate_derived=is_derived,
    )
    kind = RateKind.INSTANTANEOUS if is_derived else RateKind.AVERAGED
    info = SensorInfo(serial=stream.serial, model="MTi", rate_hz=rate_hz, rate_kind=kind)
    return ImportedSensor(path.name, tuple({path.stem, name}), str(path), block, info, tuple(findings))


def _times(stream: MtiStream, asked_hz: float | None, where: str) -> RepairedClock:
    """Seconds of all rows."""
    if np.isfinite(stream.ticks).all():
        time_s = np.unwrap(stream.ticks, period=2.0**FINE_BITS) / FINE_HZ
    elif asked_hz is None:
        raise FileRefusedError(
            where,
            "not every message has a time (sample time fine)",
            "Give the samples per second in Hz (--rate), so that the packet counter gives the time",
        )
    elif np.isfinite(stream.counter).all():
        time_s = np.unwrap(stream.counter, period=2.0**COUNTER_BITS) / asked_hz
    else:
        raise FileRefusedError(where, "the file's messages contain neither time nor packet counter", SET_OUTPUT)
    return repaired(time_s, FileClock(where, lambda row: f"sample {row + 1}", "its clock"))


def _rates(
    stream: MtiStream, is_new: BoolArray, q: FloatArray | None, counter: Numbers, rate_hz: float
) -> tuple[FloatArray, bool]:
    """(m, 3) rad/s, and whether they had to be derived from the orientation."""
    if np.isfinite(stream.rate).any():
        return stream.rate[is_new], False
    turn = stream.turn[is_new]
    is_there = np.isfinite(turn).all(axis=1) & (np.abs(np.linalg.norm(turn, axis=1) - 1.0) < 0.05)
    if is_there.any():
        return rates_of_turns(turn, is_there, rate_hz), False
    assert q is not None  # of rows without rate and turn
    return derive_rates(q, counter, rate_hz), True


def _forces(
    stream: MtiStream, is_new: BoolArray, q: FloatArray | None, usual_s: float, where: str
) -> tuple[FloatArray, bool]:
    """(m, 3) m/s2 with gravity, and whether that had to be added."""
    if np.isfinite(stream.force).any():
        return stream.force[is_new], False
    if np.isfinite(stream.velocity).any():
        return stream.velocity[is_new] / usual_s, False
    if q is None:
        raise FileRefusedError(
            where,
            "the acceleration in the file is without gravity. There is no orientation to restore gravity",
            SET_OUTPUT,
        )
    return with_gravity(stream.free[is_new], q), True


def _findings(stream: MtiStream, *, is_derived: bool, is_added: bool) -> Iterator[Finding]:
    if is_derived:
        yield Finding("rate_from_orientation", Severity.INFO, "")
    if is_added:
        yield Finding("gravity_from_orientation", Severity.INFO, "")
    if stream.lone > MOST_LONE * len(stream.ticks):
        yield Finding("slower_kept", Severity.WARNING, "", {"kept": len(stream.ticks), "count": stream.lone})
    if stream.damaged:
        yield Finding("damaged_stretches", Severity.WARNING, "", {"count": stream.damaged})


_ANSWERS = frozenset({OLD_DATA, Mid.DEVICE_ID + 1, Mid.PRODUCT + 1, Mid.FIRMWARE + 1, Mid.OUTPUT + 1})
