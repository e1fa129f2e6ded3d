"""The CSV that x-io's program makes of its first sensor, the x-IMU: `..._CalInertialAndMag.csv`, one for each sensor.

It holds no times. The packet number counts packets of every kind, also those that are in other files; the rate is in
`..._Registers.csv` beside it, else it has to be given. Samples are evenly spaced, except where the packet number leaps
further than the other packets make it. Held against public files of the maker's library.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.findings import Finding, Severity
from core.samples import G_M_S2, BoolArray, FloatArray, ImuBlock, SensorInfo
from devices.files.clock_repair import FileClock, repaired
from devices.files.magnitudes import check_magnitudes
from devices.files.own_clocks import with_own_clocks
from devices.files.refusal import FileRefusedError
from devices.files.site_names import without_site
from devices.files.tables import Table, read_csv
from devices.files.trial import OF_XIMU, REGISTERS, ImportedSensor, ImportedTrial, read_each, registers_beside

FORMAT, MODEL = "ximu", "x-IMU"
NUMBER = "packet number"
NUMBERS = "Packet number", "Packet Number"
GYR = tuple(f"Gyroscope {axis} (deg/s)" for axis in "XYZ")
ACC = tuple(f"Accelerometer {axis} (g)" for axis in "XYZ")
MAG = tuple(f"Magnetometer {axis} (G)" for axis in "XYZ")
NAME_OF_RATE = "InertialAndMagneticDataRate"
MOST_REGISTERS = 1_000_000  # bytes
MOST_RATE = 10  # of the register: 512 Hz
DELIMITERS = ",;\t"
WINDOW = 64  # samples over which packets are counted
EXPORT_AGAIN = "Convert the file again with the x-IMU GUI"


@dataclass(frozen=True, slots=True)
class PacketTimes:
    """Times of samples in seconds, which samples they are, and the shortest loss that is seen, in samples."""

    time_s: FloatArray
    is_kept: BoolArray
    least_loss: int


def is_ximu(_path: Path, head: bytes) -> bool:
    """Whether a table begins with packet numbers, rates and specific force as the x-IMU's do."""
    first = head.partition(b"\n")[0].decode("utf-8", "replace").strip().lstrip("\ufeff")
    names = [name.strip() for name in first.split(max(DELIMITERS, key=first.count))]
    return names[0].casefold() == NUMBER and set(names) >= {*GYR, *ACC}


def ximu_recording(path: Path) -> str:
    """What the names of a recording's files have in common."""
    return without_site(_name(path))


def _name(path: Path) -> str:
    """The sensor's name in its program: the file's without what it holds."""
    name = path.stem
    for ending in OF_XIMU:
        name = name.removesuffix(ending)
    return name


def ximu_trial(files: Sequence[Path], rate_hz: float | None = None) -> ImportedTrial:
    """Read one trial's sensors, a file each; raises FileRefusedError without a rate, or OSError."""
    sensors, unread = read_each(files, lambda path: _sensor(path, rate_hz))
    return ImportedTrial(FORMAT, tuple(with_own_clocks(sensors)), tuple(unread))


def _sensor(path: Path, asked_hz: float | None) -> ImportedSensor:
    where = path.name
    table = read_csv(path, where, {*NUMBERS, *GYR, *ACC, *MAG}, delimiters=DELIMITERS, keep_others=False)
    missing = [name for name in (*GYR, *ACC) if name not in table.numbers]
    missing += [NUMBERS[0]] if not set(NUMBERS) & set(table.numbers) else []
    if missing:
        raise FileRefusedError(where, "column {name} is missing", EXPORT_AGAIN, name=missing[0])
    rate_hz = asked_hz or _registered_rate(path)
    if rate_hz is None:
        raise FileRefusedError(
            where,
            "the file has packet numbers but no times, and no registers beside it give its rate",
            "Put the file {registers} beside it, or give the sampling rate (--rate)",
            registers=(registers_beside(path) or [Path(REGISTERS)])[0].name,
        )
    counts = table.numbers[next(name for name in NUMBERS if name in table.numbers)]
    times = _times(counts, rate_hz, table, where)
    acc, gyr = table.matrix(ACC)[times.is_kept] * G_M_S2, np.radians(table.matrix(GYR)[times.is_kept])
    name = _name(path)
    check_magnitudes(acc, gyr, name, where, gyr_unit="deg/s")
    mag = table.matrix(MAG)[times.is_kept] if set(MAG) <= set(table.numbers) else None
    block = ImuBlock(name, times.time_s, gyr, acc, mag=mag)
    numbers = {"rate_hz": rate_hz, "least_loss": times.least_loss}
    findings = (*table.findings, Finding("packet_numbers", Severity.WARNING, "", numbers))
    info = SensorInfo(serial=name, model=MODEL, rate_hz=rate_hz)
    return ImportedSensor(name, (path.stem,), str(path), block, info, findings)


def _times(counts: FloatArray, rate_hz: float, table: Table, where: str) -> PacketTimes:
    """Even times, with a gap where packets were lost; packet numbers that step back are mended or refused."""
    clock = repaired(counts, FileClock(where, table.place, NUMBER))
    kept = clock.stamps[clock.is_new]
    steps = np.diff(kept)
    if not len(steps):
        return PacketTimes(np.zeros(len(kept)), clock.is_new, 1)
    window = min(WINDOW, len(steps))
    packets = max(float(np.median(kept[window:] - kept[:-window])) / window, 1.0)  # of all kinds, for each sample
    most = 2.0 * np.ceil(packets) + 2.0  # of packets of all kinds between two samples
    lost = np.where(steps > most, np.maximum(np.round(steps / packets) - 1.0, 0.0), 0.0)
    index = np.concatenate([[0.0], np.cumsum(1.0 + lost)])
    return PacketTimes(index / rate_hz, clock.is_new, int(np.ceil(most / packets)))


def _registered_rate(path: Path) -> float | None:
    """Samples per second by the sensor's register: 2 to the power of its value less 1; None where it is not there."""
    registers = next((one for one in registers_beside(path) if one.is_file()), None)
    if registers is None:
        return None
    with registers.open("rb") as file:
        lines = file.read(MOST_REGISTERS).decode("utf-8", "replace").splitlines()
    for line in lines:
        cells = [cell.strip() for cell in line.replace(";", ",").split(",")]
        if len(cells) >= 3 and cells[-1] == NAME_OF_RATE and cells[2].isascii() and cells[2].isdigit():
            return 2.0 ** (int(cells[2]) - 1) if 1 <= int(cells[2]) <= MOST_RATE else None
    return None
