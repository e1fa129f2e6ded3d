"""Recordings of Movella (Xsens) DOT sensors: one CSV or Excel file per sensor, by the app, its export, or the PC SDK.

The app heads its columns with lines such as `DeviceTag:`; the SDK writes columns only. Rates are deg/s, specific force
m/s2 in sensor axes, free acceleration (without gravity) m/s2 in earth axes, z up; the orientation is earth from sensor,
as quaternion, scalar first, or as Euler angles in degrees about x, y and z, turned about z first. Time counts from the
sensor's start: microseconds from the app, tenths of a millisecond from the SDK, 32 bits in both.

Held against excerpts of public files: of the app at 60 Hz, of its export of a recording at 120 Hz, whose rates are
means over the interval before their stamps, and of the SDK. The Excel form, delta quantities and a turn of the clock
are read as they are described and not held against a real file.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from core.findings import Finding, Severity
from core.samples import BoolArray, FloatArray, ImuBlock, RateKind, SensorInfo
from devices.files.clock_repair import FileClock, repaired, unwrapped
from devices.files.magnitudes import check_magnitudes, times_the_turning
from devices.files.orientation_rates import (
    Numbers,
    derive_rates,
    quaternions,
    rate_kind_by,
    rates_of_turns,
    with_gravity,
)
from devices.files.refusal import FileRefusedError
from devices.files.site_names import without_site
from devices.files.spreadsheets import ZIP, read_xlsx, sheet_states
from devices.files.tables import Table, header_of, read_csv
from devices.files.trial import ImportedSensor, ImportedTrial, read_each

TIME = "SampleTimeFine"
ACC = ("Acc_X", "Acc_Y", "Acc_Z")
GYR = ("Gyr_X", "Gyr_Y", "Gyr_Z")
MAG = ("Mag_X", "Mag_Y", "Mag_Z")
FREE_ACC = ("FreeAcc_X", "FreeAcc_Y", "FreeAcc_Z")
QUAT = ("Quat_W", "Quat_X", "Quat_Y", "Quat_Z")
EULER = ("Euler_X", "Euler_Y", "Euler_Z")
TURNS = ("dq_W", "dq_X", "dq_Y", "dq_Z")
VELOCITIES = ("dv[1]", "dv[2]", "dv[3]")
NUMERIC = frozenset((TIME, *ACC, *GYR, *MAG, *FREE_ACC, *QUAT, *EULER, *TURNS, *VELOCITIES))
ONLY_DOT = {"Quat_W", "Euler_X", "dq_W"}  # MT Manager calls its own otherwise
TAG = "DeviceTag"
DELIMITERS = ",;\t"

TICKS_TURN_AT = 2**32
MICROSECOND_S, TENTH_OF_A_MILLISECOND_S = 1e-6, 1e-4
RATES_HZ = (1.0, 4.0, 10.0, 12.0, 15.0, 20.0, 30.0, 60.0, 120.0)  # all that these sensors have
RATE_ERROR = 0.03  # the steps of 120 Hz in tenths of a millisecond are 83 or 84
FEW_STEPS = 0.05  # a shorter step than this share of them all is no period but a mistake in some
SAME_GRID_S = 2e-5  # synchronised sensors stamp the same instants; two that are not do so once in two hundred times
ONE_TRIAL_S = 60.0  # the app starts its sensors one after the other
CLOCK = "Movella DOT"
DOT_GRAVITY_M_S2 = 9.8127  # by which the sensors make free acceleration
ROTATION_ERROR = 0.01
WRONG_UNIT = 0.05  # of the orientation's turning; rates in rad/s that are taken for deg/s are a 57th
MEASURE_AGAIN = (
    'Record again in "Custom mode 5" or, to sensor memory, with orientation, acceleration and angular velocity'
)
EXPORT_AGAIN = "Export the file again from the Movella DOT app"


@dataclass(frozen=True, slots=True)
class DotFile:
    """One sensor's file: n samples in sensor axes, NaN where a value is missing.

    `ticks` ascend: turns of their 32 bits are taken out. `counter`: the whole periods since the first sample.
    `is_synced` None: the file does not say.
    """

    path: Path
    ids: tuple[str, ...]
    info: SensorInfo
    started: str
    is_synced: bool | None
    ticks: Numbers
    tick_s: float
    counter: Numbers
    block: ImuBlock
    is_gravity_added: bool
    of_clock: tuple[Finding, ...]


def is_movella_dot(path: Path, head: bytes) -> bool:
    """Whether a file that begins so is one of these, by the lines above its columns or by the columns."""
    if head.startswith(ZIP):
        return sheet_states(path, TIME.encode())
    lines = head.decode("utf-8", "replace").lstrip("\ufeff").splitlines()
    header = next((number for number, line in enumerate(lines) if TIME in line), None)
    if header is None or lines[0].startswith("//"):  # of MT Manager, whose columns have the same names
        return False
    names = [name.strip() for name in re.split(f"[{DELIMITERS}]", lines[header])]
    if TIME not in names:
        return False
    is_headed = any(line.startswith(f"{TAG}:") for line in lines[:header])
    return (
        is_headed or bool(ONLY_DOT & set(names)) or (names[0] == TIME and {ACC[0], FREE_ACC[0]} & set(names) != set())
    )


def dot_recording(path: Path) -> str:
    """Give what the names of a recording's files share: of the app's, the time, without milliseconds."""
    dated = re.fullmatch(r".*?(?:_[0-9A-F]{12}_(\d{8}_\d{6})|_(\d{8}_\d{6})_\d{3})", path.stem)
    return dated[1] or dated[2] if dated else without_site(path.stem)


def read_dot(path: Path, asked_hz: float | None = None) -> DotFile:
    """Read one file; raises FileRefusedError without force or rates, with other units or times stepping back."""
    where = path.name
    settings, table = _read(path, where)
    ticks = unwrapped(table, TIME, TICKS_TURN_AT, where)
    reported_hz = _reported_rate(settings) or asked_hz
    steps: Numbers = np.diff(ticks)
    tick_s, rate_hz = _clock(steps[steps > 0], reported_hz, where)
    clock = repaired(ticks, FileClock(where, table.place, TIME, tick_s))
    is_new = clock.is_new
    ticks = np.rint(clock.stamps[is_new]).astype(np.int64)
    counter = _counter(ticks, tick_s, rate_hz)
    q = _orientation(table, where)
    q = None if q is None else q[is_new]
    gyr, rate_kind = _rates(table, is_new, q, counter, rate_hz, where)
    acc, is_gravity_added = _specific_force(table, is_new, q, rate_hz, where)
    is_empty = np.logical_and.accumulate((acc == 0.0).all(axis=1) & (gyr == 0.0).all(axis=1))
    if not is_empty.all():  # the export begins with a row of nothing but zeros
        acc[is_empty] = gyr[is_empty] = np.nan
    check_magnitudes(acc, None, path.stem, where)  # rates in deg/s are recognised by the orientation
    is_rate_derived = not (set(GYR) <= set(table.numbers) or set(TURNS) <= set(table.numbers))
    ids = tuple(dict.fromkeys([*_named(path), *filter(None, [settings.get(TAG)])]))
    serial = (*ids, path.stem)[0]
    since_s = (ticks - ticks[:1]) * tick_s
    mag = table.matrix(MAG)[is_new] if set(MAG) <= set(table.numbers) else None
    block = ImuBlock(serial, since_s, gyr, acc, q, mag, is_rate_derived)
    return DotFile(
        path=path,
        ids=ids,
        info=SensorInfo(
            serial=serial,
            model="Movella DOT",
            firmware=settings.get("FirmwareVersion", ""),
            rate_hz=rate_hz,
            rate_kind=rate_kind,
        ),
        started=settings.get("StartTime", ""),
        is_synced=settings["SyncStatus"].casefold() == "synced" if settings.get("SyncStatus") else None,
        ticks=ticks,
        tick_s=tick_s,
        counter=counter,
        block=block,
        is_gravity_added=is_gravity_added,
        of_clock=(*table.findings, *clock.findings),
    )


def movella_dot_trial(files: Sequence[Path], rate_hz: float | None = None) -> ImportedTrial:
    """Read a trial, one sensor per file; unsynchronised sensors keep their own clock; raises FileRefusedError."""
    read, unread = read_each(files, lambda path: read_dot(path, rate_hz), _named)
    starts_s = _starts_s(read)
    is_one_grid = _is_one_grid(read, starts_s)
    is_shared = len(read) < 2 or all(file.is_synced for file in read) or is_one_grid
    sensors = []
    for file, start_s in zip(read, starts_s, strict=True):
        info = replace(file.info, clock=(CLOCK if is_one_grid else "") if is_shared else file.info.serial)
        block = replace(file.block, time_s=file.block.time_s + start_s) if is_shared else file.block
        findings = tuple(_findings(file, is_shared))
        sensors.append(ImportedSensor(file.path.name, file.ids, str(file.path), block, info, findings))
    return ImportedTrial("movella-dot", tuple(sensors), tuple(unread), started=read[0].started if read else "")


def _named(path: Path) -> list[str]:
    """The sensor's address in a file's name, with or without hyphens."""
    address = re.search(r"(?<![0-9A-Fa-f])((?:[0-9A-Fa-f]{2}-?){5}[0-9A-Fa-f]{2})(?![0-9A-Fa-f])", path.stem)
    return [address[1].replace("-", "").upper()] if address else []


def _read(path: Path, where: str) -> tuple[dict[str, str], Table]:
    with path.open("rb") as file:
        is_zip = file.read(len(ZIP)) == ZIP
    if is_zip:
        before, table = read_xlsx(path, where, NUMERIC, TIME)
    else:
        lines, names = header_of(path, where, delimiters=DELIMITERS, header_names=TIME)
        if TIME not in names:
            raise FileRefusedError(where, "column {name} is missing", EXPORT_AGAIN, name=TIME)
        before = [re.split(f"[{DELIMITERS}]", line, maxsplit=1) for line in lines]
        table = read_csv(path, where, NUMERIC, delimiters=DELIMITERS, keep_others=False, header_names=TIME)
    settings = {
        cells[0].strip().rstrip(":"): cells[1].strip(f" {DELIMITERS}")
        for cells in before
        if len(cells) > 1 and cells[0]
    }
    return settings, table


def _reported_rate(settings: Mapping[str, str]) -> float | None:
    rate = re.match(r"(\d{1,4}(\.\d{1,3})?)\s*Hz", settings.get("OutputRate", ""))
    return float(rate[1]) or None if rate else None


def _clock(steps: Numbers, reported_hz: float | None, where: str) -> tuple[float, float]:
    """Length of a tick in s and samples per second: the unit in which the common step is one of the sensors' rates."""
    if not len(steps):
        return MICROSECOND_S, reported_hz or 60.0
    step = float(np.sort(steps)[int(FEW_STEPS * len(steps))])
    for tick_s in (MICROSECOND_S, TENTH_OF_A_MILLISECOND_S):
        for rate_hz in [reported_hz] if reported_hz else RATES_HZ:
            if abs(step * tick_s * rate_hz - 1.0) < RATE_ERROR:
                return tick_s, rate_hz
    if reported_hz:  # so many are lost that hardly two follow each other
        for tick_s in (MICROSECOND_S, TENTH_OF_A_MILLISECOND_S):
            periods = step * tick_s * reported_hz
            if 1.5 < periods < 20.0 and abs(periods - round(periods)) < RATE_ERROR * periods:
                return tick_s, reported_hz
        raise FileRefusedError(
            where,
            "the file's time step of {step} does not match {rate} samples per second",
            "Give the recording rate in Hz (--rate), or export the file again",
            step=f"{step:.0f}",
            rate=f"{reported_hz:g}",
        )
    raise FileRefusedError(
        where,
        "the file's time step of {step} matches no rate of these sensors, neither in microseconds nor "
        "in tenths of a millisecond",
        "Give the recording rate in Hz (--rate)",
        step=f"{step:.0f}",
    )


