"""What a Shimmer3 keeps on its card: a head of 256 bytes, then samples in blocks of 512 bytes at most.

    0  period in ticks of 32768 Hz, u16 little-endian    3  switches of what is measured, 3 bytes little-endian
    16 settings; bit 2: synchronised by radio            30 version of the board, u16 big-endian; 3 is a Shimmer3
    44 real time less the board's, ticks, u64 big-endian 76, 97, 118, 139 calibration of wide-range accelerometer,
    251 the first sample's ticks since the board began,     rate, field and low-noise accelerometer, 21 bytes each
        5 bytes, the highest first, then little-endian

Each sample is a time of 3 bytes and the channels in a fixed order; where sensors were synchronised, each block begins
with a sign and 8 bytes: how far this clock is ahead of the leading one's, all bits set where that is not known. By
what an open reader of such files shows of them (pyshimmer); one of its own test files and what Consensys made of it
were read to the same numbers once, by hand. Calibrated as live data is. Parts of an hour each, of one folder
and called by numbers, are one recording.
"""

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.samples import FloatArray, ImuBlock, SensorInfo
from devices.drivers.shimmer3 import CALIBRATION_SIZE, TICK_HZ, TURN, calibrating
from devices.files.clock_repair import FileClock, repaired, without_turns
from devices.files.magnitudes import check_magnitudes
from devices.files.refusal import FileRefusedError, plain
from devices.files.trial import ImportedSensor

HEAD, BLOCK, STAMP = 256, 512, 9  # bytes
PERIOD, SWITCHES, SETTINGS, BOARD, REAL_TIME, START = 0, 3, 16, 30, 44, 251
SYNCHRONISED, SHIMMER3 = 0x04, 3
MOST_TICKS = 1 << 53  # 8000 years; what is more, was not set
PERIODS = (16, 32768)  # ticks: 2048 Hz to 1 Hz
LEAST_SAMPLES = 3
MOST_AHEAD_OFF = 0.05 * TICK_HZ  # what the radio reports is that far off its line only where it is wrong
MOST_OFF_RATE = 0.02
GYR_SCALE = 100.0 * np.pi / 180  # what its sensitivities are stored in multiples of, per rad/s
TIME_SIZE = 3
# what is measured, in its order in a sample: bit of its switch, bytes
ORDER: Mapping[str, tuple[int, int]] = {
    "acc_low_noise": (7, 6),
    "battery": (13, 2),
    "external_0": (1, 2),
    "external_1": (0, 2),
    "external_2": (11, 2),
    "internal_0": (9, 2),
    "internal_1": (8, 2),
    "internal_2": (23, 2),
    "strain": (15, 4),
    "internal_3": (10, 2),
    "skin": (2, 2),
    "rate": (6, 6),
    "acc_wide": (12, 6),
    "field": (5, 6),
    "pressure": (18, 5),
    "heart_1": (4, 7),
    "heart_1_short": (20, 5),
    "heart_2": (3, 7),
    "heart_2_short": (19, 5),
}
KNOWN_SWITCHES = sum(1 << bit for bit, _ in ORDER.values()) | 1 << 17  # a temperature that takes no room
CALIBRATIONS = {"acc_wide": 76, "rate": 97, "acc_low_noise": 139}
SET_IT = "Switch on gyroscope and wide-range accelerometer in Consensys, and record again"
Bytes = NDArray[np.uint8]
Ticks = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class CardPart:
    """One file: ticks (n,) since 1970 or since the board began, rates and forces (n, 3) in SI units."""

    ticks: Ticks
    rate: FloatArray
    force: FloatArray
    period: int
    is_synced: bool


