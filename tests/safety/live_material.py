"""What is played live where sources are pulled and machines held up: samples that say which one they are."""

import time
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from uuid import UUID

import numpy as np

from app.storage.journal.decoding import DecodedJournal, decode
from app.storage.journal.writer import JournalWriter
from core.body import LEG_SITES
from core.samples import ImuBlock, IntArray, SensorInfo
from core.session import Recording, RecordingKind, Session
from devices.source import DecodedSensor
from tests.safety.journal_material import KEY, NO_ROOM_ASKED

RATE_HZ = 200.0
LOOP = 1000  # samples; then they come again
TICK_S = 0.001


class Clock:
    """The host's clock, injected: it goes on where somebody sleeps by it, and when it is given to."""

    def __init__(self) -> None:
        self.time_ns = 5_000_000_000_000

    def __call__(self) -> int:
        return self.time_ns

    def sleep(self, seconds: float) -> None:
        self.time_ns += round(seconds * 1e9)
        time.sleep(TICK_S)  # others want to work, too


def numbered(sensor: str, count: int = LOOP, rate_hz: float = RATE_HZ) -> ImuBlock:
    """Samples whose first rate is their number."""
    number = np.arange(count, dtype=float)
    gyr = np.stack([number, np.sin(number / 7), np.cos(number / 7)], axis=1)
    return ImuBlock(sensor, number / rate_hz, gyr, np.stack([number * 0.0, number * 0.0, 9.81 + gyr[:, 1]], axis=1))


def numbered_session(name: str, sensors: int = 6, rate_hz: float = RATE_HZ) -> Session:
    """Standing, five seconds of it at 200 Hz, that a replay plays over and over."""
    sites = LEG_SITES[:sensors]
    imu = {site: numbered(f"{name}-{site}", rate_hz=rate_hz) for site in sites}
    standing = Recording("standing", RecordingKind.STANDING, "standing", imu)
    known = {site: SensorInfo(serial=imu[site].sensor, rate_hz=rate_hz) for site in sites}
    return Session((standing,), sensors=known, is_simulated=True)


def open_journal(folder: Path, recording_id: UUID, **settings: object) -> JournalWriter:
    return JournalWriter.create(folder, recording_id, KEY, room=NO_ROOM_ASKED, **settings)  # type: ignore[arg-type]  # each caller names its own


def read_back(paths: Sequence[Path]) -> DecodedJournal:
    return decode(paths, KEY, {})


def gaps_of(decoded: DecodedSensor) -> list[int]:
    """How many samples each gap lacks, by the samples' own numbers; a gap is no longer than `LOOP`."""
    number: IntArray = decoded.block.gyr_rad_s[:, 0].astype(np.int64)
    return [step - 1 for step in (np.diff(number) % LOOP).tolist() if step != 1]


def faults_of(sensors: Mapping[str, DecodedSensor], required: Mapping[str, int]) -> list[str]:
    """What is wrong with sensors that should have so many gaps each: nothing, where each gap is right to a sample."""
    faults = []
    for name, gaps in required.items():
        decoded = sensors.get(name)
        if decoded is None:
            faults.append(f"{name} is not there")
            continue
        found, time_s = gaps_of(decoded), decoded.block.time_s
        reported = [round(step * RATE_HZ) - 1 for step in np.diff(time_s).tolist() if step > 1.5 / RATE_HZ]
        if time_s[0] < 0 or not all(later > earlier for earlier, later in pairwise(time_s.tolist())):
            faults.append(f"{name}: its times go back")
        if len(found) != gaps or reported != found or decoded.counts.lost != sum(found):
            faults.append(f"{name}: {found} are missing, {reported} by its clock, {decoded.counts.lost} counted")
    return faults