def _counter(ticks: Numbers, tick_s: float, rate_hz: float) -> Numbers:
    periods: Numbers = np.rint(np.diff(ticks) * (tick_s * rate_hz)).astype(np.int64)
    return np.concatenate([np.zeros(len(ticks[:1]), dtype=np.int64), np.cumsum(periods)])


def _orientation(table: Table, where: str) -> FloatArray | None:
    """(n, 4) earth from sensor, scalar first."""
    names = set(table.numbers)
    if names >= set(QUAT):
        q = table.matrix(QUAT)
        _refuse_no_rotation(q, table, where)
        return q
    if not names >= set(EULER):
        return None
    about_xyz = table.matrix(EULER)
    is_there = np.isfinite(about_xyz.sum(axis=1)) & (np.abs(about_xyz) <= 360.0).all(axis=1)
    return quaternions(lambda a: Rotation.from_euler("ZYX", a, degrees=True), about_xyz[:, ::-1], is_there)


def _refuse_no_rotation(q: FloatArray, table: Table, where: str) -> None:
    is_wrong = np.abs(np.linalg.norm(q, axis=1) - 1.0) > ROTATION_ERROR
    if is_wrong.any():
        row = table.place(int(np.argmax(is_wrong)))
        raise FileRefusedError(f"{where}, {row}", "the orientation is not a valid rotation", EXPORT_AGAIN)