def is_card(head: bytes) -> bool:
    """Give whether first bytes are of a Shimmer3's card: a valid head, and first times a period apart."""
    if len(head) < HEAD or int.from_bytes(head[BOARD : BOARD + 2], "big") != SHIMMER3:
        return False
    period, switches = _head(head)
    if not PERIODS[0] <= period <= PERIODS[1] or switches == 0 or switches & ~KNOWN_SWITCHES:
        return False
    size, at = _size(switches), HEAD + STAMP * _is_synced(head)
    ticks = [int.from_bytes(head[at + k * size :][:TIME_SIZE], "little") for k in range(LEAST_SAMPLES)]
    if len(head) < at + LEAST_SAMPLES * size:
        return len(head) == HEAD
    slack = max(period // 16, 2)
    return any(abs((after - before) % TURN - period) <= slack for before, after in pairwise(ticks))


def card_recording(path: Path) -> str:
    """What the parts of one recording have in common: the folder that holds them."""
    return path.parent.name if path.stem.isdigit() else path.stem


def read_card(files: Sequence[Path]) -> ImportedSensor:
    """Read one sensor's parts of a folder, in any order; raises FileRefusedError, or OSError if unreadable."""
    parts = sorted((_part(path) for path in files), key=lambda part: int(part.ticks[0]))
    name, first = card_recording(files[0]), parts[0]
    if any(part.period != first.period or part.is_synced != first.is_synced for part in parts):
        raise FileRefusedError(
            name, "the parts of the recording were made with different settings", "Import each recording separately"
        )
    ticks = np.concatenate([part.ticks for part in parts])
    clock = repaired(ticks / TICK_HZ, FileClock(name, lambda row: f"sample {row + 1}", "its clock"))
    is_new = clock.is_new
    block = ImuBlock(
        sensor=name,
        time_s=clock.stamps[is_new],
        gyr_rad_s=np.concatenate([part.rate for part in parts])[is_new],
        acc_m_s2=np.concatenate([part.force for part in parts])[is_new],
    )
    check_magnitudes(block.acc_m_s2, block.gyr_rad_s, name, name, is_export=False)
    info = SensorInfo(serial=name, model="Shimmer3", rate_hz=round(TICK_HZ / first.period, 3))
    return ImportedSensor(name, tuple(path.name for path in files), str(files[0]), block, info, clock.findings)


def is_synchronised(path: Path) -> bool:
    """Give whether the clock was set by radio while it recorded; raises OSError where it cannot be read."""
    with path.open("rb") as file:
        return _is_synced(file.read(HEAD))


def _part(path: Path) -> CardPart:
    data = path.read_bytes()
    head = data[:HEAD]
    if len(head) < HEAD:
        raise FileRefusedError(
            path.name, "the file ends before its header is complete", "Copy the file again from the card"
        )
    period, switches = _head(head)
    is_synced, size = _is_synced(head), _size(switches)
    places, at = {}, TIME_SIZE
    for what, (bit, count) in ORDER.items():
        if switches >> bit & 1:
            places[what] = at
            at += count
    acc = next((what for what in ("acc_wide", "acc_low_noise") if what in places), "")
    if not acc or "rate" not in places:
        raise FileRefusedError(path.name, "the gyroscope or the accelerometer was not switched on", SET_IT)
    samples, offsets = _samples(np.frombuffer(data, np.uint8, offset=HEAD), size, is_synced)
    if not len(samples):
        raise FileRefusedError(path.name, "the file contains no samples", "Choose another recording on the card")
    times = samples[:, :TIME_SIZE].astype(np.int64)
    raw: Ticks = times[:, 0] | times[:, 1] << 8 | times[:, 2] << 16
    begun = int.from_bytes(head[START + 1 : START + 5] + head[START : START + 1], "little")
    ticks: Ticks = begun + _since(raw, begun, period)
    if len(offsets):  # how far it was ahead, at the samples that followed; between them its clock runs evenly
        ticks = ticks - np.rint(_ahead(path.name, offsets, len(ticks), period)).astype(np.int64)
    real = int.from_bytes(head[REAL_TIME : REAL_TIME + 8], "big")
    return CardPart(
        ticks + (real if real < MOST_TICKS else 0),
        _vector(path, head, samples, "rate", places["rate"], ">i2", GYR_SCALE),
        _vector(path, head, samples, acc, places[acc], "<i2", 1.0),
        period,
        is_synced,
    )


def _since(raw: Ticks, begun: int, period: int) -> Ticks:
    """(n,) ticks since the recording began, by its samples' times; the first of these may be wrong itself."""
    since = without_turns(raw, TURN) - raw[0]
    later = without_turns(np.array([begun % TURN, *raw[1:2]]), TURN)
    if len(raw) > 1 and 0 < later[1] - later[0] < 2 * period:
        since += later[1] - later[0] - since[1]
    return since


def _ahead(name: str, offsets: Sequence[tuple[int, int]], count: int, period: int) -> FloatArray:
    """(count,) ticks by which the clock is ahead, by a line through the radio's values, of which a few may be wrong."""
    at_sample, ahead = np.array(offsets, dtype=float).T
    if len(offsets) < 2:
        return np.full(count, ahead[0])
    half = len(offsets) // 2
    first, later = slice(len(offsets) - half), slice(half, None)
    slope = np.median((ahead[later] - ahead[first]) / (at_sample[later] - at_sample[first]))
    off = ahead - slope * at_sample
    is_right = np.abs(off - np.median(off)) < MOST_AHEAD_OFF
    line = np.polyfit(at_sample[is_right], ahead[is_right], 1 if is_right.sum() > 1 else 0)
    slope = line[0] if len(line) > 1 else 0.0
    if abs(slope) > MOST_OFF_RATE * period:
        raise FileRefusedError(
            name,
            "the times in the file give {found} samples per second, expected {reported}",
            "Synchronise the sensors again in Consensys, then record again",
            found=plain(TICK_HZ / (period - slope), 4),
            reported=plain(TICK_HZ / period, 4),
        )
    return np.asarray(np.polyval(line, np.arange(count)))


def _samples(body: Bytes, size: int, is_synced: bool) -> tuple[Bytes, list[tuple[int, int]]]:
    """(n, size) whole samples, and by the number of a block's first sample how many ticks the clock was ahead."""
    stamp = STAMP * is_synced
    count = (BLOCK - stamp) // size
    length = stamp + count * size
    blocks, rest = divmod(len(body), length)
    whole = body[: blocks * length].reshape(blocks, length)
    last = body[blocks * length + stamp :][: max((rest - stamp) // size, 0) * size]
    samples = np.concatenate([whole[:, stamp:].reshape(-1, size), last.reshape(-1, size)])
    offsets = []
    for k in range(blocks if is_synced else 0):
        sign, ahead = struct.unpack("<BQ", whole[k, :STAMP].tobytes())
        if ahead < MOST_TICKS and sign in (0, 1):
            offsets.append((k * count, int(ahead) * (1 - 2 * sign)))
    return samples, offsets


def _vector(path: Path, head: bytes, samples: Bytes, what: str, place: int, numbers: str, scale: float) -> FloatArray:
    try:
        offset, matrix = calibrating(head[CALIBRATIONS[what] :][:CALIBRATION_SIZE], scale)
    except ValueError as problem:
        raise FileRefusedError(
            path.name, "the file contains no calibration", "Calibrate the sensor in Consensys, and record again"
        ) from problem
    raw = np.ascontiguousarray(samples[:, place : place + 6]).view(numbers).astype(float)
    return np.asarray((raw - offset) @ matrix.T)


def _head(head: bytes) -> tuple[int, int]:
    """Ticks of a period, and the switches of what is measured."""
    return int.from_bytes(head[PERIOD : PERIOD + 2], "little"), int.from_bytes(head[SWITCHES : SWITCHES + 3], "little")


def _size(switches: int) -> int:
    return TIME_SIZE + sum(count for bit, count in ORDER.values() if switches >> bit & 1)


def _is_synced(head: bytes) -> bool:
    return bool(head[SETTINGS] & SYNCHRONISED)