def _rates(
    table: Table, is_new: BoolArray, q: FloatArray | None, counter: Numbers, rate_hz: float, where: str
) -> tuple[FloatArray, RateKind | None]:
    names = set(table.numbers)
    if names >= set(GYR):
        gyr = np.radians(table.matrix(GYR)[is_new])
        if q is None:
            return gyr, None
        if times_the_turning(gyr, q, counter, rate_hz) < WRONG_UNIT:
            raise FileRefusedError(where, "the angular rates are in rad/s, not in deg/s", EXPORT_AGAIN)
        return gyr, rate_kind_by(q, gyr, counter, rate_hz)
    if names >= set(TURNS):
        turns = table.matrix(TURNS)
        _refuse_no_rotation(turns, table, where)
        turns = turns[is_new]
        return rates_of_turns(turns, np.isfinite(turns.sum(axis=1)), rate_hz), RateKind.AVERAGED
    if q is None:
        raise FileRefusedError(
            where, "there are neither angular rates (Gyr_X) nor an orientation to derive them from", MEASURE_AGAIN
        )
    return derive_rates(q, counter, rate_hz), RateKind.INSTANTANEOUS


def _specific_force(
    table: Table, is_new: BoolArray, q: FloatArray | None, rate_hz: float, where: str
) -> tuple[FloatArray, bool]:
    """(n, 3) and whether gravity had to be added."""
    names = set(table.numbers)
    if names >= set(ACC):
        return table.matrix(ACC)[is_new], False
    if names >= set(VELOCITIES):
        return table.matrix(VELOCITIES)[is_new] * rate_hz, False
    if names >= set(EULER) and not names & {*FREE_ACC, *GYR, *QUAT}:
        raise FileRefusedError(
            where,
            "the file holds only Euler angles, as the payload Orientation (Euler) measures them, and no acceleration",
            MEASURE_AGAIN,
        )
    if not names >= set(FREE_ACC):
        raise FileRefusedError(where, "there is no acceleration (Acc_X, Acc_Y, Acc_Z)", MEASURE_AGAIN)
    if q is None:
        raise FileRefusedError(
            where,
            "the acceleration in the file is without gravity (FreeAcc_X). There is no orientation to restore gravity",
            MEASURE_AGAIN,
        )
    return with_gravity(table.matrix(FREE_ACC)[is_new], q, DOT_GRAVITY_M_S2), True


def _starts_s(files: Sequence[DotFile]) -> list[float]:
    """When each file starts after the first that does, by the turns of the clocks that lie nearest to each other."""
    filled = [file for file in files if len(file.ticks)]
    if not filled:
        return [0.0] * len(files)
    near_s = float(filled[0].ticks[0]) * filled[0].tick_s
    starts_s = []
    for file in files:
        start_s = float(file.ticks[0]) * file.tick_s if len(file.ticks) else near_s
        turn_s = TICKS_TURN_AT * file.tick_s
        starts_s.append(start_s + round((near_s - start_s) / turn_s) * turn_s)
    first_s = min(starts_s)
    return [start_s - first_s for start_s in starts_s]


def _is_one_grid(files: Sequence[DotFile], starts_s: Sequence[float]) -> bool:
    """Whether the stamps of several sensors are the same instants, as only one clock makes them."""
    filled = [(file, start_s) for file, start_s in zip(files, starts_s, strict=True) if len(file.ticks) > 1]
    if len(filled) < 2 or any(file.is_synced is False for file, _ in filled):
        return False
    first, reference_s = filled[0]
    period_s = first.tick_s * float(first.ticks[-1] - first.ticks[0]) / max(float(first.counter[-1]), 1.0)
    for file, start_s in filled[1:]:
        apart_s = start_s - reference_s
        beside_s = apart_s - round(apart_s / period_s) * period_s
        if file.tick_s != first.tick_s or abs(apart_s) > ONE_TRIAL_S or abs(beside_s) > max(SAME_GRID_S, file.tick_s):
            return False
    return True


def _findings(file: DotFile, is_shared: bool) -> Iterator[Finding]:
    if file.block.is_rate_derived:
        yield Finding("rate_from_orientation", Severity.INFO, "")
    if file.is_gravity_added:
        yield Finding("gravity_from_orientation", Severity.INFO, "")
    yield from file.of_clock
    if not is_shared:
        yield Finding("not_synchronised", Severity.WARNING, "")
